"""Write the list of the signatures of all compiled functions again: those of the code that the tests have left on disk.

pytest && python tests/signatures.py
"""

import json
import pkgutil
from importlib import import_module
from inspect import signature
from pathlib import Path

import imuwb
from imuwb.compiled import kernels
from imuwb.readers.bytes.loops import compiled_loop, late
from imuwb.signatures import NAME, listed, text_of


def found() -> dict[str, list]:
    """Return {module:function: signatures} of the code that is kept."""
    for module in pkgutil.walk_packages(imuwb.__path__, "imuwb."):
        if not module.name.endswith("__main__"):
            import_module(module.name)
    for function in late.values():
        compiled_loop(function)
    before, every = listed(), dict[str, list]()
    for name, kernel in sorted(kernels.items()):
        kept = [list(map(text_of, one)) for one in sorted(kernel._cache.signatures(), key=str)]  # noqa: SLF001
        count = len(signature(kernel.py_func).parameters)
        # Of a function that has not changed since, code of some signatures may not be there: their lines stay.
        more = [one for one in before.get(name, []) if len(one) == count and one not in kept]
        if not kept and not more:
            print(f"no code is kept of {name}: run its tests first, unless compiled code alone calls it")
        # What has a literal is called by compiled code alone, and is compiled with it.
        if outer := [one for one in (*kept, *more) if None not in one]:
            every[name] = outer
    return every


if __name__ == "__main__":
    every = found()
    texts = {name: ",\n ".join(map(json.dumps, signatures)) for name, signatures in every.items()}
    lines = ",\n".join(f'"{name}": [\n {text}\n]' for name, text in texts.items())
    (Path(imuwb.__file__).parent / NAME).write_text(f"{{\n{lines}\n}}\n", "utf-8")

"""Write the signatures of all compiled functions again: of the code that the tests have left on disk.

pytest && python tests/signatures.py
"""

import json
import pkgutil
from importlib import import_module
from pathlib import Path

import imuwb
from imuwb.compiled import kernels
from imuwb.signatures import NAME, text_of


def found() -> dict[str, list]:
    """Return {module:function: signatures} of the code that is kept."""
    for module in pkgutil.walk_packages(imuwb.__path__, "imuwb."):
        if not module.name.endswith("__main__"):
            import_module(module.name)
    kept = {name: sorted(kernels[name]._cache.signatures(), key=str) for name in sorted(kernels)}  # noqa: SLF001
    missing = [name for name, signatures in kept.items() if not signatures]
    if missing:
        raise SystemExit(f"no code is kept of {', '.join(missing)}; run pytest first")
    listed = {name: [list(map(text_of, signature)) for signature in signatures] for name, signatures in kept.items()}
    # What has a literal is called by compiled code alone, and is compiled with it.
    outer = {name: [one for one in signatures if None not in one] for name, signatures in listed.items()}
    return {name: signatures for name, signatures in outer.items() if signatures}


if __name__ == "__main__":
    listed = found()
    texts = {name: ",\n ".join(map(json.dumps, signatures)) for name, signatures in listed.items()}
    lines = ",\n".join(f'"{name}": [\n {text}\n]' for name, text in texts.items())
    (Path(imuwb.__file__).parent / NAME).write_text(f"{{\n{lines}\n}}\n", "utf-8")

"""Coverage-guided fuzzing of a whole reader, with atheris, in pure Python.

``pip install atheris`` (Linux), then ``python -m tests.fuzz.coverage_guided flight.ulg -max_total_time=600``. The name is that of a sound
log (``tests/fuzz/seeds.py``), from which the fuzzer begins; the other arguments are those of libFuzzer. An input that gives a traceback,
or takes more than 5 s, is written to the working folder as ``crash-...`` or ``timeout-...``.
"""

import importlib
import os
import pkgutil
import sys
import tempfile
import warnings
from pathlib import Path

os.environ["NUMBA_DISABLE_JIT"] = "1"  # compiled loops have no branches that a fuzzer sees

import atheris  # pyright: ignore[reportMissingImports]

with atheris.instrument_imports(include=["imuwb.readers"]):  # all modules: readers import their decoders late
    from imuwb import readers
    from imuwb.errors import ImuwbError

    for module in pkgutil.walk_packages(readers.__path__, "imuwb.readers."):
        if module.name.rpartition(".")[2] not in ("novatel_messages", "mdf_export"):  # extras
            importlib.import_module(module.name)


def main() -> None:
    """Run the fuzzer."""
    from tests.fuzz.seeds import write

    name = sys.argv.pop(1)
    folder = Path(tempfile.mkdtemp())
    for part in ("seeds", "corpus"):
        (folder / part).mkdir()
    sound = write(folder / "seeds")[name]
    (folder / "corpus" / "sound").write_bytes(sound)
    path = folder / name

    def one(data: bytes) -> None:
        path.write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                readers.read(path)
        except ImuwbError:
            pass

    limits = "-timeout=5", "-rss_limit_mb=2048", f"-max_len={2 * len(sound)}"
    atheris.Setup([sys.argv[0], *limits, *sys.argv[1:], str(folder / "corpus")], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()

"""Coverage-guided fuzzing of a whole reader, with atheris, in pure Python.

``pip install atheris`` (Linux), then ``python -m tests.fuzz.coverage_guided flight.ulg -max_total_time=600``. The name is that of a sound
log (``tests/fuzz/seeds.py``), from which the fuzzer begins; the other arguments are those of libFuzzer. An input that gives a traceback,
or takes more than 5 s, is written to the working folder as ``crash-...`` or ``timeout-...``.

Half of the inputs are changed by libFuzzer, half with lengths and checksums made right again (``mutators.py``). For speed, the log is short
and in memory, and the reader starts no threads.
"""

import importlib
import os
import pkgutil
import random
import sys
import tempfile
import warnings
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path
from typing import Self

os.environ["NUMBA_DISABLE_JIT"] = "1"  # compiled loops have no branches that a fuzzer sees

import atheris  # pyright: ignore[reportMissingImports]

ROWS = 4  #: of the sound log
MEMORY = Path("/dev/shm")  # noqa: S108 - a folder that is no disk


class Here:
    """An executor without threads: it does the work at once."""

    def __init__(self, workers: int) -> None:
        del workers

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def submit(self, work, *given) -> Future:
        done = Future()
        try:
            done.set_result(work(*given))
        except BaseException as error:  # noqa: BLE001 - raised by ``result``
            done.set_exception(error)
        return done


with atheris.instrument_imports(include=["imuwb.readers"]):  # all modules: readers import their decoders late
    from imuwb.readers.bytes import ahead

    ahead.ahead = lambda items, *_: items
    from imuwb import readers
    from imuwb.errors import ImuwbError
    from imuwb.readers import reading

    reading.ThreadPoolExecutor = Here
    for module in pkgutil.walk_packages(readers.__path__, "imuwb.readers."):
        if module.name.rpartition(".")[2] not in ("novatel_messages", "mdf_export"):  # extras
            importlib.import_module(module.name)


def main() -> None:
    """Run the fuzzer."""
    from tests.fuzz import seeds
    from tests.fuzz.mutators import damaged

    name = sys.argv.pop(1)
    seeds.ROWS = ROWS
    folder = Path(tempfile.mkdtemp(dir=MEMORY if MEMORY.is_dir() else None))
    for part in ("seeds", "corpus"):
        (folder / part).mkdir()
    sound = seeds.write(folder / "seeds")[name]
    (folder / "corpus" / "sound").write_bytes(sound)
    path, options = folder / name, readers.ReadOptions()

    def mutated(data: bytes, most: int, seed: int) -> bytes:
        rng = random.Random(seed)  # noqa: S311 - libFuzzer's own seed
        if rng.random() < 0.5:
            with suppress(Exception):  # what is damaged already may have no structure
                return damaged(name, data, rng)[:most]
        return atheris.Mutate(data, most)

    def one(data: bytes) -> None:
        path.write_bytes(data)
        with suppress(ImuwbError):
            readers.read(path, options)

    limits = "-timeout=5", "-rss_limit_mb=2048", f"-max_len={max(2 * len(sound), 1024)}"
    atheris.Setup([sys.argv[0], *limits, *sys.argv[1:], str(folder / "corpus")], one, custom_mutator=mutated)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atheris.Fuzz()


if __name__ == "__main__":
    main()

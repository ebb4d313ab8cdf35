"""What the command line sets in its own process, so that it starts and ends fast; a program that uses imuwb is left alone.

* pyarrow looks for pandas at its first array, and numba for cffi at its first compiled function. imuwb uses neither; where they are
  installed, their imports take a tenth of a second each.
* OpenBLAS, which numpy and scipy bring along, starts threads that wait in a loop after every product of matrices. The matrices of
  imuwb are small: with one thread the same results take a fifth less CPU time, and no more time by the clock.
* When a command is done, its process ends at once. Python would look through all objects for garbage, and a thread of a library that
  drops an object of Python meanwhile, as pyarrow's reading ahead does, would abort the process after its work was done.
"""

import atexit
import gc
import os
import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from importlib.abc import MetaPathFinder
from types import ModuleType

OBJECTS = 50_000  #: new objects after which Python looks for garbage; imports make many that stay
ROUNDS = 40  #: rounds after which it looks among the objects that stayed too
THREADS = "OPENBLAS_NUM_THREADS"  #: read when numpy and scipy are imported

_own = False  # whether the process is that of the command line
_given = os.environ.get(THREADS)


def command_line() -> None:
    """State that the process is that of imuwb's command line. numpy must not be imported yet."""
    global _own  # noqa: PLW0603 - a process has one state
    _own = True
    gc.set_threshold(OBJECTS, ROUNDS)
    os.environ.setdefault(THREADS, "1")


def run_program(program: Callable[[], None]) -> None:
    """Run the program of this process, and end the process when it is done. Nothing else of this process may follow."""
    code: object = 1
    # Registered before all others, so it runs after them, when all threads of Python have ended.
    atexit.register(lambda: _end(code))
    try:
        program()
        code = 0
    except SystemExit as leaving:
        code = leaving.code or 0
        raise


def _end(code: object) -> None:
    if not isinstance(code, int):  # a sentence, which Python prints
        return
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except (OSError, ValueError):  # Python says so, in its own words
        return
    os._exit(code)


def environment() -> dict[str, str]:
    """Return the environment for another program, as it was given to this one."""
    others = {name: value for name, value in os.environ.items() if name != THREADS}
    return others if _given is None else {**others, THREADS: _given}


@contextmanager
def without(package: str) -> Generator[None]:
    """Within this context, a package that is not imported yet counts as not installed, if the process is that of the command line."""
    if not _own:
        yield
        return
    finder = _Without(package)
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)


class _Without(MetaPathFinder):
    def __init__(self, package: str) -> None:
        self._package = package

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        """Raise ModuleNotFoundError for the package; find nothing else."""
        del path, target
        if fullname == self._package:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)

"""A limit of the memory that a library may take for a log: a packed file may unpack to any size inside the library, which asks nobody.

Only Linux limits a process by what it has now. Elsewhere nothing is limited: macOS has the limit of addresses but does not enforce
it, and a job object of Windows would need the C interface of the system, which no test here could try. A watch of the process, as
that of ``imuwb.fleet.bounds``, ends it: it suits a child process, and not the program that a person runs.
"""

import mmap
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path

from imuwb.readers.bytes import budget

SPARE = 64 << 20  #: bytes of addresses that threads and allocators reserve and do not use


@contextmanager
def limited() -> Generator[None]:
    """Let this process take no more memory than the log may; a library that asks for more gets none.

    Raises:
        OverBudgetError: in place of MemoryError.
    """
    before = _lower()
    try:
        yield
    except MemoryError as error:
        raise budget.current().over("its content does not fit in the memory for it") from error
    finally:
        if before is not None:
            _set(before)


def check_room(size: int) -> None:
    """Raise MemoryError if this process cannot have this many bytes more, for a library that ends the process in that case."""
    try:
        mmap.mmap(-1, size).close()
    except OSError as error:
        raise MemoryError from error


def _lower() -> tuple[int, int] | None:
    """Lower the limit of this process, and return the one before; None: there is none to lower."""
    with suppress(ImportError, OSError, ValueError):
        import resource  # noqa: PLC0415 - not on Windows

        before = resource.getrlimit(resource.RLIMIT_AS)
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        most = pages * resource.getpagesize() + SPARE + budget.current().most * budget.SHARES
        if before[0] == resource.RLIM_INFINITY or most < before[0]:
            resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
            return before
    return None


def _set(limit: tuple[int, int]) -> None:
    import resource  # noqa: PLC0415 - not on Windows

    resource.setrlimit(resource.RLIMIT_AS, limit)

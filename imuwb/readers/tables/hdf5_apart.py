"""Opens an HDF5 file in a process of its own first: at damaged bytes the library may not end, or may end its process.

``python -m imuwb.readers.tables.hdf5_apart FILE MEMORY matlab|other`` reads all arrays and tells nothing.
"""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget

LONGEST, SLOWEST = 4.0, 2e6  #: s of the processor, and bytes each s; a reading that takes longer does not end
CPU_TIME = getattr(signal, "SIGXCPU", 0)  #: ends a process that has worked too long; not on Windows
PATIENCE = 15.0  #: how many times as long the clock on the wall may take


def check_apart(path: Path, *, matlab: bool = False) -> None:
    """Raise UnreadableLogError if the library does not end, or ends its process."""
    longest = LONGEST + path.stat().st_size / SLOWEST
    memory = budget.current().most * budget.SHARES / 1e9
    words = ["-P", "-m", __name__, str(path), f"{memory:g}", "matlab" if matlab else "other"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    endless = f"{path}: the HDF5 library does not end within {longest:.0f} s; the file is damaged: copy it again"
    run = partial(subprocess.run, capture_output=True, check=False, timeout=PATIENCE * longest, env=environment)
    try:
        done = run([sys.executable, *words])
    except subprocess.TimeoutExpired as error:
        raise UnreadableLogError(endless) from error
    if done.returncode == -CPU_TIME:
        raise UnreadableLogError(endless)
    if done.returncode < 0:
        raise UnreadableLogError(
            f"{path}: the HDF5 library fails (signal {-done.returncode}); the file is damaged: copy it again"
        )


def main() -> None:
    """Read all arrays of a file; whoever asked reads them again, and tells what is wrong."""
    from imuwb.readers.bytes.budget import Budget, under  # noqa: PLC0415
    from imuwb.readers.tables.hdf5_arrays import tree_of  # noqa: PLC0415

    file, memory, kind = sys.argv[1:]
    _limit_time(Path(file).stat().st_size)
    with suppress(Exception):
        under(Budget(memory=float(memory)), lambda: tree_of(Path(file), [], matlab=kind == "matlab"))


def _limit_time(size: int) -> None:
    """End this process when it has worked too long, also if the process that asked has ended."""
    with suppress(ImportError, ValueError, OSError):
        import resource  # noqa: PLC0415 - not on Windows

        seconds = int(LONGEST + size / SLOWEST)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


if __name__ == "__main__":
    main()

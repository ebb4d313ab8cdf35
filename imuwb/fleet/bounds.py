"""Bounds of time and memory within a process, where its system has them.

The bound of time is an alarm (POSIX), which interrupts Python and waiting, and compiled code when it returns; the bound of memory is the limit
of the data of the process (Linux), which makes the next request for memory fail. Whoever started the process kills it if it does
not heed them, and ``watch`` ends it elsewhere.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from types import FrameType

from imuwb.fleet.executor import Bounds

MEMORY_EXIT = 77  #: exit code of a process that took too much memory
IMPORTS = "<frozen importlib"  #: begin of the file name of Python's own code of imports
AGAIN = 1.0  #: s between two alarms, until one is heeded
PERIOD = 0.25  #: s between two looks of ``watch``
tripped: list[str] = []  #: bounds that were reached: the process may have threads that go on, so it should end


class OutOfTimeError(BaseException):
    """The bound of time was reached; no ``except Exception`` catches it."""


@contextmanager
def bounded(bounds: Bounds) -> Generator[None]:
    """Raise OutOfTimeError or MemoryError within the block if it takes more than it may.

    Only the main thread gets the alarm.
    """
    with _timed(bounds.seconds), _limited(bounds.memory):
        try:
            yield
        except MemoryError:
            tripped.append("memory")
            raise


@contextmanager
def _timed(seconds: float) -> Generator[None]:
    main = threading.current_thread() is threading.main_thread()
    if sys.platform == "win32" or not main:
        yield
        return

    def end(number: int, frame: FrameType | None) -> None:
        del number
        while (
            frame is not None
        ):  # an import that is torn leaves its lock, and the next import of another thread waits for ever
            if frame.f_code.co_filename.startswith(IMPORTS):
                return
            frame = frame.f_back
        tripped.append("time")
        raise OutOfTimeError

    before = signal.signal(signal.SIGALRM, end)
    # Again and again: an import, or code that drops all exceptions, such as a finalizer, may be running at the first alarm.
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def _limited(memory: float) -> Generator[None]:
    used = _data()
    if sys.platform != "linux" or used is None:
        yield
        return
    import resource  # noqa: PLC0415 - of that system alone

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    ends = [int(used + memory), *(end for end in (soft, hard) if end != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_DATA, (min(ends), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _data() -> int | None:
    """Return the bytes of data that this process has asked for; None: the system does not say."""
    try:
        lines = Path("/proc/self/status").read_text("ascii", "replace").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmData:")), None)


class Watch:
    """Ends this process when its parent has ended, or when it takes more memory than it may."""

    def __init__(self) -> None:
        """Begin."""
        self.memory = 0.0  #: bytes that the call may take; 0: no call
        self._parent = os.getppid()
        self._process = None
        if find_spec("psutil") is not None:
            import psutil  # noqa: PLC0415 - an optional package

            self._process = psutil.Process()
        self._least = self._resident()
        threading.Thread(target=self._look, daemon=True).start()

    def _resident(self) -> int:
        return 0 if self._process is None else self._process.memory_info().rss

    def _look(self) -> None:
        while True:
            time.sleep(PERIOD)
            if os.getppid() != self._parent:
                os._exit(1)
            if self.memory and self._resident() - self._least > 2 * self.memory:  # far beyond what the system lets pass
                os._exit(MEMORY_EXIT)

"""A process of this machine that runs one call at a time, and is started again after it has ended."""

import os
import pickle
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from typing import Any, cast

from imuwb import own_process
from imuwb.fleet.bounds import MEMORY_EXIT
from imuwb.fleet.executor import Call, Completed, Fault, memory_fault, time_fault

GRACE = 10.0  #: s after the bound of time, in which the process may end the call itself
STARTING = 300.0  #: s until a call is prepared
#: libraries that start threads of their own -> their variable
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
#: signals that come from outside; a process that ends by another one has a fault
OUTSIDE = tuple(getattr(signal, name, None) for name in ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT"))


def warm() -> None:
    """Compile what workers on this machine need (``imuwb warm``), in a process of its own; where that fails, each worker does it."""
    with suppress(OSError):
        subprocess.run(
            [sys.executable, "-m", "imuwb", "warm"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=_environment(), check=False,
        )  # fmt: skip


def _environment() -> dict[str, str]:
    return {**own_process.environment(), **dict.fromkeys(THREADS, "1")}


class OwnChild:
    """A process that runs calls, each within its bounds; it is started by its first call."""

    def __init__(self) -> None:
        """Start nothing yet."""
        self._process: subprocess.Popen[bytes] | None = None
        self._closed = False

    def call(self, number: int, call: Call) -> Completed:
        """Return what becomes of a call. A process that exceeds its bounds is killed."""
        try:
            packed = pickle.dumps(pickle.dumps(call))
        except Exception as error:  # noqa: BLE001 - of many types
            return Completed(number, fault=Fault("fault", f"the call cannot be sent to a process: {error}"))
        late, began = threading.Event(), False
        try:
            process = self._started()
        except (OSError, RuntimeError) as error:
            return Completed(number, fault=Fault("lost", f"no process can be started for it: {_reason(error)}"))
        try:
            self._send(process, packed)
            self._answer(process, STARTING, late)
            began = True
            done = cast("Completed", self._answer(process, call.bounds.seconds + GRACE, late))
        except (EOFError, OSError, pickle.UnpicklingError):
            self._process = None
            code = self._ended(process)
            fault = _fault(code, call, late=late.is_set()) if began else _no_start(code, late=late.is_set())
            return Completed(number, fault=fault, worker=str(process.pid))
        except Exception as error:  # noqa: BLE001 - an answer may raise anything when it is unpacked
            self.drop()
            fault = Fault("lost", f"its process gave no answer that can be read: {_reason(error)}")
            return Completed(number, fault=fault, worker=str(process.pid))
        except BaseException:
            self.close()
            raise
        if done.fault is not None and done.fault.kind in ("time", "memory"):  # it ends after such an answer
            self._process = None
            self._ended(process)
        return Completed(number, done.value, done.fault, str(process.pid))

    def kill(self) -> None:
        """End the process and start none again; any thread may do so, and a call under way has a fault."""
        self._closed, process = True, self._process
        if process is not None:
            process.kill()

    def close(self) -> None:
        """End the process and start none again, from the thread that calls it."""
        self.kill()
        self.drop()

    def drop(self) -> None:
        """End the process, from the thread that calls it; the next call starts another."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            self._ended(process)

    def runs(self) -> bool:
        """Return whether there is a process; any thread may ask."""
        process = self._process
        return process is not None and process.poll() is None

    def start(self) -> bool:
        """Start the process unless it runs, and return whether it does."""
        try:
            self._started()
        except (OSError, RuntimeError):
            return False
        return True

    def _started(self) -> "subprocess.Popen[bytes]":
        if self._process is not None and self.runs():
            return self._process
        errors = None if os.environ.get("IMUWB_TRACEBACK") else subprocess.DEVNULL
        self._process = subprocess.Popen(
            [sys.executable, "-m", "imuwb.fleet.child"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, env=_environment(), start_new_session=os.name == "posix",
        )  # fmt: skip
        if self._closed:
            self._process.kill()
        with suppress(OSError):
            self._send(self._process, pickle.dumps(sys.path))
        return self._process

    @staticmethod
    def _send(process: "subprocess.Popen[bytes]", packed: bytes) -> None:
        stdin = cast("Any", process.stdin)
        stdin.write(packed)
        stdin.flush()

    @staticmethod
    def _answer(process: "subprocess.Popen[bytes]", seconds: float, late: threading.Event) -> object:
        """Return the next answer; EOFError, after the process is killed, if it takes longer."""

        def end() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(seconds, end)
        timer.daemon = True
        timer.start()
        try:
            return pickle.load(cast("Any", process.stdout))  # noqa: S301 - from our own process
        finally:
            timer.cancel()

    @staticmethod
    def _ended(process: "subprocess.Popen[bytes]") -> int:
        """Close the pipes of a process that ends, and return its exit code."""
        with suppress(OSError):
            cast("Any", process.stdin).close()
        cast("Any", process.stdout).close()
        try:
            return process.wait(GRACE)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()


def _fault(code: int, call: Call, *, late: bool) -> Fault:
    """Return why a process ended in a call that had begun, by its exit code."""
    if late:
        return time_fault(call.bounds)
    if code == MEMORY_EXIT:
        return memory_fault(call.bounds)
    if code < 0 and -code in OUTSIDE:
        return Fault("lost", f"its process was ended from outside (signal {-code})")
    if code < 0:
        return Fault("crash", f"its process crashed (signal {-code})")
    return Fault("lost", f"its process ended (exit code {code})")


def _no_start(code: int, *, late: bool) -> Fault:
    """Return why a process ended before a call began; the log is not at fault."""
    if late:
        return Fault("lost", f"its worker did not start within {STARTING:g} s: imports and compiled code took too long")
    return Fault(
        "lost", f"its worker ended while it started ({f'signal {-code}' if code < 0 else f'exit code {code}'})"
    )


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__

"""Runs calls in this process, one after the other."""

from collections import deque
from collections.abc import Iterator

from imuwb.fleet.bounds import OutOfTimeError, bounded
from imuwb.fleet.executor import Call, Completed, Fault, TransportError, memory_fault, time_fault


def prepared(number: int, call: Call) -> Completed | None:
    """Do what must be done before a call; return its fault if that fails."""
    try:
        if call.prepare is not None:
            call.prepare(call.argument)
    except Exception as error:  # noqa: BLE001 - a plugin may raise anything
        return Completed(number, fault=Fault("fault", f"{type(error).__name__}: {error}"))
    return None


def outcome(number: int, call: Call) -> Completed:
    """Return what becomes of a prepared call in this process. The bounds hold where the system has them."""
    try:
        with bounded(call.bounds):
            return Completed(number, call.function(call.argument))
    except OutOfTimeError:
        fault = time_fault(call.bounds)
    except MemoryError:
        fault = memory_fault(call.bounds)
    except TransportError as error:
        fault = Fault("transport", str(error))
    except Exception as error:  # noqa: BLE001 - the function may raise anything
        fault = Fault("fault", f"{type(error).__name__}: {error}")
    return Completed(number, fault=fault)


class InProcess:
    """An executor in this process. A call that hangs in compiled code is not interrupted."""

    name, link, slots = "this process", "", 1

    def __init__(self) -> None:
        """Have no calls."""
        self._calls: deque[tuple[int, Call]] = deque()

    def warm(self) -> None:
        """Do nothing: one process compiles what it needs."""

    def submit(self, number: int, call: Call) -> None:
        """Take a call."""
        self._calls.append((number, call))

    def as_completed(self) -> Iterator[Completed]:
        """Run the calls in their order."""
        while self._calls:
            number, call = self._calls.popleft()
            yield prepared(number, call) or outcome(number, call)

    def close(self) -> None:
        """Drop the calls."""
        self._calls.clear()

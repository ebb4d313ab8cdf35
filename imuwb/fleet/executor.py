"""The protocol of what runs calls: in this process, in processes of this machine, or on a cluster.

``submit`` takes a call, ``as_completed`` yields what became of the calls, each as soon as it is ready and in any order, and ``close``
ends the workers. A call is a function that workers can import, its argument, and bounds of time and memory. A call that returns or
raises is the worker's own matter; ``Fault`` states why a call gave no value.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from imuwb.errors import ImuwbError

#: "time" and "memory": a bound was reached. "lost": the worker ended from outside, by a signal or with its machine. "crash": the worker
#: ended by itself, in compiled code. "transport": a store or a network failed. "fault": the function raised
FaultKind = Literal["time", "memory", "lost", "crash", "transport", "fault"]


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much a call may take."""

    seconds: float
    memory: float  #: bytes, besides those of a worker that waits


@dataclass(frozen=True, slots=True)
class Call:
    """A function of a module, to be called with one argument."""

    function: Callable[[Any], Any]
    argument: Any
    bounds: Bounds
    prepare: Callable[[Any], None] | None = None  #: is called with the argument first, outside the bounds: imports


@dataclass(frozen=True, slots=True)
class Fault:
    """Why a call gave no value."""

    kind: FaultKind
    message: str


@dataclass(frozen=True, slots=True)
class Completed:
    """What became of a call."""

    number: int  #: as it was submitted
    value: Any = None
    fault: Fault | None = None
    worker: str = ""


class TransportError(ImuwbError):
    """A store or a network failed; another attempt may succeed."""


class Executor(Protocol):
    """What runs calls."""

    @property
    def name(self) -> str:
        """What it is, in a few words: "4 processes"."""
        ...

    @property
    def slots(self) -> int:
        """Return how many calls it works on at a time."""
        ...

    @property
    def link(self) -> str:
        """Address of a page that shows its work; empty: it has none."""
        ...

    def warm(self) -> None:
        """Compile what the workers need, once on each machine, so that they do not do it at the same time."""
        ...

    def submit(self, number: int, call: Call) -> None:
        """Take a call; the number names it."""
        ...

    def as_completed(self) -> Iterator[Completed]:
        """Yield each submitted call that is ready; calls may be submitted meanwhile. It ends when none is left.

        Raises:
            ImuwbError: no worker is left.
        """
        ...

    def close(self) -> None:
        """End the workers; calls that are not ready are dropped."""
        ...


def time_fault(bounds: Bounds) -> Fault:
    """Return the fault of a call that took too long."""
    return Fault("time", f"it took more than {bounds.seconds:g} s; allow more with --task-time")


def memory_fault(bounds: Bounds) -> Fault:
    """Return the fault of a call that took too much memory."""
    return Fault("memory", f"it took more than {bounds.memory / 1e9:g} GB of memory; allow more with --task-memory")

"""How much memory the reading of a log may take: a constant and a multiple of its size, or what the user allows.

A file may state any length, and a small packed file may unpack to any size. So each place that takes memory by what a file states, or by
what it unpacks to, asks first. The budget is that of the reading that is under way, also in threads that read ahead.
"""

from collections.abc import Callable, Iterator
from contextvars import ContextVar, copy_context
from dataclasses import dataclass
from typing import TypeVar, cast

from imuwb.errors import UnreadableLogError

CONSTANT = 256 << 20  #: bytes that one part of any log may take: its rows, its largest chunk, its unpacked content
MULTIPLE = 32  #: bytes of such a part for a byte of the log
SHARES = 3  #: such parts that are in memory at a time, with what is computed from them
LONGEST_LINE = 16 << 20  #: bytes of a line of text

Item = TypeVar("Item")

_END = object()


class OverBudgetError(UnreadableLogError):
    """The log needs more memory than its budget."""


@dataclass(frozen=True, slots=True)
class Budget:
    """The memory of one reading."""

    name: str = ""  #: of the log
    size: int = 0  #: bytes of the log
    memory: float | None = None  #: GB that the user allows

    @property
    def most(self) -> int:
        """Bytes of one part of the log."""
        return CONSTANT + MULTIPLE * self.size if self.memory is None else int(self.memory * 1e9 / SHARES)

    def check(self, need: int, what: str) -> None:
        """Raise OverBudgetError if a part of the log takes more bytes than it may."""
        if need > self.most:
            raise self.over(f"{what} would take about {_gigabytes(need)} of memory", need)

    def over(self, fault: str, need: int = 0) -> OverBudgetError:
        """Return the error of a log that needs more memory than it may take; 0 bytes: nobody knows how much more."""
        named = f"{self.name}: " if self.name else ""
        return OverBudgetError(
            f"{named}{fault}, and reading a log of {self.size / 1e6:.3g} MB may take {_gigabytes(self.most)}; if you trust the log and "
            f"have the memory, allow more: --memory {SHARES * (need or 2 * self.most) / 1e9 * 1.2:.2g} (GB)"
        )


_CURRENT: ContextVar[Budget] = ContextVar("budget", default=Budget())  # noqa: B039 - frozen


def current() -> Budget:
    """Return the budget of the reading that is under way."""
    return _CURRENT.get()


def check(need: int, what: str) -> None:
    """Raise OverBudgetError if a part of the log that is being read takes more bytes than it may.

    Args:
        need: bytes.
        what: the part, as the subject of a sentence.
    """
    current().check(need, what)


def check_line(size: int) -> None:
    """Raise UnreadableLogError for a line of text that is longer than any of a log."""
    if size > LONGEST_LINE:
        name = current().name
        raise UnreadableLogError(
            f"{name}{': ' if name else ''}a line has more than {LONGEST_LINE >> 20} MiB; a text log has short lines, so this is no log, or it is damaged"
        )


def within(budget: Budget, items: Callable[[], Iterator[Item]]) -> Iterator[Item]:
    """Yield the items of an iterator, each prepared under a budget."""
    context = copy_context()
    context.run(_CURRENT.set, budget)
    found = context.run(items)
    while (item := context.run(next, found, _END)) is not _END:
        yield cast("Item", item)


def under(budget: Budget, work: Callable[[], Item]) -> Item:
    """Return what a function returns under a budget."""
    context = copy_context()
    context.run(_CURRENT.set, budget)
    return context.run(work)


def _gigabytes(part: int) -> str:
    return f"{SHARES * part / 1e9:.2g} GB"

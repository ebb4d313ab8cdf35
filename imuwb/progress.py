"""Reports to a function how much of a long work is done; without a function the work is the same."""

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Item = TypeVar("Item")
Progress = Callable[[int, int], None]  #: called with (done, all): bytes or rows of a file

_report: ContextVar[Callable[[float], None] | None] = ContextVar("report", default=None)


@contextmanager
def watched(report: Callable[[float], None]) -> Generator[None]:
    """Call ``report`` with the share of the work inside that is done, 0 to 1."""
    token = _report.set(report)
    try:
        yield
    finally:
        _report.reset(token)


def tracked(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Yield the items, of which there are ``count``, and report the share of them that is done.

    Work that is tracked while an item is processed counts as a part of that item.
    """
    outer = _report.get()
    if outer is None:
        yield from items
        return
    for i, item in enumerate(items):
        with watched(lambda share, before=i: outer((before + share) / count)):
            yield item
        outer((i + 1) / count)

"""How far long work is, told to whoever watches; work that nobody watches is the same work."""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    Item = TypeVar("Item")

_watcher: ContextVar[Callable[[float], None] | None] = ContextVar("watcher", default=None)


@contextmanager
def watched(report: Callable[[float], None]) -> Generator[None]:
    """Let ``report`` be told the done part of the work within, 0 to 1."""
    token = _watcher.set(report)
    try:
        yield
    finally:
        _watcher.reset(token)


def tracked(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Yield the items, of which there are ``count``, and tell how many are done.

    What is tracked while an item is worked on counts as a part of that item.
    """
    outer = _watcher.get()
    if outer is None:
        yield from items
        return
    for i, item in enumerate(items):
        with watched(lambda part, before=i: outer((before + part) / count)):
            yield item
        outer((i + 1) / count)

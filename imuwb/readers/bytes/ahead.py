"""Prepares the next items of an iterator while the last one is used, as long as those in memory are small."""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass
from itertools import islice
from threading import Condition
from typing import Generic, TypeVar

Item = TypeVar("Item")

TOGETHER = 64 << 20  #: bytes; while the items in memory have more, no further one is prepared


@dataclass(frozen=True)
class _Ready(Generic[Item]):
    """An item, the end of all items, or the error in the item's preparation."""

    items: tuple[Item, ...] = ()
    error: BaseException | None = None


def ahead(items: Iterator[Item], depth: int, size: Callable[[Item], int] = lambda _: 0) -> Iterator[Item]:
    """Yield the same items in order; another thread prepares up to ``depth`` of them in advance.

    An error in an item's preparation is raised where the item would be yielded.

    Args:
        items: what is prepared, one after another.
        depth: number of items that are prepared in advance at most.
        size: returns the bytes of an item. All items in memory, with the one in use, have 64 MiB and one item at most.
    """
    coming, changed = deque[_Ready[Item]](), Condition()
    held, stopped = 0, False

    def prepare() -> None:
        nonlocal held
        while True:
            with changed:
                changed.wait_for(lambda: stopped or (len(coming) < depth and held <= TOGETHER))  # noqa: B023 - the latest value is meant
                if stopped:
                    return
            try:
                found = _Ready(tuple(islice(items, 1)))
                more = sum(map(size, found.items))
            except BaseException as error:  # noqa: BLE001 - raised in the other thread
                found, more = _Ready[Item](error=error), 0
            with changed:
                coming.append(found)
                held += more
                changed.notify_all()
            if not found.items:
                return

    with ThreadPoolExecutor(1) as thread:
        thread.submit(copy_context().run, prepare)
        try:
            while True:
                with changed:
                    changed.wait_for(lambda: bool(coming))
                    found = coming.popleft()
                    changed.notify_all()
                if found.error is not None:
                    raise found.error
                if not found.items:
                    return
                used = sum(map(size, found.items))
                yield from found.items
                del found
                with changed:
                    held -= used
                    changed.notify_all()
        finally:
            with changed:
                stopped = True
                changed.notify_all()

"""Prepares the next items of an iterator while the last one is used."""

from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar, cast

Item = TypeVar("Item")

_END = object()


def ahead(items: Iterator[Item], depth: int) -> Iterator[Item]:
    """Yield the same items in order; another thread prepares up to ``depth`` of them in advance.

    An error in an item's preparation is raised where the item would be yielded.
    """
    with ThreadPoolExecutor(1) as thread:
        coming = deque(thread.submit(next, items, _END) for _ in range(depth))
        try:
            while (item := coming.popleft().result()) is not _END:
                coming.append(thread.submit(next, items, _END))
                yield cast("Item", item)
        finally:
            for future in coming:
                future.cancel()

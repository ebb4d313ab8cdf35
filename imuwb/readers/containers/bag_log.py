"""ROS 1 bags: IMU, GNSS, temperature and speed messages of any topic, by the names of their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.readers.containers import bag_records
from imuwb.readers.containers.topics import streamed

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.batch import Batch, ReadOptions, Remark

format = "bag"  # noqa: A001 - the contract's name
uses = ("time_source", "frame")


def probe(head: bytes) -> bool:
    """Return whether the file begins as a bag of version 2.0 does."""
    return head.startswith(bag_records.MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the messages chunk by chunk.

    Raises:
        UnreadableLogError: the file holds not one message.
    """
    return streamed(path, bag_records.Bag(path), options)

"""ROS 1 bags: IMU, GNSS, temperature and speed messages of any topic, by the names of their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.errors import UnreadableLogError
from imuwb.readers import bag_records
from imuwb.readers.topics import Topics

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.batch import Batch, ReadOptions, Remark

format = "bag"  # noqa: A001 - the contract's name


def probe(head: bytes) -> bool:
    """Return whether the file begins as a bag of version 2.0 does."""
    return head.startswith(bag_records.MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the messages chunk by chunk.

    Raises:
        UnreadableLogError: the file holds not one message.
    """
    bag = bag_records.Bag(path)
    topics = Topics(bag.channels, bag.schemas, options)
    for messages in bag.messages():
        yield from topics.batches(messages)
    if not topics.count:
        what = "; ".join(remark.text for remark in bag.remarks) or "it is a recording of nothing"
        message = f"{path}: no message can be read: {what}"
        raise UnreadableLogError(message)
    yield from bag.remarks
    yield from topics.remarks()

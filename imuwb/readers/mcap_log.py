"""MCAP logs: IMU, GNSS and temperature messages of any topic, by the names of their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.errors import UnreadableLogError
from imuwb.readers import mcap_records
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.topics import Topics

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.summary import LogSummary

format = "mcap"  # noqa: A001 - the contract's name


def probe(head: bytes) -> bool:
    """Return whether the file begins with MCAP's magic."""
    return head.startswith(mcap_records.MAGIC)


def describe(path: Path) -> LogSummary | None:
    """Return what the file's index says, without reading its messages; None where it has none."""
    from imuwb.readers import mcap_index  # noqa: PLC0415 - seldom needed

    return mcap_index.describe(path)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the IMU, GNSS and temperature messages chunk by chunk.

    Raises:
        UnreadableLogError: the file holds not one message.
    """
    recording = mcap_records.Recording(path)
    topics = Topics(recording.channels, recording.schemas, options)
    for messages in recording.messages():
        yield from topics.batches(messages)
    if not topics.count:
        what = "; ".join(remark.text for remark in recording.remarks) or "it is a recording of nothing"
        message = f"{path}: no message can be read: {what}"
        raise UnreadableLogError(message)
    yield from recording.remarks
    if recording.damaged:
        yield Remark(f"{recording.damaged} messages whose recorded time cannot be left out")
    yield from topics.remarks()

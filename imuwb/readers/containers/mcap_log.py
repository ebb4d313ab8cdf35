"""MCAP logs: IMU, GNSS and temperature messages of any topic, by the names of their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.readers.containers.mcap_chunk import MAGIC

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.batch import Batch, ReadOptions, Remark
    from imuwb.summary import LogSummary

format = "mcap"  # noqa: A001 - the contract's name
uses = ("time_source", "frame")


def probe(head: bytes) -> bool:
    """Return whether the file begins with MCAP's magic."""
    return head.startswith(MAGIC)


def describe(path: Path) -> LogSummary | None:
    """Return what the file's index says, without reading its messages; None where it has none."""
    from imuwb.readers.containers import mcap_index  # noqa: PLC0415 - seldom needed

    return mcap_index.describe(path)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the IMU, GNSS, speed and temperature messages chunk by chunk.

    Raises:
        UnreadableLogError: the file holds not one message.
    """
    from imuwb.readers.containers.mcap_records import Recording  # noqa: PLC0415 - compiled code, which an index does without
    from imuwb.readers.containers.topics import streamed  # noqa: PLC0415

    return streamed(path, Recording(path), options)

"""ROS 2 recordings in SQLite (.db3): IMU, GNSS, temperature and speed messages, recognised by the names of their fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.readers.containers.magic import SQLITE

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.batch import Batch, Remark
    from imuwb.readers.read_options import ReadOptions

format = "db3"  # noqa: A001 - the contract's name
uses = ("time_source", "frame")


def probe(head: bytes) -> bool:
    """Return whether the file begins as an SQLite database with topics."""
    return head.startswith(SQLITE) and b"topics" in head


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the messages, some thousand at a time.

    Raises:
        UnreadableLogError: the database is no recording of ROS 2, or has no readable message.
    """
    from imuwb.readers.containers.sqlite_messages import streamed  # noqa: PLC0415 - a probe needs no database

    return streamed(path, options)

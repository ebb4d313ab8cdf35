"""ROS 2 recordings in SQLite (.db3): IMU, GNSS, temperature and speed messages, recognised by the names of their fields."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.containers.recording_folder import Form, has_recording, has_several
from imuwb.readers.containers.split import container_of
from imuwb.readers.containers.sqlite_file import MAGIC, in_wal_mode
from imuwb.readers.containers.sqlite_rows import Database
from imuwb.readers.read_options import ReadOptions

format = "db3"  # noqa: A001 - the contract's name
uses = ("time_source", "frame", "messages")


def probe(head: bytes) -> bool:
    """Return whether the file begins as an SQLite database with topics; they may be in its write-ahead log alone."""
    return head.startswith(MAGIC) and (b"topics" in head or in_wal_mode(head))


FORM = Form(".db3", probe)


def probe_folder(folder: Path) -> bool:
    """Return whether a folder has databases, such as that of a rosbag2 recording."""
    return has_recording(folder, FORM)


def has_several_logs(folder: Path) -> bool:
    """Return whether a folder has several recordings."""
    return has_several(folder, FORM)


def beside(name: str) -> tuple[str, ...]:
    """Return the names of the files beside a database that hold a part of it."""
    return f"{name}-wal", f"{name}-journal"


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the messages, some thousand at a time.

    Raises:
        UnreadableLogError: the database is no recording of ROS 2, or has no readable message.
    """
    from imuwb.readers.containers.topics import streamed  # noqa: PLC0415 - a log of another format must not wait for it

    return streamed(path, container_of(path, FORM, Database), options)


def part(path: Path, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Return the messages of the rows that are in a part, by the index of their times.

    Raises:
        CannotSeekError: the database is damaged, or its rows are in no order of time.
    """
    if path.is_dir():
        raise CannotSeekError
    from imuwb.readers.containers import sqlite_part  # noqa: PLC0415 - a probe needs no compiled code

    return sqlite_part.part(path, options, limits)

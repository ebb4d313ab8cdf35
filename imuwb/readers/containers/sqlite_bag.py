"""ROS 2 recordings in SQLite (.db3): IMU, GNSS, temperature and speed messages of any topic."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING
from urllib.parse import quote

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.containers import ros_types
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.topics import Topics

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

format = "db3"  # noqa: A001 - the contract's name
uses = ("time_source", "frame")
MAGIC = b"SQLite format 3\0"
ROWS = 4096  #: messages at a time
LARGEST = 64 << 20  #: bytes of a message; larger ones are images, which are not asked for
EARLIEST, LATEST = 0, 2**62  #: ns


def probe(head: bytes) -> bool:
    """Return whether the file begins as an SQLite database does, and speaks of topics."""
    return head.startswith(MAGIC) and b"topics" in head


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the messages some thousand at a time.

    Raises:
        UnreadableLogError: it is no recording of ROS 2, or not one message can be read.
    """
    channels: dict[int, Channel] = {}
    schemas: dict[int, Schema] = {}
    topics = Topics(channels, schemas, options)
    trouble = ""
    try:
        with closing(sqlite3.connect(f"file:{quote(str(path.resolve()))}?mode=ro&immutable=1", uri=True)) as database:
            database.execute("PRAGMA writable_schema=ON")  # else a file shorter than it says is not opened at all
            _declare(database, channels, schemas)
            for messages in _messages(database, path.stat().st_size):
                yield from topics.batches(messages)
    except (sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
        trouble = f"the database is cut or damaged ({error}): what can be read before is used"
    if not topics.count:
        message = f"{path}: no message can be read: {trouble or 'it is a recording of nothing'}"
        raise UnreadableLogError(message)
    missing = _missing(path)
    if missing and not trouble:
        trouble = f"the database lacks its last {missing} bytes: it was cut, and rows may be missing"
    if trouble:
        yield Remark(trouble)
    yield from topics.remarks()


def _missing(path: Path) -> int:
    """Return how many bytes the file is shorter than its header says."""
    with path.open("rb") as file:
        head = file.read(32)
    size = int.from_bytes(head[16:18], "big")
    return max((65536 if size == 1 else size) * int.from_bytes(head[28:32], "big") - path.stat().st_size, 0)


def _declare(database: sqlite3.Connection, channels: dict[int, Channel], schemas: dict[int, Schema]) -> None:
    told: dict[str, str] = {}
    tables = {str(name) for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if "message_definitions" in tables:
        rows = database.execute(
            "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = 'ros2msg'"
        )
        told = {str(name): str(text) for name, text in rows}
    for number, topic, kind, encoding in database.execute("SELECT id, name, type, serialization_format FROM topics"):
        if not isinstance(number, int) or abs(number) >= LATEST:
            continue
        channels[number] = Channel(str(topic), str(encoding), number)
        text = told.get(str(kind)) or ros_types.definition(str(kind))
        # Without a definition nothing can be read of the topic; its name says what it would be.
        schemas[number] = Schema(str(kind), "ros2msg" if text else "none", (text or "").encode())


def _messages(database: sqlite3.Connection, size: int) -> Iterator[Messages]:
    try:
        total = max(int(database.execute("SELECT COUNT(*) FROM messages").fetchone()[0]), 1)
    except sqlite3.Error:  # the end is cut: progress is not known, the rows before are
        total = size
    found = database.execute(
        "SELECT topic_id, timestamp, CASE WHEN LENGTH(data) < ? THEN data END, LENGTH(data) FROM messages ORDER BY rowid",
        (LARGEST,),
    )
    done, lost = 0, False
    while rows := found.fetchmany(ROWS):
        done += len(rows)
        kept: list[tuple[int, int, bytes]] = []
        for *row, length in rows:
            # Of a page that was cut, SQLite makes zeros: a row without data is lost, and the next may be half of one.
            if _whole(tuple(row)) and not lost:
                kept.append(tuple(row))
            lost = length is None
        if not kept:
            continue
        numbers, times, data = zip(*kept, strict=True)
        length = np.array([len(one) for one in data], np.int64)
        time = np.array(times, np.int64)
        yield Messages(
            np.frombuffer(b"".join(data), np.uint8), np.array(numbers, np.int64), time, time,
            np.cumsum(length) - length, length, size * done // total,
        )  # fmt: skip


def _whole(row: tuple[object, ...]) -> bool:
    number, time, data = row
    return isinstance(number, int) and isinstance(time, int) and EARLIEST <= time < LATEST and isinstance(data, bytes)

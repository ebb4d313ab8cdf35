"""The messages of a ROS 2 recording in SQLite, some thousand rows at a time."""

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from imuwb.notes import Note
from imuwb.readers.bytes.ahead import TOGETHER
from imuwb.readers.containers.messages import Channel, Container, Messages, Schema
from imuwb.readers.containers.sqlite_file import OddTableError, missing_bytes, opened, tables

ROWS = 4096  #: number of messages that are read at a time
LARGEST = 64 << 20  #: bytes; larger messages, such as images, are not read
EARLIEST, LATEST = 0, 2**62  #: ns; a time outside these limits is damage


class Database(Container):
    """A recording in SQLite. It does not state whether heights are above mean sea level."""

    def __init__(self, path: Path) -> None:
        """Set the file; nothing is read yet."""
        super().__init__()
        self.path = path

    def messages(self) -> Iterator[Messages]:
        """Yield the messages, some thousand at a time."""
        try:
            with opened(self.path, self.notes) as database:
                declare(database, self.channels, self.schemas)
                yield from messages_of(database, self.path.stat().st_size)
        except OddTableError as error:
            self.notes.append(Note("odd_table", f"the database is not read further: {error}"))
            return
        except (sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
            fault = f"the database is cut or damaged ({error}); all data before this point are used"
            self.notes.append(Note("cut", fault))
            return
        if missing := missing_bytes(self.path):
            fault = f"the database lacks its last {missing} bytes: it was cut, and rows may be missing"
            self.notes.append(Note("cut", fault))


def declare(database: sqlite3.Connection, channels: dict[int, Channel], schemas: dict[int, Schema]) -> None:
    """Add the topics of a recording, and the definitions of their messages where it has some."""
    definitions: dict[str, tuple[str, str]] = {}
    if "message_definitions" in tables(database):
        rows = database.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")
        definitions = {str(name): (str(language), str(text)) for name, language, text in rows}
    for number, topic, kind, encoding in database.execute("SELECT id, name, type, serialization_format FROM topics"):
        if not isinstance(number, int) or abs(number) >= LATEST:
            continue
        channels[number] = Channel(str(topic), str(encoding), number)
        language, text = definitions.get(str(kind), ("none", ""))
        schemas[number] = Schema(str(kind), language, text.encode())


def messages_of(
    database: sqlite3.Connection, size: int, first: int = -(2**63), last_row: int = 2**63 - 1
) -> Iterator[Messages]:
    """Yield the messages of some rows, some thousand at a time."""
    (pages,), (page,) = (database.execute(f"PRAGMA {name}").fetchone() for name in ("page_count", "page_size"))
    most = int(pages) * int(page)
    try:
        last = database.execute("SELECT MAX(rowid) FROM messages").fetchone()[0] or 1
    except sqlite3.Error:  # the end is cut
        last = most
    cursor = database.execute(
        "SELECT topic_id, timestamp, CASE WHEN LENGTH(data) < ? THEN data END, LENGTH(data), rowid FROM messages "
        "WHERE rowid BETWEEN ? AND ? ORDER BY rowid",
        (min(LARGEST, most), first, last_row),
    )
    done, lost = 0, False
    while rows := _some(cursor):
        done += sum(len(row[2]) for row in rows if isinstance(row[2], bytes | str))
        if done > most:
            raise OddTableError("its rows have more bytes than the file")
        kept: list[tuple[int, int, bytes]] = []
        for *row, length, _ in rows:
            # SQLite fills a cut page with zeros: a row without data is lost, and the next row may be half of one.
            if _whole(tuple(row)) and not lost:
                kept.append(tuple(row))
            lost = length is None
        if not kept:
            continue
        numbers, times, data = zip(*kept, strict=True)
        length = np.array([len(payload) for payload in data], np.int64)
        time = np.array(times, np.int64)
        yield Messages(
            np.frombuffer(b"".join(data), np.uint8), np.array(numbers, np.int64), time, time,
            np.cumsum(length) - length, length, int(size * min(max(rows[-1][4] / last, 0.0), 1.0)),
        )  # fmt: skip


def _some(cursor: sqlite3.Cursor) -> list[tuple[Any, ...]]:
    """Return the next rows, some thousand or some megabytes."""
    rows, held = list[tuple[Any, ...]](), 0
    for row in cursor:
        rows.append(row)
        held += len(row[2]) if isinstance(row[2], bytes | str) else 0
        if len(rows) == ROWS or held > TOGETHER:
            break
    return rows


def _whole(row: tuple[object, ...]) -> bool:
    number, time, data = row
    return isinstance(number, int) and isinstance(time, int) and EARLIEST <= time < LATEST and isinstance(data, bytes)

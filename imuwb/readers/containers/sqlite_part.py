"""A part of a ROS 2 recording in SQLite, by the times of its rows: of these there is an index, so other messages are not read."""

import sqlite3
from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes import source
from imuwb.readers.containers.chunk_part import Chunk, Indexed, part_of
from imuwb.readers.containers.messages import Messages
from imuwb.readers.containers.sqlite_file import OddTableError, in_wal_mode, missing_bytes, opened
from imuwb.readers.containers.sqlite_rows import EARLIEST, LATEST, Database, declare, messages_of
from imuwb.readers.read_options import ReadOptions

TOGETHER = 1024  #: rows that are read or left out together


def part(path: Path, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the first rows, and of the rows that may lie within the limits, in the order of the rows.

    Raises:
        CannotSeekError: the database is damaged or not closed, or its rows are in no order of time.
    """
    return part_of(_Rows(path), options, limits)


class _Rows(Database, Indexed):
    """The rows of a recording in groups that follow each other."""

    def __init__(self, path: Path) -> None:
        """Read the times of all rows.

        Raises:
            CannotSeekError: the database is damaged or not closed, or its rows are in no order of time.
        """
        super().__init__(path)
        if in_wal_mode(source.head(path)) or missing_bytes(path):
            raise CannotSeekError
        try:
            with opened(path, self.notes) as database:
                declare(database, self.channels, self.schemas)
                rows = database.execute(
                    "SELECT rowid / ?, MIN(timestamp), MAX(timestamp) FROM messages GROUP BY 1 ORDER BY 1", (TOGETHER,)
                ).fetchall()
        except (OddTableError, sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
            raise CannotSeekError from error
        if not all(isinstance(x, int) and EARLIEST <= x < LATEST for row in rows for x in row):
            raise CannotSeekError
        topics = frozenset(self.channels)  # which of them a group has is not known
        self.chunks = tuple(Chunk(group, start, end, topics) for group, start, end in rows)
        self.check_order()

    def messages_of(self, places: list[int]) -> Iterator[tuple[int, list[Messages]]]:
        """Yield places of groups, each with its messages."""
        size = self.path.stat().st_size
        try:
            with opened(self.path, []) as database:
                for place in places:
                    first = self.chunks[place].offset * TOGETHER
                    yield place, list(messages_of(database, size, first, first + TOGETHER - 1))
        except (OddTableError, sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
            raise CannotSeekError from error

"""Opens an SQLite database without a change of its files, with the rows of its write-ahead log or without those of an open write.

A recorder that is killed leaves committed rows in ``NAME-wal``, or a write that was not finished and ``NAME-journal``, which takes it
back. SQLite uses both only where it may write, so a copy is opened. Source: https://www.sqlite.org/wal.html,
https://www.sqlite.org/fileformat.html (offsets 18 and 19 of the header; the magic of a journal).
"""

import shutil
import sqlite3
import tempfile
from collections.abc import Generator
from contextlib import closing, contextmanager
from pathlib import Path
from urllib.parse import quote

from imuwb.notes import Note

MAGIC = b"SQLite format 3\0"
JOURNAL_MAGIC = b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"  #: of a journal that is not taken back yet
WAL_HEADER = 32  #: bytes; a write-ahead log of this length or less has no rows
IN_WAL_MODE = b"\2\2"  #: the header's versions of writing and reading
SPARE = 64 << 20  #: bytes that a copy leaves free in the temporary folder


@contextmanager
def opened(path: Path, notes: list[Note]) -> Generator[sqlite3.Connection]:
    """Give a connection to a database as its recorder last committed it.

    Notes on what lies beside the file, and what is done with it, are added to ``notes``.

    Raises:
        sqlite3.Error: the file is damaged.
    """
    log = _pending(path)
    if log is None:
        if _lacks_log(path):
            text = (
                f"the database was written with a write-ahead log, and {path.name}-wal is not beside it: if the recorder was not "
                "closed properly, its last messages were in that file; copy it as well"
            )
            notes.append(Note("write_ahead_log_missing", text))
        with closing(_connected(path, "mode=ro&immutable=1")) as database:
            yield database
        return
    with tempfile.TemporaryDirectory(prefix="imuwb-") as folder:
        try:
            copy = _copied(path, log, Path(folder))
        except OSError as error:
            text = (
                f"{log.name} ({log.stat().st_size} bytes), which holds the last changes of the database, is not used: {error.strerror}; "
                f"let the recorder close the file, or apply them on a copy: sqlite3 {path.name} 'PRAGMA wal_checkpoint(TRUNCATE)'"
            )
            notes.append(Note("write_ahead_log_left_out", text))
            with closing(_connected(path, "mode=ro&immutable=1")) as database:
                yield database
            return
        with closing(_connected(copy, "mode=rw")) as database:
            notes.append(_applied(path, log, database))
            yield database


def _pending(path: Path) -> Path | None:
    """Return the write-ahead log or the journal that lies beside a database and has something to apply; None without one."""
    log, journal = (path.with_name(f"{path.name}-{end}") for end in ("wal", "journal"))
    if log.is_file() and log.stat().st_size > WAL_HEADER:
        return log
    if journal.is_file():
        with journal.open("rb") as file:
            return journal if file.read(len(JOURNAL_MAGIC)) == JOURNAL_MAGIC else None
    return None


def in_wal_mode(head: bytes) -> bool:
    """Return whether a database that begins with some bytes is written with a write-ahead log."""
    return head.startswith(MAGIC) and head[18:20] == IN_WAL_MODE


def _lacks_log(path: Path) -> bool:
    """Return whether a database is written with a write-ahead log, and none lies beside it."""
    with path.open("rb") as file:
        return in_wal_mode(file.read(20)) and not path.with_name(f"{path.name}-wal").exists()


def _copied(path: Path, log: Path, folder: Path) -> Path:
    """Return a copy of a database with what lies beside it.

    Raises:
        OSError: there is no room for it.
    """
    need, free = path.stat().st_size + log.stat().st_size + SPARE, shutil.disk_usage(folder).free
    if need > free:
        raise OSError(0, f"a copy needs {need >> 20} MB, and the temporary folder has {free >> 20} MB free")
    copy = folder / path.name
    shutil.copyfile(path, copy)
    shutil.copyfile(log, folder / log.name)
    return copy


def _connected(path: Path, mode: str) -> sqlite3.Connection:
    return sqlite3.connect(f"file:{quote(str(path.resolve()))}?{mode}", uri=True)


def _applied(path: Path, log: Path, database: sqlite3.Connection) -> Note:
    """Return the note on a write-ahead log or a journal that is applied to a copy."""
    size = f"{log.name} ({log.stat().st_size} bytes)"
    if log.name.endswith("-journal"):
        text = f"{size}: a write that was not finished is taken back, in a copy; the files are not changed"
        return Note("journal_applied", text)
    with closing(_connected(path, "mode=ro&immutable=1")) as alone:
        whole, before = _count(database), _count(alone)
    added = "messages" if whole is None or before is None else f"{whole - before} messages"
    return Note("write_ahead_log_applied", f"{added} of {size} are read too, in a copy; the files are not changed")


def _count(database: sqlite3.Connection) -> int | None:
    """Return the number of messages; None if the database is damaged."""
    try:
        if (
            database.execute("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'messages'").fetchone()
            is None
        ):
            return 0
        return int(database.execute("SELECT COUNT(*) FROM messages").fetchone()[0])
    except sqlite3.Error:
        return None

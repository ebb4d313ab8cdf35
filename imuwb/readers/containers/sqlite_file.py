"""Opens an SQLite database without a change of its files, with the rows of its write-ahead log or without those of an open write.

A recorder that is killed leaves committed rows in ``NAME-wal``, or a write that was not finished and ``NAME-journal``, which takes it
back. SQLite uses both only where it may write, so a copy is opened. Source: https://www.sqlite.org/wal.html,
https://www.sqlite.org/fileformat.html (offsets 18 and 19 of the header; the magic of a journal).
"""

import re
import shutil
import sqlite3
import tempfile
from collections.abc import Generator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from urllib.parse import quote

from imuwb.notes import Note
from imuwb.readers.bytes import budget
from imuwb.texts import printable

MAGIC = b"SQLite format 3\0"
JOURNAL_MAGIC = b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"  #: of a journal that is not taken back yet
WAL_HEADER = 32  #: bytes; a write-ahead log of this length or less has no rows
IN_WAL_MODE = b"\2\2"  #: the header's versions of writing and reading
LEAST_LENGTH, LARGEST_LENGTH = 1 << 20, 1 << 30  #: bytes of a value
LEAST_STEPS, STEPS = 10_000_000, 100  #: steps of SQLite's machine for any file, and for each of its bytes
EVERY = 10_000  #: steps after which they are compared with the budget
SPARE = 64 << 20  #: bytes that a copy leaves free in the temporary folder


TABLES = ("topics", "messages", "message_definitions")
_ORDINARY = re.compile(r"\s*CREATE\s+TABLE\b(?!.*\bWITHOUT\s+ROWID\b)", re.IGNORECASE | re.DOTALL)


@contextmanager
def opened(path: Path, notes: list[Note]) -> Generator[sqlite3.Connection]:
    """Give a connection to a database as its recorder last committed it.

    Notes on what lies beside the file, and what is done with it, are added to ``notes``.

    Raises:
        sqlite3.Error: the file is damaged.
    """
    log = _pending(path)
    if log is None:
        if missing := missing_bytes(path):
            with _filled(path, missing) as whole, closing(_connected(whole, "mode=ro&immutable=1")) as database:
                yield database
            return
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


def missing_bytes(path: Path) -> int:
    """Return how many bytes the file lacks of the size in its header."""
    with path.open("rb") as file:
        head = file.read(32)
    size = int.from_bytes(head[16:18], "big")
    return max((65536 if size == 1 else size) * int.from_bytes(head[28:32], "big") - path.stat().st_size, 0)


@contextmanager
def _filled(path: Path, missing: int) -> Generator[Path]:
    """Give a cut database with zeros in place of what it lacks, in a copy; SQLite opens no file whose tables begin after its end."""
    size = path.stat().st_size + missing
    if missing > budget.current().most or size > shutil.disk_usage(tempfile.gettempdir()).free - SPARE:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="imuwb-") as folder:
        copy = Path(folder) / "cut.db3"
        shutil.copyfile(path, copy)
        with copy.open("r+b") as file:
            file.truncate(size)
        yield copy


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
    """Return a connection that runs nothing that the file's schema may hold, and works in proportion to the file's size.

    Source: https://www.sqlite.org/security.html, "Untrusted SQLite Database Files".
    """
    database = sqlite3.connect(f"file:{quote(str(path.resolve()))}?{mode}", uri=True)
    size = sum(f.stat().st_size for f in (path, path.with_name(f"{path.name}-wal")) if f.is_file())
    database.text_factory = partial(str, encoding="utf-8", errors="replace")
    for limit, most in (
        (sqlite3.SQLITE_LIMIT_LENGTH, min(max(size, LEAST_LENGTH), LARGEST_LENGTH)),
        (sqlite3.SQLITE_LIMIT_SQL_LENGTH, 1 << 16),
        (sqlite3.SQLITE_LIMIT_EXPR_DEPTH, 32),
        (sqlite3.SQLITE_LIMIT_ATTACHED, 0),
        (sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH, 1),
    ):
        database.setlimit(limit, most)
    for pragma in ("trusted_schema=OFF", "cell_size_check=ON", "mmap_size=0"):
        database.execute(f"PRAGMA {pragma}")
    steps = iter(range((LEAST_STEPS + STEPS * size) // EVERY))
    database.set_progress_handler(lambda: next(steps, None) is None, EVERY)
    return database


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
    """Return the number of messages; None if the database is damaged, or ``messages`` is no table."""
    try:
        if "messages" not in tables(database):
            return 0
        # COUNT(*) would walk the pages of the table without a look at the budget.
        return int(database.execute("SELECT COUNT(timestamp) FROM messages").fetchone()[0])
    except (sqlite3.Error, OddTableError):
        return None


class OddTableError(Exception):
    """A database has a view, a virtual table or computed columns where a recording has a table."""


def tables(database: sqlite3.Connection) -> dict[str, tuple[str, ...]]:
    """Return the columns of the tables that a recording has.

    Raises:
        OddTableError: one of them is no ordinary table.
        sqlite3.Error: the schema is damaged.
    """
    found: dict[str, tuple[str, ...]] = {}
    names = ", ".join(f"'{name}'" for name in TABLES)
    query = f"SELECT name, type, sql FROM sqlite_master WHERE name COLLATE NOCASE IN ({names})"  # noqa: S608 - constants
    for name, kind, sql in database.execute(query).fetchall():
        shown = str(name).lower()
        if kind != "table" or not _ORDINARY.match(str(sql)):
            raise OddTableError(
                f"{shown} is no table of a recording, but computed by the file ({printable(str(kind))})"
            )
        columns = database.execute(f"PRAGMA table_xinfo({shown})").fetchall()
        if any(column[6] for column in columns):
            raise OddTableError(f"{shown} has columns that the file computes, which no recording has")
        found[shown] = tuple(str(column[1]) for column in columns)
    return found

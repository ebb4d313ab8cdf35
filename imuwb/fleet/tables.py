"""The tables of a fleet from its parts: the rows of all logs in a fixed order, so that the same logs give the same bytes."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from imuwb.errors import ImuwbError
from imuwb.fleet.parquet import table_in
from imuwb.fleet.parts import Part
from imuwb.fleet.plan import Task
from imuwb.fleet.schemas import DONE, DUPLICATE, ORDER, QUARANTINED, TABLES, check_schema, file_of
from imuwb.fleet.store import Store
from imuwb.readers.bytes.address import is_address, place_of, without_secrets
from imuwb.texts import printable

CHUNK = 1000  #: logs whose rows are in memory as Python's own values
READERS = 16  #: parts that are read at a time
Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Entry:
    """A log of a run, and where its result is."""

    task: Task
    part: str  #: name of its part; empty: there is none
    fault: Row | None = None  #: stage, kind and message, of a log without a part


@dataclass(frozen=True, slots=True)
class Tables:
    """The tables of a run."""

    by_name: dict[str, pa.Table]

    def write(self, store: Store) -> str:
        """Write each table, and return the hash of their bytes; logs is the last, so it never names results that are not there."""
        written: dict[str, bytes] = {}
        for name in sorted(self.by_name, key=lambda name: name == "logs"):
            sink = BytesIO()
            pq.write_table(self.by_name[name], sink, compression="zstd")
            written[name] = sink.getvalue()
            store.write(file_of(name), written[name])
        return _hash(written)


def hash_of_tables(store: Store) -> str:
    """Return the hash of the bytes of the tables that are there; empty: one is missing."""
    found = {name: store.read(file_of(name)) for name in TABLES}
    whole = {name: content for name, content in found.items() if content is not None}
    return _hash(whole) if len(whole) == len(found) else ""


def _hash(contents: dict[str, bytes]) -> str:
    parts = [name.encode() + hashlib.sha256(contents[name]).digest() for name in sorted(contents)]
    return hashlib.sha256(b"".join(parts)).hexdigest()


def tables_of(entries: Iterable[Entry], store: Store) -> Tables:
    """Return the tables of the logs of a run.

    Args:
        entries: of all logs.
        store: of the parts.
    """
    pieces: dict[str, list[pa.Table]] = {name: [schema.empty_table()] for name, schema in TABLES.items()}
    seen: dict[str, tuple[str, str | None]] = {}
    ordered = sorted(entries, key=lambda entry: entry.task.log.place)
    with ThreadPoolExecutor(READERS) as pool:
        for chunk in _chunks(ordered, CHUNK):
            parts = pool.map(_reading(store), chunk)
            rows: dict[str, list[Row]] = {name: [] for name in TABLES}
            for entry, part in zip(chunk, parts, strict=True):
                _add(rows, entry, part, seen)
            for name, schema in TABLES.items():
                pieces[name].append(pa.Table.from_pylist(rows[name], schema))
    return Tables({name: _sorted(name, pa.concat_tables(own)) for name, own in pieces.items()})


def read_table(store: Store, table: str, place: str) -> pa.Table | None:
    """Return a table of a folder of results; None: there is none.

    Args:
        store: of the results.
        table: its name.
        place: of the results, for messages.

    Raises:
        UsageError: the file is no such table, or one of another version.
    """
    content = store.read(file_of(table))
    if content is None:
        return None
    where = f"{place.rstrip('/')}/{file_of(table)}"
    try:
        read = table_in(content)
    except ValueError:
        read = pa.table({})
    check_schema(table, read.schema, where)
    return read.select(TABLES[table].names)


def _reading(store: Store) -> Callable[[Entry], Part | None]:
    def part_of(entry: Entry) -> Part | None:
        content = store.read(entry.part) if entry.part else None
        try:
            return None if content is None else Part.unpacked(content)
        except ValueError:
            raise ImuwbError(
                f"{entry.part}: this part of the results is damaged; remove it, and run the command again"
            ) from None

    return part_of


def _add(rows: dict[str, list[Row]], entry: Entry, part: Part | None, seen: dict[str, tuple[str, str | None]]) -> None:
    """Add the rows of a log; one with the bytes of another log counts once."""
    task = entry.task
    path = _path(task.log.place)
    owner = {"vehicle": task.identity.vehicle, "serial": task.identity.serial, "family": task.identity.family}
    fault = entry.fault if part is None else None
    if part is None and fault is None:
        fault = {"stage": "analyse", "kind": "lost", "message": "its result is missing; run the command again"}
    part = part or Part()
    key = part.log.get("log")
    own = path, task.identity.serial
    if not part.quarantine and key and (first := seen.setdefault(f"{key} {task.options}", own))[0] != path:
        other = (
            f"; that one is stated to be of {first[1] or 'no known sensor'}, this one of {own[1] or 'none'}"
            if own[1] != first[1]
            else ""
        )
        message = printable(f"it has the same bytes as {first[0]}, which counts{other}")
        fault = {"stage": "triage", "kind": DUPLICATE, "message": message}
        part = Part(part.log)
    faults = [*part.quarantine, *([] if fault is None else [{"log": key, **fault}])]
    date = task.identity.date
    log = {
        **part.log,
        "path": path,
        "size": task.log.size,
        "tag": task.log.tag,
        "state": QUARANTINED if faults else DONE,
        **owner,
    }
    rows["logs"].append(_dated(log, date))
    rows["sensors"] += [_dated({**row, **owner}, date) for row in part.sensors]
    rows["outages"] += [_dated({**row, **owner}, date) for row in part.outages]
    rows["quarantine"] += [{**row, **owner, "path": path} for row in faults]


def _dated(row: Row, date: int | None) -> Row:
    """Return a row with the date that the user states, which beats the clock of the log."""
    return row if date is None else {**row, "start": date}


def _path(place: str) -> str:
    """Return the place of a log as it can be opened again, without secrets; what is no UTF-8 becomes a question mark."""
    path = str(place_of(place)) if is_address(place) else without_secrets(place)
    return path.encode("utf-8", "replace").decode("utf-8")


def _chunks(entries: Sequence[Entry], size: int) -> Iterator[Sequence[Entry]]:
    for at in range(0, len(entries), size):
        yield entries[at : at + size]


def _sorted(name: str, table: pa.Table) -> pa.Table:
    """Return a table in the order of its rows; rows that are alike in the columns of the order are ordered by all others."""
    rest = [column for column in table.column_names if column not in ORDER[name]]
    keys = [(column, "ascending", "at_start") for column in (*ORDER[name], *rest)]
    return table.take(pc.sort_indices(table, sort_keys=keys)).combine_chunks()

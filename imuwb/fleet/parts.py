"""The parts of a run: what one task found, in one file that is written whole or not at all.

A part has one row, with the rows of each table in a list. It has neither the place nor the owner of the log, which may change. Its
name is ``parts/RUN/CC/TAG.CONTENT.parquet``; CC are the first letters of CONTENT.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from imuwb.fleet.listing import tag_of
from imuwb.fleet.own_files import PARTS
from imuwb.fleet.parquet import table_in
from imuwb.fleet.schemas import LOGS, OUTAGES, QUARANTINE, SENSORS
from imuwb.fleet.store import Store

Row = dict[str, Any]
NOT_READ = "none"  #: content of a log whose bytes are not known

OWNER = ("vehicle", "serial", "family")  #: columns that the plan knows
PLACE = ("path", "size", "tag", "state", *OWNER)


def _inner(schema: pa.Schema, without: Iterable[str]) -> pa.DataType:
    return pa.list_(pa.struct([f for f in schema if f.name not in without]))


SCHEMA = pa.schema([
    ("logs", _inner(LOGS, PLACE)),
    ("sensors", _inner(SENSORS, OWNER)),
    ("outages", _inner(OUTAGES, OWNER)),
    ("quarantine", _inner(QUARANTINE, ("path", *OWNER))),
])  # fmt: skip


@dataclass(frozen=True, slots=True)
class Part:
    """What one task found."""

    log: Row = field(default_factory=dict[str, Any])  #: columns of logs
    sensors: tuple[Row, ...] = ()
    outages: tuple[Row, ...] = ()
    quarantine: tuple[Row, ...] = ()

    @property
    def quarantined(self) -> bool:
        """Whether the log gave no result."""
        return bool(self.quarantine)

    def packed(self) -> bytes:
        """Return the part as Parquet."""
        row = {"logs": [self.log], "sensors": self.sensors, "outages": self.outages, "quarantine": self.quarantine}
        sink = BytesIO()
        pq.write_table(pa.Table.from_pylist([row], SCHEMA), sink, compression="zstd", write_statistics=False)
        return sink.getvalue()

    @classmethod
    def unpacked(cls, content: bytes) -> "Part":
        """Return the part that a file has.

        Raises:
            ValueError: the file is damaged, or no part.
        """
        (row,) = table_in(content).to_pylist()
        if row.keys() != set(SCHEMA.names) or not row["logs"]:
            raise ValueError("the file is no part of results")
        return cls(row["logs"][0], tuple(row["sensors"]), tuple(row["outages"]), tuple(row["quarantine"]))


def part_name(run: str, tag: str, content: str) -> str:
    """Return the name of a part.

    Args:
        run: name of the run.
        tag: of the task.
        content: as ``content_name`` or ``stopped_content`` returns it.
    """
    return f"{folder_of(run)}/{content[:2]}/{tag}.{content}.parquet"


def folder_of(run: str) -> str:
    """Return the folder of a run's parts."""
    return f"{PARTS}/{run}"


def content_name(digest: str, options: str) -> str:
    """Return what stands for the bytes of a log and the options that are its own."""
    return tag_of(digest, options)


def stopped_content(bounds: object) -> str:
    """Return what stands for the content of a log whose task reached a bound; with other bounds the task is tried again."""
    return f"{NOT_READ}-{tag_of(bounds)[:8]}"


def known_parts(store: Store, run: str, contents: Iterable[str]) -> Mapping[str, str]:
    """Return the parts that a run has already, {tag: name}, in whatever order the store lists them.

    A log that was stopped once and read another time has two parts: the one that was read counts.

    Args:
        store: of the results.
        run: its name.
        contents: what may stand for the content of a log that was not read; parts with others of these are tried again.
    """
    allowed = set(contents)
    known: dict[str, tuple[bool, str]] = {}  # whether the log was read, and the part
    for name in store.names(folder_of(run)):
        tag, _, rest = name.rpartition("/")[2].partition(".")
        content = rest.removesuffix(".parquet")
        read = not content.startswith(NOT_READ)
        if read or content in allowed:
            known[tag] = max(known.get(tag, (False, "")), (read, name))
    return {tag: name for tag, (_, name) in known.items()}


def same_content(store: Store, run: str, content: str) -> str | None:
    """Return a part of the same bytes under another tag, which a copy or a new date of the file makes; None: there is none."""
    found = (name for name in store.names(f"{folder_of(run)}/{content[:2]}") if name.endswith(f".{content}.parquet"))
    return min(found, default=None)

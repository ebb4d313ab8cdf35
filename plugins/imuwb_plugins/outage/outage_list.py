"""Outages that a user gives: START:DURATION on the command line, or a table with names in a file."""

import csv
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self, cast

from imuwb.documents import parsed, shown
from imuwb.errors import UsageError

SUFFIXES = (".csv", ".toml")
MOST = 10_000  #: outages in a file
LARGEST = 10_000_000  #: bytes of a file
KEYS = ("name", "start", "duration", "log", "table")


@dataclass(frozen=True, slots=True)
class NamedOutage:
    """An outage that a user gives."""

    start: float  #: s from the log's start
    duration: float  #: s
    name: str = ""
    log: str = ""  #: name of the log that it belongs to; empty: every log
    table: str = ""  #: of the table that shows it: one for each text


@dataclass(frozen=True, slots=True)
class OutageFile:
    """A file of outages: CSV with the columns name, start, duration (s), log and table, or TOML with ``[[outage]]`` of the same keys."""

    FORMS: ClassVar[str] = "a .csv or .toml file of outages"
    path: Path
    outages: tuple[NamedOutage, ...]

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Return the outages of a file.

        Raises:
            ValueError: the text is no name of such a file.
            UsageError: the file cannot be used.
        """
        path = Path(text)
        if path.suffix not in SUFFIXES:
            raise ValueError(text)
        try:
            if path.stat().st_size > LARGEST:
                raise UsageError(
                    f"at {path}: it has more than {LARGEST // 10**6} MB; a file of outages is a small table"
                )
            content = path.read_text("utf-8-sig")
        except OSError as error:
            raise UsageError(f"at {path}: the file cannot be read: {error.strerror}") from error
        except UnicodeDecodeError as error:
            raise UsageError(f"at {path}: the file is no text in UTF-8") from error
        rows = _csv_rows(path, content) if path.suffix == ".csv" else _toml_rows(path, content)
        outages = tuple(_outage(where, row) for where, row in rows)
        if not 0 < len(outages) <= MOST:
            raise UsageError(f"at {path}: it has {len(outages)} outages; it must have 1 to {MOST}")
        return cls(path, outages)

    def __str__(self) -> str:
        """Return the path."""
        return str(self.path)


def given(at: object) -> tuple[NamedOutage, ...]:
    """Return the outages of --at; none for a sweep and for those of the log itself."""
    if isinstance(at, OutageFile):
        return at.outages
    pairs = cast("tuple[tuple[float, float], ...]", at) if isinstance(at, tuple) else ()
    return tuple(NamedOutage(start, duration) for start, duration in pairs)


def _csv_rows(path: Path, content: str) -> Iterator[tuple[str, Mapping[str, object]]]:
    lines = [line for line in content.splitlines() if line.strip() and not line.startswith("#")]
    delimiter = ";" if lines and ";" in lines[0] else ","
    table = csv.DictReader(lines, delimiter=delimiter, strict=True)
    names = [name.strip().lower().removesuffix("_s") for name in table.fieldnames or ()]
    unknown = [name for name in names if name not in KEYS]
    if unknown or not {"start", "duration"} <= set(names):
        raise UsageError(
            f"at {path}: its columns are {', '.join(names) or 'none'}; they must be start and duration (s), and may be name, log and table"
        )
    table.fieldnames = names
    try:
        for number, row in enumerate(table, 1):
            yield f"at {path}, outage {number}", row
    except csv.Error as error:
        raise UsageError(f"at {path}: it is no table: {error}") from error


def _toml_rows(path: Path, content: str) -> Iterator[tuple[str, Mapping[str, object]]]:
    document = parsed(content, f"at {path}")
    rows = document.get("outage")
    if set(document) != {"outage"} or not isinstance(rows, list):
        raise UsageError(f"at {path}: it must have tables [[outage]] with start and duration (s), and nothing else")
    for number, row in enumerate(cast("list[object]", rows), 1):
        where = f"at {path}, outage {number}"
        if not isinstance(row, dict) or not set(cast("dict[str, object]", row)) <= set(KEYS):
            raise UsageError(
                f"{where}: it must be a table with start and duration (s), and perhaps name, log and table"
            )
        yield where, cast("dict[str, object]", row)


def _outage(where: str, row: Mapping[str, Any]) -> NamedOutage:
    numbers: list[float] = []
    for key in ("start", "duration"):
        try:
            numbers.append(float(row[key]))
        except (KeyError, TypeError, ValueError):
            raise UsageError(f"{where}: {key} is {shown(row.get(key))}; it must be a number of seconds") from None
        if not math.isfinite(numbers[-1]):
            raise UsageError(f"{where}: {key} is {shown(row[key])}; it must be finite")
    texts = (str(row.get(key) or "").strip() for key in ("name", "log", "table"))
    name, log, group = ("".join(c for c in text if c.isprintable()) for text in texts)
    return NamedOutage(numbers[0], numbers[1], name, log, group)

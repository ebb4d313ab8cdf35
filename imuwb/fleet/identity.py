"""Which vehicle and which sensor a log is of: by a pattern of its path, by a table, or by what the log states; never guessed."""

import csv
import posixpath
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import Self

from imuwb.errors import UsageError
from imuwb.fleet.listing import Listed
from imuwb.readers.bytes.address import is_address
from imuwb.readers.stated import stated
from imuwb.texts import counted, names_text, printable
from imuwb.units import unix_nanoseconds

LARGEST = 100_000_000  #: bytes of a table
MOST = 3  #: logs that a message names
FIRST, LAST = 1970, 2261  #: years whose ns since 1970 a table can hold
DATE_FORM = (
    "2026-01-02 or 20260102, with a time 2026-01-02T03:04:05 or 20260102_030405; it is UTC unless a zone is stated"
)


@dataclass(frozen=True, slots=True)
class Identity:
    """Whose log it is. A part that is not known is None."""

    vehicle: str | None = None
    serial: str | None = None  #: of the sensor
    family: str | None = None  #: type of the sensor
    date: int | None = None  #: ns since 1970 UTC, of the log

    @classmethod
    def of(cls, known: Mapping[str, str | None], where: str = "") -> Self:
        """Return the identity that some texts state; an empty text is not known.

        Args:
            known: name of a part -> text.
            where: the texts are from, for messages.

        Raises:
            UsageError: a date is none.
        """
        texts = {key: printable(value.strip()) for key, value in known.items() if value and value.strip()}
        date = texts.pop("date", "")
        when = _date(date) if date else None
        if date and when is None:
            raise UsageError(f"{where}: {date!r} is no date; write {DATE_FORM}")
        return cls(**texts, date=when)  # type: ignore[arg-type]

    def filled(self, text: str) -> str:
        """Return a text with the parts of the identity in place of ``{serial}``, ``{vehicle}`` and ``{family}``.

        Raises:
            KeyError: a part that is not known; its argument is the name.
        """
        for name in PLACES:
            mark = f"{{{name}}}"
            if mark in text:
                value = getattr(self, name)
                if value is None:
                    raise KeyError(name)
                text = text.replace(mark, value)
        return text


PARTS = tuple(f.name for f in fields(Identity))
PLACES = ("vehicle", "serial", "family")  #: what may stand in braces in an option
NOBODY = Identity()


class Rule:
    """States whose a log is. This one says nothing; the others say what a user states."""

    def of(self, log: Listed) -> Identity:
        """Return the identity of a log; ``NOBODY`` if the rule does not say.

        Raises:
            UsageError: a date is none.
        """
        del log
        return NOBODY

    def nothing(self, example: Listed) -> str:
        """Return why the rule says nothing of any log, and what to do; empty: nothing to complain of."""
        del example
        return ""

    def check(self, logs: Sequence[Listed]) -> None:
        """Raise UsageError if the rule does not tell some of the logs apart."""

    def unused(self, logs: Sequence[Listed]) -> str:
        """Return how much of the rule is of none of the logs, as a sentence; empty: nothing."""
        del logs
        return ""


@dataclass(frozen=True, slots=True)
class ByGroup(Rule):
    """A regular expression with named groups, which is searched in the path or the address, with ``/`` between folders."""

    text: str

    def __post_init__(self) -> None:
        """Check the expression."""
        try:
            names = re.compile(self.text).groupindex
        except re.error as error:
            raise UsageError(f"--group {self.text!r}: this is no regular expression: {error}") from error
        if not names or set(names) - set(PARTS):
            raise UsageError(
                f"--group {self.text!r}: its named groups are {', '.join(names) or 'none'}; they must be among {', '.join(PARTS)}, as in "
                "'(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/[^/]+$'"
            )

    def of(self, log: Listed) -> Identity:
        """Return what the named groups match."""
        match = re.search(self.text, _slashed(log.place))
        return (
            NOBODY if match is None else Identity.of(match.groupdict(), f"--group {self.text!r}: {_slashed(log.place)}")
        )

    def nothing(self, example: Listed) -> str:
        """Return why the expression says nothing."""
        return f"--group {self.text!r} matches no log; the first log is {_slashed(example.place)}"


class ByTable(Rule):
    r"""A CSV with a column ``log``, the path or the name of a log, and columns among vehicle, serial, family and date.

    A path is written in any way: absolute or not, with ``./``, with ``/`` or ``\`` between folders; its end is enough where it is that of one log.
    """

    def __init__(self, path: Path) -> None:
        """Read the table.

        Raises:
            UsageError: it is no such table, or a row of it is wrong.
        """
        self.path = path
        columns, *rows = self._read() or [[]]
        columns = [name.strip() for name in columns]
        twice = [name for name, count in Counter(columns).items() if name and count > 1]
        if twice:
            raise self._wrong(
                f"it has several columns {', '.join(map(repr, twice))}; each column must have a name of its own"
            )
        names = set(columns)
        if "log" not in names or not names & set(PARTS):
            raise self._wrong(
                f"its columns are {', '.join(sorted(names)) or 'none'}; it must have log, and some of {', '.join(PARTS)}"
            )
        self._rows: dict[str, Identity] = {}  #: normal path, or the end of one -> identity
        self._numbers: dict[str, int] = {}  #: the same -> number of the row; that of the columns is 1
        known: dict[str, Identity] = {}
        for number, cells in enumerate(rows, 2):
            if not any(cell.strip() for cell in cells):
                continue
            if len(cells) != len(columns):
                raise self._wrong(
                    f"row {number} has {counted(len(cells), 'field')}, and there are {counted(len(columns), 'column')}"
                )
            row = dict(zip(columns, cells, strict=True))
            if not (log := row["log"].strip()):
                raise self._wrong(f"row {number} names no log")
            identity = Identity.of({key: row[key] for key in names & set(PARTS)}, f"--identities {path}: row {number}")
            if known.setdefault(_absolute(log), identity) != identity:
                raise self._wrong(f"row {number}: the log {_normal(log)} has another row that differs")
            self._rows[_normal(log)] = identity
            self._numbers.setdefault(_normal(log), number)

    def _wrong(self, what: str) -> UsageError:
        return UsageError(f"--identities {self.path}: {what}")

    def _read(self) -> list[list[str]]:
        """Return the cells of the rows, the names of the columns first."""
        try:
            if self.path.stat().st_size > LARGEST:
                raise self._wrong(f"it has more than {LARGEST // 10**6} MB; it must be a table with a row for each log")
            text = self.path.read_text("utf-8-sig")
            return list(csv.reader(StringIO(text), strict=True))
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise self._wrong(f"the table cannot be read: {error}") from error

    def _row(self, log: Listed) -> str | None:
        """Return the row of a log: that of its path, or of the longest end of it."""
        return next((end for end in _ends(log.place) if end in self._rows), None)

    def of(self, log: Listed) -> Identity:
        """Return what the row of the log says."""
        row = self._row(log)
        return NOBODY if row is None else self._rows[row]

    def check(self, logs: Sequence[Listed]) -> None:
        """Raise UsageError if a row fits several logs."""
        fits: dict[str, list[str]] = defaultdict(list)
        for log in logs:
            if (row := self._row(log)) is not None:
                fits[row].append(_slashed(log.place))
        for row, places in fits.items():
            if len(places) > 1:
                raise self._wrong(
                    f"row {self._numbers[row]}: {row} fits {len(places)} logs ({names_text(places, MOST)}); write the folders of the log too, "
                    "and a row for each"
                )

    def unused(self, logs: Sequence[Listed]) -> str:
        """Return how many rows are of none of the logs."""
        left = self._rows.keys() - {end for log in logs for end in _ends(log.place)}
        if not left:
            return ""
        first = min(left, key=lambda row: self._numbers[row])
        match = "matches" if len(left) == 1 else "match"
        return f"{len(left)} of {counted(len(self._rows), 'row')} of {self.path} {match} no log; the first is {first}."

    def nothing(self, example: Listed) -> str:
        """Return why the table says nothing."""
        first = next(iter(self._rows), "none")
        return f"--identities {self.path} has no row of these logs; its first is {first}, and the first log is {_slashed(example.place)}"


class ByMetadata(Rule):
    """What the logs state themselves: ``serial=KEY,vehicle=KEY``."""

    def __init__(self, text: str) -> None:
        """Read the keys."""
        pairs = [part.partition("=") for part in text.split(",")]
        self._keys = {name.strip(): key.strip() for name, _, key in pairs}
        self.text = text
        if len(self._keys) < len(pairs):
            raise UsageError(f"--metadata {text}: it has one part twice; give each of {', '.join(PARTS)} once at most")
        if set(self._keys) - set(PARTS) or not all(self._keys.values()):
            raise UsageError(
                f"--metadata {text}: write a key of the log for each of {', '.join(PARTS)}, as in serial=KEY,vehicle=KEY"
            )

    def of(self, log: Listed) -> Identity:
        """Return what the metadata of the log say."""
        known = stated(log.place)
        return Identity.of(
            {name: known.get(key) for name, key in self._keys.items()}, f"--metadata {self.text}: {_slashed(log.place)}"
        )

    def nothing(self, example: Listed) -> str:
        """Return why the metadata say nothing."""
        known = ", ".join(sorted(stated(example.place))) or "none"
        return f"--metadata {self.text}: no log has these keys; those of {_slashed(example.place)}: {known}"


def _slashed(place: str) -> str:
    return place if is_address(place) else place.replace("\\", "/")


def _normal(place: str) -> str:
    """Return a path with ``/`` between folders, and without ``.`` and ``..``; one that leaves the working folder as an absolute path."""
    if is_address(place):
        return place
    normal = posixpath.normpath(_slashed(place))
    return _absolute(place) if normal.startswith("..") else normal


def _absolute(place: str) -> str:
    return place if is_address(place) else posixpath.normpath(_slashed(str(Path(_slashed(place)).absolute())))


def _ends(place: str) -> Iterator[str]:
    """Yield the absolute path of a log, and its ends, the longest first."""
    parts = _absolute(place).split("/")
    return ("/".join(parts[i:]) for i in range(len(parts)))


def _date(text: str) -> int | None:
    """Return the ns of a date: ISO 8601, also with _ or - in the time; None for another text, and before 1970 or after 2261."""
    spelled = re.sub(r"^(\d{4})[-_]?(\d\d)[-_]?(\d\d)(?:[-_T ](\d\d)[-_:]?(\d\d)(?:[-_:]?(\d\d))?)?$", _iso, text)
    try:
        date = datetime.fromisoformat(spelled)
    except ValueError:
        return None
    return unix_nanoseconds(date) if FIRST <= date.year <= LAST else None


def _iso(found: re.Match[str]) -> str:
    year, month, day, *clock = found.groups()
    return f"{year}-{month}-{day}T{':'.join(part or '00' for part in clock)}"

"""Which vehicle and which sensor a log is of: by a pattern of its path, by a table, or by what the log states; never guessed."""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import Protocol, Self

from imuwb.errors import UsageError
from imuwb.fleet.listing import Listed
from imuwb.readers.bytes.address import is_address
from imuwb.readers.stated import stated
from imuwb.texts import printable
from imuwb.units import unix_nanoseconds

LARGEST = 100_000_000  #: bytes of a table


@dataclass(frozen=True, slots=True)
class Identity:
    """Whose log it is. A part that is not known is None."""

    vehicle: str | None = None
    serial: str | None = None  #: of the sensor
    family: str | None = None  #: type of the sensor
    date: int | None = None  #: ns since 1970 UTC, of the log

    @classmethod
    def of(cls, known: Mapping[str, str | None]) -> Self:
        """Return the identity that some texts state; an empty text, and a date that is none, are not known."""
        texts = {key: printable(value.strip()) for key, value in known.items() if value and value.strip()}
        date = texts.pop("date", "")
        return cls(**texts, date=_date(date) if date else None)  # type: ignore[arg-type]

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


class Rule(Protocol):
    """States whose a log is."""

    def of(self, log: Listed) -> Identity:
        """Return the identity of a log; ``NOBODY`` if the rule does not say."""
        ...

    def nothing(self, example: Listed) -> str:
        """Return why the rule says nothing of any log, and what to do."""
        ...


@dataclass(frozen=True, slots=True)
class Unknown:
    """No rule."""

    def of(self, log: Listed) -> Identity:
        """Return that nothing is known."""
        del log
        return NOBODY

    def nothing(self, example: Listed) -> str:
        """Return nothing to complain of."""
        del example
        return ""


@dataclass(frozen=True, slots=True)
class ByGroup:
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
        return NOBODY if match is None else Identity.of(match.groupdict())

    def nothing(self, example: Listed) -> str:
        """Return why the expression says nothing."""
        return f"--group {self.text!r} matches no log; the first log is {_slashed(example.place)}"


class ByTable:
    """A CSV with a column ``log``, the path or the name of a log, and columns among vehicle, serial, family and date."""

    def __init__(self, path: Path) -> None:
        """Read the table."""
        self.path = path
        try:
            if path.stat().st_size > LARGEST:
                raise UsageError(
                    f"--identities {path}: it has more than {LARGEST // 10**6} MB; it must be a table with a row for each log"
                )
            lines = path.read_text("utf-8-sig").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise UsageError(f"--identities {path}: the table cannot be read: {error}") from error
        table = csv.DictReader(lines)
        names = set(table.fieldnames or ())
        if "log" not in names or not names & set(PARTS):
            raise UsageError(
                f"--identities {path}: its columns are {', '.join(sorted(names)) or 'none'}; it must have log, and some of {', '.join(PARTS)}"
            )
        self._rows: dict[str, Identity] = {}
        for row in table:
            place, identity = _slashed(row["log"] or ""), Identity.of({key: row[key] for key in names & set(PARTS)})
            if self._rows.setdefault(place, identity) != identity:
                raise UsageError(f"--identities {path}: the log {place} has two rows that differ")

    def of(self, log: Listed) -> Identity:
        """Return the row of the path, or of its end, the longest first."""
        parts = _slashed(log.place).split("/")
        ends = ("/".join(parts[i:]) for i in range(len(parts)))
        return next((self._rows[end] for end in ends if end in self._rows), NOBODY)

    def nothing(self, example: Listed) -> str:
        """Return why the table says nothing."""
        first = next(iter(self._rows), "none")
        return f"--identities {self.path} has no row of these logs; its first is {first}, and the first log is {_slashed(example.place)}"


class ByMetadata:
    """What the logs state themselves: ``serial=KEY,vehicle=KEY``."""

    def __init__(self, text: str) -> None:
        """Read the keys."""
        pairs = [part.partition("=") for part in text.split(",")]
        self._keys = {name.strip(): key.strip() for name, _, key in pairs}
        self.text = text
        if set(self._keys) - set(PARTS) or not all(self._keys.values()):
            raise UsageError(
                f"--metadata {text}: write a key of the log for each of {', '.join(PARTS)}, as in serial=KEY,vehicle=KEY"
            )

    def of(self, log: Listed) -> Identity:
        """Return what the metadata of the log say."""
        known = stated(log.place)
        return Identity.of({name: known.get(key) for name, key in self._keys.items()})

    def nothing(self, example: Listed) -> str:
        """Return why the metadata say nothing."""
        known = ", ".join(sorted(stated(example.place))) or "none"
        return f"--metadata {self.text}: no log has these keys; those of {_slashed(example.place)}: {known}"


def _slashed(place: str) -> str:
    return place if is_address(place) else place.replace("\\", "/")


def _date(text: str) -> int | None:
    """Return the ns of a date: ISO 8601, also with _ or - in the time; None for another text."""
    spelled = re.sub(r"^(\d{4})[-_]?(\d\d)[-_]?(\d\d)(?:[-_T ](\d\d)[-_:]?(\d\d)(?:[-_:]?(\d\d))?)?$", _iso, text)
    try:
        date = datetime.fromisoformat(spelled)
    except ValueError:
        return None
    return unix_nanoseconds(date if date.tzinfo else date.replace(tzinfo=UTC))


def _iso(found: re.Match[str]) -> str:
    year, month, day, *clock = found.groups()
    return f"{year}-{month}-{day}T{':'.join(part or '00' for part in clock)}"

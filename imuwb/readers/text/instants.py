"""Dates and times of day as texts: which forms a column has, and its cells in nanoseconds."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import lru_cache

from imuwb.units import SECOND, UNIX_EPOCH

_CLOCK = r"(?P<h>\d{1,2})(?P<sep>[:\-_])(?P<mi>\d\d)(?P=sep)(?P<s>\d\d)(?:[.,:_](?P<f>\d+))?(?: ?(?P<half>[AP]M))?"
_SHORT_CLOCK = r"(?P<h>\d\d)(?P<mi>\d\d)(?P<s>\d\d)(?:[.,](?P<f>\d+))?"
#: a time of day as a number, 95958.5 for 09:59:58.5, without the zeros at its beginning
_NUMBER_CLOCK = r"(?:(?P<h>\d{1,2})(?=\d{4}))?(?:(?P<mi>\d{1,2})(?=\d\d))?(?P<s>\d{1,2})(?:\.(?P<f>\d+))?"
_DAY_DIGITS = 6  #: of HHMMSS; a second of the day has five at most
_ZONE = r"(?: ?(?P<zone>Z|UTC|GMT|[+-]\d\d(?::?\d\d)?))?"
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
#: form of a date -> its pattern; of two that fit all cells, the first
_DATES = {
    "year first": r"(?P<y>\d{4})(?P<mark>[-/._])(?P<m>\d{1,2})(?P=mark)(?P<d>\d{1,2})",
    "day first": r"(?P<d>\d{1,2})\.(?P<m>\d{1,2})\.(?P<y>\d{4})",
    "day or month first": r"(?P<d>\d{1,2})(?P<mark>[-/])(?P<m>\d{1,2})(?P=mark)(?P<y>\d{4})",
    "month by name": rf"(?P<d>\d{{1,2}})[- /.](?P<name>{'|'.join(_MONTHS)})[a-z]*[- /.](?P<y>\d{{4}})",
    "digits": r"(?P<y>(?:19|20)\d\d)(?P<m>\d\d)(?P<d>\d\d)",
}
_DAY = 86_400 * SECOND
_HALF_DAY = _DAY // 2
_MONTH_FIRST = 12  #: the greatest month; a first number above it is a day


@dataclass(frozen=True, slots=True)
class Form:
    """How the texts of a column, or of a column of dates and one of times of day, show an instant."""

    pattern: re.Pattern[str]
    dated: bool  #: False: a time of day alone
    month_first: bool = False
    ambiguous: bool = False  #: the day and the month may be exchanged


def form_of(texts: Iterable[str], *, numbers: bool = False) -> Form | None:
    """Return the form that most texts have; None for other texts. A date and a time of day are joined by a T.

    Args:
        texts: cells of a column, or of two.
        numbers: whether the times of day are numbers, HHMMSS.
    """
    cells = [text for text in texts if text]
    if not cells:
        return None
    for clock in (_NUMBER_CLOCK,) if numbers else (_CLOCK, _SHORT_CLOCK):
        for name, date in _DATES.items():
            found = _matches(rf"{date}[T _]+{clock}{_ZONE}", cells)
            if found is not None:
                return _dated(name, found)
    found = _matches(_CLOCK + _ZONE, cells)
    return None if found is None else Form(found[0].re, dated=False)


def _matches(pattern: str, cells: Sequence[str]) -> list[re.Match[str]] | None:
    compiled = re.compile(pattern, re.IGNORECASE)
    found = [match for cell in cells if (match := compiled.fullmatch(cell))]
    return found if 2 * len(found) > len(cells) else None


def _dated(name: str, found: list[re.Match[str]]) -> Form:
    """Return the form of dates; the numbers show whether the day or the month is first."""
    pattern = found[0].re
    if name != "day or month first":
        return Form(pattern, dated=True)
    days = any(int(match["d"]) > _MONTH_FIRST for match in found)
    months = any(int(match["m"]) > _MONTH_FIRST for match in found)
    return Form(pattern, dated=True, month_first=months, ambiguous=days == months)


def is_date(text: str) -> bool:
    """Return whether a text is a date without a time of day."""
    return any(re.fullmatch(date, text, re.IGNORECASE) for date in _DATES.values())


def is_time_of_day(text: str) -> bool:
    """Return whether a text is a time of day without a date."""
    return re.fullmatch(_CLOCK + _ZONE, text, re.IGNORECASE) is not None


def are_clock_numbers(cells: Iterable[str]) -> bool:
    """Return whether all cells are numbers HHMMSS or HHMMSS.sss of times of day, and not seconds of the day."""
    filled = [cell for cell in cells if cell]
    found = [re.fullmatch(_NUMBER_CLOCK, cell) for cell in filled]
    possible = all(m and int(m["h"] or 0) < 24 and int(m["mi"] or 0) < 60 and int(m["s"]) < 61 for m in found)  # noqa: PLR2004 - a clock
    return possible and any(len(cell.partition(".")[0]) == _DAY_DIGITS for cell in filled)


def nanoseconds(text: str, form: Form) -> int | None:
    """Return an instant in ns since 1970 UTC, or a time of day in ns since midnight; None for a text of another form.

    A date without a time zone is UTC.
    """
    match = form.pattern.fullmatch(text)
    if match is None:
        return None
    parts = match.groupdict()
    fraction = (parts["f"] or "")[:9].ljust(9, "0")
    hour, minutes = parts["h"] or "0", parts["mi"] or "0"
    if half := (parts.get("half") or "").upper():
        hour = str(int(hour) % 12 + 12 * (half == "PM"))
    if not form.dated:
        whole = (int(hour) * 60 + int(minutes)) * 60 + int(parts["s"])
        return whole * SECOND + int(fraction)
    month = parts.get("m") or str(_MONTHS.index(parts["name"].lower()) + 1)
    day, month = (month, parts["d"]) if form.month_first else (parts["d"], month)
    minute = _minute(parts["y"], month, day, hour, minutes, (parts["zone"] or "").upper())
    return None if minute is None else minute + int(parts["s"]) * SECOND + int(fraction)


@lru_cache(maxsize=64)
def _minute(*parts: str) -> int | None:
    """Return the beginning of a minute, ns since 1970 UTC; None for a date that does not exist."""
    *numbers, zone = parts
    try:
        when = datetime(*(int(number) for number in numbers), tzinfo=UTC)  # pyright: ignore[reportArgumentType]
    except ValueError:
        return None
    minutes = 0
    if zone[:1] in {"+", "-"}:
        digits = zone[1:].replace(":", "").ljust(4, "0")
        minutes = (int(digits[:2]) * 60 + int(digits[2:])) * (-1 if zone[0] == "-" else 1)
    return ((when - UNIX_EPOCH) - timedelta(minutes=minutes)) // timedelta(seconds=1) * SECOND


class Days:
    """The days that times of day have passed: a step back of more than half a day is midnight."""

    def __init__(self) -> None:
        """Start at the first day."""
        self._days = 0
        self._before: int | None = None

    def continued(self, time: int) -> int:
        """Return a time of day in ns since the first midnight."""
        if self._before is not None and self._before - time > _HALF_DAY:
            self._days += 1
        self._before = time
        return time + self._days * _DAY

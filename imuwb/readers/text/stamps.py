"""The columns of a text log that state its time, alone or together, and the choice among them."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

from imuwb.readers.text.column_names import Column, with_units
from imuwb.readers.text.instants import Form, are_clock_numbers, form_of, is_date, is_time_of_day
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.trust import is_number
from imuwb.units import UNITS

Kind = Literal["number", "week", "text", "calendar"]
Source = Literal["header", "log", "publish"]

_TOKEN = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
#: words of a name that show a time
_TIMES = {
    "time", "times", "timestamp", "timestamps", "stamp", "epoch", "utc", "tow", "itow", "sow", "gpst", "datetime", "uptime", "clock",
    "unix", "seconds", "elapsed", "ts", "zeit", "tiempo", "temps", "tempo",
}  # fmt: skip
#: words of a name that show something else: a duration, an accuracy, a state
_NO_TIMES = {
    "accuracy", "acc", "err", "error", "offset", "delta", "dt", "diff", "latency", "delay", "status", "valid", "validity", "uncertainty",
    "duration", "zone", "type", "flags", "exposure", "period", "interval", "rate", "mode", "temp", "temperature", "frame", "seq",
    "relative", "integral", "integration", "sync", "constant", "drift", "source",
}  # fmt: skip
#: words of times that another computer took when the message arrived, or was written to a file
_RECEIVED = {
    "log",
    "receive",
    "received",
    "recv",
    "rx",
    "bag",
    "rosbag",
    "record",
    "recorded",
    "arrival",
    "host",
    "app",
    "system",
    "pc",
}
_PUBLISHED = {"publish", "published", "sent"}
#: words of times since power-up or since the start of a record
_RELATIVE = {"elapsed", "boot", "startup", "start", "uptime", "since"}
_WHOLE = {"int", "integer", "whole"}
_SECONDS = {"sec", "secs", "second", "seconds", "s"}
#: last word of a name -> unit of a part of a second
_PARTS = {
    **dict.fromkeys(("nanosec", "nanosecs", "nsec", "nsecs", "nanosecond", "nanoseconds", "nanos", "ns"), "ns"),
    **dict.fromkeys(("usec", "usecs", "microsec", "microsecs", "microsecond", "microseconds", "micros", "us"), "us"),
    **dict.fromkeys(("msec", "msecs", "millisec", "millisecs", "millisecond", "milliseconds", "millis", "ms"), "ms"),
    **dict.fromkeys(("frac", "fraction", "fractional", "fracsec", "fsec", "subsec", "subsecs", "subsecond", "subseconds"), "s"),
}  # fmt: skip
_SPLIT_PART = re.compile(r"\b(nano|micro|milli) (sec)")  #: ``nanoSec``
_CALENDAR = ("year", "month", "day", "hour", "minute", "second")
_CALENDAR_WORDS = {
    "year": "year", "yr": "year", "month": "month", "mon": "month", "day": "day", "hour": "hour", "hours": "hour", "hr": "hour",
    "minute": "minute", "minutes": "minute", "min": "minute", "second": "second", "seconds": "second", "sec": "second",
}  # fmt: skip
_SHORT_NAMES = {("sec",), ("secs",), ("second",), ("gps", "s"), ("gps", "sec"), ("gps", "second")}
_WEEK = {"week", "weeks", "wn", "weekno"}
FIRST = 256  #: number of first rows in which the numbers of a column are looked at
SOUND = 0.9  #: least share of the first rows that show what a column is; the others may be damaged
COARSE = 0.5  #: share of the steps that are 0 from which a stamp does not time single rows


@dataclass(frozen=True, slots=True)
class Stamp:
    """One way to time the rows: from a column, or from several that belong together."""

    name: str  #: of the column, or what the names of its columns have in common
    kind: Kind
    #: numbers that add up; for a calendar, its parts from the year or the hour to the second, which their quantities name
    columns: tuple[Column, ...]
    source: Source = "header"
    week: Column | None = None
    form: Form | None = None  #: of texts
    relative: bool = False
    coarse: bool = False  #: most of its steps are 0
    dead: bool = False  #: it has no number in the first rows, or one alone
    weak: bool = False  #: its name may mean something else


@dataclass(frozen=True, slots=True)
class _Named:
    """A column whose name may belong to a time."""

    column: Column
    base: tuple[str, ...]  #: words of the name without its unit
    words: tuple[str, ...]  #: words of the name with its unit
    numbers: tuple[float, ...]  #: of the first rows, nan for another cell; empty if most cells are no numbers


def stamps_of(names: Sequence[str], layout: Layout) -> list[Stamp]:
    """Return all ways to time the rows of a log, the best first."""
    named = [_named(i, name, layout) for i, name in enumerate(names)]
    found = [*_texts(named, layout), *_calendars(named)]
    taken = {column.index for stamp in found for column in stamp.columns}
    pairs = [pair for pair in _pairs(named) if not taken & {column.index for column in pair.columns}]
    taken |= {column.index for stamp in pairs for column in stamp.columns}
    alone = [
        Stamp(part.column.name, "number", (part.column,), weak=part.column.name.strip() == "T")
        for part in named
        if part.column.index not in taken and _is_time(part)
    ]
    alone += [stamp for stamp in _units_alone(named) if stamp.columns[0].index not in taken]
    found += _with_week([*pairs, *alone], named)
    return sorted(_judged(found, named), key=_order)


def _units_alone(named: Sequence[_Named]) -> Iterator[Stamp]:
    """Yield the columns that rise and whose whole name is a unit of time: ``millis``, ``micros``, ``ms``."""
    for part in named:
        measure = _PARTS.get(part.words[0], "s") if len(part.words) == 1 else "s"
        rises = [b > a for a, b in pairwise(part.numbers)]
        if measure != "s" and rises and all(b >= a for a, b in pairwise(part.numbers)) and any(rises):
            yield Stamp(part.column.name, "number", (replace(part.column, unit=UNITS[measure]),), weak=True)


def _order(stamp: Stamp) -> tuple[object, ...]:
    return (
        stamp.dead, stamp.weak, stamp.kind == "text" and not stamp.form, stamp.coarse, stamp.source == "log", stamp.source == "publish",
        stamp.relative, stamp.kind != "week", stamp.columns[0].index,
    )  # fmt: skip


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case; a capital letter begins a word."""
    text = " ".join(word.lower() for word in _TOKEN.findall(name))
    return tuple(_SPLIT_PART.sub(r"\1\2", text).split())


def _named(index: int, name: str, layout: Layout) -> _Named:
    """Return a column with its unit, if the name has one of time, and the words of the name without it."""
    base, measure = name.strip(), None
    for text, stated in with_units(name):
        if stated is not None and stated.dimension == "time":
            base, measure = text, stated
            break
    words = words_of(base)
    if measure is None and len(words) > 1 and words[-1] in ("us", "ms", "ns"):
        measure, words = UNITS[words[-1]], words[:-1]
    cells = [cell for cell in layout.cells(index)[:FIRST] if cell]
    known = sum(map(is_number, cells))
    numbers = tuple(float(cell) if is_number(cell) else math.nan for cell in cells) if 2 * known > len(cells) else ()
    return _Named(Column(index, name, "time", 0, measure), words, words_of(name), numbers)


def _is_time(part: _Named) -> bool:
    """Return whether a column's name is that of a time, alone or with others."""
    words, of_week = set(part.base), {"of", "tow", "sow"} & set(part.base)
    if words & _NO_TIMES or ("week" in words and not of_week) or part.words == ("t", "imu"):
        return False
    return bool(words & _TIMES) or part.words[:1] == ("t",) or part.words in _SHORT_NAMES


def _texts(named: Sequence[_Named], layout: Layout) -> Iterator[Stamp]:
    """Yield the columns of dates and times as texts; a date and a time of day in two columns belong together."""
    cells = {part.column.index: layout.cells(part.column.index) for part in named if not part.numbers}
    texts = {index: column for index, column in cells.items() if any(column)}
    columns = {part.column.index: part.column for part in named}
    days = [index for index, column in texts.items() if _most(is_date, column)]
    days += [
        p.column.index
        for p in named
        if p.numbers and "date" in p.words and _most(is_date, layout.cells(p.column.index))
    ]
    clocks = [index for index, column in texts.items() if _most(is_time_of_day, column)]
    clocks += [p.column.index for p in named if days and p.numbers and _is_clock(p, layout)]
    joined = set[int]()
    for clock in clocks:
        day = min(days, key=lambda index: (abs(index - clock), index), default=None)
        if day is not None:
            joined |= {day, clock}
            both = [f"{a}T{b}" for a, b in zip(layout.cells(day), layout.cells(clock), strict=True) if a and b]
            name = f"{columns[day].name} {columns[clock].name}".strip()
            form = form_of(both, numbers=clock not in texts)
            yield Stamp(name, "text", (columns[day], columns[clock]), form=form)
    for index, column in texts.items():
        form = form_of(column)
        if index not in joined and (form is not None or _is_time(named[index])):
            yield Stamp(
                columns[index].name, "text", (columns[index],), form=form, relative=form is not None and not form.dated
            )


def _is_clock(part: _Named, layout: Layout) -> bool:
    """Return whether a column has times of day as numbers, HHMMSS."""
    return _is_time(part) and are_clock_numbers(layout.cells(part.column.index))


def _most(test: Callable[[str], bool], cells: Sequence[str]) -> bool:
    """Return whether most of the cells that are not empty pass a test."""
    filled = [cell for cell in cells if cell]
    return 2 * sum(map(test, filled)) > len(filled)


def _calendars(named: Sequence[_Named]) -> Iterator[Stamp]:
    """Yield a year, month, day, hour, minute and second in columns of their own, or an hour, minute and second without a date."""
    parts = {_CALENDAR_WORDS[p.base[-1]]: p for p in named if p.numbers and p.base and p.base[-1] in _CALENDAR_WORDS}
    needed = _CALENDAR if set(_CALENDAR) <= parts.keys() else _CALENDAR[3:]
    if set(needed) <= parts.keys():
        columns = tuple(replace(parts[word].column, quantity=word) for word in needed)
        rest = next((p for p in named if p.words and p.words[-1] in _PARTS and _is_fraction(p)), None)
        extra = () if rest is None else (replace(rest.column, unit=UNITS[_PARTS[rest.words[-1]]]),)
        name = " ".join(column.name for column in columns)
        yield Stamp(name, "calendar", columns + extra, relative=needed != _CALENDAR)


def _pairs(named: Sequence[_Named]) -> Iterator[Stamp]:
    """Yield whole seconds and a fraction of a second in two columns."""
    fractions = [part for part in named if part.words and part.words[-1] in _PARTS and _is_fraction(part)]
    used = set[int]()
    for fraction in fractions:
        prefix = tuple(word for word in fraction.words[:-1] if word not in _PARTS)
        free = (part for part in named if part.column.index not in used and part is not fraction)
        wholes = [part for part in free if _is_whole(part, prefix) and _starts_again(part, fraction)]
        whole = min(wholes, key=lambda part: abs(part.column.index - fraction.column.index), default=None)
        if whole is None:
            continue
        used |= {whole.column.index, fraction.column.index}
        measure = UNITS[_PARTS[fraction.words[-1]]]
        yield Stamp(
            _common(whole.column.name, fraction.column.name), "number",
            (replace(whole.column, unit=UNITS["s"]), replace(fraction.column, unit=measure)),
        )  # fmt: skip


def _starts_again(whole: _Named, fraction: _Named) -> bool:
    """Return whether a fraction falls wherever the whole seconds step, in all rows that show it."""
    rows = zip(pairwise(whole.numbers), pairwise(fraction.numbers), strict=False)
    return all(after < before for (first, second), (before, after) in rows if second > first)


def _common(whole: str, fraction: str) -> str:
    """Return what two names have in common at their beginning, or both names."""
    same = 0
    while same < min(len(whole), len(fraction)) and whole[same] == fraction[same]:
        same += 1
    prefix = whole[:same].rstrip("._ /:[(").strip()
    return prefix if len(prefix) > 1 else f"{whole}+{fraction}"


def _is_fraction(part: _Named) -> bool:
    """Return whether all numbers of a column are parts of a second."""
    factor = UNITS[_PARTS[part.words[-1]]].factor
    known = [number for number in part.numbers if math.isfinite(number)]
    return bool(known) and sum(0 <= number * factor < 1 for number in known) >= SOUND * len(known)


def _is_whole(part: _Named, prefix: tuple[str, ...]) -> bool:
    """Return whether a column has whole seconds, and a name that belongs to a fraction with some words before its unit."""
    known = [number for number in part.numbers if math.isfinite(number)]
    if not known or sum(number == int(number) for number in known) < SOUND * len(known):
        return False
    words = part.words
    base = tuple(word for word in words if word not in _WHOLE)
    base = base[:-1] if base and base[-1] in _SECONDS else base
    if prefix:
        return prefix in (base, words)
    return words[-1:] != () and (words[-1] in _SECONDS or _is_time(part)) and part.column.unit in (None, UNITS["s"])


def _with_week(stamps: Sequence[Stamp], named: Sequence[_Named]) -> Iterator[Stamp]:
    """Yield the stamps, those of a GPS week with the column of the week."""
    weeks = [
        part for part in named if part.words and part.words[-1] in _WEEK and "of" not in part.words and part.numbers
    ]
    week = weeks[0].column if weeks else None
    words = {part.column.index: set(part.words) for part in named}
    of_week = [
        s
        for s in stamps
        if week is not None and words[s.columns[0].index] & {"tow", "itow", "sow", "of", "gps", "gpst"}
    ]
    if week is not None and not of_week:
        of_week = [s for s in stamps if abs(s.columns[0].index - week.index) <= len(s.columns)]
    for stamp in stamps:
        yield replace(stamp, kind="week", week=week) if stamp in of_week[:1] else stamp


def _judged(stamps: Sequence[Stamp], named: Sequence[_Named]) -> Iterator[Stamp]:
    """Yield the stamps with their source, and with what their first rows show."""
    headers = any(_is_header(named[stamp.columns[0].index].base) for stamp in stamps)
    for stamp in stamps:
        words = named[stamp.columns[0].index].base
        numbers = [sum(parts) for parts in zip(*(_scaled(column, named) for column in stamp.columns), strict=False)]
        steps = [b != a for a, b in pairwise(numbers)]
        yield replace(
            stamp,
            source=_source(words, headers=headers),
            relative=stamp.relative or bool(set(words) & _RELATIVE),
            coarse=bool(steps) and sum(steps) < COARSE * len(steps),
            dead=stamp.kind != "text" and (not numbers or (bool(steps) and not any(steps) and not any(numbers))),
        )


def _scaled(column: Column, named: Sequence[_Named]) -> tuple[float, ...]:
    factor = column.unit.factor if column.unit is not None else 1.0
    return tuple(number * factor for number in named[column.index].numbers)


def _is_header(words: Sequence[str]) -> bool:
    return "header" in words or "stamp" in words or "sensor" in words or "sample" in words


def _source(words: Sequence[str], *, headers: bool) -> Source:
    """Return whose clock a stamp is; beside a message's own stamp, a plain time is that of the recording."""
    if set(words) & _PUBLISHED:
        return "publish"
    if set(words) & _RECEIVED and not _is_header(words):
        return "log"
    return "log" if headers and words in {("time",), ("timestamp",)} else "header"


def matches(stamp: Stamp, text: str) -> bool:
    """Return whether a user's text names a stamp: its name, or that of one of its columns."""
    names = (stamp.name, *(column.name for column in stamp.columns))
    return text.strip().lower() in {name.strip().lower() for name in names} | {
        name.strip().lstrip("#% ").lower() for name in names
    }

"""Numbers, times and estimates as texts for people. A quantity always has its unit."""

import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from unicodedata import category

from imuwb.statistics.estimate import Coefficient, Estimate
from imuwb.units import Unit

HOURS = 2  #: shortest time, in hours, that is written in hours
LONG_NUMBER = 10_000  #: smallest whole number whose digits are in groups
LARGE = 100  #: smallest number that is written without decimals
COEFFICIENT_DIGITS = (3, 6)  #: fewest and most significant digits of a coefficient
MOST_DECIMALS = 9
WIDE = 0.1  #: share of a value; with a wider interval, two digits are enough
DECIMALS = 6  #: decimals of a value whose interval has no width or an infinite width


LONGEST_NAME, LONGEST_TEXT = 120, 2000  #: letters of a name, and of a sentence, that a log gives
_MARKUP = re.compile(r"([\\`*_\[\]<>|~#!&$])")  #: letters that Markdown may take as markup
_LINE_START = re.compile(r"^(\s*\d*)([-+=.)])(?=\s|$)")  #: what begins a list, a line or a heading


def printable(text: str) -> str:
    """Return a text that a terminal, a viewer and a page show as it is.

    What UTF-8 lacks, control characters, line ends, and marks of no width, such as those that turn the direction of a text, become a
    question mark, which every font has; other blanks become the usual one.
    """
    if text.isascii() and text.isprintable():
        return text
    known = (" " if category(c) == "Zs" else c for c in text)
    return "".join(c if c.isprintable() and c != "\N{REPLACEMENT CHARACTER}" else "?" for c in known)


def printable_lines(text: str) -> str:
    """Return a text of several lines, each as ``printable`` returns it."""
    return "\n".join(map(printable, text.split("\n")))


def name_of(text: str) -> str:
    """Return a name that a log gives as a name that can be shown: printable, and not long; two names never become one."""
    shown = printable(text)
    if shown == text and len(text) <= LONGEST_NAME:
        return text
    mark = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:6]
    return f"{shown[:LONGEST_NAME]}{'…' if len(shown) > LONGEST_NAME else ''}~{mark}"


def sentence_of(text: str) -> str:
    """Return a sentence that may have words of a log: printable, and not long."""
    shown = printable(text)
    return shown if len(shown) <= LONGEST_TEXT else f"{shown[:LONGEST_TEXT]}…"


def markdown_text(text: str) -> str:
    """Return a text as Markdown that shows it letter by letter: no link, picture, heading, list or table begins in it."""
    return _LINE_START.sub(r"\1\\\2", _MARKUP.sub(r"\\\1", printable(text)))


def markdown_block(lines: Iterable[str]) -> str:
    """Return lines as a block of Markdown that shows them as they are; no line ends the block."""
    shown = [printable(line) for line in lines]
    fence = "`" * max(3, *(len(run) + 1 for line in shown for run in re.findall("`+", line)), 3)
    return "\n".join((f"{fence}text", *shown, fence))


def number_text(value: float) -> str:
    """Return a number with three significant digits; a large one as a whole number, without a power of ten: 0.0123, 4.56, 78 901."""
    return count_text(value) if abs(value) >= LARGE and math.isfinite(value) else f"{value:.3g}"


def count_text(value: float) -> str:
    """Return a whole number; more than four digits are in groups of three, which no line break parts: 6400, 5 837 380."""
    return f"{value:,.0f}".replace(",", "\N{NO-BREAK SPACE}") if abs(value) >= LONG_NUMBER else f"{value:.0f}"


def counted(count: int, noun: str, several: str = "") -> str:
    """Return a number of things: 1 position, 5 837 380 samples; ``several`` is the plural if it is not that with s."""
    return f"{count_text(count)} {noun if count == 1 else several or f'{noun}s'}"


def quantity_text(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a value with its unit, with that many significant digits; a dash for None."""
    return "—" if value is None else f"{value:.{digits}g} {unit}".rstrip()


def seconds_text(seconds: float) -> str:
    """Return a time: 0.35 s, 20.5 s, 655 s, 2.3 h."""
    return f"{number_text(seconds / 3600)} h" if seconds >= HOURS * 3600 else f"{number_text(seconds)} s"


def names_text(names: Sequence[str], most: int = 12) -> str:
    """Return names, and how many more there are if there are many: a, b, c and 28 more."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def rows_text(rows: int, rate: float | None, seconds: float, gaps: Sequence[tuple[float, float]]) -> str:
    """Return how much of a stream there is: 901 rows, 100 Hz, 9.02 s, 1 gap (longest 0.02 s).

    Args:
        rows: how many.
        rate: Hz, or None.
        seconds: from the first row to the last.
        gaps: (start, length) of each, s.
    """
    parts = [f"{rows} rows"]
    if rows > 1:
        longest = f" (longest {max((length for _, length in gaps), default=0.0):.3g} s)" if gaps else ""
        count = f"{len(gaps)} gap{'s' if len(gaps) > 1 else ''}" if gaps else "no gaps"
        parts += [quantity_text(rate, "Hz", 4), seconds_text(seconds), f"{count}{longest}"]
    return ", ".join(parts)


def interval_text(estimate: Estimate, unit: str = "") -> str:
    """Return an estimate and its interval with three digits each: 12.3 [10, 15] m; 12.3 m for an estimate without an interval.

    Args:
        estimate: to print.
        unit: name of the unit that the estimate has; empty: the name that stands in the estimate.
    """
    text = number_text(estimate.value)
    if not math.isnan(estimate.lower):
        text += f" [{number_text(estimate.lower)}, {number_text(estimate.upper)}]"
    return f"{text} {unit or estimate.unit}".rstrip()


def estimate_text(estimate: Estimate, unit: str, factor: float = 1.0) -> str:
    """Return an estimate with as many decimals as the width of its interval justifies: 0.123 [0.120, 0.126] deg/s.

    Args:
        estimate: with an interval.
        unit: name of the display unit; empty: no unit.
        factor: value of one display unit in the unit of the estimate.
    """
    value, low, high = (x / factor for x in (estimate.value, estimate.lower, estimate.upper))
    digits = decimals(high - low)
    return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}] {unit}".rstrip()


def converted_text(estimate: Estimate, unit: Unit) -> str:
    """Return an estimate in SI with its interval in a display unit, three digits each."""
    return interval_text(estimate.scaled(1 / unit.factor, unit.name))


def coefficient_text(coefficient: Coefficient, unit: Unit) -> str:
    """Return a coefficient and its interval in a display unit, with as many digits as the width of the interval justifies.

    "<" stands before an upper limit. A dash stands for a coefficient, or for an end of its interval, that the data do not bound.
    """
    c = coefficient
    if c.value is None:
        return f"< {_short(unit.from_si(c.upper), 3)} {unit.name}" if math.isfinite(c.upper) else "—"
    low, value = unit.from_si(c.lower or 0.0), unit.from_si(c.value)
    if not math.isfinite(c.upper):
        return f"{_short(value, 3)} [{_short(low, 3)}, —] {unit.name}"
    high = unit.from_si(c.upper)
    fewest, most = COEFFICIENT_DIGITS
    digits = fewest
    if high > low and value > 0:
        digits = min(max(2 - math.floor(math.log10((high - low) / value)), fewest), most)
    return f"{_short(value, digits)} [{_short(low, digits)}, {_short(high, digits)}] {unit.name}"


def _short(value: float, digits: int) -> str:
    """Return a number with that many significant digits; a large one as a whole number, without a power of ten."""
    return f"{value:.{digits}g}" if abs(value) < 10**digits else count_text(float(f"{value:.{digits}g}"))


def coefficient_cell(coefficient: Coefficient, unit: Unit) -> str:
    """Return a coefficient and its interval without the unit's name, for a column that states it: 2.40 [2.38, 2.43].

    Three digits; two where the interval is wide. "<" stands before an upper limit, and for an interval from 0.
    """
    c = coefficient
    if not math.isfinite(c.upper):
        return "—"
    if c.value is None or not c.lower or not c.value:
        return f"< {_digits(unit.from_si(c.upper), 3)}"
    digits = 2 if c.upper - c.lower > WIDE * c.value else 3
    value, low, high = (_digits(unit.from_si(x), digits, unit.from_si(c.value)) for x in (c.value, c.lower, c.upper))
    return f"{value} [{low}, {high}]"


def _digits(value: float, digits: int, like: float | None = None) -> str:
    """Return a number with the decimals that another number has, which is written with so many significant digits."""
    size = abs(value if like is None else like)
    return f"{value:.{max(digits - 1 - math.floor(math.log10(size)), 0)}f}" if size else "0"


def duration_text(seconds: float) -> str:
    """Return a time as people say it: 35 s, 12 min, 2 h 46 min."""
    minutes = round(seconds / 60)
    if seconds < 2 * 60:
        return f"{number_text(seconds)} s"
    hours, rest = divmod(minutes, 60)
    return f"{minutes} min" if not hours else f"{hours} h {rest} min" if rest else f"{hours} h"


def bytes_text(count: int) -> str:
    """Return a number of bytes as people say it: 812 bytes, 8.16 MB, 1.2 TB."""
    for factor, unit in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if count >= factor:
            return f"{count / factor:.3g} {unit}"
    return f"{count} bytes"


def coefficients_text(coefficients: Mapping[str, Coefficient]) -> str:
    """Return noise coefficients on one line: N 0.0014 [0.0013, 0.0015], K < 0.002."""
    return ", ".join(f"{letter} {coefficient}" for letter, coefficient in coefficients.items())


def decimals(width: float) -> int:
    """Return the number of decimals of a value whose interval has a width: enough for two digits of the width."""
    if not (width > 0 and math.isfinite(width)):
        return DECIMALS
    return min(max(1 - math.floor(math.log10(width)), 0), MOST_DECIMALS)

"""What a paper prints: its tables value by value, and its figures and equations by number.

Each paper is a TOML file in ``papers``. A value is a text, so that its last digit is known; a table or figure states the command
that makes it and, in ``readings``, what the paper leaves open and which reading was taken, or the ``reason`` why it is not made.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

from imuwb.documents import document_of

FOLDER = Path(__file__).with_name("papers")
NORMAL = 1.959964  #: half width of a 95 % interval, in sigmas


@dataclass(frozen=True, slots=True)
class Key:
    """Names one value of a paper."""

    table: str  #: number: "4"
    quantity: str  #: "N"
    item: str  #: "gyro_x"


@dataclass(frozen=True, slots=True)
class PrintedValue:
    """One value, as printed."""

    key: Key
    text: str  #: "2.420"
    unit: str
    sigma: float | None = None  #: as printed; None: the paper states none
    other: bool = False  #: the paper's own record or drive decides the value, so a simulation cannot give it again

    @property
    def value(self) -> float:
        """The number."""
        return float(self.text)

    @property
    def half_width(self) -> float:
        """Half the 95 % interval: from the printed sigma; without one, half a unit of the last digit."""
        return self.last_digit / 2 if self.sigma is None else math.hypot(NORMAL * self.sigma, self.last_digit / 2)

    @property
    def last_digit(self) -> float:
        """One unit of the last printed digit."""
        mantissa, _, exponent = self.text.lower().partition("e")
        return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))

    def __str__(self) -> str:
        """Return the value with its sigma."""
        return self.text if self.sigma is None else f"{self.text} ± {self.sigma:g}"


@dataclass(frozen=True, slots=True)
class Printed:
    """A table, a figure or an equation of a paper."""

    number: str
    title: str
    command: str = ""  #: that makes it
    readings: tuple[str, ...] = ()  #: what the paper leaves open, and which reading was taken
    reason: str = ""  #: why it is not made again
    values: tuple[PrintedValue, ...] = ()  #: of a table


@dataclass(frozen=True, slots=True)
class Paper:
    """A paper."""

    name: str  #: "quinchia"
    title: str
    source: str  #: authors, journal, year
    tables: tuple[Printed, ...]
    figures: tuple[Printed, ...]
    equations: tuple[Printed, ...]

    def values(self) -> Iterator[PrintedValue]:
        """Yield the values of all tables."""
        return (value for table in self.tables for value in table.values)


@cache
def paper(name: str) -> Paper:
    """Return a paper by the name of its file."""
    content = cast("Mapping[str, Any]", document_of(FOLDER / f"{name}.toml", "the tables of a paper"))
    kinds = (tuple(_printed(one) for one in content.get(kind, ())) for kind in ("table", "figure", "equation"))
    return Paper(name, str(content["title"]), str(content["source"]), *kinds)


def _printed(content: Mapping[str, Any]) -> Printed:
    texts = {part: str(content.get(part, "")) for part in ("number", "title", "command", "reason")}
    blocks = cast("Sequence[Mapping[str, Any]]", content.get("values", ()))
    values = tuple(value for block in blocks for value in _values(texts["number"], block))
    return Printed(**texts, readings=tuple(content.get("readings", ())), values=values)


def _values(table: str, block: Mapping[str, Any]) -> Iterator[PrintedValue]:
    """Yield the values of one quantity: a text for each item, "-" where the paper's cell is empty."""
    sigmas = block.get("sigma", [None] * len(block["items"]))
    for item, text, sigma in zip(block["items"], block["printed"], sigmas, strict=True):
        if text != "-":
            key = Key(table, block["quantity"], item)
            yield PrintedValue(key, text, block["unit"], sigma, block.get("other", False))

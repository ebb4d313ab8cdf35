"""The estimators and simulators whose files imuwb writes and reads: each a table of fields and a layout, as data.

``tools/*.toml`` has them, with the source of each fact. A field says which coefficient it has (``accel N``), by which formula
(``c √(2f)``), and in which unit; the layout is the file, with ``{key}`` in the place of each value.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from imuwb.errors import UsageError
from imuwb.estimators.formula import FORMULAS, Formula
from imuwb.units import UNITS

#: what a field may have of ``gyro`` or ``accel``, and the letter that stands for it in a comment
TERMS = ("N", "K", "own_K", "B", "sigma", "Tc", "drive", "turn_on", "scale")
#: what a field may have of the whole file
SETTINGS = ("rate", "step", "horizon")
SHAPES = ("largest", "each", "diagonal", "xyz")


@dataclass(frozen=True, slots=True)
class Field:
    """One value of a file."""

    key: str  #: its name in the file; {axis} stands for x, y, z
    sensor: str  #: "gyro", "accel", "both", or "" for a setting
    term: str
    formula: Formula
    written: str  #: the formula as text
    unit: str  #: as comments state it
    factor: float = 1.0  #: SI value of one unit
    shape: str = "largest"  #: one value for three axes, one for each, the diagonal of a matrix, or a key for each
    least: float | None = None
    most: float | None = None
    default: str = ""  #: what the tool takes where the field is missing

    @property
    def keys(self) -> tuple[str, ...]:
        """Return the names in the file."""
        return tuple(self.key.replace("{axis}", axis) for axis in "xyz") if self.shape == "xyz" else (self.key,)


@dataclass(frozen=True, slots=True)
class Tool:
    """One estimator or simulator."""

    name: str
    title: str
    source: str  #: where the facts stand, by name
    suffix: str
    layout: str
    fields: tuple[Field, ...]
    form: str = "text"  #: or "json", "xml"
    comment: str = "#"
    needs: str = ""  #: "rate" or "step", where values depend on it
    step: float | None = None  #: s, the estimator's own, unless stated
    join: str = ", "
    notes: tuple[str, ...] = ()  #: traps that its users must know
    calibration: str = ""  #: form of the calibration that its files have too
    identity: tuple[str, ...] = ()  #: keys that tell its files from those of others

    @property
    def terms(self) -> frozenset[str]:
        """Return the terms that its files have a place for."""
        return frozenset(field.term for field in self.fields)


@cache
def tools() -> Mapping[str, Tool]:
    """Return all tools by name, in the order of the tables."""
    found: dict[str, Tool] = {}
    for entry in sorted(files("imuwb.estimators").joinpath("tools").iterdir(), key=lambda e: e.name):
        if entry.name.endswith(".toml"):
            document = tomllib.loads(entry.read_text("utf-8"))
            found |= {row["name"]: _tool(row) for row in document["tool"]}
    return found


def tool_named(name: str, option: str = "--to") -> Tool:
    """Return a tool; ``option`` names where it was asked for.

    Raises:
        UsageError: no such tool; the message lists all.
    """
    if name not in tools():
        raise UsageError(f"{option} {name}: there is no such tool; it must be one of {', '.join(tools())}")
    return tools()[name]


def _tool(row: dict[str, Any]) -> Tool:
    fields = tuple(_field(field) for field in row.pop("field"))
    lists = {key: tuple(row.pop(key, ())) for key in ("notes", "identity")}
    return Tool(fields=fields, **lists, **row)


def _field(row: dict[str, Any]) -> Field:
    sensor, _, term = str(row.pop("of")).rpartition(" ")
    written = str(row.pop("value", "c"))
    unit = row.pop("unit", None)
    factor = float(row.pop("factor", 1.0)) if unit is None else UNITS[unit].factor
    label = str(row.pop("si", "") if unit is None else unit)
    return Field(sensor=sensor, term=term, formula=FORMULAS[written], written=written, unit=label, factor=factor, **row)

"""What is known of a shape of text logs, and the table of all shapes."""

import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from typing import Any

from imuwb.readers.quantities import DIMENSIONS
from imuwb.units import Epoch, unit

_BRACES = re.compile(r"\{(...)\}")


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a column of a shape measures."""

    quantity: str  #: a key of DIMENSIONS
    axis: int  #: 0, 1, 2 for x, y, z of the file; 0 for a quantity without axes
    unit: str  #: the unit that the format fixes; empty: the file or the user states it
    sign: int  #: -1: the column has the quantity with the other sign


@dataclass(frozen=True, slots=True)
class Shape:
    """A known shape of text logs; the package's docstring says what each part means."""

    name: str
    source: str
    header: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    file: str = ""
    text: str = ""
    cells: int = 0
    ranges: Mapping[int, tuple[float, float]] = field(default_factory=dict[int, tuple[float, float]])
    steps: tuple[float, float] = (0.0, math.inf)
    changes: Mapping[int, float] = field(default_factory=dict[int, float])
    row: tuple[Meaning | None, ...] = ()
    columns: Mapping[str, Meaning] = field(default_factory=dict[str, Meaning])
    refused: Mapping[str, str] = field(default_factory=dict[str, str])
    frame: tuple[str, ...] = ()
    epoch: Epoch | None = None
    rate: str = ""
    sparse: bool = False
    remark: str = ""

    @property
    def detail(self) -> int:
        """How much must fit: of two shapes that fit, the one with more is taken."""
        return len(self.header) + len(self.absent) + len(self.ranges) + 10 * bool(self.file) + 10 * bool(self.text)


@cache
def shapes() -> tuple[Shape, ...]:
    """Return all shapes, those with more detail first."""
    folder = files("imuwb.readers.text.shapes")
    tables = (item for item in folder.iterdir() if item.name.endswith(".toml"))
    documents = [tomllib.loads(table.read_text("utf-8")) for table in tables]
    known = [shape_from(stated) for document in documents for stated in document.get("shape", ())]
    return tuple(sorted(known, key=lambda shape: (-shape.detail, shape.name)))


def shape_from(stated: Mapping[str, Any]) -> Shape:
    """Return the shape that a TOML table states."""
    texts: dict[str, Any] = {
        key: value for key, value in stated.items() if isinstance(value, str | bool | int) and key != "frame"
    }
    frame = stated.get("frame", ())
    return replace(
        Shape(**texts),
        header=tuple(_expanded(stated.get("header", ()))),
        absent=tuple(_expanded(stated.get("absent", ()))),
        ranges={int(cell): (low, high) for cell, (low, high) in stated.get("ranges", {}).items()},
        steps=tuple(stated.get("steps", (0.0, math.inf))),
        changes={int(cell): most for cell, most in stated.get("changes", {}).items()},
        row=tuple(None if text == "-" else _meaning(text) for text in stated.get("row", ())),
        columns=dict(_columns(stated.get("columns", {}))),
        refused={name: why for key, why in stated.get("refused", {}).items() for name in _expanded((key,))},
        frame=(frame,) if isinstance(frame, str) else tuple(frame),
    )


def _columns(stated: Mapping[str, str]) -> Iterator[tuple[str, Meaning]]:
    for key, text in stated.items():
        meaning = _meaning(text)
        names = list(_expanded((key,)))
        for axis, name in enumerate(names):
            yield name, replace(meaning, axis=axis) if len(names) > 1 else meaning


def _expanded(keys: Iterable[str]) -> Iterator[str]:
    """Yield names; ``{xyz}`` stands for three of them."""
    for key in keys:
        braces = _BRACES.search(key)
        yield from ([key.replace(braces[0], letter) for letter in braces[1]] if braces else [key])


def _meaning(text: str) -> Meaning:
    """Return the meaning of ``gyro_x rad/s``.

    Raises:
        ValueError: no such quantity, or a unit of another dimension.
    """
    name, _, measure = text.removeprefix("-").partition(" ")
    quantity, axis = (name[:-2], "xyz".index(name[-1])) if re.search(r"_[xyz]$", name) else (name, 0)
    if quantity not in DIMENSIONS or (measure and unit(measure).dimension != DIMENSIONS[quantity]):
        raise ValueError(f"{text!r} is no quantity and its unit")
    return Meaning(quantity, axis, measure, -1 if text.startswith("-") else 1)

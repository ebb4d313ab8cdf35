"""The contract between an analysis, the command line and the review.

An analysis is a module (or any object) with

* ``Parameters``: a frozen dataclass. Each field is an option of the command line; its annotation
  gives the type and, as ``Annotated[float, "what it means"]``, the help. ``__post_init__`` raises
  ValueError with the reason when a value cannot be.
* ``run(logs, parameters) -> result``: pure; the result is a frozen dataclass (or a dict), and becomes JSON. It raises
  MissingDataError when a log has not what it needs.
* ``draw(result, review)``: shows the result; computes nothing.
* optionally ``LOGS = (fewest, most)`` (default one log; most may be None), and
  ``error_model(result) -> ImuErrorModel``.

It is registered under the entry-point group ``imuwb.analyses``, or is a single file:
``imuwb ./mine.py LOG``. Its docstring's first line is its help. This module imports nothing heavy, so
that help is quick; keep imports of numpy inside ``run`` and ``draw``, or in modules they import.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    import rerun as rr
    from numpy.typing import NDArray

    from imuwb.log import Log

    Floats = NDArray[np.float64]

#: One colour per axis, the same in every figure, series and table (x, y, z: red, green, blue, toned for both themes).
AXIS_COLORS = {"x": (228, 87, 86), "y": (84, 162, 75), "z": (76, 120, 168)}


class DataclassInstance(Protocol):
    """Any dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


class Analysis(Protocol):
    """What a module must have to be an analysis."""

    Parameters: Any

    def run(self, logs: Sequence[Log], parameters: Any) -> Any:  # noqa: ANN401 - each analysis has its own types
        """Return the result of the analysis."""
        ...

    def draw(self, result: Any, review: Review) -> None:  # noqa: ANN401 - as above
        """Show a result."""
        ...


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """A line in a log-log figure; points that are not positive and finite are left out."""

    label: str  #: in the legend; empty: none
    x: Floats
    y: Floats
    color: tuple[int, int, int]
    lower: Floats | None = None  #: ends of the interval at each point
    upper: Floats | None = None
    style: str = "line"  #: "line", "fit" (thin), or "faint"


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in a figure with a text beside it."""

    x: float
    y: float
    text: str
    color: tuple[int, int, int]


@dataclass(frozen=True, eq=False, slots=True)
class Figure:
    """A log-log figure. Axis titles carry the unit."""

    title: str
    x_title: str
    y_title: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under headings; a figure in a cell or its heading carries its unit."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Series:
    """One or more quantities over time, in the unit shown."""

    title: str
    unit: str
    time: NDArray[np.int64]  #: (n,) ns
    values: Floats  #: (n, k)
    names: tuple[str, ...]
    colors: tuple[tuple[int, ...], ...] = ()  #: RGB or RGBA
    epoch: str = "log"  #: what time counts from: "unix", "boot" or "log"


class Review(Protocol):
    """Where an analysis shows its result: one call puts it into the recording and, for text, the terminal."""

    def series(self, series: Series) -> None:
        """Show quantities over time; long ones as envelopes of their extremes."""
        ...

    def figure(self, figure: Figure) -> None:
        """Show a log-log figure."""
        ...

    def table(self, table: Table) -> None:
        """Show a table, in the recording and in the terminal."""
        ...

    def track(self, name: str, position: Floats, color: tuple[int, int, int]) -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, in local east and north."""
        ...

    def note(self, text: str) -> None:
        """Say something a reader of the result must know."""
        ...

    @property
    def recording(self) -> rr.RecordingStream:
        """The recording itself, for what the other calls do not cover; its views join the analysis's tab."""
        ...


def quantity(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a value with its unit, with that many significant digits; a dash for None."""
    return "—" if value is None else f"{value:.{digits}g} {unit}"

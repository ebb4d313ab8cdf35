"""The contract between an analysis, the command line and the review.

An analysis is a module (or any object) with

* ``Parameters``: a frozen dataclass. Each field is an option of the command line; its annotation
  gives the type and, as ``Annotated[float, "what it means"]``, the help. ``__post_init__`` raises
  ValueError with the reason when a value cannot be.
* ``run(logs, parameters) -> result``: pure; the result is a frozen dataclass (or a dict), and becomes JSON. It raises
  MissingDataError when a log has not what it needs.
* ``draw(result, review)``: shows the result; computes nothing.
* optionally ``LOGS = (fewest, most)`` (default one log; most may be None), and
  ``error_model(result) -> ImuErrorModel``; with ``LEAVES_MODEL`` the model is saved unasked, beside the recording: as
  ``.error-model.toml``, or, where it is a text, with that in its place.

* optionally ``findings(result) -> tuple of Finding``: what it says of each axis in common terms, which
  recipes lay beside what other analyses say;
* optionally ``outputs(parameters) -> tuple of paths`` and ``write_outputs(result, parameters)``, for files of its own: those
  that exist are not written over without --force;
* optionally ``study(cases, parameters) -> result`` and ``draw_study(result, review)``, for ``--study``.

An analysis of several methods has ``METHODS`` instead, {name: module}, each an analysis as above: they become
commands of a group, and the result's JSON has the method among its parameters.

It is registered under the entry-point group ``imuwb.analyses``, or is a single file:
``imuwb ./mine.py LOG``. Its docstring's first line is its help. This module imports nothing heavy, so
that help is quick; keep imports of numpy inside ``run`` and ``draw``, or in modules they import.

A conditioner changes the samples before an analysis sees them (``--through NAME:key=value,...``). It is a module with

* ``Parameters``, as above;
* ``condition(log, parameters) -> (log, found)``: the log with its change, which it names in ``Log.conditioning``:
  whether it is causal, and how late; ValueError says why a parameter cannot be with this log;
* optionally ``draw(found, review)``.

It is registered under ``imuwb.conditioners``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    import rerun as rr
    from numpy.typing import NDArray

    from imuwb.log import Log
    from imuwb.units import Unit

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
    """A line in a figure; what is not finite, or not positive on a logarithmic axis, is left out."""

    label: str  #: in the legend; empty: none
    x: Floats
    y: Floats
    color: tuple[int, int, int]
    lower: Floats | None = None  #: ends of the interval at each point
    upper: Floats | None = None
    style: str = "line"  #: "line" (with points), "curve" (without), "points", "fit" (thin), or "faint"


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in a figure with a text beside it."""

    x: float
    y: float
    text: str
    color: tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Vertical:
    """A dashed line across a figure, with a text."""

    x: float
    text: str
    color: tuple[int, int, int] = (200, 200, 205)


@dataclass(frozen=True, eq=False, slots=True)
class Figure:
    """A figure, log-log unless it says otherwise. Axis titles carry the unit."""

    title: str
    x_title: str
    y_title: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    x_scale: Literal["log", "linear"] = "log"
    y_scale: Literal["log", "linear"] = "log"
    verticals: tuple[Vertical, ...] = ()
    x_limits: tuple[float, float] | None = None  #: None: what holds all curves
    y_limits: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under headings; a figure in a cell or its heading carries its unit."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    wide: bool = False  #: has a row of the recording's tab to itself


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


class AnyCoefficient(Protocol):
    """A coefficient in SI as any estimator gives it: ``value`` None where it is not identified."""

    @property
    def value(self) -> float | None:
        """Return the estimate."""
        ...

    @property
    def lower(self) -> float | None:
        """Return the lower end of its interval."""
        ...

    @property
    def upper(self) -> float | None:
        """Return the upper end of its interval, or the limit."""
        ...


@dataclass(frozen=True, slots=True)
class CoefficientResult:
    """One coefficient in SI; ``value`` None where it is not identified, ``upper`` then is its limit."""

    value: float | None
    lower: float | None
    upper: float | None
    unit: str
    at: float | None = None  #: s, averaging time at which it is read off its line


@dataclass(frozen=True, slots=True)
class LineResult:
    """A periodic line in SI."""

    frequency: float  #: Hz
    amplitude: float
    lower: float
    upper: float
    unit: str
    name: str = ""  #: such as "line at 0.56 Hz" or "3 × 0.56 Hz"


@dataclass(frozen=True, slots=True)
class Finding:
    """What an analysis says of one axis, in terms that all share."""

    axis: str
    source: str  #: the estimator's name
    coefficients: Mapping[str, AnyCoefficient]  #: of Q, N, B, K, R, those it speaks of
    remarks: tuple[str, ...] = ()  #: one line each, for a person to act on
    headline: bool = False  #: this estimator's figures go into the model


@dataclass(frozen=True, eq=False, slots=True)
class Case:
    """One setting of a study, and the log as it is there."""

    settings: Mapping[str, str]  #: such as {"rate": "100", "bandwidth": "42"}
    log: Log


class Conditioner(Protocol):
    """What a module must have to be a conditioner."""

    Parameters: Any

    def condition(self, log: Log, parameters: Any) -> tuple[Log, Any]:  # noqa: ANN401 - each has its own types
        """Return the changed log, and what can be drawn of the change."""
        ...


class Review(Protocol):
    """Where an analysis shows its result: one call puts it into the recording and, for text, the terminal."""

    def tab(self, name: str) -> None:
        """Put what follows on a tab of that name."""
        ...

    def series(self, series: Series) -> None:
        """Show quantities over time; long ones as envelopes of their extremes."""
        ...

    def figure(self, figure: Figure) -> None:
        """Show a figure."""
        ...

    def table(self, table: Table) -> None:
        """Show a table, in the recording and in the terminal."""
        ...

    def track(self, name: str, position: Floats, color: tuple[int, int, int], label: str = "") -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, in local east and north; a label at its end.

        Tracks of one tab share a picture, whose origin is the first one's first point.
        """
        ...

    def chart(self, name: str, position: Floats, color: tuple[int, int, int]) -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, on a map; the viewer fetches it from the network."""
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


HOURS = 2  #: from here on a time is told in hours


def seconds_text(seconds: float) -> str:
    """Return a time as one reads it: 0.35 s, 20.5 s, 655 s, 2.3 h."""
    if seconds >= HOURS * 3600:
        return f"{seconds / 3600:.2g} h"
    return f"{seconds:.3g} s" if seconds < 100 else f"{seconds:.0f} s"  # noqa: PLR2004 - three digits


def estimate_text(coefficient: AnyCoefficient, unit: Unit) -> str:
    """Return a coefficient with its interval in a display unit: as many digits as the interval is worth; < is a limit."""
    c = coefficient
    if c.value is None:
        if c.upper is None or not math.isfinite(c.upper):
            return "—"
        return f"< {unit.from_si(c.upper):.3g} {unit.name}"
    low, value = unit.from_si(c.lower or 0.0), unit.from_si(c.value)
    if c.upper is None or not math.isfinite(c.upper):  # nothing bounds it
        return f"{value:.3g} [{low:.3g}, —] {unit.name}"
    high = unit.from_si(c.upper)
    digits = 3
    if high > low and value > 0:
        digits = min(max(math.floor(2 - math.floor(math.log10((high - low) / value))), 3), 6)
    return f"{value:.{digits}g} [{low:.{digits}g}, {high:.{digits}g}] {unit.name}"


def decimals(width: float) -> int:
    """Return how many decimals a value is worth whose interval is so wide: two digits of the width."""
    if not (width > 0 and math.isfinite(width)):
        return 6
    return min(max(1 - math.floor(math.log10(width)), 0), 9)

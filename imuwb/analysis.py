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
* ``condition(log, parameters) -> (log, applied)``: the log with its change, which ``Log.conditioning`` states with its
  delay and whether it is causal; ValueError with the reason where the log does not allow a parameter;
* optionally ``draw(applied, review)``;
* optionally ``STUDY = {short name: (parameter, {parameter: value, ...})}``, for ``--study``: a name that people may write
  for ``NAME.parameter``, and the values (as texts) of other parameters that go with it;
* optionally ``ORDER``, a number: within one setting of a study conditioners run in rising order, those without a number last.

It is registered under ``imuwb.conditioners``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

from imuwb.colors import PALE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    import rerun as rr
    from numpy.typing import NDArray

    from imuwb.colors import Color
    from imuwb.log import Log
    from imuwb.statistics import Coefficient

    Floats = NDArray[np.float64]


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
    color: Color
    lower: Floats | None = None  #: ends of the interval at each point
    upper: Floats | None = None
    style: str = "line"  #: "line" (with points), "curve" (without), "points", "fit" (thin), or "faint"


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in a figure with a text beside it."""

    x: float
    y: float
    text: str
    color: Color


@dataclass(frozen=True, slots=True)
class Vertical:
    """A dashed line across a figure, with a text."""

    x: float
    text: str
    color: Color = PALE


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
    coefficients: Mapping[str, Coefficient]  #: of Q, N, B, K, R, those it speaks of
    remarks: tuple[str, ...] = ()  #: one line each, for a person to act on
    headline: bool = False  #: this estimator's figures go into the model


@dataclass(frozen=True, eq=False, slots=True)
class Case:
    """One setting of a study, and the log as it is there."""

    settings: Mapping[str, str]  #: such as {"rate": "100", "bandwidth": "42"}
    log: Log


def offers(plugin: object, part: str) -> bool:
    """Return whether a plugin has a part, such as "error_model", without importing it."""
    return part in dir(plugin)


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

    def track(self, name: str, position: Floats, color: Color, label: str = "") -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, in local east and north; a label at its end.

        Tracks of one tab share a picture, whose origin is the first one's first point.
        """
        ...

    def chart(self, name: str, position: Floats, color: Color) -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, on a map; the viewer fetches it from the network."""
        ...

    def note(self, text: str) -> None:
        """Say something a reader of the result must know."""
        ...

    @property
    def recording(self) -> rr.RecordingStream:
        """The recording itself, for what the other calls do not cover; its views join the analysis's tab."""
        ...

"""The contracts of plugins: analyses and conditioners, and what a review shows for them.

``imuwb.testing`` asks whether a plugin keeps them; ``imuwb plugins new`` writes a plugin that does.

An analysis is a module, or any object, with these parts:

* ``Parameters``: a frozen dataclass whose fields are the options of the command; ``imuwb.options`` states how they are declared.
  It inherits from ``imuwb.options.Options``, which raises ValueError, with the reason, for a value that is not allowed.
* ``run(logs, parameters) -> result``: computes the result, and changes nothing. The result is a frozen dataclass or a dict, and
  becomes JSON. For a log that lacks data it raises MissingDataError.
* ``draw(result, review)``: shows the result, and computes nothing.

and these, if it needs them:

* ``LOGS = (fewest, most)``: how many logs the analysis takes. Without ``LOGS`` it takes one; ``most`` = None means any number;
  (0, 0): the analysis makes its own logs, and its command has no options of reading and conditioning.
* ``TAKES_COUNTS = True``: samples in counts of an unknown scale are no error, see ``Origin.counts``;
* ``error_model(result) -> ImuErrorModel``, for ``--save-model``. With ``LEAVES_MODEL`` the model is always saved, beside the
  recording, as ``NAME.error-model.toml``; if ``LEAVES_MODEL`` is a text, this text replaces "error-model" in the name.
* ``objections(result) -> tuple of notes``: why no error model should be made of the logs. If there are any, the error model
  is written only with --force-model. ``ImuErrorModel.doubts`` states them.
* ``answer(result) -> Answer``: what a person must know first. Without it, the first table and the first notes take its place.
* ``findings(result) -> tuple of Finding``: the result of each axis in terms that several analyses share. Over a fleet of logs each
  coefficient of each finding becomes a row of a table; without findings, the ``numbers`` of the answer do.
* ``drifts(result) -> tuple of Drift``: the errors of each filter in each outage; over a fleet they become rows too.
* ``outputs(parameters) -> tuple of paths`` and ``write_outputs(result, parameters)``: files that the analysis
  itself writes. Existing files are overwritten only with --force.
* ``study(cases, parameters) -> result`` and ``draw_study(result, review)``, for ``--study``; ``answer_study(result) -> Answer`` for
  its answer. Without it, the first table of ``draw_study`` takes its place.
* ``compare_imus(logs, parameters) -> result`` and ``draw_imus(result, review)``, for ``--imu all``: one log for each IMU of a log;
  ``answer_imus(result) -> Answer`` for its answer. ``IMUS_OF_LOGS = True``: several logs may be given, each with several IMUs.
* ``imu_of(log, parameters) -> name``: the IMU that is analysed if the user names none; without it, the first.
* ``EVERY_IMU = True``: the analysis examines all IMUs of a log.
* ``DEMO = "still"`` or ``"drive"``: imuwb demo runs the analysis on that sample log. The analysis of the drive has a parameter
  ``error_model``, and gets in it the error model that the analysis of the still log saves.
* ``returns() -> type``: the type of the result, where the annotation of ``run`` does not state it; ``imuwb.schemas`` makes the JSON
  Schema of the document from it.
* ``SHOWS_FAULTS = True``: imuwb info names this analysis to a user whose log has faults.

An analysis of several methods has ``METHODS`` instead, {name: module}; each module has the parts of an analysis, and
becomes a command of a group. The JSON of its result has the method among the parameters.

An analysis is registered under the entry-point group ``imuwb.analyses``, or is a single file: ``imuwb ./mine.py LOG``. The first
line of its docstring is its help; a last paragraph ``Example: imuwb mine LOG`` is the example at the end of its help. ``imuwb --help`` imports every analysis, so its module imports nothing heavy: import numpy
inside ``run`` and ``draw``, or attach them with ``lazy_loader`` as the plugins of imuwb do.

A conditioner changes the samples before an analysis uses them (``--through NAME:key=value,...``). It is a module with

* ``Parameters``, like those of an analysis;
* ``condition(log, parameters) -> (log, applied)``: the changed log, and what ``draw`` shows of the change. ``Log.conditioning``
  of the changed log states the conditioner, its delay, and whether it is causal. ValueError gives the reason why a parameter
  does not suit the log;

and these, if it needs them:

* ``draw(applied, review)``;
* ``STUDY = {short name: (parameter, {parameter: value, ...})}``, for ``--study``: a name that users may write for
  ``NAME.parameter``, and the values (as texts) of other parameters that go with it;
* ``ORDER``, a number: in each setting of a study, conditioners run in rising order; those without a number run last.

It is registered under ``imuwb.conditioners``, or is a single file: ``--through ./mine.py:key=value``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, TypeAlias

from imuwb.colors import INK, PALE, Color

if TYPE_CHECKING:
    import rerun as rr

    from imuwb.arrays import Floats, Integers
    from imuwb.log import Epoch, Log
    from imuwb.scene import Event, Scene, Span
    from imuwb.statistics import Coefficient, Estimate


AxisScale: TypeAlias = Literal["log", "linear", "whole"]  #: whole: linear, with ticks at whole numbers only


class DataclassInstance(Protocol):
    """Any dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


class Analysis(Protocol):
    """What a module must have to be an analysis."""

    Parameters: Any

    def run(self, logs: Sequence[Log], parameters: Any) -> Any:  # noqa: ANN401 - each analysis has its own types
        """Return the result of the analysis."""
        ...

    def draw(self, result: Any, review: Review) -> None:  # noqa: ANN401 - each analysis has its own types
        """Show a result."""
        ...


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """A line in a figure. Points that are not finite, or not positive on a logarithmic axis, are left out."""

    label: str  #: for the legend; empty: the curve is not in the legend
    x: Floats
    y: Floats
    color: Color
    lower: Floats | None = None  #: ends of the interval at each point
    upper: Floats | None = None
    #: "line" (with points), "curve" (without), "points", "fit" (thin), "faint", "band" (from ``lower`` to ``upper``), or "bar" (from 0 to ``y``)
    style: str = "line"


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in a figure with a text beside it."""

    x: float
    y: float
    text: str
    color: Color
    value: str = ""  #: with its unit; the legend shows it after the text


@dataclass(frozen=True, slots=True)
class Vertical:
    """A dashed line across a figure, with a text."""

    x: float
    text: str
    color: Color = PALE


@dataclass(frozen=True, eq=False, slots=True)
class Figure:
    """A figure, with logarithmic axes by default. The titles of its axes contain the unit."""

    title: str
    x_title: str
    y_title: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    x_scale: AxisScale = "log"
    y_scale: AxisScale = "log"
    verticals: tuple[Vertical, ...] = ()
    x_limits: tuple[float, float] | None = None  #: None: limits that contain all curves
    y_limits: tuple[float, float] | None = None
    group: str = ""  #: figures of one tab and group share their axes, have one legend, and are drawn side by side


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under headings. A number has its unit, in its cell or in the heading."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    wide: bool = False  #: the table fills a whole row of its tab in the recording


@dataclass(frozen=True, slots=True)
class Bar:
    """One value with its interval."""

    label: str
    value: float
    color: Color
    lower: float | None = None
    upper: float | None = None

    def text(self, unit: str) -> str:
        """Return value, interval and unit."""
        if self.lower is None or self.upper is None:
            return f"{self.value:.3g} {unit}"
        return f"{self.value:.3g} [{self.lower:.3g}, {self.upper:.3g}] {unit}"


@dataclass(frozen=True, slots=True)
class Bars:
    """Values of several things side by side, all in one unit."""

    title: str
    unit: str
    bars: tuple[Bar, ...]

    def table(self) -> Table:
        """Return the same as a table."""
        rows = tuple((bar.label, bar.text(self.unit)) for bar in self.bars)
        return Table(self.title, ("", "value [interval]"), rows)


@dataclass(frozen=True, eq=False, slots=True)
class Series:
    """One or more quantities over time, all in one unit."""

    title: str
    unit: str
    time: Integers  #: (n,) ns
    values: Floats  #: (n, k)
    names: tuple[str, ...]
    colors: tuple[tuple[int, ...], ...] = ()  #: RGB or RGBA
    epoch: Epoch | None = None  #: zero of the time; None: that of the log
    spans: tuple[Span, ...] = ()  #: shaded; a review adds those of its tab


@dataclass(frozen=True, slots=True)
class Step:
    """A command that a person may type next.

    In the command, ``{log}`` stands for the logs as they were given, ``{model}`` for the saved error model, and ``{command}`` for
    the whole command that was typed.
    """

    command: str
    why: str


@dataclass(frozen=True, slots=True)
class Answer:
    """What a person must know of a result in ten seconds.

    A terminal shows it in at most 15 lines of 80 columns; the recording shows it on its first tab.
    """

    about: str  #: what was analysed, in a few words: "2.8 h still, 100 Hz"
    headings: tuple[str, ...] = ()
    rows: tuple[
        tuple[str, ...], ...
    ] = ()  #: at most eight, the most important first; a row without a first cell states units
    sentences: tuple[str, ...] = ()  #: what to believe and what to do, the most important first
    next: tuple[Step, ...] = ()
    aside: str = ""  #: at the end of the first line: "95 % intervals"
    figure: Figure | None = None  #: shows the answer; None: the first figure that is drawn
    #: the figures of the answer as numbers, in units of data sheets, for a catalog of recordings: name -> estimate
    numbers: Mapping[str, Estimate] = field(default_factory=dict[str, "Estimate"])

    def __post_init__(self) -> None:
        """Drop headings that no row is below."""
        if not self.rows:
            object.__setattr__(self, "headings", ())


SUSPICIOUS = "SUSPICIOUS: "  #: begin of a remark that puts the coefficients in doubt


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of an analysis for one axis, in terms that all analyses share."""

    axis: str
    source: str  #: name of the estimator
    coefficients: Mapping[str, Coefficient]  #: the coefficients among Q, N, B, K, R that the estimator gives
    remarks: tuple[str, ...] = ()  #: advice to the user, one line each; ``SUSPICIOUS`` begins a doubt
    headline: bool = False  #: whether the error model takes this estimator's values


@dataclass(frozen=True, slots=True)
class Drift:
    """The errors of one filter in one outage, horizontal at its end unless the name states otherwise; nan or None: not known."""

    filter: str
    outage_start: float  #: s from the start of the log
    outage_duration: float  #: s
    end: float  #: m
    mean: float  #: m, over the outage
    max: float  #: m, the largest
    vertical: float  #: m
    velocity: float  #: m/s
    heading: float | None = None  #: rad
    share: float | None = None  #: of the distance driven, 1
    sigma: float | None = None  #: m, of the filter itself
    nees: float | None = None  #: two degrees of freedom
    motion: str = ""  #: "stop", "turn", "fast" or "straight"
    mean_speed: float | None = None  #: m/s
    name: str = ""  #: of the outage, as the user gives it


@dataclass(frozen=True, eq=False, slots=True)
class Case:
    """One setting of a study, and the log that is conditioned with it."""

    settings: Mapping[str, str]  #: {"rate": "100", "bandwidth": "42"}, for example
    log: Log
    units: Mapping[str, str] = field(default_factory=dict[str, str])  #: {"rate": "Hz"}, of the settings that have one


def setting_text(settings: Mapping[str, str], units: Mapping[str, str]) -> str:
    """Return a setting for people: "rate 100 Hz, bandwidth 42 Hz"; a conditioner's name only where two have the same key."""
    short = {key: key.rpartition(".")[2] for key in settings}
    shown = {key: name if [*short.values()].count(name) == 1 else key for key, name in short.items()}
    return ", ".join(f"{shown[key]} {value} {units.get(key, '')}".strip() for key, value in settings.items())


def offers(plugin: object, part: str) -> bool:
    """Return whether a plugin has a part, such as "error_model", without importing it."""
    return part in dir(plugin)


def takes_no_log(plugin: object) -> bool:
    """Return whether an analysis makes its own logs."""
    return getattr(plugin, "LOGS", None) == (0, 0)


class Conditioner(Protocol):
    """What a module must have to be a conditioner."""

    Parameters: Any

    def condition(self, log: Log, parameters: Any) -> tuple[Log, Any]:  # noqa: ANN401 - each has its own types
        """Return the changed log, and what ``draw`` can show of the change."""
        ...


class Review(Protocol):
    """Where an analysis shows its result. Each call writes to the recording; tables and notes go to the terminal too.

    A class that inherits from this protocol need not know scenes, spans, events and bars: it shows them by its other calls.
    """

    def tab(self, name: str) -> None:
        """Open a tab; all later calls show on this tab."""
        ...

    def series(self, series: Series) -> None:
        """Show quantities over time. Long series are drawn as the envelopes of their extremes."""
        ...

    def figure(self, figure: Figure) -> None:
        """Show a figure."""
        ...

    def table(self, table: Table) -> None:
        """Show a table, in the recording and in the terminal."""
        ...

    def track(self, name: str, position: Floats, color: Color, label: str = "") -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, in local east and north, with a label at its end.

        The tracks of one tab share a picture. Its origin is the first point of the first track.
        """
        ...

    def map_track(self, name: str, position: Floats, color: Color) -> None:
        """Show a trajectory, (n, 3) latitude rad, longitude rad, height m, on a map that the viewer fetches from the network."""
        ...

    def note(self, text: str) -> None:
        """State what a reader of the result must know."""
        ...

    def scene(self, scene: Scene) -> None:
        """Show a motion over time: the body, what estimators believe in each episode, and points; once on a tab.

        Without a picture in time, it is a map of tracks: that of the body, and in the named episodes those of the estimators.
        """
        self.track(scene.body.name, scene.body.position, INK)
        for episode in scene.episodes:
            for belief in episode.beliefs if episode.name else ():
                self.track(f"{belief.name}, {episode.name}", belief.position, belief.color)

    def span(self, span: Span) -> None:
        """Shade a span of time in all charts of the tab. Without shading, it is not shown: a span only helps to read a chart."""

    def event(self, event: Event) -> None:
        """Mark an event in all charts of the tab, and list it. Without marks, it is a note."""
        self.note(f"{event.level}: {event.source}: {event.text}")

    def bars(self, bars: Bars) -> None:
        """Show bars with their intervals. Without bars, they are a table."""
        self.table(bars.table())

    @property
    def recording(self) -> rr.RecordingStream:
        """The recording itself, for what the other calls cannot show."""
        ...

"""The result of an outage replay."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from imuwb.analysis import Series
from imuwb.arrays import Floats
from imuwb.log import Reference
from imuwb.notes import Note
from imuwb.replay import (
    Choice,
    Clocks,
    Consistency,
    DriftCurve,
    GnssCorrelation,
    MotionNoise,
    Mounting,
    Paired,
    Replay,
    Tuned,
)
from imuwb.scene import Event, Scene, Span
from imuwb.statistics import Estimate
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import counted

HELD = {"document": False}  #: for a field that is drawn or written, but not part of the JSON


@dataclass(frozen=True, slots=True)
class FilterErrors:
    """Errors of one filter in one outage: horizontal, against the common reference, unless the name states otherwise."""

    mean: float  #: m
    max: float  #: m
    end: float  #: m
    vertical: float  #: m, at the end
    velocity: float  #: m/s, at the end
    heading: float | None  #: rad, at the end
    percent: float | None  #: per cent of the distance driven, at the end; None: too slow
    sigma: float  #: m, of the filter itself, at the end
    nees: float  #: at the end, two degrees of freedom
    causal: bool
    own_mean: float  #: m, against the filter's own run without outages (Quinchia, tables 9 and 10)
    own_max: float  #: m


@dataclass(frozen=True, slots=True)
class OutageResult:
    """One outage."""

    start: float  #: s from the log's start
    duration: float  #: s
    mean_speed: float  #: m/s
    motion: str  #: "stop", "turn", "fast" or "straight"
    models: dict[str, FilterErrors]
    name: str = ""  #: as the user gives it
    table: str = ""  #: of the table that shows it, as the user gives it


@dataclass(frozen=True, slots=True)
class FilterSummary:
    """One filter in all outages of one duration. Errors are horizontal unless the name states otherwise."""

    count: int
    effective_count: int  #: outages that do not overlap
    median_end: float  #: m, at the end
    median_end_interval: tuple[float, float]
    p68_end: float  #: m, 68 % quantile at the end
    p68_end_interval: tuple[float, float]
    p95_end: float  #: m, 95 % quantile at the end
    p95_end_interval: tuple[float, float]
    median_max: float  #: m, median of each outage's largest error
    median_max_interval: tuple[float, float]
    median_vertical: float  #: m, at the end
    median_velocity: float  #: m/s, at the end
    median_heading: float | None  #: rad, at the end; None: the reference has no heading
    median_percent: float | None  #: per cent of the distance driven, at the end; None: no outage is fast enough
    nees_per_dof: float | None  #: at the end, mean; None: the outages are too short
    coverage95: float | None  #: share of the outages within the filter's own 95 % ellipse at the end
    nis_per_dof: float  #: mean NIS over its degrees of freedom, in the filter's run over the whole log
    consistency: tuple[Consistency, ...]
    curve: DriftCurve

    def estimate(self, name: str) -> Estimate:
        """Return one of the values with an interval, such as "median_end", m."""
        return Estimate(getattr(self, name), *getattr(self, f"{name}_interval"), unit="m")


@dataclass(frozen=True, slots=True)
class DurationSummary:
    """All filters in the outages of one duration."""

    duration: float  #: s
    models: dict[str, FilterSummary]
    paired: tuple[Paired, ...]
    by_motion: dict[str, dict[str, float]]  #: motion -> filter -> median error at the end, m
    choice: Choice | None  #: None: too few outages, or one filter

    @property
    def ranked(self) -> list[str]:
        """Return the filters, the best first: by the likelihood of the errors; where it is not known, by their median."""
        names = sorted(self.models, key=lambda name: self.models[name].median_end)
        if self.choice is None:
            return names
        likely = [candidate.model for candidate in self.choice.candidates]
        return [*likely, *(name for name in names if name not in likely)]


@dataclass(frozen=True, slots=True)
class FilterInfo:
    """A filter that was run."""

    name: str
    states: tuple[str, ...]
    gyros: str  #: the processes of gyro_x
    accelerometers: str  #: the processes of accel_x
    left_out: tuple[str, ...]  #: processes without a state
    reading: str
    causal: bool
    nis_position: float  #: mean normalised innovation squared over its degrees of freedom
    nis_velocity: float | None
    refused: int  #: positions and velocities of fixes
    fixes: int  #: positions and velocities after the alignment
    document: str = field(metadata=HELD)  #: TOML


@dataclass(frozen=True, eq=False, slots=True)
class ErrorBudget:
    """The sources of a filter's horizontal sigma, the largest first: k of them, at L marks and h horizons."""

    filter: str
    sources: tuple[str, ...]
    elapsed: Floats  #: (L,) s
    sigma: Floats  #: (k, L) m; nan where the correlations of the sources lower the variance
    total: Floats  #: (L,) m
    horizons: Floats  #: (h,) s
    percent: Floats  #: (k, h) share of the variance; negative where the correlations lower it


@dataclass(frozen=True, eq=False, slots=True)
class ErrorSamples:
    """The errors of k outages of the longest duration, over time."""

    duration: float  #: s
    elapsed: Floats  #: (L,) s
    errors: dict[str, Floats]  #: filter -> (k, L) m
    limit: dict[str, float]  #: filter -> m, largest value of a figure that shows most of them


@dataclass(frozen=True, slots=True)
class PublishedGain:
    """The improvement by 18AVWD as the paper states it: mean over the outages of 1 - 18AVWD/filter, against the own runs."""

    own_mean: float
    own_max: float


@dataclass(frozen=True, eq=False, slots=True)
class OutagePicture:
    """One outage from near: where the filters go in the plane, and how far each is from its own run (Quinchia, figures 21 to 25)."""

    name: str
    reference: Floats  #: (n, 3) latitude rad, longitude rad, height m, some seconds longer than the outage
    tracks: dict[str, Floats]  #: filter -> (L + 1, 3)
    elapsed: Floats  #: (L,) s
    errors: dict[str, Floats]  #: filter -> (L,) m, horizontal


@dataclass(frozen=True, eq=False, slots=True)
class Drive:
    """The drive in time: the vehicle, what the filters believe in some outages, and charts of the same times."""

    scene: Scene
    charts: tuple[Series, ...]
    spans: tuple[Span, ...]  #: the outages of the scene, and gaps of the fixes themselves
    events: tuple[Event, ...]  #: faults of the log at a known time
    about: str  #: which outages are shown


@dataclass(frozen=True, eq=False, slots=True)
class SmoothedRun:
    """The smoothed trajectory of a filter at the rate of the IMU, with the forward and the backward ones."""

    smoothed: Reference
    forward: Reference
    backward: Reference  #: only where the later fixes say something
    quaternion: Floats  #: (n, 4) of the smoothed trajectory


@dataclass(frozen=True, slots=True)
class EngineInfo:
    """Another engine whose solutions are scored."""

    name: str
    source: str  #: its file, or its command
    scored: str  #: in "outages", or over the "whole run"
    tried: int  #: runs or files
    failures: tuple[str, ...]  #: reasons, one for each run or file without a solution
    sigmas: bool  #: whether its solutions state sigmas of positions


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """The result of an outage replay."""

    outages: tuple[OutageResult, ...]
    listed: tuple[int, ...]  #: the outages in the table: all, or the worst that do not overlap, in order of time
    summary: tuple[DurationSummary, ...]
    samples: ErrorSamples
    published: dict[str, PublishedGain]  #: by filter; empty without 18AVWD
    filters: tuple[FilterInfo, ...]
    budget: ErrorBudget
    reference: str
    verdicts: tuple[Note, ...]
    notes: tuple[str, ...]
    clocks: Clocks | None  #: None: given, not estimated
    mounting: Mounting | None  #: None: given, not estimated
    motion: MotionNoise | None  #: None: no filter has it
    gnss_correlation: GnssCorrelation | None  #: None: given, or not shown by the log
    tuned: Tuned | None
    error_model: ImuErrorModel | None = field(metadata=HELD)  #: in motion, or tuned; None: no such filter
    reference_track: Floats = field(metadata=HELD)  #: (n, 3) latitude rad, longitude rad, height m
    drive: Drive = field(metadata=HELD)
    on_map: bool = field(metadata=HELD)
    navigation: tuple[Reference, Floats] = field(metadata=HELD)  #: the last filter's run; (n, 4) its quaternions
    failed: dict[str, str] = field(default_factory=dict[str, str])  #: filter that cannot run -> reason
    replay: Replay | None = field(default=None, metadata=HELD)  #: None: not kept
    engines: tuple[EngineInfo, ...] = ()  #: other engines, of --solution and --filter-command
    autoregressive_origin: str | None = None  #: where the AR processes of 15AR and 27AR come from
    pictures: tuple[OutagePicture, ...] = field(default=(), metadata=HELD)  #: of given outages, if they are few
    smoothed: SmoothedRun | None = field(default=None, metadata=HELD)  #: None: not wanted
    whole_run: dict[str, FilterSummary] = field(default_factory=dict[str, FilterSummary])
    #: ^ filter or engine -> its errors over the whole run with all fixes; empty unless an engine is scored so

    def ranked(self, names: Iterable[str]) -> list[str]:
        """Return filters in the order of the longest outages, the best first; others follow in their own order."""
        best = self.summary[-1].ranked if self.summary else []
        return sorted(names, key=lambda name: best.index(name) if name in best else len(best))

    def __repr__(self) -> str:
        """Return reference and verdicts, a line each."""
        return "\n  ".join(
            [f"Outage replay of {counted(len(self.outages), 'outage')} against {self.reference}", *self.verdicts]
        )

"""What an outage replay found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.log import Floats
    from imuwb.replay import Budget, Choice, Clocks, Mounting, Paired, Replay, Summary, Tuned


@dataclass(frozen=True, slots=True)
class OfModel:
    """One filter in one outage; horizontal errors against the common reference."""

    mean: float  #: m
    max: float  #: m
    end: float  #: m
    vertical: float  #: m, at the end
    velocity: float  #: m/s, at the end
    heading: float | None  #: rad, at the end
    percent: float | None  #: of the distance driven, at the end; None: it stood
    sigma: float  #: m, the filter's own, at the end
    nees: float  #: at the end, of two degrees of freedom
    causal: bool
    own_mean: float  #: m, against the same filter's run without outage (Quinchia, tables 9 and 10)
    own_max: float  #: m


@dataclass(frozen=True, slots=True)
class OneOutage:
    """One outage."""

    start: float  #: s from the log's start
    duration: float  #: s
    mean_speed: float  #: m/s
    motion: str  #: "stop", "turn", "fast" or "straight"
    models: dict[str, OfModel]


@dataclass(frozen=True, slots=True)
class OfDuration:
    """All filters over the outages of one duration."""

    duration: float  #: s
    models: dict[str, dict[str, object]]  #: the design's few figures of each
    summaries: tuple[Summary, ...]
    paired: tuple[Paired, ...]
    by_motion: dict[str, dict[str, float]]  #: motion -> filter -> median error at the end, m
    choice: Choice | None  #: None: too few outages, or one filter


@dataclass(frozen=True, slots=True)
class Filter:
    """A filter that was run."""

    name: str
    states: tuple[str, ...]
    gyros: str  #: the processes on x
    accelerometers: str
    left_out: tuple[str, ...]  #: processes that no state stands for
    reading: str
    causal: bool
    nis_position: float  #: mean normalised innovation squared over its degrees of freedom
    nis_velocity: float | None
    refused: int  #: positions and velocities of fixes
    fixes: int  #: positions and velocities behind the start


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All of it."""

    outages: tuple[OneOutage, ...]
    summary: tuple[OfDuration, ...]
    filters: tuple[Filter, ...]
    reference: str
    verdicts: tuple[str, ...]
    notes: tuple[str, ...]
    clocks: Clocks | None  #: None: they were given
    mounting: Mounting | None  #: likewise
    tuned: Tuned | None
    budget: Budget
    budget_of: str  #: filter
    true_errors: tuple[Floats, Floats] | None = field(metadata={"document": False})  #: s; rad/s and m/s², (k, 6)
    on_map: bool = field(metadata={"document": False})
    replay: Replay = field(metadata={"document": False})

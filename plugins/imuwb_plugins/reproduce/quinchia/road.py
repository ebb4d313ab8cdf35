"""The drives of Quinchia and others: filters in GNSS outages, tables 6 to 10."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.geodesy.tangent_plane import ned_of
from imuwb.log import Log
from imuwb.navigation import FilterModel
from imuwb.replay import Outage, Replay, model_named, prepare, replay
from imuwb.simulation import planned_outages
from imuwb.statistics import Estimate
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.reproduce.estimates import exact, mean_of
from imuwb_plugins.reproduce.printed import Key
from imuwb_plugins.wavelet.apply import Applied, condition
from imuwb_plugins.wavelet.parameters import Parameters as WaveletParameters

FILTERS = ("15AV", "18AV", "18AVWD", "15AR", "27AR")
ROUTES = ("turin-1", "turin-2")
DURATIONS = (30.0, 60.0, 30.0, 30.0, 30.0, 30.0, 60.0)  #: s, of outages 1 to 7
#: levels of gyro x, y, z, accel x, y, z in table 6
LEVELS: Mapping[str, tuple[int, ...]] = {
    "0 levels": (),
    "3 levels": (3, 2, 2, 3, 2, 2),
    "7 levels": (7, 7, 7, 7, 6, 6),
}
SETTLING = 120.0  #: s before the first outage of a drive of the user's own
KMH = 3.6
SIX = 6  #: the table of the levels of denoising


@dataclass(frozen=True, slots=True)
class Planned:
    """An outage, by its number in the paper."""

    number: int  #: 1 to 7
    start: float  #: s from the log's start
    duration: float  #: s


@dataclass(frozen=True, slots=True)
class Plan:
    """The outages of one drive."""

    table: str  #: "9" or "10"
    filters: tuple[Planned, ...]  #: of that table
    levels: tuple[Planned, ...]  #: of table 6


@dataclass(frozen=True, eq=False, slots=True)
class Outages:
    """One filter after the other in one outage."""

    number: int
    duration: float  #: s
    speed: float  #: m/s, mean
    elapsed: Floats  #: (L,) s
    track: Floats  #: (L, 2) m, north and east of the drive's start: the first filter's own run
    apart: dict[str, Floats]  #: filter -> (L, 2) m, north and east, against its own run without outages

    def error(self, name: str) -> Floats:
        """Return the horizontal error of a filter, (L,) m."""
        return np.hypot(*self.apart[name].T)


@dataclass(frozen=True, eq=False, slots=True)
class Driven:
    """What the filters did on one drive."""

    plan: Plan
    track: Floats  #: (m, 2) m, north and east of its start
    filters: tuple[Outages, ...]  #: tables 9 and 10
    levels: tuple[Outages, ...]  #: table 6
    states: dict[str, int]  #: filter -> number of states
    denoised: Applied  #: levels by the measured motion


def plans(drives: Sequence[Log], *, simulated: bool) -> tuple[Plan, ...]:
    """Return the outages of each drive: those of the paper for the simulated routes, else spread evenly.

    Raises:
        MissingDataError: a drive is too short.
    """
    if simulated:
        return tuple(_of_route(route) for route in ROUTES)
    numbers = np.array_split(np.arange(1, len(DURATIONS) + 1), len(drives))
    return tuple(
        _spread(log, [int(n) for n in own], i) for i, (log, own) in enumerate(zip(drives, numbers, strict=True))
    )


def _of_route(route: str) -> Plan:
    planned = sorted(planned_outages(route), key=lambda o: o.start)
    tables = {o.table for o in planned} - {SIX}
    chosen = {
        six: tuple(Planned(o.number, o.start, o.duration) for o in planned if (o.table == SIX) == six)
        for six in (False, True)
    }
    return Plan(str(*tables), chosen[False], chosen[True])


def _spread(log: Log, numbers: Sequence[int], place: int) -> Plan:
    """Return outages of the paper's durations, spread evenly over a drive; those of table 6 lie between the others."""
    time = next(time for time, _ in log.imu().axes().values())
    whole = float(time[-1] - time[0]) * 1e-9
    step = (whole - SETTLING) / len(numbers) / 2
    if step < max(DURATIONS):
        raise MissingDataError(
            f"{log.provenance.path}: the drive lasts {whole:.0f} s; {len(numbers)} pairs of outages of up to {max(DURATIONS):g} s "
            f"need {SETTLING + 2 * len(numbers) * max(DURATIONS):.0f} s"
        )
    starts = SETTLING + step * np.arange(2 * len(numbers))
    made = [
        [Planned(n, float(t), DURATIONS[n - 1]) for n, t in zip(numbers, starts[k::2], strict=True)] for k in (0, 1)
    ]
    return Plan("9" if place == 0 else "10", tuple(made[0]), tuple(made[1]))


def driven(log: Log, plan: Plan, model: ImuErrorModel) -> Driven:
    """Return the errors of all filters on one drive.

    Args:
        log: the drive.
        plan: its outages.
        model: of the sensor, with the autoregressive processes of 15AR and 27AR.
    """
    base = FilterModel("base", model)
    prepared = prepare(log, base)
    interval = prepared.measurement.interval
    five = [model_named(name, base, interval=interval) for name in FILTERS]
    bare = model_named("none", base, interval=interval)
    nine = [replace(bare, name=name, wavelet_levels=levels, wavelet_scale="none") for name, levels in LEVELS.items()]
    runs = [
        replay(prepared, models, [Outage(o.start, o.duration) for o in planned], reference="own")
        for models, planned in ((five, plan.filters), (nine, plan.levels))
    ]
    position = runs[0].runs[FILTERS[0]].solution.position
    _, applied = condition(log, WaveletParameters(levels="auto", motion_band="measured"))
    return Driven(
        plan, ned_of(position, position[0])[:, :2], tuple(_outages(runs[0], plan.filters)), tuple(_outages(runs[1], plan.levels)),
        {m.name: len(m.states(interval)) for m in five}, applied,
    )  # fmt: skip


def _outages(run: Replay, planned: Sequence[Planned]) -> Iterator[Outages]:
    """Yield the outages in the order of the plan; one that is not scored is left out."""
    solution = next(iter(run.runs.values())).solution
    plane = ned_of(solution.position, solution.position[0])[:, :2]
    for o in planned:
        own = [p.start for p in run.outages.get(o.duration, ())]
        if o.start not in own:
            continue
        i = own.index(o.start)
        scores = {name: filtered.outages[o.duration].own for name, filtered in run.runs.items()}
        first = next(iter(scores.values()))
        times = first.start[i] + first.elapsed
        track = np.stack([np.interp(times, solution.time, column) for column in plane.T], axis=1)
        apart = {name: s.north_east[i] for name, s in scores.items()}
        yield Outages(o.number, o.duration, float(first.distance[i, -1]) / o.duration, first.elapsed, track, apart)


def tables(drives: Sequence[Driven]) -> dict[Key, Estimate | str]:
    """Return tables 6 to 10, and the gains of section 7."""
    values: dict[Key, Estimate | str] = {
        **dict(_levels(drives)),
        **dict(_states(drives[0])),
        **dict(_motion(drives[0])),
    }
    for drive in drives:
        for outage in drive.filters:
            values |= dict(_errors(drive.plan.table, outage))
    return values | dict(_gains([outage for drive in drives for outage in drive.filters]))


def _errors(table: str, outage: Outages) -> Iterator[tuple[Key, Estimate]]:
    item = f"outage {outage.number}"
    yield Key(table, "duration", item), exact(outage.duration, "s")
    yield Key(table, "mean speed", item), exact(outage.speed * KMH, "km/h")
    for name in outage.apart:
        error = outage.error(name)
        yield Key(table, f"{name}, mean", item), exact(float(error.mean()), "m")
        yield Key(table, f"{name}, largest", item), exact(float(error.max()), "m")


def _levels(drives: Sequence[Driven]) -> Iterator[tuple[Key, Estimate]]:
    outages = [outage for drive in drives for outage in drive.levels]
    for outage in outages:
        for name in LEVELS:
            yield Key("6", name, f"outage {outage.number}*"), exact(float(outage.error(name).max()), "m")
    none, _, most = ([float(o.error(name).max()) for o in outages] for name in LEVELS)
    # The paper's figure is a ratio of sums; its error follows from the outages' own ratios, weighted by the error without denoising.
    gain = 100 * (1 - sum(most) / sum(none))
    weighted = [100 * (1 - a / b) * b * len(none) / sum(none) for a, b in zip(most, none, strict=True)]
    spread = mean_of(weighted, "%")
    yield Key("6", "gain of 7 levels over 0, by sums", "all outages"), replace(spread, value=gain)


def _states(drive: Driven) -> Iterator[tuple[Key, Estimate]]:
    for name, count in drive.states.items():
        yield Key("8", "states", name), exact(count, "1")


def _motion(drive: Driven) -> Iterator[tuple[Key, Estimate]]:
    for axis, choice in drive.denoised.axes.items():
        yield Key("7", "levels", axis), exact(choice.level, "1")
        yield Key("7", "highest frequency", axis), exact(choice.band, "Hz")


def _gains(outages: Sequence[Outages]) -> Iterator[tuple[Key, Estimate]]:
    """Yield the mean gain of 18AVWD over each other filter, with the 95 % interval of the mean over the outages."""
    for kind, of in (("largest", np.max), ("mean", np.mean)):
        for name in FILTERS:
            if name != "18AVWD":
                ratios = [float(of(o.error("18AVWD")) / of(o.error(name))) for o in outages]
                yield Key("section 7", f"{kind} error, gain over", name), mean_of([100 * (1 - r) for r in ratios], "%")

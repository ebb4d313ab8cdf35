"""The judgement of a fleet: family and spread of each coefficient, sensors outside, changes, and temperature, with one error for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans
from imuwb.identification.family.changes import Change, changes
from imuwb.identification.family.limits import Limits, contradicting, joined, with_limits
from imuwb.identification.family.members import FEWEST, Members, Outside, members, outside, reach
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.identification.family.spread import between_spread, spread_of, within_spread
from imuwb.identification.family.tails import heavy_tails
from imuwb.statistics import Coefficient, Estimate
from imuwb.statistics.distributions import normal_tails, student_limit, student_score

KINDS = 3  #: of findings, which share the error: sensors outside, changes, dependence on temperature
ROUNDS = 20  #: of the search for changes
LEAST_TEMPERATURES, LEAST_RANGE = 10, 1.0  #: degrees of freedom; °C, root mean square from log to log of one sensor


@dataclass(frozen=True, slots=True)
class Slope:
    """The dependence of all sensors of a family on temperature from log to log."""

    per_degree: Estimate
    probability: float  #: that chance makes the slopes of any family so steep
    reference: float  #: °C, at which the observations are compared
    used: bool  #: whether the dependence is sure, and the observations are reduced to the reference


@dataclass(frozen=True, eq=False, slots=True)
class Judged:
    """One family, on the scale of its observations."""

    rows: Observations  #: at one temperature if the dependence on temperature is sure
    kept: Booleans  #: (n,) rows that count; not those of single logs that differ
    slope: Slope | None  #: None: too few logs with a temperature, or of too equal ones
    sensors: Members  #: that have a value
    mean: Estimate
    between: Coefficient  #: standard deviation between sensors; without several logs of a sensor, of both
    within: Coefficient  #: from log to log of one sensor, beyond the sampling errors
    #: mean, and the interval that contains the mean of a further sensor with the level; where the spread has a limit only, with it
    sensor_range: Estimate
    log_range: Estimate  #: the same for a further log
    #: beyond which the most distant sensor is outside the family at the error of the fleet; infinite: too few sensors, or none is
    sensor_limits: tuple[float, float]
    outside: tuple[Outside, ...]  #: of a family of ``FEWEST`` sensors or more
    changes: tuple[Change, ...]  #: each with its probability over the whole fleet
    below: tuple[Outside, ...]  #: sensors that have limits only, far below the family
    more: bool  #: whether more sensors may be outside than the search takes
    tails: float | None  #: probability that chance makes the tails of normal sensors so heavy; None: it cannot be told
    limited: int  #: logs of which a limit counts
    contradicting: int  #: logs whose limit does not count, because the values of the same sensor make it improbable

    @property
    def found(self) -> frozenset[int]:
        """Return the sensors with a finding."""
        return frozenset([one.sensor for one in self.outside] + [one.sensor for one in self.changes])


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """All families of a fleet."""

    error: float  #: probability that chance makes any finding, as in ``judge``
    level: float  #: of the intervals
    families: Mapping[str, Judged]


@dataclass(slots=True)
class _State:
    """One family during the search."""

    rows: Observations
    limits: Limits  #: of further logs
    kept: Booleans  #: rows without the single logs that were found
    steady: Booleans  #: rows of sensors that change neither by a trend nor by a step
    found: list[Change]
    waiting: list[Change]  #: of sensors without a finding


def judge(
    families: Mapping[str, Observations],
    error: float = 0.01,
    level: float = 0.95,
    limits: Mapping[str, Limits] | None = None,
) -> Judgement:
    """Return the judgement of a fleet.

    The error is shared by three kinds of findings, and by the families: sensors outside by a maximum statistic in each family, changes
    by Holm's method over all sensors of all families. After each round the sensors that change no longer count in the variance from log
    to log. The dependence on temperature is common to the sensors of a family; where it is sure, it is taken off before.

    Args:
        families: name -> observations of at least one row.
        error: probability that a fleet without any such sensor has any finding, if its sensors differ as normal variables do. What is
            measured is in tests/studies/fleet_judgement.md.
        level: of the intervals.
        limits: name -> logs that give a limit only. They count in mean and spread of the family and in the means of the sensors, not in
            changes; those of sensors that drift or step do not count.
    """
    slopes = _slopes(families, error / KINDS, level)
    states: dict[str, _State] = {}
    for name, stated in families.items():
        slope = slopes.get(name)
        rows, beside = stated, (limits or {}).get(name, Limits.none())
        if slope is not None and slope.used:
            where = slope.per_degree.value, slope.reference
            rows, beside = rows.at(*where), beside.at(*where)
        every = np.ones(rows.y.size, dtype=bool)
        states[name] = _State(rows, beside, every, every.copy(), [], [])
    _search(list(states.values()), error / KINDS, level)
    for state in states.values():
        _described(state, level)
    share = error / KINDS / max(len(families), 1)
    return Judgement(error, level, {name: _judged(s, slopes.get(name), share, level) for name, s in states.items()})


def _slopes(families: Mapping[str, Observations], error: float, level: float) -> dict[str, Slope]:
    """Return the dependence on temperature of the families that can tell it."""
    found = {name: slope for name, rows in families.items() if (slope := _slope(rows, level)) is not None}
    chances = {name: min(1.0, slope.probability * len(found)) for name, slope in found.items()}
    return {
        name: replace(slope, probability=chances[name], used=chances[name] <= error) for name, slope in found.items()
    }


def _slope(rows: Observations, level: float) -> Slope | None:
    known = rows.of(np.isfinite(rows.temperature))
    count = known.sums(np.ones_like(known.y))
    mean = known.sums(known.temperature) / np.maximum(count, 1)
    away = known.temperature - mean[known.sensor]
    freedom = int(known.y.size - (count > 0).sum()) - 1
    if freedom < LEAST_TEMPERATURES or float(np.sqrt(away @ away / freedom)) < LEAST_RANGE:
        return None
    fit = random_effects(known, away)
    value, sigma = float(fit.coefficients[1]), float(fit.covariance[1, 1]) ** 0.5
    reach = student_limit(level, freedom) * sigma
    tail = float(normal_tails(student_score(value / sigma, freedom)))
    return Slope(
        Estimate(value, value - reach, value + reach, sigma), tail, float(known.temperature.mean()), used=False
    )


def _search(states: Sequence[_State], error: float, level: float) -> None:
    """Find the sensors that change, round by round, until no further one is found."""
    stale = list(states)
    for _ in range(ROUNDS):
        for state in stale:
            _scan(state, level)
        waiting = sorted(
            ((change, state) for state in states for change in state.waiting), key=lambda one: one[0].probability
        )
        stale = []
        for place, (change, state) in enumerate(waiting):
            chance = min(1.0, change.probability * (len(waiting) - place))
            if chance > error:
                break
            _take(state, replace(change, probability=chance))
            stale = [*(one for one in stale if one is not state), state]
        if not stale:
            break


def _scan(state: _State, level: float) -> None:
    """Look at all sensors of a family that were not found to change."""
    rows = state.kept & state.steady
    if not rows.any():
        state.waiting = []
        return
    fit = random_effects(state.rows.of(rows))
    tested = rows if fit.free[1] else np.zeros_like(rows)
    state.waiting = changes(state.rows, fit.within, fit.errors[1], level, tested)


def _take(state: _State, change: Change) -> None:
    """Take a change as found."""
    state.found.append(change)
    if change.kind == "log":
        state.kept[change.rows[0]] = False
    else:
        state.steady[state.rows.sensor == change.sensor] = False


def _described(state: _State, level: float) -> None:
    """Describe the trends and steps that were found once more, now that the variance from log to log does not contain them."""
    steady = state.kept & state.steady
    names = [one.sensor for one in state.found if one.kind != "log"]
    if not names or not steady.any():
        return
    fit = random_effects(state.rows.of(steady))
    tested = state.kept & np.isin(state.rows.sensor, names)
    again = {one.sensor: one for one in changes(state.rows, fit.within, fit.errors[1], level, tested)}
    for place, one in enumerate(state.found):
        new = again.get(one.sensor)
        if one.kind != "log" and new is not None and new.kind != "log":
            state.found[place] = replace(new, probability=one.probability)


def _judged(state: _State, slope: Slope | None, error: float, level: float) -> Judged:
    steady = state.kept & state.steady
    rows = state.rows.of(steady if steady.any() else state.kept)
    plain = random_effects(rows)
    limits = state.limits.of(~np.isin(state.limits.sensor, [one.sensor for one in state.found if one.kind != "log"]))
    against = contradicting(rows, limits, plain)
    fit, stand = with_limits(rows, limits.of(~against), plain)
    every = members(joined(state.rows.of(state.kept), stand), fit.within)
    known = every.sensor < state.rows.sensors
    enough = int(known.sum()) >= FEWEST
    found = outside(every, error if enough else 0.0)
    left = ~np.isin(every.sensor, [one.sensor for one in found.outside])
    inside, seen = every.of(left), every.of(left & known)
    mean, sigma = float(found.family.coefficients[0]), float(found.family.covariance[0, 0]) ** 0.5
    t = student_limit(level, max(inside.mean.size - 1, 1))
    between, within = _spreads(seen, rows, found.family, fit, level, limited=bool(stand.y.size))
    spread = found.family.between if between.value is not None or not np.isfinite(between.upper) else between.upper**2
    sampling = float(np.median(rows.variance))

    def ranged(variance: float) -> Estimate:
        return Estimate(mean, mean - t * variance**0.5, mean + t * variance**0.5)

    return Judged(
        rows=state.rows, kept=state.kept, slope=slope, sensors=every.of(known), mean=replace(ranged(sigma**2), sigma=sigma),
        between=between, within=within, sensor_range=ranged(spread + sigma**2),
        log_range=ranged(found.family.between + sigma**2 + fit.within + sampling),
        sensor_limits=reach(inside, every.mean.size, error) if enough else (-np.inf, np.inf),
        outside=tuple(one for one in found.outside if one.sensor < state.rows.sensors),
        below=tuple(one for one in found.outside if one.sensor >= state.rows.sensors),
        changes=tuple(state.found), more=found.more, tails=None if stand.y.size else heavy_tails(seen, found.family),
        limited=int((~against).sum()), contradicting=int(against.sum()),
    )  # fmt: skip


def _spreads(
    sensors: Members, rows: Observations, family: RandomEffects, fit: RandomEffects, level: float, *, limited: bool
) -> tuple[Coefficient, Coefficient]:
    """Return the standard deviations between sensors and from log to log; where limits count, from the errors of the estimates."""
    if limited:
        typical = float(np.median(sensors.variance)), float(np.median(rows.variance))
        return (
            spread_of(family.between, family.errors[0], typical[0], level),
            spread_of(fit.within, fit.errors[1], typical[1], level),
        )
    return (
        between_spread(sensors, family.between, family.errors[0], level),
        within_spread(rows, fit.within, fit.errors[1], level),
    )

"""Filters over a log, and what becomes of them without fixes: from a log to scores."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.conditioning import corrected_log
from imuwb.errors import MissingDataError, UsageError
from imuwb.navigation.alignment import align, standing
from imuwb.navigation.events import corrections
from imuwb.navigation.filter import solve
from imuwb.navigation.measurement import denoised, measurement
from imuwb.navigation.outages import drift
from imuwb.progress import tracked
from imuwb.replay.degraded import degraded
from imuwb.replay.reference import is_independent, own, yardstick
from imuwb.replay.scores import Scores, scores

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.log import Floats, GnssStream, Log
    from imuwb.navigation.alignment import Alignment
    from imuwb.navigation.events import Corrections
    from imuwb.navigation.filter import Solution
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.navigation.measurement import Measurement
    from imuwb.navigation.outages import Drift
    from imuwb.replay.degraded import Degradation
    from imuwb.replay.reference import Yardstick

OWN, OWN_SHARE = 3.0, 2.5  #: s, and usual intervals, from which on a span without fixes is an outage
LEAST_SETTLING = 10.0  #: s of fixes before any outage
WORSE = 3.0  #: times the usual sigma, of a degraded fix
SPACING = 0.95  #: s; a sweep starts at fixes at least so far apart


@dataclass(frozen=True, slots=True)
class Outage:
    """A span without fixes."""

    start: float  #: s from the log's start
    duration: float  #: s


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """A log as filters take it."""

    log: Log
    gnss: GnssStream
    moves: Measurement
    still: Floats  #: (k, 2) s from the log's start
    found: Corrections
    start: Alignment
    notes: tuple[str, ...]

    @property
    def start_time(self) -> float:
        """Return when filters start, s from the log's start."""
        return float(self.found.time[self.start.event])


@dataclass(frozen=True, eq=False, slots=True)
class Replayed:
    """One filter in the outages of one duration."""

    drift: Drift
    scores: Scores  #: against the common reference
    own: Scores  #: against its own run without outage


@dataclass(frozen=True, eq=False, slots=True)
class Run:
    """One filter: its run over the whole log, and its outages by duration."""

    solution: Solution
    outages: dict[float, Replayed]


@dataclass(frozen=True, eq=False, slots=True)
class Replay:
    """All filters in the same outages."""

    prepared: Prepared
    reference: Yardstick
    runs: dict[str, Run]
    scored: dict[float, NDArray[np.bool_]]  #: duration -> (s,) whether an outage counts
    notes: tuple[str, ...]


def prepare(log: Log, model: FilterModel, receiver: str | None = None, worse: Degradation | None = None) -> Prepared:
    """Return a log as filters take it, without what the error model knows of its sensors: all of them begin alike.

    Args:
        log: an IMU and a receiver; samples that ``corrected_log`` has corrected are taken as they are.
        model: its settings, and the deterministic terms of its error model; its noise does not matter.
        receiver: name of the receiver; None: the first.
        worse: how its fixes are made worse first; the reference is not.

    Raises:
        MissingDataError: no IMU, no receiver, too few fixes, no motion.
        UsageError: no receiver of that name; deterministic terms that cannot be.
    """
    if not log.gnss:
        message = (
            f"{log.provenance.path}: no GNSS receiver in this log; name a file with its fixes with --gnss "
            "(an outage replay needs fixes to take away)"
        )
        raise MissingDataError(message)
    chosen = receiver_of(log, receiver)
    gnss = chosen if worse is None else degraded(chosen, worse)
    several = ()
    if len(log.gnss) > 1 and receiver is None:
        several = (f"of {len(log.gnss)} receivers {gnss.name} is taken; --receiver names another",)
    log, taken_off = corrected_log(log, model.error_model)
    thermal = any(axis.thermal for axis in model.error_model.axes.values())
    moves = measurement(log, log.imu(), model.installation, thermal=thermal)
    still = standing(moves, log, gnss)
    found = corrections(log, gnss, moves, still, model)
    start = align(moves, found, still, model)
    return Prepared(
        log, gnss, moves, still, found, start, (*several, *taken_off, *moves.notes, *found.notes, start.note)
    )


def receiver_of(log: Log, name: str | None) -> GnssStream:
    """Return a receiver by its name; without one, that which tells most: velocities, then sigmas, then most fixes.

    Raises:
        UsageError: no receiver of that name.
    """
    named = [g for g in log.gnss if name in (None, g.name)]
    if not named:
        message = f"no receiver {name!r}; there are {', '.join(g.name for g in log.gnss)}"
        raise UsageError(message)
    return max(named, key=lambda g: (g.velocity is not None, g.position_sigma is not None, len(g)))


def run(model: FilterModel, prepared: Prepared, *, smooth: bool = False) -> Solution:
    """Return a filter's run over a whole log; with what a smoother needs, if it is wanted."""
    moves = prepared.moves
    if any(model.wavelet_levels):
        moves = denoised(moves, model.wavelet_levels)
    return solve(model, moves, prepared.found, prepared.start, smooth=smooth)


def sweep(prepared: Prepared, model: FilterModel, duration: float) -> tuple[Outage, ...]:
    """Return an outage behind every fix, once a second, from when the filter has settled to the end of the log."""
    time = prepared.found.time[prepared.found.fix >= 0]
    first, last = (
        prepared.start_time + model.settings.settling,
        min(time[-1], prepared.moves.time[-1] - prepared.moves.interval) - duration,
    )
    kept: list[Outage] = []
    for t in time[(time >= first) & (time <= last)]:
        if not kept or t - kept[-1].start >= SPACING:
            kept.append(Outage(float(t), duration))
    return tuple(kept)


def own_outages(prepared: Prepared, model: FilterModel) -> tuple[Outage, ...]:
    """Return the outages that a log has itself, in whole seconds: spans between fixes that are as good as most.

    A fix is degraded when its sigma is three times the usual one, or its type below the usual one: those within a span are not
    used. They can be scored where a reference goes on meanwhile: the log's truth, or all fixes smoothed.
    """
    places = np.flatnonzero(prepared.found.fix >= 0)
    variance = prepared.found.events.variance[places, 0]
    good = variance <= WORSE**2 * np.median(variance)
    if prepared.gnss.fix_type is not None:
        kind = prepared.gnss.fix_type[prepared.found.fix[places]]
        good &= kind >= np.median(kind)
    time = prepared.found.time[places[good]]
    first = prepared.start_time + model.settings.settling
    usual = float(np.median(np.diff(time)))
    long = np.flatnonzero(np.diff(time) > max(OWN, OWN_SHARE * usual))
    return tuple(Outage(float(time[k]), float(np.floor(time[k + 1] - time[k]))) for k in long if time[k] >= first)


def apart(outages: Sequence[Outage]) -> list[Outage]:
    """Return those of some outages, in order of time, that do not overlap."""
    kept: list[Outage] = []
    for outage in outages:
        if not kept or outage.start >= kept[-1].start + kept[-1].duration:
            kept.append(outage)
    return kept


def replay(
    prepared: Prepared,
    models: Sequence[FilterModel],
    outages: Sequence[Outage],
    *,
    reference: str = "best",
) -> Replay:
    """Return what all filters do in the same outages.

    Args:
        prepared: the log.
        models: the filters; their names differ.
        outages: in order of time; those of a duration are run together.
        reference: "best", "truth", "fixed", "smoothed" or "own".

    Raises:
        UsageError: an outage before the filter has settled, or behind the log's end.
        MissingDataError: a filter that ends in no number.
        ValueError: the log has not the reference that is wanted; no process that a filter can carry.
    """
    check_outages(prepared, models[0], outages)
    solutions: dict[str, Solution] = {model.name: run(model, prepared) for model in models}
    best = next((m for name in ("tuned", "full", "18AV", "15AV") for m in models if m.name == name), models[0])
    alone = is_independent(prepared.log, reference)
    against = yardstick(prepared.log, solutions[best.name] if alone else run(best, prepared, smooth=True), reference)
    durations = sorted({outage.duration for outage in outages})
    runs: dict[str, Run] = {name: Run(solution, {}) for name, solution in solutions.items()}
    scored: dict[float, NDArray[np.bool_]] = {}
    notes = list(prepared.notes)
    early = [o for o in outages if o.start < prepared.start_time + models[0].settings.settling - SPACING]
    if early:
        notes.append(
            f"{len(early)} outages begin before the filter has had {models[0].settings.settling:g} s of fixes: it starts at "
            f"{prepared.start_time:.1f} s, the first of them at {early[0].start:.1f} s"
        )
    known = len(notes)
    for duration in tracked(durations, len(durations)):
        chosen = [outage for outage in outages if outage.duration == duration]
        good = np.ones(len(chosen), dtype=bool)
        for name, solution in tracked(solutions.items(), len(solutions)):
            drifted = drift(solution, events_of(solution, chosen), duration)
            found = scores(drifted, against)
            runs[name].outages[duration] = Replayed(drifted, found, scores(drifted, own(solution)))
            good &= np.isfinite(found.horizontal).all(axis=1)
        lost = int((~good).sum())
        if lost:
            notes.append(
                f"{lost} outages of {duration:g} s are not scored: {against.name} has no value there, or a filter failed"
            )
        gap = with_gap(prepared, chosen)
        if gap.any():
            notes.append(
                f"{int(gap.sum())} outages of {duration:g} s are not scored: IMU samples are missing within them"
            )
        scored[duration] = good & ~gap
    if not any(rows.any() for rows in scored.values()):
        message = f"{prepared.log.provenance.path}: no outage can be scored: {'; '.join(notes[known:])}"
        raise MissingDataError(message)
    return Replay(prepared, against, runs, scored, tuple(notes))


def check_outages(prepared: Prepared, model: FilterModel, outages: Sequence[Outage]) -> None:
    """Raise UsageError unless every outage lies where it can be run."""
    first = prepared.start_time
    last = float(prepared.moves.time[-1])
    if not outages:
        message = (
            f"no outage fits: the filter starts at {first:.1f} s, needs {model.settings.settling:g} s to settle, "
            f"and the log ends at {last:.1f} s"
        )
        raise MissingDataError(message)
    time = prepared.found.time[prepared.found.fix >= 0]
    usual = float(np.median(np.diff(time)))
    fixes: set[tuple[float, float]] = set()
    for outage in outages:
        if outage.start < first + LEAST_SETTLING:
            message = (
                f"the outage at {outage.start:g} s begins before the filter has settled: it starts at {first:.1f} s and needs "
                f"{LEAST_SETTLING:g} s at the very least"
            )
            raise UsageError(message)
        if outage.start + outage.duration > last - prepared.moves.interval:
            message = f"the outage of {outage.duration:g} s at {outage.start:g} s ends behind the log ({last:.1f} s)"
            raise UsageError(message)
        before = float(time[np.searchsorted(time, outage.start + 1e-3, side="right") - 1])
        if outage.start - before > OWN_SHARE * usual:
            message = (
                f"the outage at {outage.start:g} s begins where the log has no fixes: the last is at {before:.1f} s; "
                "--at own runs the outages that a log has itself"
            )
            raise UsageError(message)
        if (before, outage.duration) in fixes:
            message = f"two outages of {outage.duration:g} s begin behind the same fix, at {before:.1f} s"
            raise UsageError(message)
        fixes.add((before, outage.duration))


def events_of(solution: Solution, outages: Sequence[Outage]) -> NDArray[np.int64]:
    """Return the last fix up to the start of each outage."""
    time = solution.found.time[solution.events]
    at = np.searchsorted(time, np.array([outage.start for outage in outages]) + 1e-3, side="right") - 1
    return solution.events[np.maximum(at, 0)]


def with_gap(prepared: Prepared, outages: Sequence[Outage]) -> NDArray[np.bool_]:
    """Return which outages have IMU samples missing within them."""
    found = np.zeros(len(outages), dtype=bool)
    for begin, end in prepared.moves.bridged:
        found |= np.array([o.start < end and o.start + o.duration > begin for o in outages])
    return found

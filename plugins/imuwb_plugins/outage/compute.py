"""From a log to the figures of an outage replay."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

from imuwb.conditioning import corrected_log
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES
from imuwb.navigation import Aids, FilterModel, Installation, Settings
from imuwb.navigation.filter_document import read_filter
from imuwb.replay import (
    HORIZONS,
    Degradation,
    Outage,
    Replay,
    apart,
    budget,
    choose,
    compare,
    estimate_clocks,
    estimate_mounting,
    events_of,
    model_named,
    motion_classes,
    own_outages,
    prepare,
    replay,
    summarize,
    sweep,
    true_errors,
    tune,
    verdict,
)
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.outage.parameters import OWN
from imuwb_plugins.outage.result import Filter, OfDuration, OfModel, OneOutage, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Log
    from imuwb.replay import Budget, Prepared, Run, Scores
    from imuwb_plugins.outage.parameters import Parameters

BUDGETED = 30  #: outages
TESTED = "18AVWD"  #: the paper's claim is about it


def run(log: Log, parameters: Parameters) -> Result:
    """Return what each filter does in the outages.

    Raises:
        UsageError: no error model, an outage where none can be.
        MissingDataError: what the log lacks.
    """
    base = _base(parameters)
    log, _ = corrected_log(log, base.error_model)
    mounting = None
    if parameters.angles() is None:
        mounting = estimate_mounting(log, parameters.receiver, parameters.level)
        base = replace(base, installation=replace(base.installation, mounting=mounting.angles))
    clocks = None
    if parameters.delay() is None or parameters.rate() is None:
        first = _named("full", base, prepare(log, base, parameters.receiver), parameters)
        clocks = estimate_clocks(
            log, first, parameters.receiver, parameters.level, with_delay=parameters.delay() is None,
            with_rate=parameters.rate() is None,
        )  # fmt: skip
        estimates = {"gnss_delay": clocks.delay, "velocity_delay": clocks.velocity_delay, "clock_rate": clocks.rate}
        known = {name: found.value for name, found in estimates.items() if found is not None}
        base = replace(base, installation=replace(base.installation, **known))
    worse = Degradation(**parameters.degradation(), seed=parameters.seed) if parameters.degrade else None
    prepared = prepare(log, base, parameters.receiver, worse)
    models = [_named(name, base, prepared, parameters) for name in parameters.names()]
    if parameters.levels():
        denoised = _named("18AVWD", base, prepared, parameters)
        models.extend(
            replace(denoised, name=f"18AVWD at {level}", wavelet_levels=(level,) * len(AXES))
            for level in parameters.levels()
        )
    if parameters.filter is not None:
        models.append(base)
    tuned = None
    if parameters.tune:
        try:
            better, tuned = tune(prepared, models[-1], parameters.reference)
        except ValueError as error:
            raise MissingDataError(str(error)) from error
        models.append(replace(better, name="tuned"))
    if base.aids.speed and not log.speeds:
        message = f"{log.provenance.path}: no speed in this log: --speed has nothing to use"
        raise MissingDataError(message)
    try:
        found = replay(prepared, models, _outages(prepared, base, parameters), reference=parameters.reference)
    except ValueError as error:
        message = f"{log.provenance.path}: {error}"
        raise MissingDataError(message) from error
    durations = tuple(found.scored)
    summary = tuple(_of_duration(found, duration, parameters.level) for duration in durations)
    words = tuple(dict.fromkeys(f"{one.duration:g} s: {verdict(s)}" for one in summary for s in one.summaries))
    return Result(
        tuple(one for duration in durations for one in _each(found, duration)), summary,
        tuple(_filter(one, causal=log.causal) for one in found.runs.values()), found.reference.name, words, found.notes,
        clocks, mounting, tuned, *_budget(found), true_errors(prepared), parameters.map, found,
    )  # fmt: skip


def _base(parameters: Parameters) -> FilterModel:
    """Return the filter that is given, or one of the error model with the settings that are given.

    Raises:
        UsageError: neither an error model nor a filter; a filter of one of our own names.
    """
    if parameters.filter is not None:
        base = read_filter(parameters.filter)
        if base.name in (*parameters.names(), "tuned"):
            base = replace(base, name=f"{base.name} of {parameters.filter.name}")
        if parameters.error_model is not None:
            base = replace(base, error_model=ImuErrorModel.read(parameters.error_model))
        return base
    if parameters.error_model is None:
        message = "outage needs --error-model MODEL.toml: imuwb noise makes one of a still record, or write one by hand"
        raise UsageError(message)
    return FilterModel(
        "base", ImuErrorModel.read(parameters.error_model), scale_factor=parameters.scale_factors(),
        installation=Installation(
            parameters.angles() or (0.0, 0.0, 0.0), parameters.lever(), parameters.delay() or 0.0, parameters.velocity_delay,
            parameters.rate() or 1.0, parameters.skew,
        ),
        settings=Settings(every=parameters.every, settling=parameters.settling),
        aids=Aids(parameters.straight, parameters.still, parameters.speed),
    )  # fmt: skip


def _budget(found: Replay) -> tuple[Budget, str]:
    """Return what the last filter's sigma is made of, in the longest outages that do not overlap."""
    name, last = list(found.runs.items())[-1]
    duration = max(found.scored)
    starts = [Outage(float(t), duration) for t in last.outages[duration].scores.start]
    chosen = apart(starts)[:BUDGETED]
    return budget(last.solution, events_of(last.solution, chosen), duration), name


def _named(name: str, base: FilterModel, prepared: Prepared, parameters: Parameters) -> FilterModel:
    reading = "as printed" if parameters.reading == "as-printed" else "corrected"
    try:
        return model_named(
            name, base, reading=reading, interval=prepared.moves.interval, turn_on=parameters.turn_on_sigmas()
        )
    except ValueError as error:
        raise UsageError(str(error)) from error


def _outages(prepared: Prepared, base: FilterModel, parameters: Parameters) -> Sequence[Outage]:
    if parameters.at == OWN:
        return own_outages(prepared, base)
    if parameters.outages():
        return [Outage(start, duration) for start, duration in parameters.outages()]
    found: list[Outage] = []
    for duration in parameters.lengths():
        all_of_them = sweep(prepared, base, duration)
        if parameters.random and len(all_of_them) > parameters.random:
            rng = np.random.default_rng(parameters.seed)
            chosen = np.sort(rng.choice(len(all_of_them), parameters.random, replace=False))
            all_of_them = tuple(all_of_them[i] for i in chosen)
        found.extend(all_of_them)
    return found


def _of_duration(found: Replay, duration: float, level: float) -> OfDuration:
    rows = found.scored[duration]
    kept = {name: one.outages[duration].scores.of(rows, duration) for name, one in found.runs.items()}
    summaries = [
        s
        for name, one in found.runs.items()
        if (s := summarize(name, duration, kept[name], tuple(sorted({*HORIZONS, duration})), _nis(one)[0], level))
        is not None
    ]
    pairs = [pair for pair in permutations(kept, 2) if pair[0] == TESTED] if TESTED in kept else []
    if not pairs:
        pairs = [(name, next(iter(kept))) for name in list(kept)[1:]]
    paired = [compare(a, kept[a], b, kept[b], duration, level) for a, b in pairs] if rows.any() else []
    motion = motion_classes(found, duration)[rows]
    by_motion = {
        kind: {name: float(np.median(s.horizontal[motion == kind, -1])) for name, s in kept.items()}
        for kind in dict.fromkeys(motion.tolist())
    }
    few: dict[str, dict[str, object]] = {
        s.model: {
            "count": s.count, "effective_count": s.effective_count, "median_end": s.median_end.value,
            "median_end_interval": [s.median_end.lower, s.median_end.upper], "p95_end": s.p95_end.value,
            "nees_per_dof": s.consistency[-1].nees_per_dof if s.consistency else None,
            "coverage95": s.consistency[-1].coverage95 if s.consistency else None, "nis_per_dof": s.nis_per_dof,
        }
        for s in summaries
    }  # fmt: skip
    choice = choose(kept, duration) if rows.any() else None
    return OfDuration(duration, few, tuple(summaries), tuple(paired), by_motion, choice)


def _each(found: Replay, duration: float) -> list[OneOutage]:
    motion = motion_classes(found, duration)
    first = next(iter(found.runs.values())).outages[duration].scores
    return [
        OneOutage(
            float(first.start[i]), duration, float(first.distance[i, -1] / duration), str(motion[i]),
            {name: _of_model(one, duration, int(i), causal=found.prepared.log.causal) for name, one in found.runs.items()},
        )
        for i in np.flatnonzero(found.scored[duration])
    ]  # fmt: skip


def _of_model(one: Run, duration: float, i: int, *, causal: bool) -> OfModel:
    s: Scores = one.outages[duration].scores
    own = one.outages[duration].own.horizontal[i]
    error, driven = s.horizontal[i], float(s.distance[i, -1])
    heading = float(s.heading[i, -1])
    return OfModel(
        float(error.mean()), float(error.max()), float(error[-1]), float(s.vertical[i, -1]), float(s.velocity[i, -1]),
        heading if np.isfinite(heading) else None, float(error[-1] / driven * 100) if driven > duration else None,
        float(s.sigma[i, -1]), float(s.nees[i, -1]), one.solution.model.causal and causal, float(own.mean()), float(own.max()),
    )  # fmt: skip


def _nis(one: Run) -> tuple[float, float | None, float | None]:
    """Return mean NIS over degrees of freedom: of all, of position, of velocity."""
    nis = one.solution.fix_nis
    position, velocity = (float(np.nanmean(nis[:, k]) / 3) if np.isfinite(nis[:, k]).any() else None for k in (0, 1))
    known = [x for x in (position, velocity) if x is not None]
    return float(np.mean(known)) if known else float("nan"), position, velocity


def _filter(one: Run, *, causal: bool) -> Filter:
    model, interval = one.solution.model, one.solution.moves.interval
    _, position, velocity = _nis(one)
    return Filter(
        model.name, model.states(interval), _processes(model, "gyro_x"), _processes(model, "accel_x"),
        model.left_out(interval), model.reading, model.causal and causal,
        position if position is not None else float("nan"), velocity, one.solution.refused,
        int(np.isfinite(one.solution.fix_nis).sum()),
    )  # fmt: skip


def _processes(model: FilterModel, axis: str) -> str:
    terms = model.error_model.axes[axis].processes.terms
    return " + ".join(str(getattr(term, "name", type(term).__name__)).replace("_", " ") for term in terms)

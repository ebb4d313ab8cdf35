"""The rows of other engines in the result of a replay."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from imuwb.notes import Note
from imuwb.replay import (
    HORIZONS,
    Replay,
    Scores,
    compare,
    drift_curve,
    motion_classes,
    summarize,
    verdict,
    whole_run_scores,
)
from imuwb_plugins.outage import notes, summary
from imuwb_plugins.outage.engines import SHOWN, Engine, engines_of
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import DurationSummary, EngineInfo, FilterErrors, FilterSummary, OutageResult, Result

BLOCK = 60.0  #: s; errors of a whole run within this time count as one


def with_engines(result: Result, parameters: Parameters) -> Result:
    """Return a result with the engines of --solution and --filter-command in its tables."""
    replay = result.replay
    if replay is None or not (parameters.solution or parameters.filter_command):
        return result
    engines = engines_of(replay, parameters)
    failed = {e.name: _reason(e) for e in engines if e.whole is None and not e.parts}
    whole = {}
    if any(engine.whole is not None for engine in engines):
        whole = {
            name: _whole(name, whole_run_scores(replay, None, name), parameters.level, sigmas=True)
            for name in replay.runs
        }
    whole |= {
        e.name: _whole(e.name, e.whole, parameters.level, sigmas=e.sigmas) for e in engines if e.whole is not None
    }
    durations, verdicts = [], list(result.verdicts)
    for own in result.summary:
        for engine in engines:
            own, more = _with_row(own, engine, replay, parameters.level)  # noqa: PLW2901 - one row after the other
            verdicts += more
        durations.append(own)
    infos = tuple(
        EngineInfo(e.name, e.source, "whole run" if e.whole is not None else "outages", e.tried, e.failures, e.sigmas)
        for e in engines
    )
    return replace(
        result, summary=tuple(durations), outages=_outages(result.outages, engines, replay), verdicts=tuple(verdicts),
        notes=(*result.notes, *_notes(engines)), failed={**result.failed, **failed}, engines=infos, whole_run=whole,
    )  # fmt: skip


def _reason(engine: Engine) -> str:
    return f"{len(engine.failures)} of {engine.tried} without a solution: {'; '.join(engine.failures[:SHOWN])}"


def _notes(engines: tuple[Engine, ...]) -> Iterator[Note]:
    for engine in engines:
        if engine.failures:
            yield Note("engine-failed", f"{engine.name}: {_reason(engine)}")
        elif engine.whole is not None:
            text = f"{engine.name} is scored over the whole run, with all its fixes: its errors are no drift"
            yield Note("engine-whole-run", text)
        elif engine.tried == 1 and engine.parts:
            text = f"{engine.name}: one run is taken as without the fixes of all these outages; whole:FILE is a run with all fixes"
            yield Note("engine-one-run", text)
        if not engine.sigmas and (engine.parts or engine.whole is not None):
            yield Note("engine-without-sigmas", f"{engine.name} states no sigmas of positions: it has no NEES")


def _summarized(
    name: str, duration: float, scores: Scores, horizons: tuple[float, ...], level: float, *, sigmas: bool
) -> summary.Summary | None:
    own = summarize(name, duration, scores, horizons, math.nan, level)
    return own if own is None or sigmas else replace(own, consistency=())


def _whole(name: str, scores: Scores, level: float, *, sigmas: bool) -> FilterSummary:
    own = _summarized(name, BLOCK, scores, (BLOCK,), level, sigmas=sigmas)
    if own is None:
        raise ValueError(f"{name} has no scores")
    return summary.filter_summary(own, drift_curve(scores))


def _with_row(
    own: DurationSummary, engine: Engine, replay: Replay, level: float
) -> tuple[DurationSummary, list[Note]]:  # fmt: skip
    """Return the summary of a duration with an engine, and the verdict on its sigma."""
    if own.duration not in engine.parts or not own.models:
        return own, []
    rows, scores = engine.parts[own.duration]
    horizons = tuple(sorted({*HORIZONS, own.duration}))
    found = _summarized(engine.name, own.duration, scores, horizons, level, sigmas=engine.sigmas)
    if found is None:
        return own, []
    last, run = list(replay.runs.items())[-1]
    pair = compare(
        engine.name, scores, last, run.outages[own.duration].scores.of(rows, own.duration), own.duration, level
    )
    motion = motion_classes(replay, own.duration)[rows]
    by_motion = {
        kind: {
            **medians, engine.name: float(np.median(scores.horizontal[motion == kind, -1])) if kind in motion else math.nan,
        }
        for kind, medians in own.by_motion.items()
    }  # fmt: skip
    row = summary.filter_summary(found, drift_curve(scores))
    more = [notes.prefixed(f"{own.duration:g} s", verdict(found))] if engine.sigmas else []
    return replace(own, models={**own.models, engine.name: row}, paired=(*own.paired, pair), by_motion=by_motion), more


def _outages(
    outages: tuple[OutageResult, ...], engines: tuple[Engine, ...], replay: Replay
) -> tuple[OutageResult, ...]:
    """Return the outages with the errors of the engines that have scores in them."""
    at: dict[tuple[float, float], dict[str, FilterErrors]] = {}
    for engine in engines:
        for duration, (rows, scores) in engine.parts.items():
            starts = next(iter(replay.runs.values())).outages[duration].scores.start[rows]
            for k, start in enumerate(starts.tolist()):
                at.setdefault((start, duration), {})[engine.name] = _errors(scores, duration, k)
    return tuple(replace(o, models={**o.models, **at.get((o.start, o.duration), {})}) for o in outages)


def _errors(scores: Scores, duration: float, k: int) -> FilterErrors:
    error, driven, heading = scores.horizontal[k], float(scores.distance[k, -1]), float(scores.heading[k, -1])
    return FilterErrors(
        float(error.mean()), float(error.max()), float(error[-1]), float(scores.vertical[k, -1]),
        float(scores.velocity[k, -1]), heading if math.isfinite(heading) else None,
        float(error[-1] / driven * 100) if driven > duration else None, float(scores.sigma[k, -1]),
        float(scores.nees[k, -1]), False, math.nan, math.nan,
    )  # fmt: skip

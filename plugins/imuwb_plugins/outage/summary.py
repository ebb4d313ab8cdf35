"""The outages of a replay one by one, and their statistics."""

import math
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from imuwb.replay import (
    HORIZONS,
    DriftCurve,
    FilterRun,
    Replay,
    Scores,
    Summary,
    choose,
    compare,
    drift_curve,
    motion_classes,
    summarize,
    without_overlap,
)
from imuwb.statistics import Estimate
from imuwb_plugins.outage.filters import nis_per_dof
from imuwb_plugins.outage.result import (
    DurationSummary,
    ErrorSamples,
    FilterErrors,
    FilterSummary,
    OutageResult,
    PublishedGain,
)

TESTED = "18AVWD"  #: the filter of the paper's claim
LISTED = 20  #: outages in the table
SAMPLES = 60  #: outages in the figure of errors


def scored(replay: Replay, duration: float) -> dict[str, Scores]:
    """Return the scores of each filter in the outages of a duration that are scored."""
    rows = replay.scored[duration]
    return {name: own.outages[duration].scores.of(rows, duration) for name, own in replay.runs.items()}


def summaries(replay: Replay, duration: float, level: float) -> dict[str, Summary]:
    """Return the statistics of each filter in the outages of a duration; none without outages."""
    horizons = tuple(sorted({*HORIZONS, duration}))
    by_filter = {
        name: summarize(name, duration, scores, horizons, nis_per_dof(replay.runs[name])[0], level)
        for name, scores in scored(replay, duration).items()
    }
    return {name: own for name, own in by_filter.items() if own is not None}


def duration_summary(replay: Replay, duration: float, statistics: dict[str, Summary], level: float) -> DurationSummary:
    """Return the summary of all filters in the outages of a duration."""
    motion = motion_classes(replay, duration)[replay.scored[duration]]
    return summary_of(duration, scored(replay, duration), motion, statistics, level)


def summary_of(
    duration: float, kept: dict[str, Scores], motion: NDArray[np.str_], statistics: dict[str, Summary], level: float
) -> DurationSummary:
    """Return the summary of filters by their scores.

    Args:
        duration: s.
        kept: the scores of each filter in the same outages.
        motion: (s,) the class of motion of each outage.
        statistics: of each filter.
        level: of all intervals.
    """
    if not statistics:
        return DurationSummary(duration, {}, (), {}, None)
    pairs = [pair for pair in permutations(kept, 2) if pair[0] == TESTED]
    if not pairs:
        pairs = [(name, next(iter(kept))) for name in list(kept)[1:]]
    by_motion = {
        kind: {name: float(np.median(s.horizontal[motion == kind, -1])) for name, s in kept.items()}
        for kind in dict.fromkeys(motion.tolist())
    }
    return DurationSummary(
        duration, {name: filter_summary(own, drift_curve(kept[name])) for name, own in statistics.items()},
        tuple(compare(a, kept[a], b, kept[b], duration, level) for a, b in pairs), by_motion, choose(kept, duration),
    )  # fmt: skip


def filter_summary(own: Summary, curve: DriftCurve) -> FilterSummary:
    """Return the statistics of one filter as part of a result."""
    last = own.consistency[-1] if own.consistency else None
    return FilterSummary(
        count=own.count, effective_count=own.effective_count,
        median_end=own.median_end.value, median_end_interval=_interval(own.median_end),
        p68_end=own.p68_end.value, p68_end_interval=_interval(own.p68_end),
        p95_end=own.p95_end.value, p95_end_interval=_interval(own.p95_end),
        median_max=own.median_max.value, median_max_interval=_interval(own.median_max),
        median_vertical=own.median_vertical, median_velocity=own.median_velocity, median_heading=own.median_heading,
        median_percent=own.median_percent, nees_per_dof=None if last is None else last.nees_per_dof,
        coverage95=None if last is None else last.coverage95, nis_per_dof=own.nis_per_dof, consistency=own.consistency,
        curve=curve,
    )  # fmt: skip


def _interval(estimate: Estimate) -> tuple[float, float]:
    return estimate.lower, estimate.upper


def outage_results(replay: Replay) -> tuple[OutageResult, ...]:
    """Return the outages that are scored, by duration."""
    return tuple(own for duration in replay.scored for own in _of_duration(replay, duration))


def _of_duration(replay: Replay, duration: float) -> list[OutageResult]:
    motion = motion_classes(replay, duration)
    first = next(iter(replay.runs.values())).outages[duration].scores
    causal = replay.prepared.log.causal
    return [
        OutageResult(
            float(first.start[i]), duration, float(first.distance[i, -1] / duration), str(motion[i]),
            {name: _errors(own, duration, int(i), causal=causal) for name, own in replay.runs.items()},
            replay.outages[duration][i].name, replay.outages[duration][i].table,
        )
        for i in np.flatnonzero(replay.scored[duration])
    ]  # fmt: skip


def _errors(run: FilterRun, duration: float, i: int, *, causal: bool) -> FilterErrors:
    scores, own = run.outages[duration].scores, run.outages[duration].own.horizontal[i]
    error, driven, heading = scores.horizontal[i], float(scores.distance[i, -1]), float(scores.heading[i, -1])
    return FilterErrors(
        float(error.mean()), float(error.max()), float(error[-1]), float(scores.vertical[i, -1]),
        float(scores.velocity[i, -1]), heading if np.isfinite(heading) else None,
        float(error[-1] / driven * 100) if driven > duration else None, float(scores.sigma[i, -1]),
        float(scores.nees[i, -1]), run.solution.model.causal and causal, float(own.mean()), float(own.max()),
    )  # fmt: skip


def listed(outages: tuple[OutageResult, ...]) -> tuple[int, ...]:
    """Return the outages in the table, by duration and time: all, or the worst by the best filter that do not overlap."""
    order = sorted(range(len(outages)), key=lambda i: -min(m.end for m in outages[i].models.values()))
    if len(order) > LISTED:
        tried = [outages[i] for i in order]
        order = [order[k] for k in without_overlap([o.start for o in tried], [o.duration for o in tried])[:LISTED]]
    return tuple(sorted(order, key=lambda i: (outages[i].duration, outages[i].start)))


def samples(replay: Replay) -> ErrorSamples:
    """Return the errors of some outages of the longest duration."""
    duration = max(replay.scored)
    kept = {name: s for name, s in scored(replay, duration).items() if s.start.size}
    errors, limit, elapsed = {}, {}, np.zeros(0)
    for name, s in kept.items():
        rows = np.unique(np.linspace(0, s.start.size - 1, min(SAMPLES, s.start.size)).astype(int))
        elapsed, errors[name] = s.elapsed, s.horizontal[rows]
        limit[name] = max(3 * float(np.median(s.sigma[:, -1])), float(np.quantile(s.horizontal[:, -1], 0.9)))
    return ErrorSamples(duration, elapsed, errors, limit)


def published(outages: tuple[OutageResult, ...]) -> dict[str, PublishedGain]:
    """Return the improvement by 18AVWD over each filter as the paper states it."""
    first = outages[0].models if outages else {}
    names = [n for n in first if all(n in o.models and math.isfinite(o.models[n].own_max) for o in outages)]
    if TESTED not in names:
        return {}

    def gain(name: str, part: str) -> float:
        ratios = [getattr(o.models[TESTED], part) / max(getattr(o.models[name], part), 1e-9) for o in outages]
        return float(np.mean([1 - ratio for ratio in ratios]))

    return {name: PublishedGain(gain(name, "own_mean"), gain(name, "own_max")) for name in names}

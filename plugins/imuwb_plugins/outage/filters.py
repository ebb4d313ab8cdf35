"""The filters of a replay: states, innovations, error budget."""

from collections import Counter

import numpy as np

from imuwb.arrays import Floats
from imuwb.navigation import FilterModel, filter_text
from imuwb.replay import HORIZONS, FilterRun, Outage, Replay, events_of, without_overlap
from imuwb.replay import budget as error_budget
from imuwb.replay.scoring.budget import COMMON
from imuwb_plugins.outage.result import ErrorBudget, FilterInfo

BUDGETED = 30  #: outages


def nis_per_dof(run: FilterRun) -> tuple[float, float | None, float | None]:
    """Return the mean NIS over its degrees of freedom: of all, of positions, of velocities; refused fixes do not count."""
    nis = run.solution.used_nis / run.solution.fix_dof
    position, velocity = (float(np.nanmean(nis[:, k])) if np.isfinite(nis[:, k]).any() else None for k in (0, 1))
    known = [x for x in (position, velocity) if x is not None]
    return float(np.mean(known)) if known else float("nan"), position, velocity


def info(run: FilterRun, *, causal: bool) -> FilterInfo:
    """Return a description of a filter; ``causal``: whether the samples are."""
    solution = run.solution
    model, interval = solution.model, solution.measurement.interval
    _, position, velocity = nis_per_dof(run)
    return FilterInfo(
        model.name, model.states(interval), _processes(model, "gyro_x"), _processes(model, "accel_x"),
        model.left_out(interval), model.reading, model.causal and causal,
        position if position is not None else float("nan"), velocity, solution.refused,
        int(np.isfinite(solution.fix_nis).sum()), filter_text(model),
    )  # fmt: skip


def _processes(model: FilterModel, axis: str) -> str:
    terms = model.error_model.axes[axis].processes.terms
    names = Counter(str(getattr(term, "name", type(term).__name__)).replace("_", " ") for term in terms)
    return " + ".join(f"{count} x {name}" if count > 1 else name for name, count in names.items())


def budget(replay: Replay) -> ErrorBudget:
    """Return the error budget of the last filter, in the longest outages that do not overlap."""
    name, last = list(replay.runs.items())[-1]
    duration = max(replay.scored)
    start = last.outages[duration].scores.start
    outages = [Outage(float(t), duration) for t in start[without_overlap(start, duration)[:BUDGETED]]]
    parts = error_budget(last.solution, events_of(last.solution, outages), duration)
    order = sorted(range(len(parts.sources)), key=lambda i: (parts.sources[i] == COMMON, -parts.variance[i, -1]))
    variance = parts.variance[order]
    at = [k for k, t in enumerate(parts.elapsed) if t in HORIZONS or k == parts.elapsed.size - 1]
    return ErrorBudget(
        name, tuple(parts.sources[i] for i in order), parts.elapsed, _root(variance), _root(parts.total),
        parts.elapsed[at], variance[:, at] / parts.total[at] * 100,
    )  # fmt: skip


def _root(variance: Floats) -> Floats:
    return np.sqrt(np.where(variance >= 0, variance, np.nan))

"""Noise parameters fitted by what outages say: found on the first part of a log, judged on the rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize

from imuwb.navigation.outages import drift
from imuwb.replay.choice import log_likelihood
from imuwb.replay.reference import is_independent, yardstick
from imuwb.replay.replay import Outage, apart, events_of, run, sweep, with_gap
from imuwb.replay.scaled import scaled
from imuwb.replay.scores import scores

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Floats
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.replay.replay import Prepared
    from imuwb.replay.scores import Scores

DURATION = 30.0  #: s, of the outages
SHARE = 0.5  #: of the log that is fitted to
LEAST = 4  #: outages on each side
STEP = 1.0  #: of the first simplex, in the log of a factor
PRIOR = 2.0  #: sigma of the log of a factor: keeps what outages do not show near the model


@dataclass(frozen=True, slots=True)
class Tuned:
    """Factors of a model's noise, and what they did to outages that they were not fitted to."""

    white: tuple[float, float]  #: of gyros and accelerometers
    slow: tuple[float, float]  #: of their slower processes
    fitted: int  #: outages
    judged: int
    split: float  #: s from the log's start; fitted before, judged behind
    log_likelihood: tuple[float, float]  #: of an outage judged, before and behind tuning, mean
    nees_per_dof: tuple[float, float]  #: at the end, likewise
    median_end: tuple[float, float]  #: m, likewise


def tune(prepared: Prepared, model: FilterModel, reference: str) -> tuple[FilterModel, Tuned]:
    """Return a filter whose noise makes the errors in outages most likely, and how it does on outages it has not seen.

    Outages do not overlap; the horizontal errors at some seconds into each are taken as independent, of the filter's own
    covariance.

    Args:
        prepared: the log.
        model: the filter.
        reference: as of ``replay``.

    Raises:
        ValueError: too few outages fit into the log; no such reference.
    """
    smooth = not is_independent(prepared.log, reference)
    against = yardstick(prepared.log, run(model, prepared, smooth=smooth), reference)
    swept = sweep(prepared, model, DURATION)
    alone = apart([o for o, broken in zip(swept, with_gap(prepared, swept), strict=True) if not broken])
    split = alone[0].start + SHARE * (alone[-1].start + DURATION - alone[0].start) if alone else 0.0
    early = [o for o in alone if o.start + o.duration <= split]
    late = [o for o in alone if o.start >= split]
    if min(len(early), len(late)) < LEAST:
        message = f"tuning needs {LEAST} outages of {DURATION:g} s that do not overlap in each half of the log; there are {len(early)} and {len(late)}"
        raise ValueError(message)

    def of(factors: Floats, outages: Sequence[Outage]) -> tuple[FilterModel, Scores]:
        g, a, slow_g, slow_a = (float(f) for f in np.exp(factors))
        tried = replace(model, error_model=scaled(model.error_model, (g, a), (slow_g, slow_a)))
        solution = run(tried, prepared)
        return tried, scores(drift(solution, events_of(solution, outages), DURATION), against)

    def misfit(factors: Floats) -> float:
        value = -float(np.nanmean(log_likelihood(of(factors, early)[1]))) * len(early)
        return value + float((factors**2).sum()) / (2 * PRIOR**2)

    start = np.zeros(4)
    best = optimize.minimize(
        misfit, start, method="Nelder-Mead",
        options={"initial_simplex": np.vstack([start, np.eye(4) * STEP]), "xatol": 0.02, "fatol": 0.02, "maxfev": 160},
    )  # fmt: skip
    tuned, behind = of(best.x, late)
    _, before = of(start, late)
    g, a, slow_g, slow_a = (float(f) for f in np.exp(best.x))
    return tuned, Tuned(
        (g, a), (slow_g, slow_a), len(early), len(late), float(split),
        (float(np.nanmean(log_likelihood(before))), float(np.nanmean(log_likelihood(behind)))),
        (float(np.nanmean(before.nees[:, -1]) / 2), float(np.nanmean(behind.nees[:, -1]) / 2)),
        (float(np.nanmedian(before.horizontal[:, -1])), float(np.nanmedian(behind.horizontal[:, -1]))),
    )  # fmt: skip

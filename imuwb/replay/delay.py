"""How late a receiver's stamps are: the delay under which a filter's innovations are most likely."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize

from imuwb.identification.distributions import normal_limit
from imuwb.replay.replay import prepare, run
from imuwb.replay.statistics import Interval

if TYPE_CHECKING:
    from imuwb.log import Log
    from imuwb.navigation.filter_model import FilterModel

GRID = np.arange(-0.5, 0.51, 0.1)  #: s
STEP = 0.01  #: s, of the curvature


def estimate_delay(log: Log, model: FilterModel, receiver: str | None, level: float) -> Interval:
    """Return the delay of a receiver's fixes, s, with its interval.

    The likelihood of all innovations as a function of the delay, its maximum refined, its curvature the interval: once
    divided by the innovations' own mean square, where they are larger than the filter thinks.

    Args:
        log: the log.
        model: a filter; its own delay is where the search begins.
        receiver: name of the receiver; None: the first.
        level: of the interval.

    Raises:
        MissingDataError: as ``prepare``.
    """
    before = model.installation.gnss_delay

    def misfit(delay: float) -> float:
        tried = replace(model, installation=replace(model.installation, gnss_delay=float(before + delay)))
        return -run(tried, prepare(log, tried, receiver)).log_likelihood

    values = [misfit(d) for d in GRID]
    coarse = float(GRID[int(np.argmin(values))])
    best = optimize.minimize_scalar(
        misfit, bounds=(coarse - 0.1, coarse + 0.1), method="bounded", options={"xatol": 5e-4}
    )
    found = float(best.x)
    at = misfit(found)
    curvature = (misfit(found + STEP) - 2 * at + misfit(found - STEP)) / STEP**2
    solution = run(model, prepare(log, model, receiver))
    excess = max(1.0, float(np.nanmean(np.minimum(solution.track.nis[solution.events[1:]], solution.rules.gate))) / 3)
    half = normal_limit(level) * np.sqrt(excess / max(curvature, 1e-12))
    return Interval(before + found, before + found - half, before + found + half)

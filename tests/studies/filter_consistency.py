"""Consistency of a filter in simulated outages: NIS of its fixes, NEES and error of its drift, as rows of a table.

Bands: the mean over n independent outages of two degrees of freedom each is inside the 95 % quantiles of chi-squared over 2n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from imuwb.navigation import drift
from imuwb.replay import Outage, events_of, prepare, reference_track, run, scores
from imuwb.statistics.distributions import chi_square_quantile

ELLIPSE = 5.991  #: 95 % quantile of chi-squared with two degrees of freedom
INTERVAL = 0.01  #: s, of the IMU's samples
FIX_FREEDOM = 6  #: degrees of freedom of a fix: position and velocity
SETTLING_FIXES = 60  #: fixes without a place in the NIS, while the filter settles
QUANTITIES = ("quantity", "mean", "95 % band", "within the 95 % ellipse", "median error")  #: headings


@dataclass(frozen=True)
class Outcome:
    """One filter on one drive."""

    nis: np.ndarray  #: (f, 2) of position and velocity
    nees: np.ndarray  #: (s, horizons)
    error: np.ndarray  #: (s, horizons) m, horizontal
    start: np.ndarray  #: (s,) s from the log's start, of the outages
    notes: tuple


def outcome(log, model, *, duration, every, settling, horizons):
    """Return the outcome of a filter in outages of one duration, one after the other; all arguments are in s."""
    prepared = prepare(log, model)
    solution = run(model, prepared)
    start = np.arange(prepared.start_time + settling, prepared.measurement.time[-1] - duration - 1, every)
    drifted = drift(solution, events_of(solution, [Outage(float(t), duration) for t in start]), duration)
    scored = scores(drifted, reference_track(log, solution, "truth"))
    at = [horizon - 1 for horizon in horizons]
    return Outcome(
        solution.fix_nis[SETTLING_FIXES:], scored.nees[:, at], scored.horizontal[:, at], start, prepared.notes
    )


def band(freedom):
    """Return the 95 % band of the mean of chi-squared over its degrees of freedom."""
    return tuple(float(chi_square_quantile(p, freedom) / freedom) for p in (0.025, 0.975))


def nis_row(title, outcomes):
    """Return the row of the NIS of a filter's fixes."""
    nis = np.concatenate([o.nis for o in outcomes])
    low, high = band(float(FIX_FREEDOM * len(nis)))
    mean = float(np.nansum(nis) / (FIX_FREEDOM * len(nis)))
    return (title, f"NIS/6 of {len(nis):,} fixes", f"{mean:.4f}", f"{low:.4f} to {high:.4f}", "", "")


def nees_row(quantity, nees, error):
    """Return the row of the NEES of outages after one horizon."""
    low, high = band(2.0 * len(nees))
    within = 100 * float((nees <= ELLIPSE).mean())
    return (
        "", f"{quantity}, {len(nees)} outages", f"{nees.mean() / 2:.3f}", f"{low:.2f} to {high:.2f}", f"{within:.1f} %",
        f"{np.median(error):.3g} m",
    )  # fmt: skip

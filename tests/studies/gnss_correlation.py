"""Estimate the correlated error of a receiver's positions on simulated drives of known error, and judge its intervals.

Each drive takes 8 minutes (mixed route, 50 Hz, fixes each second, 3DM-GX3-25 with the usual turn-on bias). The error of positions is
white noise plus a first-order Gauss-Markov error, whose sigma and correlation time are drawn for each drive, log-uniform in
``SIGMAS`` and ``TIMES``; a height's sigmas are twice as large. The stated sigmas are those of the whole error. Every fourth drive has
no correlated error. The filter is ``full`` with the sensor's true model, so that the receiver alone is judged.

The error is shown if the log-likelihood rises by more than 5. An estimate is held if its interval of 95 % has the true value.
All drives with the error count, whether it is shown or not. A short correlation time looks like white noise, and a long one like a
constant: 8 minutes have few correlation times of 80 s.

The interval of the sigma comes from scores in blocks of a minute, or from the curvature, where it gives a wider one; that of the
correlation time from its profile likelihood, which is skew: 8 minutes have six stretches that are as long as a correlation time of 80 s.

Command: ``python tests/studies/gnss_correlation.py`` (240 drives: about ten minutes of a processor).
Seeds: seed r makes the error, the noise and the route of drive r; drives 3, 7, 11 ... have no correlated error.
"""

from dataclasses import dataclass, replace

import numpy as np
from study_report import Share, Table, main, over_records

from imuwb.navigation import FilterModel, Settings
from imuwb.replay import TURN_ON, estimate_gnss_correlation, model_named, prepare
from imuwb.simulation import GnssErrors, Receiver, drive, mixed_route, preset
from imuwb.stochastic import Constant, Sum

QUESTION = "Correlated errors of positions, from the innovations of a filter"
SECONDS, RATE = 480.0, 50.0
WHITE = 0.5  #: m, sigma of the white noise, horizontal
SIGMAS, TIMES = (0.5, 3.0), (10.0, 80.0)  #: m, horizontal; s
LONG = 30.0  #: s; drives are also counted below and above this correlation time
WITHOUT = 4  #: one drive of this many has no correlated error


@dataclass(frozen=True)
class Drive:
    """The results of one drive."""

    sigma: float  #: m, true; 0: no correlated error
    time: float  #: s, true
    shown: bool
    held: tuple[bool, bool]
    error: tuple[float, float]  #: logarithms of the ratio of estimate to truth


def errors(seed):
    """Return sigma (m) and correlation time (s) of a drive; 0 and 0 without a correlated error."""
    if seed % WITHOUT == WITHOUT - 1:
        return 0.0, 0.0
    rng = np.random.default_rng([seed, 1])
    return tuple(float(np.exp(rng.uniform(*np.log(r)))) for r in (SIGMAS, TIMES))


def one(seed):
    """Return the results of the drive of a seed."""
    sigma, time = errors(seed)
    own = GnssErrors(position_sigma=(sigma, sigma, 2 * sigma), position_time=time) if sigma else GnssErrors()
    receiver = Receiver(position_sigma=(WHITE, WHITE, 2 * WHITE), errors=own)
    model = with_turn_on(preset("3dm-gx3-25"))
    log = drive(model, mixed_route(SECONDS, seed), seed, rate=RATE, receiver=receiver)
    base = FilterModel("base", model, settings=Settings(spacing=1.0))
    prepared = prepare(log, base)
    full = model_named("full", base, interval=prepared.measurement.interval)
    found = estimate_gnss_correlation(prepared, (full,), 0.95)
    pairs = ((found.sigma, sigma), (found.time, time))
    if not sigma:
        return Drive(sigma, time, found.shown, (False, False), (np.nan, np.nan))
    return Drive(
        sigma, time, found.shown, tuple(e.lower <= t <= e.upper for e, t in pairs),
        tuple(float(np.log(e.value / t)) for e, t in pairs),
    )  # fmt: skip


def with_turn_on(model):
    """Return a sensor with the usual turn-on biases of the filter ``full`` in place of its own."""
    axes = {
        name: replace(
            own, processes=Sum((*(t for t in own.processes.terms if not isinstance(t, Constant)), Constant(TURN_ON[name[0] == "a"])))
        )
        for name, own in model.axes.items()
    }  # fmt: skip
    return replace(model, axes=axes)


def study(records, workers=2):
    """Return the tables of that many drives."""
    drives = over_records(one, [(seed,) for seed in range(records)], workers)
    present, absent = [d for d in drives if d.sigma], [d for d in drives if not d.sigma]
    shown = [("with the error", Share(sum(d.shown for d in present), len(present)))]
    shown.append(("without the error", Share(sum(d.shown for d in absent), len(absent))))
    parts = {
        "all": present, f"time up to {LONG:g} s": [d for d in present if d.time <= LONG],
        f"time above {LONG:g} s": [d for d in present if d.time > LONG],
    }  # fmt: skip
    return (
        Table("Drives in which the error is shown", ("drives", "share"), tuple(shown)),
        *(_held(f"{name}: {len(own)} drives", own) for name, own in parts.items() if own),
    )


def _held(title, drives):
    rows = []
    for i, name in enumerate(("sigma", "correlation time")):
        values = np.array([d.error[i] for d in drives])
        share = Share(sum(d.held[i] for d in drives), len(drives))
        rows.append((name, share, f"{np.exp(np.median(values)):.3f}", f"{values.std():.2f}"))
    headings = ("parameter", "intervals that have the truth", "median of estimate / truth", "sd of its logarithm")
    return Table(title, headings, tuple(rows))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 240, lambda n: f"{n} drives, seeds 0 to {n - 1}")

"""Compare four estimators of Q, N, B and K on simulated records of three hours: errors, and coverage of the intervals.

A record is 3 h at 100 Hz of quantization, white noise, flicker and a random walk, of the size of a small gyro's. The
estimators work on the same records: ``fit_likelihood`` (the headline estimator), ``fit_allan`` of an octave curve,
``fit_wavelet_variance`` and ``fit_spectrum``. A coefficient that is not identified counts as an estimate of 0, which is
an error of -100 %; it covers the truth if its upper limit is above the truth. Goals of the likelihood: rms errors
of at most 0.12 % (Q), 0.24 % (N), 3.9 % (B) and 49 % (K); 95 % intervals that contain the truth in 93 to 97 % of
cases (all coefficients together) and in 92 to 98 % (each coefficient).

Command: ``python tests/studies/headline.py`` (500 records: 5 to 10 minutes in one process).
Seeds: ``numpy.random.default_rng(r)`` draws record r.
"""

from __future__ import annotations

import numpy as np
from study_report import GOALS, Share, Table, main, over_records, pooled, verdict

from imuwb.identification import (
    allan,
    fit_allan,
    fit_likelihood,
    fit_spectrum,
    fit_wavelet_variance,
    power_spectrum,
    wavelet_variance,
)
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, Sum, WhiteNoise

QUESTION = "Q, N, B and K of a three-hour record, by four estimators"
RATE, HOURS, DEGREE = 100.0, 3.0, np.pi / 180
TRUTH = {"Q": 9.1e-4 * DEGREE, "N": 0.005 * DEGREE, "B": 0.002 * DEGREE, "K": 7.3e-5 * DEGREE}
UNITS = {"Q": "deg", "N": "deg/√s", "B": "deg/s", "K": "deg/s/√s"}
MOST = {"Q": 0.12, "N": 0.24, "B": 3.9, "K": 49.0}  #: %, goal for the rms error of the likelihood
TOGETHER, EACH = (0.93, 0.97), (0.92, 0.98)
ESTIMATORS = {
    "likelihood": fit_likelihood,
    "Allan variance": lambda x, dt: fit_allan(allan(x, dt)),
    "wavelet variance": lambda x, dt: fit_wavelet_variance(wavelet_variance(x, dt)),
    "spectrum": lambda x, dt: fit_spectrum(power_spectrum(x, dt)),
}


def processes():
    """Return the sum of processes from which records are drawn."""
    kinds = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}
    return Sum(tuple(kind(TRUTH[letter]) for letter, kind in kinds.items()))


def record(seed, hours):
    """Return {estimator: {letter: coefficient}} of one record."""
    x = processes().sample(round(hours * 3600 * RATE), 1 / RATE, np.random.default_rng(seed))
    return {name: estimate(x, 1 / RATE).coefficients for name, estimate in ESTIMATORS.items()}


def study(records=500, hours=HOURS, workers=1):
    """Return the tables: a summary, coverage of all coefficients together, and each coefficient of each estimator."""
    fits = over_records(record, [(seed, hours) for seed in range(records)], workers)
    rows = [_row(name, letter, [of[name][letter] for of in fits]) for name in ESTIMATORS for letter in TRUTH]
    note = (
        "Errors are relative. A coefficient that is not identified has an error of -100 %, and covers the truth if its upper limit is "
        "above the truth. A missing lower end counts as 0. With 500 records, the standard error of an rms error is about a "
        "thirtieth of the rms error."
    )
    every = Table(
        "Estimators",
        ("estimator", "term", "truth", "mean error, %", "rms error, %", "not identified", "coverage", "interval too low", "interval too high"),
        tuple(rows), note,
    )  # fmt: skip
    return (_summary(every), _together(every), every)


def _row(name, letter, fits):
    true = TRUTH[letter]
    errors = np.array([(c.value or 0.0) / true - 1 for c in fits])
    below = sum(bool(c.upper < true) for c in fits)
    above = sum(bool((c.lower or 0.0) > true) for c in fits)
    missing = Share(sum(c.value is None for c in fits), len(fits))
    covered = Share(len(fits) - below - above, len(fits))
    return (
        name, letter, f"{true / DEGREE:.3g} {UNITS[letter]}", 100 * float(errors.mean()),
        100 * float(np.sqrt(np.mean(errors**2))), missing, covered, below, above,
    )  # fmt: skip


def _pooled(every, name):
    return pooled(row[6] for row in every.rows if row[0] == name)


def _together(every):
    rows = tuple((name, _pooled(every, name)) for name in ESTIMATORS)
    return Table("Coverage of the four coefficients together", ("estimator", "coverage"), rows)


def _summary(every):
    """Return the goals of the likelihood and its results."""
    own = [row for row in every.rows if row[0] == "likelihood"]
    rows = [
        (f"rms error of {row[1]}, %", f"at most {MOST[row[1]]:g}", f"{row[4]:.3g}", verdict(row[4] <= MOST[row[1]]))
        for row in own
    ]
    share = _pooled(every, "likelihood")
    rows.append(("coverage, all together", "93 to 97 %", share, verdict(TOGETHER[0] <= share.value <= TOGETHER[1])))
    rows += [(f"coverage, {row[1]}", "92 to 98 %", row[6], verdict(EACH[0] <= row[6].value <= EACH[1])) for row in own]
    return Table("Goals of the likelihood", GOALS, tuple(rows))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 500, lambda n: f"seeds 0..{n - 1}, n = {n} records of {HOURS:g} h at {RATE:g} Hz")

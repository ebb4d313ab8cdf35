"""Judge families of which many logs give a limit only, with and without the limits, against the truth.

A log is 10 min at 100 Hz of white noise, flicker and a random walk; imuwb's likelihood estimates B and K from it, as ``imuwb fleet
noise`` does. A fleet has 40 sensors of 4 logs. N and B are the same for all sensors; K differs from sensor to sensor by 20 % (standard
deviation of its logarithm). Its mean is such that few, many or most logs give a limit.

Command: ``nice python tests/studies/fleet_limits.py`` (30 fleets of each of 3 sizes of K: about 10 minutes).
Seeds: log l of fleet r of size s uses ``default_rng([s, r, l])``, the sensors of the fleet ``default_rng([s, r])``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from study_report import Share, Table, main, over_records

from imuwb.identification.family import judge, observations
from imuwb.identification.family.limits import Limits
from imuwb.identification.likelihood.fit import fit_likelihood
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

QUESTION = "Families of which many logs give a limit only"
SENSORS, LOGS, SAMPLES, RATE, LEVEL, ERROR = 40, 4, 60_000, 100.0, 0.95, 0.1
N, B, SPREAD = 5e-5, 1.2e-5, 0.2  #: rad/s/√Hz, rad/s, of ln K
SIZES = (6e-6, 4e-6, 2e-6)  #: rad/s/√s, of K
TRUTH = "BK"


def estimates(size, fleet):
    """Return sensor, and value, lower and upper end of B and of K, of the logs of a fleet."""
    sensor = np.repeat(np.arange(SENSORS), LOGS)
    walk = SIZES[size] * np.exp(SPREAD * np.random.default_rng([size, fleet]).standard_normal(SENSORS))[sensor]
    found = []
    for log, k in enumerate(walk):
        process = Sum((WhiteNoise(N), FlickerNoise(B), RandomWalk(float(k))))
        fit = fit_likelihood(process.sample(SAMPLES, 1 / RATE, np.random.default_rng([size, fleet, log])), 1 / RATE)
        found.append([(c.value, c.lower, c.upper) for c in (fit.coefficients[letter] for letter in TRUTH)])
    return sensor, np.array(found, dtype=float)


def family(sensor, value, lower, upper):
    """Return the observations of the logs that have a value, and the limits of the others."""
    seen = lower > 0
    there = np.unique(sensor[seen])
    order = np.append(there, np.setdiff1d(sensor, there))
    number = np.empty(SENSORS, dtype=int)
    number[order] = np.arange(SENSORS)
    rows = observations(number[sensor[seen]], value[seen], lower[seen], upper[seen], level=LEVEL)
    value, upper = value[~seen], upper[~seen]
    stated = np.isfinite(value)
    limits = Limits(
        number[sensor[~seen]], np.log(upper), np.where(stated, value / upper, 0.0) ** 2,
        np.where(stated, (1 + LEVEL) / 2, LEVEL), np.full(upper.size, np.nan),
    )  # fmt: skip
    return rows, limits


def judged(size, fleet):
    """Return of B and of K, without and with the limits: share of limits, error and coverage of the mean, spread, and whether a sensor is outside."""
    sensor, found = estimates(size, fleet)
    out = np.zeros((2, 2, 6))
    for place, true in enumerate((B, SIZES[size])):
        rows, limits = family(sensor, *found[:, place].T)
        for with_limits in (0, 1):
            one = judge({"one": rows}, ERROR, LEVEL, {"one": limits} if with_limits else None).families["one"]
            spread = SPREAD if place else 0.0
            out[place, with_limits] = (
                limits.upper.size / sensor.size, one.mean.value - np.log(true), np.log(true) in one.mean, one.between.value or 0.0,
                (one.between.lower or 0.0) <= spread <= one.between.upper, bool(one.outside),
            )  # fmt: skip
    return out


def study(records=30, workers=1):
    """Return the table."""
    rows = []
    for size, walk in enumerate(SIZES):
        every = np.array(over_records(judged, [(size, fleet) for fleet in range(records)], workers))
        for place, letter in enumerate(TRUTH):
            for counted, name in enumerate(("left out", "counted")):
                limited, away, inside, spread, held, out = every[:, place, counted].T
                rows.append((
                    letter, f"{walk:g}", f"{100 * limited.mean():.0f} %", name, f"{100 * away.mean():+.1f} % ± {100 * away.std(ddof=1) / records**0.5:.1f}",
                    Share(int(inside.sum()), records).text(0), f"{100 * spread.mean():.0f} %", Share(int(held.sum()), records).text(0),
                    Share(int(out.sum()), records).text(0),
                ))  # fmt: skip
    headings = (
        "of", "K in the mean, rad/s/√s", "logs with a limit", "limits are", "error of the mean", "its interval holds the truth",
        "spread between sensors", "its interval holds the truth", "a sensor outside",
    )  # fmt: skip
    note = (
        f"Errors are of the logarithm. The spread is {100 * SPREAD:.0f} % for K and none for B. A sensor outside: fleets with any, at an error of "
        f"{100 * ERROR / 3:.1f} %; there is none in truth. imuwb counts limits."
    )
    return (Table("Mean and spread", headings, tuple(rows), note),)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 30,
        lambda n: f"{n} fleets of {SENSORS} sensors of {LOGS} logs, {SAMPLES / RATE / 60:g} min at {RATE:g} Hz each",
    )  # fmt: skip

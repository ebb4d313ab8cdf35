"""Measure the size and the power of the test that a coefficient is the same at all temperatures.

The size is measured on sensors that do not depend on temperature: white noise alone; white noise, flicker and random walk (a gyro
of 0.3 deg/√h, 7.2 deg/h, 15.8 deg/h^1.5); and these with quantization. A record has six successive set-points of 5 minutes at
100 Hz; ``set_point_of`` and ``over_temperature`` estimate the coefficients. A further case is a ramp of 110 °C in 2 h, cut into 22 bins
of 5 °C, whose bias follows the temperature by 1 deg/s and a parabola. Goal: the test of N at 5 % rejects in 3.5 to 6.5 % of records.

The power is measured with an N that changes linearly from the coldest to the hottest set-point. Goal: a change of 10 % is found in
at least 90 % of records.

Command: ``python tests/studies/temperature_dependence.py`` (600 records, half as many ramps: about 15 minutes in two processes).
Seeds: record r of case c uses ``SeedSequence([c, r])``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrix products are small: threads would slow each other down

import numpy as np
from study_report import GOALS, Share, Table, main, over_records, verdict

from imuwb.identification.temperature import Record, over_temperature, set_point_of, smooth_temperature, stretches
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, Sum, WhiteNoise

QUESTION = "Size and power of the tests of dependence on temperature"
RATE, MINUTES, RAMP_HOURS, DEGREE = 100.0, 5.0, 2.0, np.pi / 180
CELSIUS = np.linspace(-30, 60, 6)
WHITE, FLICKER, WALK = WhiteNoise(0.005 * DEGREE), FlickerNoise(0.002 * DEGREE), RandomWalk(7.3e-5 * DEGREE)
SENSORS = {
    "white noise": Sum((WHITE,)),
    "white noise, flicker, random walk": Sum((WHITE, FLICKER, WALK)),
    "with quantization": Sum((WHITE, FLICKER, WALK, Quantization(9.1e-4 * DEGREE))),
}
RAMP = "a ramp with thermal drift"
CHANGES = (0.0025, 0.005, 0.01, 0.02, 0.1)  #: of N from the coldest to the hottest set-point
LETTERS = ("N", "B", "K", "alpha", "bias")
SIZE, LOW, HIGH, POWER = 0.05, 0.035, 0.065, 0.9


def set_points(case, seed, change, minutes):
    """Return {quantity: whether the test finds a dependence, None where there is no test} of one record of set-points."""
    rng = np.random.default_rng(np.random.SeedSequence([case, seed]))
    sensor = list(SENSORS.values())[case % len(SENSORS)]
    n = round(minutes * 60 * RATE)
    points = []
    whole = sensor.sample(n * CELSIUS.size, 1 / RATE, rng)
    for k, t in enumerate(CELSIUS):
        x = whole[k * n : (k + 1) * n]
        scale = 1 + change * (t - CELSIUS[0]) / np.ptp(CELSIUS)
        x = x + WHITE.N * (scale**2 - 1) ** 0.5 * rng.standard_normal(n) * RATE**0.5
        points.append(set_point_of([Record(x, k * minutes * 60, float(t))], 1 / RATE))
    return _decisions(over_temperature(points, size=SIZE))


def ramp(seed, hours):
    """Return {quantity: whether the test finds a dependence, None where there is no test} of one ramp."""
    rng = np.random.default_rng(np.random.SeedSequence([len(SENSORS), seed]))
    n = round(hours * 3600 * RATE)
    t = np.arange(n) / RATE
    celsius = np.linspace(-40, 70, n)
    x = SENSORS["white noise, flicker, random walk"].sample(n, 1 / RATE, rng)
    x += DEGREE * ((celsius - 20) / 110 + 0.3 * ((celsius - 20) / 55) ** 2)
    time = np.arange(0, t[-1], 1.0)
    read = np.interp(time, t, celsius) + 0.1 * rng.standard_normal(time.size)
    points = []
    for s in stretches(time, read, RATE, "bins", 5.0)[1]:
        at = t[slice(*np.searchsorted(t, [s.start, s.end]))]
        inside = slice(round(at[0] * RATE), round(at[0] * RATE) + at.size)
        points.append(
            set_point_of([Record(x[inside], at[0], s.celsius, smooth_temperature(time, read, at), True)], 1 / RATE)
        )
    return _decisions(over_temperature(points, size=SIZE))


def _decisions(result):
    return {name: None if (d := result.dependence[name]) is None else d.depends for name in LETTERS}


def study(records=600, ramps=None, minutes=MINUTES, hours=RAMP_HOURS, workers=2):
    """Return the tables: a summary, the size, and the power."""
    ramps = records // 2 if ramps is None else ramps
    fewer = max(records // 10, 1)
    sizes = {
        name: over_records(set_points, [(case, seed, 0.0, minutes) for seed in range(records)], workers)
        for case, name in enumerate(SENSORS)
    }
    sizes[RAMP] = over_records(ramp, [(seed, hours) for seed in range(ramps)], workers)
    powers = {
        change: over_records(set_points, [(1 + 3 * (1 + i), seed, change, minutes) for seed in range(fewer)], workers)
        for i, change in enumerate(CHANGES)
    }
    return _summary(sizes, powers), _sizes(sizes), _powers(powers)


def share(decisions, name):
    """Return the share of records in which the test finds a dependence, among the records with a test."""
    tested = [of[name] for of in decisions if of[name] is not None]
    return Share(sum(tested), len(tested))


def _summary(sizes, powers):
    rows = [
        (
            f"size, N: {name}",
            f"{100 * LOW:g} to {100 * HIGH:g} %",
            s := share(decisions, "N"),
            verdict(LOW <= s.value <= HIGH),
        )
        for name, decisions in sizes.items()
    ]
    together = share([of for decisions in sizes.values() for of in decisions], "N")
    goal = f"{100 * LOW:g} to {100 * HIGH:g} %"
    rows.append(("size, N: all together", goal, together, verdict(LOW <= together.value <= HIGH)))
    most = share(powers[CHANGES[-1]], "N")
    rows.append(
        (f"power for {100 * CHANGES[-1]:g} % of N", f"at least {100 * POWER:g} %", most, verdict(most.value >= POWER))
    )
    return Table("Goals", GOALS, tuple(rows))


def _sizes(sizes):
    note = (
        "Share of records in which the test at 5 % finds a dependence on temperature, of the records in which the quantity was identified "
        "(their number follows). Nothing depends on temperature, except the bias of the ramp."
    )
    rows = []
    for sensor, decisions in sizes.items():
        shares = [share(decisions, name) for name in LETTERS]
        rows.append((sensor, *(f"{s} of {s.of}" for s in shares)))
    return Table("Size", ("sensor", *LETTERS), tuple(rows), note)


def _powers(powers):
    rows = [(f"{100 * change:g} %", share(decisions, "N")) for change, decisions in powers.items()]
    error = 100 / (2 * MINUTES * 60 * RATE) ** 0.5
    note = f"The sensor has white noise, flicker and random walk. The standard error of N at one set-point is {error:.2f} % or more."
    return Table("Power", ("change of N over 90 °C", "records in which the test finds the change"), tuple(rows), note)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 600,
        lambda n: f"seeds (c, 0..{n - 1}) for sensors c, (3, 0..{n // 2 - 1}) for ramps, 0..{n // 10 - 1} for each power",
    )  # fmt: skip

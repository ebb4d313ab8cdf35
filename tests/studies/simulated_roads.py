"""Test that simulated drives have the errors that their logs state: vibration on rough roads, noise in motion, errors of fixes.

Record r is a drive of 15 minutes over route r (town, country, highway), at several rates of the IMU and on roads of all classes. The
stated densities are those of ``Log.truth``. The measured ones come from Allan variances of the error alone, in motion: N²/tau for
white noise of density N, plus 3 Q²/tau² for vibration below half of the rate, whose angle is bounded; variances at 1 s and at 2 s give
N². Random walks are measured by the Allan variance at 30 s, K² tau/3, errors of fixes by their moments. All axes of a record
count. The goal of each ratio is 1 within chance.

Command: ``python tests/studies/simulated_roads.py`` (60 records: about 4 minutes in one process).
Seeds: record r has route r and road r; its noise is that of ``SeedSequence`` with r and the settings.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from study_report import GOALS, Mean, Table, main, over_records, verdict

from imuwb.log import AXES
from imuwb.simulation import GnssErrors, MotionNoise, Road, mixed_route
from imuwb.simulation.roughness import CLASSES

QUESTION = "Simulated roads, noise in motion and errors of fixes"
DURATION, STANDING = 900.0, 0.1  #: s, m/s
SENSORS = ((50.0, None), (100.0, None), (100.0, 40.0), (200.0, None))  #: Hz, rate and bandwidth
TAU = 1.0  #: s
NOISE = MotionNoise((1e-3, 1e-2), (2e-5, 3e-4), "always")
FIXES = GnssErrors((1.0, 1.0, 2.0), 30.0, (0.1, 0.1, 0.1), 5.0, step_rate=1.0, step_duration=8.0, jitter=0.02)
COUNT, RATE = 1800, 2.0  #: fixes and Hz
SUFFICIENT = 4.0  #: standard errors


def allan(values, cells):
    """Return the Allan variance of (n, axes) without overlap, the mean over the axes."""
    means = values[: values.shape[0] // cells * cells].reshape(-1, cells, values.shape[1]).mean(axis=1)
    return float((np.diff(means, axis=0) ** 2).mean() / 2)


def white(values, rate):
    """Return the density of white noise near frequency 0 from (n, axes) values."""
    once, twice = (allan(values, round(k * TAU * rate)) * k * TAU for k in (1, 2))
    return 2 * twice - once


def vibration(route, seed, name, rate, bandwidth):
    """Return the stated N of the gyros, and measured over stated density of gyros and accelerometers."""
    speed = route.speed(np.arange(DURATION * rate) / rate)
    errors, truth = Road(name, seed).vibration_errors(
        speed,
        rate,
        dict.fromkeys(AXES, bandwidth),
        np.random.SeedSequence([seed, ord(name), int(rate), bandwidth is None]),
    )
    stated = [float(truth[f"road.vibration.{kind}.N"].split()[0]) for kind in ("gyro", "accel")]
    found = [white(values[speed > STANDING], rate) for values in errors]
    return stated[0], *(value / density**2 for value, density in zip(found, stated, strict=True))


def body(route, seed, name):
    """Return the rms in motion of heave's acceleration, m/s², and of the rates of roll and pitch, deg/s."""
    ride = Road(name, seed).under(route).ride
    t = np.arange(DURATION * 100) / 100
    t = t[route.speed(t) > STANDING]
    return ride.at(t, 2)[:, 0].std(), *np.degrees(ride.at(t, 1)[:, 1:].std(axis=0))


def noise(seed):
    """Return measured over stated density of white noise and of the random walk, of gyros and accelerometers."""
    moving, rng = np.ones(round(DURATION * 100), bool), np.random.default_rng(seed)
    steady = MotionNoise(NOISE.white, when="always").sample(moving, 0.01, rng)
    walk = MotionNoise((0.0, 0.0), NOISE.walk, "always").sample(moving, 0.01, rng)
    return (
        *(white(values, 100) / n**2 for values, n in zip(steady, NOISE.white, strict=True)),
        *(allan(values, 3000) * 3 / 30 / k**2 for values, k in zip(walk, NOISE.walk, strict=True)),
    )


def fixes(seed):
    """Return figures of the fixes' errors over the stated ones, in the order of ``OF_FIXES``."""
    rng = np.random.default_rng(seed)
    plain = GnssErrors(FIXES.position_sigma, FIXES.position_time, FIXES.velocity_sigma, FIXES.velocity_time)
    figures = []
    for values, sigma, time in zip(
        plain.sample(COUNT, RATE, rng), (plain.position_sigma, plain.velocity_sigma), (30, 5), strict=True
    ):
        lag = int(time * RATE)
        unit = values / sigma
        figures += [(unit**2).mean(), (unit[lag:] * unit[:-lag]).mean() * np.e]
    steps = GnssErrors(step_rate=FIXES.step_rate, step_sigma=FIXES.step_sigma, step_duration=FIXES.step_duration)
    moved = steps.sample(COUNT, RATE, rng)[0]
    acting = FIXES.step_rate / 60 * FIXES.step_duration
    figures += [(moved[:, 0] != 0).mean() / -np.expm1(-acting), ((moved / FIXES.step_sigma) ** 2).mean() / acting]
    delay = FIXES.delays(COUNT, 0.3, rng)
    return (*figures, delay.mean() / 0.3, delay.std() / FIXES.jitter)


OF_FIXES = (
    "positions: variance", "positions: covariance after the correlation time", "velocities: variance",
    "velocities: covariance after the correlation time", "multipath: share of time", "multipath: variance", "delay: mean",
    "delay: sigma",
)  # fmt: skip


def record(seed):
    """Return {(table, row): figures} of one drive."""
    route = mixed_route(DURATION, seed)
    made = {("vibration", ("C", *sensor)): vibration(route, seed, "C", *sensor) for sensor in SENSORS}
    made |= {("vibration", (name, 100.0, None)): vibration(route, seed, name, 100.0, None) for name in CLASSES}
    made |= {("body", (name,)): body(route, seed, name) for name in CLASSES}
    return made | {("noise", ()): noise(seed), ("fixes", ()): fixes(seed)}


def study(records=60, workers=1):
    """Return the tables: the goals, and the figures of the roads."""
    found = defaultdict(list)
    for made in over_records(record, [(seed,) for seed in range(records)], workers):
        for key, figures in made.items():
            found[key].append(figures)
    means = {key: [_mean(column) for column in np.array(rows).T] for key, rows in found.items()}
    return _goals(means), _vibration(means), _body(means)


def _mean(values):
    return Mean(float(values.mean()), float(values.std(ddof=1) / np.sqrt(values.size)))


def _goals(means):
    kinds = [
        f"{what} of the {kind}"
        for what in ("white noise in motion", "random walk")
        for kind in ("gyros", "accelerometers")
    ]
    named = [*zip(kinds, means["noise", ()], strict=True), *zip(OF_FIXES, means["fixes", ()], strict=True)]
    for (table, row), figures in means.items():
        if table == "vibration":
            name, rate, bandwidth = row
            filtered = f", low-pass {bandwidth:g} Hz" if bandwidth else ""
            named += [
                (f"vibration, class {name}, {rate:g} Hz{filtered}: {kind}", mean)
                for kind, mean in zip(("gyros", "accelerometers"), figures[1:], strict=True)
            ]
    rows = tuple((what, "1", mean, verdict(abs(mean.off) < SUFFICIENT)) for what, mean in named)
    return Table("Measured over stated", GOALS, rows)


def _vibration(means):
    rows = tuple(
        (
            name,
            f"{rate:g}",
            f"{bandwidth:g}" if bandwidth else "–",
            f"{figures[0].value:.3g}",
            f"{10 * figures[0].value:.3g}",
        )
        for (table, row), figures in means.items()
        if table == "vibration"
        for name, rate, bandwidth in (row,)
    )
    note = "The mean over the drives of the density that vibration adds near frequency 0, in motion."
    headings = ("class", "rate, Hz", "low-pass, Hz", "N of gyros, rad/s/√Hz", "N of accelerometers, m/s²/√Hz")
    return Table("White noise by aliased vibration", headings, rows, note)


def _body(means):
    rows = tuple(
        (row[0], *(f"{mean.value:.3g}" for mean in figures))
        for (table, row), figures in means.items()
        if table == "body"
    )
    headings = ("class", "vertical acceleration, m/s²", "rate of roll, deg/s", "rate of pitch, deg/s")
    return Table("True motion of the body on its suspension, rms", headings, rows)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 60, lambda n: f"seeds 0..{n - 1}, n = {n} drives of {DURATION:g} s")

"""Does an error model that knows temperature know its errors where one that does not is wrong? A drive that warms up.

Drives of 40 minutes (mixed routes, 100 Hz, fixes each second). The sensor starts at -20 °C, holds for five minutes, warms to 50 °C
within half an hour and holds again. Over that range the white noise of all axes grows fourfold and the sigma of their
Gauss-Markov biases sixfold, and their biases follow curves; a turn-on bias comes on top, which no model knows. Four filters of
all states: the sensor's own model; the model at 25 °C; and between the two that with the bias curves only, and that with the
noise by temperature only. Outages of 60 s every 75 s do not overlap; ranges are of the temperature at their start.

Bands: a mean over n outages of two degrees of freedom each lies within chi-squared's 95 % quantiles over 2n, were they independent.

Command: ``python tests/studies/thermal_drive.py [--drives 32] > tests/studies/thermal_drive.md`` (some 3 minutes on two cores).
Seeds: 0, 1, ...; of routes likewise.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from imuwb.log import AXES
from imuwb.navigation import FilterModel, drift
from imuwb.replay import Outage, events_of, model_named, prepare, run, scores, yardstick
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.statistics.distributions import chi_square_quantile
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum, WhiteNoise
from imuwb.units import unit

MINUTES, LENGTH, EVERY, SETTLE = 40.0, 60.0, 75.0, 240.0
HORIZONS = (30, 60)
LIMIT = 5.991
INTERVAL = 0.01
COLD, MIDDLE, HOT = -20.0, 15.0, 50.0  #: °C
ROOM = 25.0
RANGES = {"-20 to 0 °C": (-25.0, 0.0), "0 to 30 °C": (0.0, 30.0), "30 to 50 °C": (30.0, 55.0)}
WHITE = {COLD: 0.5, MIDDLE: 0.8, HOT: 2.0}  #: factors
SLOW = {COLD: 0.4, MIDDLE: 0.8, HOT: 2.4}
#: N, sigma of the Gauss-Markov process, sigma of the turn-on bias; and the bias by temperature
GYRO = (
    ("2 deg/√h", "20 deg/h", "0.05 deg/s"),
    {-20.0: "-0.1 deg/s", 0.0: "-0.03 deg/s", 25.0: "0 deg/s", 50.0: "0.12 deg/s"},
)
ACCEL = (
    ("0.05 m/s/√h", "0.004 m/s²", "0.03 m/s²"),
    {-20.0: "0.05 m/s²", 0.0: "0.02 m/s²", 25.0: "0 m/s²", 50.0: "-0.04 m/s²"},
)
TIME_CONSTANT = 100.0  #: s, of the Gauss-Markov processes


def si(text):
    """Return a figure with its unit in SI."""
    figure, name = text.split(" ")
    return unit(name).to_si(float(figure))


def axis(figures, curve):
    """Return one axis of the sensor."""
    white, slow, turn_on = (si(figure) for figure in figures)

    def processes(celsius):
        return Sum(
            (WhiteNoise(white * WHITE[celsius]), GaussMarkov(slow * SLOW[celsius], TIME_CONSTANT), Constant(turn_on))
        )

    points = tuple((t, processes(t)) for t in WHITE)
    found = AxisModel(points[1][1], thermal=points, thermal_bias=tuple((t, si(b)) for t, b in curve.items()))
    return replace(found, processes=found.at(ROOM), bias=0.0)


SENSOR = ImuErrorModel("sensor", {a: axis(*(GYRO if a.startswith("gyro") else ACCEL)) for a in AXES})


def without(title, **changes):
    """Return the sensor's model without what it knows of temperature."""
    return replace(SENSOR, name=title, axes={a: replace(m, **changes) for a, m in SENSOR.axes.items()})


MODELS = {
    "thermal": SENSOR,
    "constant, of 25 °C": without("constant", thermal=(), thermal_bias=()),
    "bias curves only": without("bias curves", thermal=()),
    "noise by temperature only": without("noise", thermal_bias=()),
}


def warming(seconds):
    """Return a sensor that warms up during a drive."""
    return Temperature(((0.0, COLD), (seconds / 8, COLD), (seconds * 7 / 8, HOT), (seconds, HOT)))


def driven(minutes, seed):
    """Return a drive of the sensor."""
    return drive(SENSOR, mixed_route(minutes * 60, seed), seed, celsius=warming(minutes * 60))


@dataclass(frozen=True)
class Outcome:
    """What a filter did in the outages of a drive."""

    nis: np.ndarray  #: (f, 2)
    nees: np.ndarray  #: (s, horizons)
    error: np.ndarray  #: (s, horizons) m
    celsius: np.ndarray  #: (s,) at the start
    notes: tuple


def one(log, title, settle=SETTLE):
    """Return what one filter does on one drive."""
    model = model_named("full", FilterModel(title, MODELS[title]), interval=INTERVAL)
    prepared = prepare(log, model)
    solution = run(model, prepared)
    starts = np.arange(prepared.start_time + settle, prepared.moves.time[-1] - LENGTH - 1, EVERY)
    drifted = drift(solution, events_of(solution, [Outage(float(t), LENGTH) for t in starts]), LENGTH)
    found = scores(drifted, yardstick(log, solution, "truth"))
    at = [h - 1 for h in HORIZONS]
    thermometer = log.imus[0].temperature
    celsius = np.interp(starts, log.seconds(thermometer.time), thermometer.value)
    return Outcome(solution.fix_nis[60:], found.nees[:, at], found.horizontal[:, at], celsius, prepared.notes)


def band(freedom):
    """Return the 95 % band of a mean of chi-squared over its degrees of freedom."""
    return tuple(float(chi_square_quantile(p, freedom) / freedom) for p in (0.025, 0.975))


def rows(title, results):
    """Return the lines of one filter."""
    nis = np.concatenate([r.nis for r in results])
    nees, error = (np.concatenate([getattr(r, name) for r in results]) for name in ("nees", "error"))
    celsius = np.concatenate([r.celsius for r in results])
    low, high = band(6.0 * len(nis))
    yield f"| {title} | NIS/6 of {len(nis):,} fixes | {np.nansum(nis) / (6 * len(nis)):.4f} | {low:.4f} to {high:.4f} | | |"
    for i, h in enumerate(HORIZONS):
        for name, (above, below) in {"all": (-100.0, 100.0), **RANGES}.items():
            own = (celsius >= above) & (celsius < below)
            count = int(own.sum())
            low, high = band(2.0 * count)
            covered = float((nees[own, i] <= LIMIT).mean())
            yield (
                f"| | NEES/2 after {h} s, {name}, {count} outages | {nees[own, i].mean() / 2:.3f} | {low:.2f} to {high:.2f} "
                f"| {covered * 100:.1f} % | {np.median(error[own, i]):.3g} m |"
            )


def study(drives, minutes, titles=tuple(MODELS), workers=2):
    """Return each filter's outcomes on all drives."""

    def of(seed):
        log = driven(minutes, seed)
        return {title: one(log, title) for title in titles}

    with ThreadPoolExecutor(workers) as pool:
        every = list(pool.map(of, range(drives)))
    return {title: [found[title] for found in every] for title in titles}


def main():
    """Run and print the table."""
    parser = argparse.ArgumentParser(description="a thermal error model and a constant one on drives that warm up")
    parser.add_argument("--drives", type=int, default=32)
    parser.add_argument("--minutes", type=float, default=MINUTES)
    given = parser.parse_args()
    results = study(given.drives, given.minutes)
    print("# Drives that warm up from -20 to 50 °C\n")
    print(f"{given.drives} drives of {given.minutes:g} minutes; outages of {LENGTH:g} s every {EVERY:g} s.\n")
    print(
        "| error model | what | mean | 95 % band | within the 95 % ellipse | median error |\n| --- | --- | --- | --- | --- | --- |"
    )
    for title, found in results.items():
        print("\n".join(rows(title, found)), flush=True)
    print("\nNotes of the filters:\n")
    for title, found in results.items():
        print(
            f"* {title}: {'; '.join(note for note in found[0].notes if 'correct' in note or 'temperature' in note) or 'none'}"
        )


if __name__ == "__main__":
    main()

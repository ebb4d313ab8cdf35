"""Compare error models with and without temperature on drives during which the sensor warms up.

Drives take 40 minutes (mixed routes, 100 Hz, fixes each second). The sensor has -20 °C for five minutes, warms to 50 °C within half
an hour, and has 50 °C for the rest. Over that range the white noise of all axes grows fourfold, the sigma of their Gauss-Markov biases
sixfold, and their biases follow curves; each axis also has a turn-on bias, which no model contains. Four filters have all states:
the sensor's own model; its model at 25 °C; the model with the bias curves only; the model with noise by temperature only. Outages of
60 s every 75 s do not overlap; the ranges of temperature are those at the start of the outages.

The bands are explained in ``filter_consistency.py``.

Command: ``python tests/studies/thermal_drive.py`` (32 drives: about 3 minutes on two cores).
Seeds: seed r makes the sensor and the route of drive r.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from filter_consistency import INTERVAL, QUANTITIES, Outcome, nees_row, nis_row, outcome
from study_report import Table, main, over_records

from imuwb.log import AXES
from imuwb.navigation import FilterModel
from imuwb.notes import ids
from imuwb.replay import model_named
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum, WhiteNoise
from imuwb.units import unit

QUESTION = "Drives that warm up from -20 to 50 °C"
MINUTES, DURATION, EVERY, SETTLING = 40.0, 60.0, 75.0, 240.0
HORIZONS = (30, 60)  #: s
COLD, MIDDLE, HOT = -20.0, 15.0, 50.0  #: °C
ROOM = 25.0
RANGES = {"all": (-100.0, 100.0), "-20 to 0 °C": (-25.0, 0.0), "0 to 30 °C": (0.0, 30.0), "30 to 50 °C": (30.0, 55.0)}
WHITE = {COLD: 0.5, MIDDLE: 0.8, HOT: 2.0}  #: factor on N
SLOW = {COLD: 0.4, MIDDLE: 0.8, HOT: 2.4}  #: factor on sigma of the Gauss-Markov process
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
    """Return a figure with a unit, in SI."""
    figure, name = text.split(" ")
    return unit(name).to_si(float(figure))


def axis(figures, curve):
    """Return one axis of the sensor, from its figures and its curve of bias by temperature."""
    white, slow, turn_on = (si(figure) for figure in figures)

    def processes(celsius):
        return Sum(
            (WhiteNoise(white * WHITE[celsius]), GaussMarkov(slow * SLOW[celsius], TIME_CONSTANT), Constant(turn_on))
        )

    points = tuple((t, processes(t)) for t in WHITE)
    model = AxisModel(points[1][1], thermal=points, thermal_bias=tuple((t, si(b)) for t, b in curve.items()))
    return replace(model, processes=model.at(ROOM), bias=0.0)


SENSOR = ImuErrorModel("sensor", {a: axis(*(GYRO if a.startswith("gyro") else ACCEL)) for a in AXES})


def changed(title, **changes):
    """Return the sensor's model, changed in every axis."""
    return replace(SENSOR, name=title, axes={a: replace(m, **changes) for a, m in SENSOR.axes.items()})


MODELS = {
    "thermal": SENSOR,
    "constant, of 25 °C": changed("constant", thermal=(), thermal_bias=()),
    "bias curves only": changed("bias curves", thermal=()),
    "noise by temperature only": changed("noise", thermal_bias=()),
}


def warming(seconds):
    """Return the temperature of the sensor during a drive."""
    return Temperature(((0.0, COLD), (seconds / 8, COLD), (seconds * 7 / 8, HOT), (seconds, HOT)))


def driven(minutes, seed):
    """Return a drive of the sensor."""
    return drive(SENSOR, mixed_route(minutes * 60, seed), seed, celsius=warming(minutes * 60))


@dataclass(frozen=True)
class ThermalOutcome(Outcome):
    """One filter on one drive that warms up."""

    celsius: np.ndarray  #: (s,) at the start of the outages


def thermal_outcome(log, title):
    """Return the outcome of one filter on one drive."""
    model = model_named("full", FilterModel(title, MODELS[title]), interval=INTERVAL)
    plain = outcome(log, model, duration=DURATION, every=EVERY, settling=SETTLING, horizons=HORIZONS)
    thermometer = log.imus[0].temperature
    celsius = np.interp(plain.start, log.seconds(thermometer.time), thermometer.value)
    return ThermalOutcome(**vars(plain), celsius=celsius)


def record(seed, minutes):
    """Return {error model: outcome} of one drive."""
    log = driven(minutes, seed)
    return {title: thermal_outcome(log, title) for title in MODELS}


def study(records=32, minutes=MINUTES, workers=2):
    """Return the tables: NIS and NEES, and the notes on corrections."""
    drives = over_records(record, [(seed, minutes) for seed in range(records)], workers)
    rows = [row for title in MODELS for row in _rows(title, [outcomes[title] for outcomes in drives])]
    notes = tuple((title, _corrections(drives[0][title].notes)) for title in MODELS)
    return (
        Table("NIS and NEES", ("error model", *QUANTITIES), tuple(rows)),
        Table("Notes on corrections", ("error model", "note"), notes),
    )


def _rows(title, outcomes):
    nees, error, celsius = (np.concatenate([getattr(o, k) for o in outcomes]) for k in ("nees", "error", "celsius"))
    yield nis_row(title, outcomes)
    for i, horizon in enumerate(HORIZONS):
        for name, (above, below) in RANGES.items():
            own = (celsius >= above) & (celsius < below)
            yield nees_row(f"NEES/2 after {horizon} s, {name}", nees[own, i], error[own, i])


def _corrections(notes):
    return "; ".join(note for note in notes if "corrected" in ids([note])) or "none"


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 32,
        lambda n: f"seeds 0..{n - 1}; {n} drives of {MINUTES:g} minutes; outages of {DURATION:g} s every {EVERY:g} s",
    )  # fmt: skip

"""Test whether filters know their errors in outages when their error model is right: NIS, NEES and coverage.

Drives take four hours (mixed routes, 100 Hz, fixes each second). Four truths simulate the sensor, and the filter uses the same
processes: white noise and a Gauss-Markov bias; these and a random walk of the accelerometers; white noise and AR(1); white noise
and a stable AR(3), both by Burg's method from denoised static samples. Outages of 60 s every 90 s do not overlap. The first drive
of each truth also goes through the formulas as printed (densities), and through wavelet denoising before a filter that does not model it.

The bands are explained in ``filter_consistency.py``.

Command: ``python tests/studies/outage_consistency.py`` (4 drives of each truth: about 20 minutes on two cores).
Seeds: seed r makes the sensor and the route of drive r.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from filter_consistency import INTERVAL, QUANTITIES, nees_row, nis_row, outcome
from study_report import Table, main, over_records

from imuwb.navigation import FilterModel
from imuwb.replay import model_named
from imuwb.simulation import drive, mixed_route, preset
from imuwb.stochastic import AxisModel, ImuErrorModel

QUESTION = "Consistency in matched simulation"
HOURS, EVERY, DURATION, SETTLING = 4.0, 90.0, 60.0, 300.0
HORIZONS = (5, 10, 30, 60)  #: s
TRUTHS = {"WN + GM": "15AV", "WN + GM + RW": "18AV", "WN + AR(1)": "15AR", "WN + AR(3)": "27AR"}
VARIANTS = {
    "": {}, ", as printed": {"reading": "printed densities"}, ", denoised first": {"wavelet_levels": (7, 7, 7, 7, 6, 6)},
}  # fmt: skip


def filter_of(truth):
    """Return the filter that models a truth."""
    base = FilterModel("base", preset("3dm-gx3-25-gm"))
    return replace(model_named(TRUTHS[truth], base, interval=INTERVAL), name=truth)


def driven(model, hours, seed):
    """Return a drive whose sensor follows the error model of a filter."""
    sensor = ImuErrorModel(model.name, {a: AxisModel(m.processes) for a, m in model.error_model.axes.items()})
    return drive(sensor, mixed_route(hours * 3600, seed), seed)


def record(truth, seed, hours):
    """Return {variant: outcome} of one drive; drives after the first have the plain filter only."""
    model = filter_of(truth)
    log = driven(model, hours, seed)
    variants = {name: change for name, change in VARIANTS.items() if not (name and seed)}
    return {
        name: outcome(
            log, replace(model, **change), duration=DURATION, every=EVERY, settling=SETTLING, horizons=HORIZONS
        )
        for name, change in variants.items()
    }


def study(records=4, hours=HOURS, workers=2):
    """Return the table."""
    rows = []
    for truth in TRUTHS:
        drives = over_records(record, [(truth, seed, hours) for seed in range(records)], workers)
        for variant in VARIANTS:
            rows += _rows(truth + variant, [outcomes[variant] for outcomes in drives if variant in outcomes])
    return (Table("NIS and NEES", ("truth and filter", *QUANTITIES), tuple(rows)),)


def _rows(title, outcomes):
    nees, error = (np.concatenate([getattr(o, name) for o in outcomes]) for name in ("nees", "error"))
    yield nis_row(title, outcomes)
    for i, horizon in enumerate(HORIZONS):
        yield nees_row(f"NEES/2 after {horizon} s", nees[:, i], error[:, i])


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 4,
        lambda n: f"seeds 0..{n - 1}; {n} drives of {HOURS:g} h for each truth; outages of {DURATION:g} s every {EVERY:g} s",
    )  # fmt: skip

"""Recover the published coefficients from records that are simulated with them (Quinchia and others 2013).

Preset 3dm-gx3-25 (table 4): 7 h at 100 Hz, six axes. Each axis goes through ``fit_likelihood``, ``fit_allan`` of an octave
curve and ``fit_spectrum``. The tables show the recovered means beside table 4, how often the 95 % intervals of the likelihood
contain table 4's values, and in how many cells (axis, and N, B or K, where both estimators identify it) the spectrum and the
Allan variance agree: their difference is within z √(sa² + sb²), where each s is a half width divided by z. Goal: at least
93 %. Both estimators use the same record, so chance alone makes them differ in fewer than 5 % of cells.

Preset 3dm-gx3-25-gm (tables 4 and 5): how often ``choose_model`` ranks N + GM first on the gyro axes, its correlation
time and sigma beside the preset's, and the correlation time by the peak of the Allan curve.

Command: ``python tests/studies/quinchia.py`` (20 records of the first preset, half as many of the second: about 10
minutes in one process).
Seeds: record r uses ``SeedSequence(r).spawn(6)``, a stream for each axis in the order of ``AXES``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from coverage_table4 import PRESET, truth
from study_report import Share, Table, main, over_records, pooled, verdict

from imuwb.identification import (
    allan,
    choose_model,
    fit_allan,
    fit_likelihood,
    fit_spectrum,
    power_spectrum,
)
from imuwb.log import AXES
from imuwb.simulation import preset
from imuwb.stochastic import GaussMarkov
from imuwb.units import UNITS, coefficient_units

QUESTION = "Quinchia's tables 4 and 5, recovered from simulated records"
MARKOV, RATE, HOURS = "3dm-gx3-25-gm", 100.0, 7.0
LETTERS = ("N", "B", "K")
GYROS = tuple(axis for axis in AXES if axis.startswith("gyro"))
AGREE = 0.93
PEAK = 1.8926  #: averaging time over Tc at which the Allan deviation of a Gauss-Markov process is largest


def samples(name, axis, seed, hours):
    """Return one axis of a record."""
    stream = np.random.SeedSequence(seed).spawn(len(AXES))[AXES.index(axis)]
    n = round(hours * 3600 * RATE)
    return preset(name).axes[axis].processes.sample(n, 1 / RATE, np.random.default_rng(stream))


def record(seed, axis, hours):
    """Return {estimator: coefficients} of an axis."""
    x = samples(PRESET, axis, seed, hours)
    fits = fit_likelihood(x, 1 / RATE), fit_allan(allan(x, 1 / RATE)), fit_spectrum(power_spectrum(x, 1 / RATE))
    return dict(zip(("likelihood", "allan", "spectrum"), (fit.coefficients for fit in fits), strict=True))


def markov(seed, axis, hours):
    """Return the choice of model, the Gauss-Markov term of N + GM, and Tc from the Allan curve."""
    x = samples(MARKOV, axis, seed, hours)
    choice = choose_model(x, 1 / RATE)
    sums = next(c.processes for c in choice.candidates if c.name == "N + GM")
    curve = allan(x, 1 / RATE)
    return Markov(
        choice.best.name,
        choice.clear,
        min(choice.candidates, key=lambda c: c.aic).name,
        min(choice.candidates, key=lambda c: c.out_of_sample).name,
        next((t for t in sums.terms if isinstance(t, GaussMarkov)), None),
        peak(curve),
    )


class Markov(NamedTuple):
    """The choice of model and the readings of Tc for one axis of the second preset."""

    first: str
    clear: bool
    by_aic: str
    by_half: str
    term: GaussMarkov | None
    peak: float | None  #: s


def peak(curve):
    """Return the averaging time (s) of the peak after the valley, by a parabola between octaves; None where the curve ends rising."""
    y, x = np.log(curve.deviation), np.log(curve.averaging_time)
    valley = next((i for i in range(1, y.size - 1) if y[i] < y[i + 1]), None)
    if valley is None:
        return None
    at = valley + int(np.argmax(y[valley:]))
    if at in (valley, y.size - 1):
        return None
    bend = y[at - 1] - 2 * y[at] + y[at + 1]
    return float(np.exp(x[at] + (x[1] - x[0]) * (y[at - 1] - y[at + 1]) / (2 * bend)))


def study(records=20, hours=HOURS, workers=1, markov_records=None):
    """Return the tables: a summary, table 4, agreement of two estimators, choices of model, correlation times."""
    jobs = [(seed, axis, hours) for seed in range(records) for axis in AXES]
    done = over_records(record, jobs, workers)
    fits = {axis: [f for (_, a, _), f in zip(jobs, done, strict=True) if a == axis] for axis in AXES}
    seeds = range(max(records // 2, 1) if markov_records is None else markov_records)
    jobs = [(seed, axis, hours) for seed in seeds for axis in GYROS]
    done = over_records(markov, jobs, workers)
    chosen = {axis: [c for (_, a, _), c in zip(jobs, done, strict=True) if a == axis] for axis in GYROS}
    table4, cells, choices = _table4(fits), _cells(fits), _choices(chosen)
    return (_summary(table4, cells, choices), table4, _absent(fits), cells, choices, _times(chosen))


def _table4(fits):
    rows = []
    for axis in AXES:
        for letter, true in truth(axis).items():
            unit = coefficient_units(axis, letter)[1]
            cells = [fit["likelihood"][letter] for fit in fits[axis]]
            coverage = Share(sum(bool((c.lower or 0.0) <= true <= c.upper) for c in cells), len(cells))
            values = [
                np.array([fit[name][letter].value or 0.0 for fit in fits[axis]]) / unit.factor
                for name in ("likelihood", "allan", "spectrum")
            ]
            means = [f"{v.mean():.5g} ± {v.std(ddof=1) if v.size > 1 else np.nan:.2g}" for v in values]
            rows.append((axis, letter, unit.name, f"{true / unit.factor:.5g}", *means, coverage))
    note = (
        "Mean and standard deviation over the records; a term that was not identified counts as 0. Coverage: the 95 % interval of the "
        "likelihood contains the value of table 4, or its limit is above the value."
    )
    return Table(
        "Table 4", ("axis", "term", "unit", "table 4", "likelihood", "Allan variance", "spectrum", "coverage"), tuple(rows), note
    )  # fmt: skip


def _absent(fits):
    rows = []
    for axis in AXES:
        for letter in ("Q", *LETTERS):
            if letter in truth(axis):
                continue
            unit = coefficient_units(axis, letter)[1]
            cells = [fit["likelihood"][letter] for fit in fits[axis]]
            from_zero = Share(sum(not c.lower for c in cells), len(cells))
            nulls = Share(sum(c.value is None for c in cells), len(cells))
            most = float(np.median([c.upper for c in cells])) / unit.factor
            rows.append((axis, letter, nulls, from_zero, f"{most:.3g} {unit.name}"))
    note = "An estimate above 0 does not identify a term while its interval begins at 0."
    return Table(
        "Terms that are absent, by the likelihood",
        ("axis", "term", "not identified", "interval begins at 0, or not identified", "median upper end"), tuple(rows), note,
    )  # fmt: skip


def _cells(fits):
    """Return the table of cells in which the values of the spectrum and of the Allan variance agree."""
    rows = []
    for axis in AXES:
        for letter in LETTERS:
            pairs = [(fit["allan"][letter], fit["spectrum"][letter]) for fit in fits[axis]]
            pairs = [(a, b) for a, b in pairs if a.value is not None and b.value is not None]
            if not pairs and letter not in truth(axis):
                continue
            apart = np.array([a.value - b.value for a, b in pairs])
            joint = np.array([np.hypot(a.upper - (a.lower or 0.0), b.upper - (b.lower or 0.0)) / 2 for a, b in pairs])
            share = Share(int((np.abs(apart) <= joint).sum()), len(pairs))
            rms = float(np.sqrt(np.mean((apart / joint) ** 2))) if pairs else float("nan")
            rows.append((axis, letter, share, rms))
    note = "If the two were independent and the intervals exact, the difference over the joint half width would have an rms of 0.51."
    return Table("Spectrum and Allan variance", ("axis", "term", "agree", "rms of the difference, half widths"), tuple(rows), note)  # fmt: skip


def _choices(chosen):
    rows = []
    for axis, choices in chosen.items():
        names = [c.first for c in choices]
        others = ", ".join(f"{n} ({names.count(n)})" for n in sorted(set(names) - {"N + GM"})) or "–"
        counts = [
            sum(c.first == "N + GM" for c in choices),
            sum(c.first == "N + GM" and c.clear for c in choices),
            sum(c.by_aic == "N + GM" for c in choices),
            sum(c.by_half == "N + GM" for c in choices),
        ]
        rows.append((axis, *(Share(count, len(choices)) for count in counts), others))
    firsts = ("N + GM first", "N + GM first and clear", "N + GM first by AIC", "N + GM first on the other half")
    return Table(
        "Which sum of processes ranks first, 3dm-gx3-25-gm",
        ("axis", *firsts, "other sums ranked first"),
        tuple(rows),
        "First: the lowest BIC. Clear: the next sum's BIC is more than 10 higher, and no other sum predicts the half of the record that was not fitted better.",
    )


def _times(chosen):
    rows = []
    unit = UNITS["deg/h"]
    for axis, choices in chosen.items():
        true = next(t for t in preset(MARKOV).axes[axis].processes.terms if isinstance(t, GaussMarkov))
        terms = [c.term for c in choices if c.term is not None]
        peaks = [c.peak / PEAK for c in choices if c.peak is not None]
        rows.append((
            axis, f"{true.sigma / unit.factor:.4g}", _spread([t.sigma / unit.factor for t in terms]),
            f"{true.Tc:g}", _spread([t.Tc for t in terms]), _spread(peaks), f"{len(peaks)} of {len(choices)}",
        ))  # fmt: skip
    note = (
        "Each cell: median (smallest–largest) over the records. The last columns use the peak of the Allan curve after its "
        "valley, over 1.893. How the papers read Tc is in quinchia_table5.py."
    )
    return Table(
        "Gauss-Markov terms of N + GM",
        (
            "axis", "true sigma, deg/h", "sigma by likelihood, deg/h", "true Tc, s", "Tc by likelihood, s",
            "peak of the curve over 1.893, s", "readings of the peak",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _spread(values):
    return f"{np.median(values):.4g} ({min(values):.4g}–{max(values):.4g})" if values else "–"


def _summary(table4, cells, choices):
    columns = table4.column("coverage"), cells.column("agree"), choices.column("N + GM first")
    coverage, agree, first = map(pooled, columns)
    rows = (
        ("coverage of table 4's values by the likelihood", "95 %", coverage, "–"),
        ("cells in which spectrum and Allan variance agree", "at least 93 %", agree, verdict(agree.value >= AGREE)),
        ("N + GM first", "–", first, "–"),
    )
    return Table("Goals", ("figure", "goal", "result (95 % interval)", "verdict"), rows)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 20,
        lambda n: f"seeds 0..{n - 1} of {PRESET}, 0..{max(n // 2, 1) - 1} of {MARKOV}; {HOURS:g} h at {RATE:g} Hz",
    )  # fmt: skip

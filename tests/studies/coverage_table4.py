"""Test the coverage of the intervals of ``fit_allan`` and of the Allan curve.

Records are simulated with the preset 3dm-gx3-25 (Quinchia, table 4): 7 h at 100 Hz, six axes. Each axis goes through
``allan(x, dt)`` at octaves and ``fit_allan(curve)``. Goals: the 95 % intervals contain the 15 coefficients that are
present in 93 to 97 % of cases (all together) and in at least 88 % (each); K of the gyros, which is absent, is not
identified in at least 90 of 100 records.

Command: ``python tests/studies/coverage_table4.py`` (100 records: 5 to 10 minutes on two cores).
Seeds: record r uses ``SeedSequence(r).spawn(6)``, a stream for each axis in the order of ``AXES``, as
``imuwb.simulation.static`` does; apart from the rounding of gravity, the noise of both is the same to the last bit.
"""

from __future__ import annotations

import numpy as np
from study_report import Share, Table, main, over_records, pooled, verdict

from imuwb.identification import allan, fit_allan
from imuwb.log import AXES
from imuwb.simulation import preset
from imuwb.units import coefficient_units

PRESET, RATE, LETTERS = "3dm-gx3-25", 100.0, ("Q", "N", "B", "K", "R")
QUESTION = "Coverage of the fit's and the curve's intervals, 3dm-gx3-25"


def truth(axis):
    """Return {letter: coefficient} of an axis; each process of the preset has one parameter, named by its letter."""
    return {
        letter: getattr(term, letter)
        for term in preset(PRESET).axes[axis].processes.terms
        for letter in LETTERS
        if hasattr(term, letter)
    }


def record(seed, hours):
    """Return {axis: (fitted coefficients, averaging times, edf interval, printed interval)} of one record."""
    model, n = preset(PRESET), round(hours * 3600 * RATE)
    results = {}
    for axis, stream in zip(AXES, np.random.SeedSequence(seed).spawn(len(AXES)), strict=True):
        x = model.axes[axis].processes.sample(n, 1 / RATE, np.random.default_rng(stream))
        curve, printed = allan(x, 1 / RATE), allan(x, 1 / RATE, uncertainty="printed")
        results[axis] = (fit_allan(curve).coefficients, curve.averaging_time, (curve.lower, curve.upper), (printed.lower, printed.upper))  # fmt: skip
    return results


def study(records=100, hours=7.0, workers=2):
    """Return the tables: a summary, present coefficients, absent coefficients, points of the curve."""
    results = over_records(record, [(seed, hours) for seed in range(records)], workers)
    present, absent = _present(results), _absent(results)
    return (_summary(present, absent), present, absent, _curve(results))


def _present(results):
    rows = []
    for axis in AXES:
        for letter, true in truth(axis).items():
            fits = [result[axis][0][letter] for result in results]
            inside = sum(c.value is not None and c.lower <= true <= c.upper for c in fits)
            errors = np.array([c.value / true - 1 for c in fits if c.value is not None])
            below = sum(c.value is not None and true > c.upper for c in fits)
            above = sum(c.value is not None and true < c.lower for c in fits)
            unit = coefficient_units(axis, letter)[1]
            rows.append((
                axis, letter, f"{true / unit.factor:.5g} {unit.name}", Share(errors.size, len(fits)), Share(inside, len(fits)),
                below, above, 100 * float(errors.mean()), 100 * float(np.sqrt(np.mean(errors**2))),
            ))  # fmt: skip
    headings = ("axis", "term", "truth", "identified", "coverage", "interval too low", "interval too high", "mean error, %", "rms error, %")  # fmt: skip
    note = "A term that was not identified counts as not covered. Errors are relative, over the records in which the term was identified."
    return Table("Coefficients that are present", headings, tuple(rows), note)


def _absent(results):
    rows = []
    for axis in AXES:
        for letter in LETTERS:
            if letter in truth(axis):
                continue
            fits = [result[axis][0][letter] for result in results]
            nulls = [c for c in fits if c.value is None]
            unit = coefficient_units(axis, letter)[1]
            median = float(np.median([c.upper for c in nulls])) / unit.factor if nulls else float("nan")
            limits = Share(sum(bool(c.upper > 0) for c in nulls), len(nulls))
            rows.append((axis, letter, Share(len(nulls), len(fits)), limits, f"{median:.3g} {unit.name}"))
    note = "With one-sided tests at 2.5 %, an absent term is not identified in 97.5 % of records."
    return Table(
        "Coefficients that are absent",
        ("axis", "term", "not identified", "upper limit above 0", "median upper limit"),
        tuple(rows), note,
    )  # fmt: skip


def _curve(results):
    model, times = preset(PRESET), results[0][AXES[0]][1]
    true = {axis: np.sqrt(model.axes[axis].processes.allan_variance(times, 1 / RATE)) for axis in AXES}
    rows = []
    for i, tau in enumerate(times):
        counts = []
        for kind in (2, 3):
            inside = [bool(r[a][kind][0][i] <= true[a][i] <= r[a][kind][1][i]) for r in results for a in AXES]
            counts.append(Share(sum(inside), len(inside)))
        rows.append((2**i, f"{tau:g}", *counts))
    note = (
        "Share of points of the curve whose 95 % interval contains the true Allan deviation of the sum, over all six axes. "
        '"edf": `allan(x, dt)`; "printed": ±z/√(2(n/m − 1)), the formula of the papers.'
    )
    return Table("Points of the Allan curve", ("m", "tau, s", "edf", "printed"), tuple(rows), note)


def _summary(present, absent):
    covered = present.column("coverage")
    together = pooled(covered)
    places = zip(covered, present.column("axis"), present.column("term"), strict=True)
    lowest, *place = min(places, key=lambda c: c[0].value)
    nulls = [(row[2], row[0]) for row in absent.rows if row[1] == "K" and row[0].startswith("gyro")]
    fewest, axis = min(nulls, key=lambda null: null[0].value)
    rows = (
        ("coverage, all 15 together", "93 to 97 %", together, verdict(0.93 <= together.value <= 0.97)),
        (f"coverage, lowest of the 15 ({' '.join(place)})", "at least 88 %", lowest, verdict(lowest.value >= 0.88)),
        (f"gyro K not identified, lowest ({axis})", "at least 90 %", fewest, verdict(fewest.value >= 0.90)),
    )
    return Table("Goals", ("figure", "goal", "result (95 % interval)", "verdict"), rows)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 100, lambda n: f"seeds 0..{n - 1}, n = {n} records of 7 h at 100 Hz, 6 axes")

"""Are the published coefficients found again in records that were made from them (Quinchia and others 2013)?

Preset 3dm-gx3-25 (table 4): 7 h at 100 Hz, six axes; each axis by ``fit_likelihood``, ``fit_allan`` of an octave curve and
``fit_spectrum``. Printed are the recovered means beside table 4, how often the likelihood's 95 % intervals hold it,
and in how many cells (axis, and N, B or K, where both have a value) the spectrum and the Allan variance agree: within
z √(sa² + sb²), each s a half width over z. Wanted: at least 93 %. Both see the same record, so chance
alone would part them in fewer than 5 %.

Preset 3dm-gx3-25-gm (tables 4 and 5): how often ``choose_model`` puts N + GM first on the gyro axes, its correlation
time and size beside the preset's, and the correlation time as the papers read it, from the flat part's centre.

Command: ``python tests/studies/quinchia.py`` (20 records of the first preset, half as many of the second: about 10
minutes in one process).
Seeds: record r uses ``SeedSequence(r).spawn(6)``, a stream for each axis in the order of ``AXES``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification import (
    AllanFit,
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

QUESTION = "Quinchia's tables 4 and 5, found again"
FLICKER, MARKOV, RATE, HOURS = "3dm-gx3-25", "3dm-gx3-25-gm", 100.0, 7.0
LETTERS = ("N", "B", "K")
GYROS = tuple(axis for axis in AXES if axis.startswith("gyro"))
AGREE = 0.93
PEAK = 1.8926  #: Tc, where the Allan deviation of a Gauss-Markov process is highest


def truth(axis):
    """Return {letter: coefficient} of an axis; each process has one, its letter."""
    terms = preset(FLICKER).axes[axis].processes.terms
    return {letter: getattr(term, letter) for term in terms for letter in LETTERS if hasattr(term, letter)}


def samples(name, axis, seed, hours):
    """Return one axis of a record."""
    stream = np.random.SeedSequence(seed).spawn(len(AXES))[AXES.index(axis)]
    n = round(hours * 3600 * RATE)
    return preset(name).axes[axis].processes.sample(n, 1 / RATE, np.random.default_rng(stream))


def record(seed, axis, hours):
    """Return {estimator: coefficients} of an axis."""
    x = samples(FLICKER, axis, seed, hours)
    fits = fit_likelihood(x, 1 / RATE), fit_allan(allan(x, 1 / RATE)), fit_spectrum(power_spectrum(x, 1 / RATE))
    return dict(zip(("likelihood", "allan", "spectrum"), (fit.coefficients for fit in fits), strict=True))


def markov(seed, axis, hours):
    """Return the choice, without its processes but for the Gauss-Markov term of N + GM, and readings of Tc."""
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
        fit_allan(curve),
        peak(curve),
    )


class Markov(NamedTuple):
    """What was found in one axis of the second preset."""

    first: str
    clear: bool
    by_aic: str
    by_half: str
    term: GaussMarkov | None
    read: AllanFit
    peak: float | None  #: s


def peak(curve):
    """Return where the curve is highest behind its valley, s, between octaves by a parabola; None where it ends rising."""
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
    """Return the tables: a summary, table 4, cells in which two estimators part, choices, correlation times."""
    jobs = [(seed, axis, hours) for seed in range(records) for axis in AXES]
    done = over_records(record, jobs, workers)
    found = {axis: [f for (_, a, _), f in zip(jobs, done, strict=True) if a == axis] for axis in AXES}
    seeds = range(max(records // 2, 1) if markov_records is None else markov_records)
    jobs = [(seed, axis, hours) for seed in seeds for axis in GYROS]
    done = over_records(markov, jobs, workers)
    chosen = {axis: [c for (_, a, _), c in zip(jobs, done, strict=True) if a == axis] for axis in GYROS}
    table4, cells, choices = _table4(found), _cells(found), _choices(chosen)
    return (_summary(table4, cells, choices), table4, _absent(found), cells, choices, _times(chosen))


def _table4(found):
    rows = []
    for axis in AXES:
        for letter, true in truth(axis).items():
            unit = coefficient_units(axis, letter)[1]
            cells = [one["likelihood"][letter] for one in found[axis]]
            held = Share(sum(bool((c.lower or 0.0) <= true <= c.upper) for c in cells), len(cells))
            values = [
                np.array([one[name][letter].value or 0.0 for one in found[axis]]) / unit.factor
                for name in ("likelihood", "allan", "spectrum")
            ]
            means = [f"{v.mean():.5g} ± {v.std(ddof=1) if v.size > 1 else np.nan:.2g}" for v in values]
            rows.append((axis, letter, unit.name, f"{true / unit.factor:.5g}", *means, held))
    note = (
        "Mean and standard deviation over the records; a null counts as 0. Covered: the likelihood's 95 % interval holds table 4's "
        "value, or its limit is above it."
    )
    return Table(
        "Table 4", ("axis", "term", "unit", "table 4", "likelihood", "Allan variance", "spectrum", "covered"), tuple(rows), note
    )  # fmt: skip


def _absent(found):
    rows = []
    for axis in AXES:
        for letter in ("Q", *LETTERS):
            if letter in truth(axis):
                continue
            unit = coefficient_units(axis, letter)[1]
            cells = [one["likelihood"][letter] for one in found[axis]]
            held = Share(sum(not c.lower for c in cells), len(cells))
            nulls = Share(sum(c.value is None for c in cells), len(cells))
            most = float(np.median([c.upper for c in cells])) / unit.factor
            rows.append((axis, letter, nulls, held, f"{most:.3g} {unit.name}"))
    note = "A likeliest size above 0 is no finding while its interval begins at 0."
    return Table(
        "Terms that are not there, by the likelihood",
        ("axis", "term", "nulls", "interval begins at 0, or null", "median upper end"), tuple(rows), note,
    )  # fmt: skip


def _cells(found):
    """Return in how many cells the spectrum's and the Allan variance's values agree."""
    rows = []
    for axis in AXES:
        for letter in LETTERS:
            pairs = [(one["allan"][letter], one["spectrum"][letter]) for one in found[axis]]
            pairs = [(a, b) for a, b in pairs if a.value is not None and b.value is not None]
            if not pairs and letter not in truth(axis):
                continue
            apart = np.array([a.value - b.value for a, b in pairs])
            joint = np.array([np.hypot(a.upper - (a.lower or 0.0), b.upper - (b.lower or 0.0)) / 2 for a, b in pairs])
            share = Share(int((np.abs(apart) <= joint).sum()), len(pairs))
            rms = float(np.sqrt(np.mean((apart / joint) ** 2))) if pairs else float("nan")
            rows.append((axis, letter, share, rms))
    note = "The difference over the joint half width has an rms of 0.51 where the two are independent and the intervals true."
    return Table("Spectrum and Allan variance", ("axis", "term", "agree", "rms of the difference, half widths"), tuple(rows), note)  # fmt: skip


def _choices(chosen):
    rows = []
    for axis, found in chosen.items():
        names = [c.first for c in found]
        others = ", ".join(f"{n} ({names.count(n)})" for n in sorted(set(names) - {"N + GM"})) or "–"
        counts = [
            sum(c.first == "N + GM" for c in found),
            sum(c.first == "N + GM" and c.clear for c in found),
            sum(c.by_aic == "N + GM" for c in found),
            sum(c.by_half == "N + GM" for c in found),
        ]
        rows.append((axis, *(Share(count, len(found)) for count in counts), others))
    return Table(
        "Which sum is first, 3dm-gx3-25-gm",
        ("axis", "N + GM first", "and clear", "first by AIC", "first on the other half", "others that were first"),
        tuple(rows),
        "First by BIC. Clear: the next sum's BIC is more than 10 worse, and no other does better on the half it was not fitted to.",
    )


def _times(chosen):
    rows = []
    unit = UNITS["deg/h"]
    for axis, found in chosen.items():
        true = next(t for t in preset(MARKOV).axes[axis].processes.terms if isinstance(t, GaussMarkov))
        terms = [c.term for c in found if c.term is not None]
        read = [c.read for c in found if c.read.correlation_time is not None]
        peaks = [c.peak / PEAK for c in found if c.peak is not None]
        rows.append((
            axis, f"{true.sigma / unit.factor:.4g}", _spread([t.sigma / unit.factor for t in terms]),
            f"{true.Tc:g}", _spread([t.Tc for t in terms]), _spread([r.correlation_time.value for r in read]),
            _spread([r.gauss_markov_time for r in read]), f"{len(read)} of {len(found)}", _spread(peaks), f"{len(peaks)} of {len(found)}",
        ))  # fmt: skip
    note = (
        "Median, least and largest over the records. The papers read Tc from the centre of the curve's flat part; "
        "the process whose curve peaks there has a Tc of that over 1.893. `fit_allan` gives no reading where its flat part "
        "lasts to the record's end, and that of a sum with flicker does unless K or R follows. Last: the "
        "curve's own peak behind its valley, over 1.893."
    )
    return Table(
        "Gauss-Markov terms of N + GM",
        (
            "axis", "sigma, deg/h", "found", "Tc, s", "found by likelihood", "flat part's centre, s", "peak-matched, s",
            "readings of the flat part", "peak of the curve over 1.893, s", "peaks",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _spread(values):
    return f"{np.median(values):.4g} ({min(values):.4g}–{max(values):.4g})" if values else "–"


def _summary(table4, cells, choices):
    held, agree, first = (
        Share(sum(s.count for s in column), sum(s.of for s in column))
        for column in (table4.column("covered"), cells.column("agree"), choices.column("N + GM first"))
    )
    rows = (
        ("table 4's values covered by the likelihood", "95 %", held, "–"),
        ("cells in which spectrum and Allan variance agree", "at least 93 %", agree, verdict(agree.value >= AGREE)),
        ("N + GM first", "–", first, "–"),
    )
    return Table("What was wanted", ("figure", "wanted", "reached (95 % interval)", "verdict"), rows)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 20,
        lambda n: f"seeds 0..{n - 1} of {FLICKER}, 0..{max(n // 2, 1) - 1} of {MARKOV}; {HOURS:g} h at {RATE:g} Hz",
    )  # fmt: skip

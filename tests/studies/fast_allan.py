"""Compare the thinned Allan deviation (``fast=True``) with the exact Allan deviation.

Records are 3 h at 100 Hz of quantization, white noise, flicker, a random walk, all of these, and all except quantization (the
sizes of ``headline.py``). Each goes through ``allan(x, dt, "log:90", fast=True)`` and, at the same averaging times, through the
exact ``allan``. The tables show the largest difference, relative to the deviation and to half the width of the 95 % interval of
the exact curve. That interval uses the degrees of freedom of the process itself (for a sum: of the reddest noise type so far),
because noise types identified by chance at the longest averaging times make intervals far too narrow. The intervals that both
curves report stand beside it, and the share of thinned intervals that contain the true deviation. The proposed bound is the
largest difference without quantization, plus a quarter, rounded up to a whole per cent.

Command: ``python tests/studies/fast_allan.py`` (60 records of each process: about 3 minutes in one process).
Seeds: record r of process p uses ``SeedSequence([p, r])``.
"""

from __future__ import annotations

import math

import numpy as np
from headline import RATE, TRUTH, processes
from scipy import stats
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification import allan, equivalent_degrees_of_freedom
from imuwb.stochastic import Sum

QUESTION = "Difference of the thinned Allan deviation from the exact one"
SAMPLES, POINTS = 1_080_000, "log:90"
HELP = 0.25  #: of an interval's half width, as the help of the option states
#: averaging factors; those below the first are not thinned
DECADES = ((16, 64), (64, 1024), (1024, 16384), (16384, 1 << 30))
TYPES = {"Q": 2, "N": 0, "B": -1, "K": -2}
NAMES = (*TRUTH, "Q + N + B + K", "N + B + K")


def sum_of(name):
    """Return the process of this name."""
    return Sum(tuple(term for letter, term in zip(TRUTH, processes().terms, strict=True) if letter in name))


def half_widths(curve, name):
    """Return half the width of each 95 % interval, and its degrees of freedom, for the noise types that are present."""
    kinds = np.full(curve.factor.size, TYPES[name]) if name in TYPES else np.minimum.accumulate(curve.noise_type)
    pairs = zip(curve.factor, kinds, strict=True)
    edf = np.array([equivalent_degrees_of_freedom(int(m), curve.n, int(kind)) for m, kind in pairs])
    lower, upper = (curve.deviation * np.sqrt(edf / stats.chi2.ppf(q, edf)) for q in (0.975, 0.025))
    return (upper - lower) / 2, edf


def record(number, seed, n):
    """Return factors, differences over the deviation and over half widths, degrees of freedom, whether intervals contain the truth."""
    x = sum_of(NAMES[number]).sample(n, 1 / RATE, np.random.default_rng(np.random.SeedSequence([number, seed])))
    fast = allan(x, 1 / RATE, POINTS, fast=True)
    exact = allan(x, 1 / RATE, fast.averaging_time)
    if not np.array_equal(fast.factor, exact.factor):
        raise ValueError("the exact curve has other averaging times")
    apart = np.abs(fast.deviation - exact.deviation)
    half, edf = half_widths(exact, NAMES[number])
    true = np.sqrt(sum_of(NAMES[number]).allan_variance(exact.averaging_time, 1 / RATE))
    printed = (apart / ((curve.upper - curve.lower) / 2) for curve in (exact, fast))
    return (
        exact.factor,
        apart / exact.deviation,
        apart / half,
        *printed,
        edf,
        (fast.lower <= true) & (true <= fast.upper),
    )


def study(records=60, n=SAMPLES, workers=1):
    """Return the tables: a summary, processes, and ranges of averaging times."""
    jobs = [(p, r, n) for p in range(len(NAMES)) for r in range(records)]
    done = over_records(record, jobs, workers)
    curves = {name: [c for (p, *_), c in zip(jobs, done, strict=True) if p == k] for k, name in enumerate(NAMES)}
    return (_summary(curves, records), _by_process(curves), _by_factor(curves))


def _largest(records, kind):
    return max(100 * float(record[kind].max()) for record in records)


def _summary(curves, records):
    plain = max(_largest(of, 2) for name, of in curves.items() if "Q" not in name)
    summed = _largest(curves["Q + N + B + K"], 2)
    rows = (
        ("largest difference without quantization, % of half the interval's width", f"{100 * HELP:g}", f"{plain:.2f}", verdict(plain <= 100 * HELP)),
        ("largest difference of Q + N + B + K, % of half the interval's width", f"{100 * HELP:g}", f"{summed:.2f}", verdict(summed <= 100 * HELP)),
        ("proposed bound without quantization, %", "–", str(math.ceil(1.25 * plain)), "–"),
        ("proposed bound with quantization of this size, %", "–", str(math.ceil(1.25 * max(summed, plain))), "–"),
    )  # fmt: skip
    return Table(f"Summary of {records * len(NAMES)} curves", ("figure", "goal, at most", "result", "verdict"), rows)  # fmt: skip


def _by_process(curves):
    rows = []
    for name, records in curves.items():
        each = np.array([100 * record[2].max() for record in records])
        where = max(records, key=lambda record: record[2].max())
        at = int(np.argmax(where[2]))
        rows.append((
            name, _largest(records, 1), float(each.max()), float(np.quantile(each, 0.99)), float(np.median(each)),
            f"{where[0][at] / RATE:.5g}", float(where[5][at]), _largest(records, 3), _largest(records, 4),
            Share(int(sum(record[6].sum() for record in records)), sum(record[6].size for record in records)),
        ))  # fmt: skip
    return Table(
        "Processes",
        (
            "process", "largest, % of the deviation", "largest, % of the half width", "99 of 100 curves below, % of the half width",
            "median curve, % of the half width", "averaging time of the largest, s", "degrees of freedom at that time",
            "largest, % of the reported half width", "largest, % of the thinned curve's half width", "coverage of the thinned intervals",
        ),
        tuple(rows), "Each curve counts with its largest difference over all averaging times.",
    )  # fmt: skip


def _by_factor(curves):
    rows = []
    for low, high in DECADES:
        for name, records in curves.items():
            inside = [(record[0] >= low) & (record[0] < high) for record in records]
            values = [np.concatenate([r[k][i] for r, i in zip(records, inside, strict=True)]) for k in (1, 2)]
            if values[0].size:
                to = f"{low}–{high - 1}" if high < 1 << 30 else f"from {low}"
                rows.append((to, name, *(100 * float(v.max()) for v in values), *(100 * float(np.sqrt(np.mean(v**2))) for v in values)))  # fmt: skip
    return Table(
        "Averaging times",
        ("m", "process", "largest, % of the deviation", "largest, % of the half width", "rms, % of the deviation", "rms, % of the half width"),
        tuple(rows),
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 60,
        lambda n: f"seeds (p, 0..{n - 1}) for processes p = 0..{len(NAMES) - 1}; n = {n} records of {SAMPLES} samples each",
    )  # fmt: skip

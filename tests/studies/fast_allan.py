"""How far is the thinned Allan deviation (``fast=True``) from the exact one?

3 h at 100 Hz of quantization, white noise, flicker, a random walk, all of these, and all but quantization (the sizes of
``headline.py``), each ``allan(x, dt, "log:90", fast=True)`` and then, at the averaging times it took, the exact one. Printed
is the largest difference, relative to the deviation and to half the width of the exact curve's 95 % interval. The interval is that
of the degrees of freedom of the process itself (of a sum: of the reddest type found so far), lest types that are found by
chance at the longest averaging times make absurdly narrow ones; beside it the intervals as both curves print them, and
how often the thinned curve's interval holds the true deviation.
The bound proposed is the largest seen without quantization, a quarter more, rounded up to a whole per cent.

Command: ``python tests/studies/fast_allan.py`` (60 records of each process: about 3 minutes in one process).
Seeds: record r of process number p uses ``SeedSequence([p, r])``.
"""

from __future__ import annotations

import math

import numpy as np
from headline import RATE, TRUTH, processes
from scipy import stats
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification import allan, equivalent_degrees_of_freedom
from imuwb.stochastic import Sum

QUESTION = "What thinning costs the Allan deviation"
SAMPLES, POINTS = 1_080_000, "log:90"
HELP = 0.25  #: of an interval's half width, as the help of the option says
DECADES = ((16, 64), (64, 1024), (1024, 16384), (16384, 1 << 30))  #: of factors; below, nothing is thinned
TYPES = {"Q": 2, "N": 0, "B": -1, "K": -2}
NAMES = (*TRUTH, "Q + N + B + K", "N + B + K")


def sum_of(name):
    """Return the process of this name."""
    return Sum(tuple(term for letter, term in zip(TRUTH, processes().terms, strict=True) if letter in name))


def half_widths(curve, name):
    """Return half the width of each 95 % interval, and its degrees of freedom, for the types that are there."""
    kinds = np.full(curve.factor.size, TYPES[name]) if name in TYPES else np.minimum.accumulate(curve.noise_type)
    pairs = zip(curve.factor, kinds, strict=True)
    edf = np.array([equivalent_degrees_of_freedom(int(m), curve.n, int(kind)) for m, kind in pairs])
    lower, upper = (curve.deviation * np.sqrt(edf / stats.chi2.ppf(q, edf)) for q in (0.975, 0.025))
    return (upper - lower) / 2, edf


def record(number, seed, n):
    """Return factors, differences relative to the deviation, to half widths, degrees of freedom, true value held."""
    x = sum_of(NAMES[number]).sample(n, 1 / RATE, np.random.default_rng(np.random.SeedSequence([number, seed])))
    fast = allan(x, 1 / RATE, POINTS, fast=True)
    exact = allan(x, 1 / RATE, fast.averaging_time)
    if not np.array_equal(fast.factor, exact.factor):
        message = "the exact curve has other averaging times"
        raise ValueError(message)
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
    """Return the tables: a summary, processes, and stretches of averaging times."""
    jobs = [(p, r, n) for p in range(len(NAMES)) for r in range(records)]
    done = over_records(record, jobs, workers)
    found = {name: [f for (p, _, _), f in zip(jobs, done, strict=True) if p == k] for k, name in enumerate(NAMES)}
    return (_summary(found, records), _by_process(found), _by_factor(found))


def _most(fits, kind):
    return max(100 * float(one[kind].max()) for one in fits)


def _summary(found, records):
    plain = max(_most(fits, 2) for name, fits in found.items() if "Q" not in name)
    summed = _most(found["Q + N + B + K"], 2)
    rows = (
        ("largest difference without quantization, % of half the interval's width", f"{100 * HELP:g}", f"{plain:.2f}", verdict(plain <= 100 * HELP)),
        ("largest difference of Q + N + B + K, %", f"{100 * HELP:g}", f"{summed:.2f}", verdict(summed <= 100 * HELP)),
        ("bound to print without quantization, %", "–", str(math.ceil(1.25 * plain)), "–"),
        ("bound to print with quantization such as here, %", "–", str(math.ceil(1.25 * max(summed, plain))), "–"),
    )  # fmt: skip
    return Table(f"What was found in {records * len(NAMES)} curves", ("figure", "wanted, at most", "reached", "verdict"), rows)  # fmt: skip


def _by_process(found):
    rows = []
    for name, fits in found.items():
        each = np.array([100 * one[2].max() for one in fits])
        where = max(fits, key=lambda one: one[2].max())
        at = int(np.argmax(where[2]))
        rows.append((
            name, _most(fits, 1), float(each.max()), float(np.quantile(each, 0.99)), float(np.median(each)),
            f"{where[0][at] / RATE:.5g}", float(where[5][at]), _most(fits, 3), _most(fits, 4),
            Share(int(sum(one[6].sum() for one in fits)), sum(one[6].size for one in fits)),
        ))  # fmt: skip
    return Table(
        "Processes",
        (
            "process", "largest, % of the deviation", "largest, % of the half width", "99 of 100 curves below", "median curve",
            "largest at tau, s", "degrees of freedom there", "largest, % of the half width as printed", "of the thinned curve's own", "thinned intervals hold the truth",
        ),
        tuple(rows), "Of each curve the largest difference of all averaging times.",
    )  # fmt: skip


def _by_factor(found):
    rows = []
    for low, high in DECADES:
        for name, fits in found.items():
            inside = [(one[0] >= low) & (one[0] < high) for one in fits]
            values = [np.concatenate([one[k][i] for one, i in zip(fits, inside, strict=True)]) for k in (1, 2)]
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

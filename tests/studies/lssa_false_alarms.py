"""How often does a least-squares spectrum claim a line where there is none, and how small a line does it find?

4,096 samples at 100 Hz of white noise, of AR(1) with 0.9, and of a random walk; a constant and a trend are estimated with every
line, the noise's parameters are estimated, two frequencies to each of Fourier's. Counted is how many frequencies exceed the
99 % level of one frequency, and how many records hold one that exceeds the 99 % level of the record. Likewise for ``local``
noise over white noise and AR(1), which assumes neither; and for the tests whether noise is a random walk or AR(1).

Then a line of growing amplitude at a random frequency is added, 1,000 records each.

Command: ``nice python tests/studies/lssa_false_alarms.py`` (20,000 records of each: about 8 minutes in two processes).
Seeds: record r of noise k uses ``default_rng([k, r])``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # small products; threads only get in each other's way

import numpy as np
from scipy import signal
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification.lssa import (
    Constituents,
    Noise,
    adjust,
    is_autoregressive,
    is_random_walk,
    least_squares_spectrum,
    significance,
)

QUESTION = "False alarms and power of the least-squares spectrum"
RATE, SAMPLES, SETTLING = 100.0, 4096, 500
TIME = np.arange(SAMPLES) / RATE
KNOWN = Constituents("linear")
BLOCK = 250  #: records of one job
CASES = {
    "white": ("white", Noise()),
    "AR(1), 0.9": ("ar", Noise("autoregressive", 1)),
    "random walk": ("walk", Noise("random-walk")),
    "local, of white noise": ("white", Noise("local")),
    "local, of AR(1), 0.9": ("ar", Noise("local")),
}
#: amplitude of a line over the noise's level, as A²n/(4 sigma²): the exceedance it adds on the average
STRENGTHS = (4.0, 8.0, 12.0, 16.0, 24.0, 32.0)
LINES = 1000


def noise_of(kind, seed):
    rng = np.random.default_rng([("white", "ar", "walk").index(kind), seed])
    steps = rng.standard_normal(SAMPLES + SETTLING)
    if kind == "white":
        return steps[SETTLING:]
    if kind == "walk":
        return np.cumsum(steps[SETTLING:])
    return signal.lfilter([1], [1, -0.9], steps)[SETTLING:]


def false_alarms(case, first, last):
    """Return frequencies, those above their level, records, those with one above the record's."""
    kind, noise = CASES[case]
    counts = np.zeros(4, dtype=int)
    for seed in range(first, last):
        spectrum = least_squares_spectrum(adjust(TIME, noise_of(kind, seed), KNOWN, noise))
        found = significance(spectrum, 0.99)
        looked = found.exceedance > 0
        counts += (looked.sum(), (found.exceedance > found.one).sum(), 1, (found.exceedance > found.record).any())
    return counts


def refusals(first, last):
    """Return how often a true structure, and a wrong one, is refused at 1 %."""
    counts = np.zeros(5, dtype=int)
    for seed in range(first, last):
        white, coloured, walk = (adjust(TIME, noise_of(k, seed), KNOWN).residual for k in ("white", "ar", "walk"))
        counts += (
            1, not is_random_walk(walk).tenable, not is_autoregressive(coloured, 1).tenable,
            not is_random_walk(coloured).tenable, not is_autoregressive(white + walk * 0.1, 1).tenable,
        )  # fmt: skip
    return counts


def finds(case, strength, first, last):
    """Return how many records show an added line above the record's level, at its frequency."""
    kind, noise = CASES[case]
    counts = np.zeros(2, dtype=int)
    for seed in range(first, last):
        rng = np.random.default_rng([9, seed])
        f, phase = rng.uniform(1, 49), rng.uniform(-np.pi, np.pi)
        level = 1.0 if kind == "white" else abs(1 / (1 - 0.9 * np.exp(-2j * np.pi * f / RATE)))
        if kind == "walk":
            level = abs(1 / (1 - np.exp(-2j * np.pi * f / RATE)))
        size = np.sqrt(4 * strength / SAMPLES) * level
        series = noise_of(kind, 10**6 + seed) + size * np.cos(2 * np.pi * f * TIME + phase)
        spectrum = least_squares_spectrum(adjust(TIME, series, KNOWN, noise))
        found = significance(spectrum, 0.99)
        near = np.abs(spectrum.frequency - f) < 1.5 / TIME[-1]
        counts += (1, (found.exceedance[near] > found.record).any())
    return counts


def study(records=20_000, workers=2):
    """Return the tables."""
    blocks = [(first, min(first + BLOCK, records)) for first in range(0, records, BLOCK)]
    rows = []
    for case in CASES:
        looked, one, count, record = sum(over_records(false_alarms, [(case, *b) for b in blocks], workers))
        share = Share(int(record), int(count))
        good = 0.008 <= one / looked <= 0.012 and 0.008 <= share.value <= 0.012
        rows.append((case, int(count), f"{100 * one / looked:.3f} %", _per_cent(share), verdict(good)))
    alarms = Table(
        "False alarms at 99 %",
        ("noise", "records", "one frequency", "anywhere in the record", "0.8 to 1.2 %"),
        tuple(rows),
    )
    few = max(records // 10, 20)
    count, walk, ar, other, mixed = sum(
        over_records(refusals, [(a, min(a + BLOCK, few)) for a in range(0, few, BLOCK)], workers)
    )
    tests = Table(
        "Tests of the structure at 1 %: how often it is refused", ("noise", "hypothesis", "refused"),
        (
            ("random walk", "random walk", _per_cent(Share(int(walk), int(count)))),
            ("AR(1), 0.9", "AR(1)", _per_cent(Share(int(ar), int(count)))),
            ("AR(1), 0.9", "random walk", _per_cent(Share(int(other), int(count)))),
            ("white and a tenth of a random walk", "AR(1)", _per_cent(Share(int(mixed), int(count)))),
        ),
    )  # fmt: skip
    lines = min(LINES, records)
    rows = []
    for strength in STRENGTHS:
        cells = []
        for case in CASES:
            jobs = [(case, strength, a, min(a + BLOCK, lines)) for a in range(0, lines, BLOCK)]
            count, hits = sum(over_records(finds, jobs, workers))
            cells.append(f"{100 * hits / count:.0f} %")
        rows.append((f"{strength:g}", *cells))
    power = Table(
        "Records in which an added line is found", ("A²n/4 over the noise's level squared", *CASES), tuple(rows),
        f"{lines} records each; the level is that of the noise at the line's frequency; above the 99 % level of the record.",
    )  # fmt: skip
    return alarms, tests, power


def _per_cent(share):
    low, high = share.interval
    return f"{100 * share.value:.2f} % ({100 * low:.2f}–{100 * high:.2f})"


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 20_000, lambda n: f"seeds 0..{n - 1} of {len(CASES)} noises, {SAMPLES} samples each"
    )

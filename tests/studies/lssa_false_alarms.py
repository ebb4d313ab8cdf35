"""Count the false alarms of the least-squares spectrum, and measure its power to find a line.

Records are 4,096 samples at 100 Hz of white noise, of AR(1) noise of 0.9, and of a random walk. A constant and a trend are
estimated with every line, the parameters of the noise are estimated, and there are two frequencies to each Fourier frequency.
The study counts the frequencies that exceed the 99 % level of one frequency, and the records with a frequency that exceeds the
99 % level of the record. It does the same for ``local`` noise, which assumes no structure, on white noise and AR(1) noise. It
also counts how often the tests for a random walk and for AR(1) reject a true and a wrong structure.

For the power, a line of increasing amplitude at a random frequency is added to 1,000 records of each noise.

Command: ``nice python tests/studies/lssa_false_alarms.py`` (20,000 records of each: about 8 minutes in two processes).
Seeds: record r of noise k uses ``default_rng([k, r])``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrix products are small: threads would slow each other down

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
#: A²n/(4 sigma²) of a line of amplitude A, where sigma² is the noise's level: the mean exceedance that the line adds
STRENGTHS = (4.0, 8.0, 12.0, 16.0, 24.0, 32.0)
LINES = 1000


def noise_of(kind, seed):
    """Return (n,) samples of one kind of noise."""
    rng = np.random.default_rng([("white", "ar", "walk").index(kind), seed])
    steps = rng.standard_normal(SAMPLES + SETTLING)
    if kind == "white":
        return steps[SETTLING:]
    if kind == "walk":
        return np.cumsum(steps[SETTLING:])
    return signal.lfilter([1], [1, -0.9], steps)[SETTLING:]


def false_alarms(case, first, last):
    """Return the numbers of frequencies, of frequencies above their level, of records, of records with a frequency above the record's level."""
    kind, noise = CASES[case]
    counts = np.zeros(4, dtype=int)
    for seed in range(first, last):
        spectrum = least_squares_spectrum(adjust(TIME, noise_of(kind, seed), KNOWN, noise))
        levels = significance(spectrum, 0.99)
        tested = levels.exceedance > 0
        counts += (tested.sum(), (levels.exceedance > levels.one).sum(), 1, (levels.exceedance > levels.record).any())
    return counts


def refusals(first, last):
    """Return the number of records, and of rejections at 1 % of two true and two wrong structures."""
    counts = np.zeros(5, dtype=int)
    for seed in range(first, last):
        white, coloured, walk = (adjust(TIME, noise_of(k, seed), KNOWN).residual for k in ("white", "ar", "walk"))
        counts += (
            1, not is_random_walk(walk).tenable, not is_autoregressive(coloured, 1).tenable,
            not is_random_walk(coloured).tenable, not is_autoregressive(white + walk * 0.1, 1).tenable,
        )  # fmt: skip
    return counts


def finds(case, strength, first, last):
    """Return the numbers of records, and of records that show the added line above the record's level at its frequency."""
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
        levels = significance(spectrum, 0.99)
        near = np.abs(spectrum.frequency - f) < 1.5 / TIME[-1]
        counts += (1, (levels.exceedance[near] > levels.record).any())
    return counts


def study(records=20_000, workers=2):
    """Return the tables."""
    blocks = [(first, min(first + BLOCK, records)) for first in range(0, records, BLOCK)]
    rows = []
    for case in CASES:
        tested, above, count, record = sum(over_records(false_alarms, [(case, *b) for b in blocks], workers))
        share = Share(int(record), int(count))
        good = 0.008 <= above / tested <= 0.012 and 0.008 <= share.value <= 0.012
        rows.append((case, int(count), f"{100 * above / tested:.3f} %", share.text(2), verdict(good)))
    alarms = Table(
        "False alarms at the 99 % levels",
        (
            "noise", "records", "frequencies above their level", "records with a frequency above the record's level",
            "goal: 0.8 to 1.2 %",
        ),
        tuple(rows),
    )  # fmt: skip
    fewer = max(records // 10, 20)
    count, walk, ar, other, mixed = sum(
        over_records(refusals, [(a, min(a + BLOCK, fewer)) for a in range(0, fewer, BLOCK)], workers)
    )
    tests = Table(
        "Tests of the structure at 1 %", ("noise", "hypothesis", "rejected"),
        (
            ("random walk", "random walk", Share(int(walk), int(count)).text(2)),
            ("AR(1), 0.9", "AR(1)", Share(int(ar), int(count)).text(2)),
            ("AR(1), 0.9", "random walk", Share(int(other), int(count)).text(2)),
            ("white and a tenth of a random walk", "AR(1)", Share(int(mixed), int(count)).text(2)),
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
        "Share of records in which an added line is found", ("A²n/4 over the squared level of the noise", *CASES), tuple(rows),
        f"{lines} records of each noise. The level of the noise is that at the line's frequency. A line is found above the 99 % level of the record.",
    )  # fmt: skip
    return alarms, tests, power


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 20_000, lambda n: f"seeds 0..{n - 1} of {len(CASES)} noises, {SAMPLES} samples each"
    )

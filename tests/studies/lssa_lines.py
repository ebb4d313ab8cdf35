"""Do the intervals of a line hold its frequency, amplitude and phase, when samples are missing and levels jump?

4,096 samples at 100 Hz, 30 % of them taken out at random; a constant, a trend and five jumps at known times, white noise, and a
line A cos(2 pi f t + phi) of random frequency and phase. Likewise at uneven stamps, and with AR(1) noise of 0.6 without gaps.
A line is looked for as ``imuwb lssa`` does; its intervals are at 95 %. Weak lines are found where noise happens to help them,
so their amplitudes are too large where they are found: the strong ones are what the intervals are judged by.

Command: ``nice python tests/studies/lssa_lines.py`` (500 records of each: about 2 minutes in two processes).
Seeds: record r uses ``default_rng(r)``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy import signal
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification.lssa import Constituents, Noise, adjust, extract, least_squares_spectrum

QUESTION = "Lines of records with gaps, jumps and coloured noise"
RATE, SAMPLES = 100.0, 4096
CASES = {
    "30 % missing, white": (0.3, "missing", Noise()),
    "30 % missing, local": (0.3, "missing", Noise("local")),
    "30 % missing, white, weak": (0.15, "missing", Noise()),
    "uneven stamps, white": (0.3, "uneven", Noise()),
    "AR(1) of 0.6": (0.3, "coloured", Noise("autoregressive", 1)),
    "AR(1) of 0.6, 30 % missing": (0.4, "coloured, missing", Noise("autoregressive", 1)),
}
BLOCK = 25


def record(case, seed):
    """Return whether intervals held (frequency, amplitude, phase), None: not found; and how many lines more there were."""
    size, kind, noise = CASES[case]
    rng = np.random.default_rng(seed)
    t = np.arange(SAMPLES) / RATE
    x = rng.standard_normal(SAMPLES + 500)
    x = (signal.lfilter([1], [1, -0.6], x) if "coloured" in kind else x)[500:]
    if kind == "uneven":
        t = t + rng.uniform(-0.4, 0.4, SAMPLES) / RATE
    if "missing" in kind:
        kept = np.sort(rng.permutation(SAMPLES)[: round(0.7 * SAMPLES)])
        t, x = t[kept], x[kept]
    jumps = 4 + 7 * np.arange(5) + rng.uniform(-2, 2, 5)
    f, phase = rng.uniform(1, 45), rng.uniform(-np.pi, np.pi)
    x = x + 2 + 0.05 * t + sum(rng.normal(0, 3) * (t >= at) for at in jumps)
    x += size * np.cos(2 * np.pi * f * (t - t[0]) + phase)
    found = extract(least_squares_spectrum(adjust(t, x, Constituents("linear", tuple(jumps)), noise)), 0.99, 0.95).peaks
    own = [p for p in found if abs(p.frequency.value - f) < 2 / t[-1]]
    if not own:
        return None, len(found)
    peak = own[0]
    turned = (phase - peak.phase.value + np.pi) % (2 * np.pi) - np.pi + peak.phase.value
    held = f in peak.frequency, size in peak.amplitude, turned in peak.phase
    return held, len(found) - 1


def block(case, first, last):
    return [record(case, seed) for seed in range(first, last)]


def study(records=500, workers=2):
    """Return the table."""
    rows = []
    for case in CASES:
        jobs = [(case, a, min(a + BLOCK, records)) for a in range(0, records, BLOCK)]
        found = [one for part in over_records(block, jobs, workers) for one in part]
        held = np.array([h for h, _ in found if h is not None])
        shares = [Share(int(held[:, i].sum()), len(held)) for i in range(3)]
        whole = Share(int(held.sum()), held.size)
        rows.append(
            (case, len(held), *shares, whole, verdict(0.93 <= whole.value <= 0.97), sum(more for _, more in found))
        )
    headings = ("record", "line found", "frequency", "amplitude", "phase", "pooled", "93 to 97 %", "other lines")
    note = f"{records} records each. At the 99 % level of the record, about one in a hundred shows another line."
    return (Table("Inside their 95 % intervals", headings, tuple(rows), note),)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 500, lambda n: f"seeds 0..{n - 1}, {SAMPLES} samples")

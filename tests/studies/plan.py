"""Test whether ``imuwb plan`` predicts the widths that records reach.

A plan takes the widths of the 95 % intervals from the Fisher information of the likelihood, before any record exists. Here records
of known noise are simulated at 10 Hz and fitted, and the half width over the value is compared with the prediction. Goal: the mean
over 500 records is within 15 % of the prediction, for all terms that are wanted to 30 % or better. An interval that begins at 0 has
no width; its share is stated, and such terms are predicted at more than 30 %.

Command: ``python tests/studies/plan.py`` (500 records of each noise: about 2 minutes of one processor).
Seeds: record r of a noise uses ``SeedSequence(r)``.
"""

from __future__ import annotations

import math

import numpy as np
from study_report import GOALS, Mean, Share, Table, main, over_records, verdict

from imuwb.identification import fit_likelihood
from imuwb.identification.likelihood.planning import hours_needed, reached
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, Sum, WhiteNoise

QUESTION = "Predicted and reached widths of intervals"
RATE, LEVEL = 10.0, 0.95
#: noise -> processes, and the number of samples
NOISES = {
    "N": (Sum((WhiteNoise(1.0),)), 2**14),
    "N + B": (WhiteNoise(1.0) + FlickerNoise(0.5), 2**15),
    "Q + N + K": (Quantization(0.3) + WhiteNoise(1.0) + RandomWalk(0.05), 2**15),
    "N + B + K": (WhiteNoise(1.0) + FlickerNoise(0.5) + RandomWalk(0.1), 2**16),
}
CLOSE, SURE = 0.15, 0.3


def record(name, seed, part):
    """Return {letter: half width over the value, nan where the interval begins at 0} of one record."""
    processes, samples = NOISES[name]
    x = processes.sample(samples // part, 1 / RATE, np.random.default_rng(np.random.SeedSequence(seed)))
    found = fit_likelihood(x, 1 / RATE, level=LEVEL).coefficients
    return {
        letter: (c.upper - c.lower) / 2 / c.value if c.value and c.lower else math.nan
        for letter, c in found.items()
        if letter != "R"
    }


def study(records=500, workers=1, part=1):
    """Return a summary, and the widths of each term; ``part`` shortens the records."""
    rows, goals = [], []
    for name, (processes, samples) in NOISES.items():
        hours = samples // part / RATE / 3600
        widths = over_records(record, [(name, seed, part) for seed in range(records)], workers)
        for letter, reach in reached(processes, RATE, hours, LEVEL).items():
            if reach.value is None:
                continue
            own = np.array([width[letter] for width in widths])
            known = own[np.isfinite(own)]
            mean = (
                Mean(float(known.mean()), float(known.std() / np.sqrt(known.size)))
                if known.size
                else Mean(math.nan, 0.0)
            )
            ratio = mean.value / reach.width
            rows.append((name, samples // part, letter, reach.width, mean, ratio, Share(int(own.size - known.size), own.size),
                         f"{hours_needed(processes, letter, reach.width, RATE, LEVEL) or math.nan:.3g}"))  # fmt: skip
            if reach.width <= SURE:
                goals.append((
                    f"{name}, {letter}: reached over predicted", f"1 ± {CLOSE}", f"{ratio:.3f}", verdict(abs(ratio - 1) <= CLOSE),
                ))  # fmt: skip
    note = (
        "Half of the 95 % interval over the value. Reached: mean and standard error over the records whose interval does not begin at 0. "
        "Needs: the length (h) that a plan states for the predicted width; it is that of the record."
    )
    headings = (
        "noise",
        "samples",
        "term",
        "predicted",
        "reached",
        "reached over predicted",
        "interval begins at 0",
        "needs (h)",
    )
    return Table("Goals", GOALS, tuple(goals)), Table("Widths", headings, tuple(rows), note)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 500, lambda n: f"seeds 0..{n - 1}, n = {n} records of each noise, {RATE:g} Hz")

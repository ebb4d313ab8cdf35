"""Compare the samples of each process with the Allan variance and the spectrum that the process states.

For every process: the overlapping Allan variance of its samples at octaves m and at n/10, and their Welch spectrum in
octave bands. Each is divided by the value that the process states, and averaged over records. The Allan variance is
calculated here from its definition, not by ``imuwb.identification``. The stated density is two-sided and Welch's
estimate is one-sided, so Welch's estimate is halved.

Goal for flicker: an Allan deviation that is flat within 1 % from m = 1 to n/10, with standard errors below 0.3 %.

Command: ``python tests/studies/samples_follow_processes.py`` (2000 records, 10 000 of flicker: 1 to 2 minutes).
Seeds: record r of process p in the list below uses ``SeedSequence([p, r])``.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy import signal
from study_report import Mean, Table, main, over_records

from imuwb.stochastic import (
    Autoregressive,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    WhiteNoise,
)

QUESTION = "Samples of processes against the stated Allan variance and spectrum"
N, DT, SEGMENT = 16384, 0.01, 4096
FLICKER_TIMES = 5  #: times as many records of flicker, whose long averages scatter most and have the strictest goal
BLOCK = 50  #: records of one job
#: Bins of a segment at which bands begin. Below bin 32, the width of the window distorts a 1/f² spectrum by 1/k².
BANDS = (32, 64, 128, 256, 512, 1024, SEGMENT // 2)
FACTORS = np.array([*2 ** np.arange(int(np.log2(N / 10)) + 1), N // 10])
#: AR(3): poles at 0.9 and 0.5 ± 0.4 i
PROCESSES = {
    "white noise": WhiteNoise(0.3),
    "quantization": Quantization(0.02),
    "flicker": FlickerNoise(0.5),
    "random walk": RandomWalk(0.2),
    "Gauss-Markov, Tc = 100 dt": GaussMarkov(0.7, 100 * DT),
    "Gauss-Markov, Tc = dt": GaussMarkov(0.7, DT),
    "AR(1), pole 0.95": Autoregressive((-0.95,), 0.1, DT),
    "AR(3)": Autoregressive(tuple(np.poly([0.9, 0.5 + 0.4j, 0.5 - 0.4j]).real[1:]), 0.1, DT),
    "sinusoid, f dt = 1/30": Sinusoid(0.4, 1 / (30 * DT)),
    "rate ramp": RateRamp(0.01),
}
#: A sinusoid is a line, not a density, and a ramp has no density.
WITHOUT_DENSITY = (Sinusoid, RateRamp)


def allan_variance(x, m):
    """Return the overlapping Allan variance of each row of x, from its definition."""
    theta = np.concatenate([np.zeros((len(x), 1)), np.cumsum(x - x.mean(axis=1, keepdims=True), axis=1)], axis=1)
    z = theta[:, 2 * m :] - 2 * theta[:, m:-m] + theta[:, : -2 * m]
    return (z**2).mean(axis=1) / (2 * m**2)


def ratios(number, first, count):
    """Return (Allan variances, band densities) of ``count`` records, each divided by the stated value."""
    process = list(PROCESSES.values())[number]
    streams = [np.random.default_rng(np.random.SeedSequence([number, first + r])) for r in range(count)]
    x = np.stack([process.sample(N, DT, rng) for rng in streams])
    stated = process.allan_variance(FACTORS * DT, DT)
    allan = np.stack([allan_variance(x, int(m)) for m in FACTORS], axis=1) / stated
    if isinstance(process, WITHOUT_DENSITY):
        return allan, np.empty((count, 0))
    f, one_sided = signal.welch(x, 1 / DT, "hann", SEGMENT, detrend="constant")
    density = one_sided[:, 1:-1] / 2 / process.power_spectral_density(f[1:-1], DT)
    bands = [density[:, a - 1 : b - 1].mean(axis=1) for a, b in itertools.pairwise(BANDS)]
    return allan, np.stack(bands, axis=1)


def study(records=2000, workers=2):
    """Return the tables: a summary, flicker, Allan variances, densities."""
    allan, density = [], []
    for number, (name, process) in enumerate(PROCESSES.items()):
        total = records * FLICKER_TIMES if isinstance(process, FlickerNoise) else records
        jobs = [(number, first, min(BLOCK, total - first)) for first in range(0, total, BLOCK)]
        parts = over_records(ratios, jobs, workers)
        allan.append((name, total, *_means(np.concatenate([part[0] for part in parts]))))
        if parts[0][1].size:
            density.append((name, total, *_means(np.concatenate([part[1] for part in parts]))))
    note = "Mean over the records ± its standard error; the goal is 1. The points of one row are correlated."
    bands = [f"{a / SEGMENT:.4g}–{b / SEGMENT:.4g}" for a, b in itertools.pairwise(BANDS)]
    of_factors = ("process", "records", *(f"m = {m}" for m in FACTORS))
    of_bands = ("process", "records", *(f"f dt = {band}" for band in bands))
    return (
        _flicker(allan),
        _farthest(allan, density),
        Table("Allan variance of the samples / stated Allan variance", of_factors, tuple(allan), note),
        Table("Density, one-sided Welch estimate / 2 / stated density", of_bands, tuple(density), note),
    )


def _means(values):
    return [Mean(float(v.mean()), float(v.std(ddof=1) / np.sqrt(v.size))) for v in values.T]


def _flicker(allan):
    """Return the table of the deviation, whose relative error is half that of the variance."""
    name, records, *means = next(row for row in allan if row[0] == "flicker")
    deviation = [Mean(mean.value**0.5, mean.error / 2 / mean.value**0.5) for mean in means]
    largest = max(abs(d.value - 1) for d in deviation)
    rows = (
        ("largest difference from flat, m = 1 ... n/10", "below 1 %", f"{100 * largest:.2f} %"),
        ("largest standard error", "below 0.3 %", f"{100 * max(d.error for d in deviation):.2f} %"),
        *((f"deviation / 0.664 B at m = {m}", "", d) for m, d in zip(FACTORS, deviation, strict=True)),
    )
    note = f"{records} records of {N} samples."
    return Table(f"Allan deviation of {name}", ("figure", "goal", "result"), rows, note)


def _farthest(allan, density):
    """Return the largest difference of each process, in standard errors."""
    rows = []
    spectra = {row[0]: row[2:] for row in density}
    for name, _, *means in allan:
        far = [
            f"{max((m.off for m in part), key=abs):+.1f}" if part else "–" for part in (means, spectra.get(name, ()))
        ]
        rows.append((name, *far))
    points = len(allan) * len(FACTORS) + len(density) * (len(BANDS) - 1)
    note = f"Unit: standard errors. If all {points} points are right, the largest difference is expected near 3."
    return Table("Largest differences", ("process", "Allan variance", "density"), tuple(rows), note)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 2000,
        lambda n: f"seeds (p, 0..{n - 1}), flicker (2, 0..{FLICKER_TIMES * n - 1}); n = {N} samples of {DT} s each",
    )  # fmt: skip

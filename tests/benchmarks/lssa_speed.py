"""How fast is a least-squares spectrum? CPU seconds of 1.08 M samples at half a million frequencies, against astropy.

White noise of three hours at 100 Hz with weights; a constant and a trend are estimated with every line, the stamps even and
uneven. The peer is ``astropy.timeseries.LombScargle``, method ``fast``, which estimates a constant with every line and weighs
likewise, on the same grid. At 50 random frequencies ours is compared with least squares by the formula itself.

Least of three runs of ours, one of the peer; finufft's first call is not counted.

Command: ``python tests/benchmarks/lssa_speed.py`` (about two minutes). Seed: 0.
"""

from __future__ import annotations

import os
import platform
import time
from importlib.metadata import version

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from astropy.timeseries import LombScargle

from imuwb.identification.lssa import Constituents, Noise, adjust, extract, least_squares_spectrum

SAMPLES, RATE = 1_080_000, 100.0
GOAL, SHARE = 1.5, 8


def spent(work, runs):
    """Return the least CPU time of some runs, and what the last returned."""
    least, found = np.inf, None
    for _ in range(runs):
        begin = time.process_time()
        found = work()
        least = min(least, time.process_time() - begin)
    return least, found


def direct(time_, values, weights, frequency):
    """Return the share that a line takes up, by the formula."""
    root = np.sqrt(weights)
    even = 2 * time_ / time_[-1] - 1
    phase = 2 * np.pi * frequency * time_
    known = np.stack([np.ones_like(time_), even], axis=1) * root[:, None]
    line = np.stack([np.cos(phase), np.sin(phase)], axis=1) * root[:, None]
    basis = np.linalg.qr(known)[0]
    left, rest = line - basis @ (basis.T @ line), values * root
    rest = rest - basis @ (basis.T @ rest)
    share = np.linalg.lstsq(left, rest, rcond=None)[0]
    return rest @ (left @ share) / (rest @ rest)


def main():
    """Print the table."""
    rng = np.random.default_rng(0)
    even = np.arange(SAMPLES) / RATE
    values, weights = rng.standard_normal(SAMPLES) + 1 + 1e-4 * even, rng.uniform(0.5, 2, SAMPLES)
    names = ("numpy", "finufft", "astropy")
    print(
        f"Python {platform.python_version()}, imuwb {version('imuwb')}, "
        + ", ".join(f"{n} {version(n)}" for n in names)
    )
    print(
        "\n| stamps | frequencies | CPU s | astropy, CPU s | ratio | furthest from the formula | goal |\n| "
        + "--- | " * 7
    )
    for name, stamps in (("even", even), ("uneven", even + rng.uniform(-2e-3, 2e-3, SAMPLES) + 2e-3)):

        def ours(stamps=stamps):
            return least_squares_spectrum(
                adjust(stamps, values, Constituents("linear"), weights=weights), oversampling=1
            )

        ours()
        own, spectrum = spent(ours, 3)
        peer, _ = spent(
            lambda stamps=stamps, f=spectrum.frequency: LombScargle(stamps, values, 1 / np.sqrt(weights)).power(f, method="fast", assume_regular_frequency=True), 1
        )  # fmt: skip
        places = rng.integers(0, spectrum.frequency.size, 50)
        off = max(
            abs(spectrum.share[k] / direct(stamps - stamps[0], values, weights, spectrum.frequency[k]) - 1)
            for k in places
        )
        print(
            f"| {name} | {spectrum.frequency.size} | {own:.2f} | {peer:.1f} | {peer / own:.1f} | {off:.1e} | "
            f"at most {GOAL} s, {SHARE} times, 1e-6 |"
        )
    whole, _ = spent(lambda: extract(least_squares_spectrum(adjust(even, values, Constituents(), Noise("local")))), 1)
    print(f"\nWith local significance, two frequencies to each of Fourier's, and lines looked for: {whole:.1f} s")


if __name__ == "__main__":
    main()

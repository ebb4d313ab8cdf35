"""Measure the CPU time of least-squares spectra, imuwb against astropy, and of their transform for uneven samples, imuwb against finufft.

The samples are three hours at 100 Hz of white noise with weights, with even and with uneven stamps; the spectrum has half a million
frequencies. imuwb estimates a constant and a trend with every line. The peer is ``astropy.timeseries.LombScargle`` with the method
``fast``; it uses the same weights and estimates a constant with every line. At 50 random frequencies, the spectrum of imuwb is
compared with least squares by the formula.

The transform is that of the same samples, one and six series, at half a million frequencies; finufft has one thread, an accuracy of 1e-11,
and each two series as one complex series. At 20 random frequencies, both are compared with the sum as it is written.

Figures are CPU seconds (``time.process_time``: all threads), of imuwb and finufft the least of three runs, of astropy one run. The first
call is not counted.

Command: ``python tests/benchmarks/lssa_speed.py`` (about two minutes; needs ``pip install -e ".[bench]" astropy``). Seed: 0.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from astropy.timeseries import LombScargle
from measure import cpu, timed, versions

from imuwb.identification.lssa import Constituents, Noise, adjust, extract, least_squares_spectrum
from imuwb.identification.lssa.uneven import uneven_sums

SAMPLES, RATE = 1_080_000, 100.0
GOAL, RATIO, PLACES = 1.5, 8, 50


def direct(time, values, weights, frequency):
    """Return the share of the sum of squares that a line explains, by the formula of least squares."""
    root = np.sqrt(weights)
    even = 2 * time / time[-1] - 1
    phase = 2 * np.pi * frequency * time
    known = np.stack([np.ones_like(time), even], axis=1) * root[:, None]
    line = np.stack([np.cos(phase), np.sin(phase)], axis=1) * root[:, None]
    basis = np.linalg.qr(known)[0]
    left, rest = line - basis @ (basis.T @ line), values * root
    rest = rest - basis @ (basis.T @ rest)
    share = np.linalg.lstsq(left, rest, rcond=None)[0]
    return rest @ (left @ share) / (rest @ rest)


def ours(stamps, values, weights):
    """Return the spectrum by imuwb."""
    return least_squares_spectrum(adjust(stamps, values, Constituents("linear"), weights=weights), oversampling=1)


def peer(stamps, values, weights, frequency):
    """Return the power by astropy at the same frequencies."""
    lomb_scargle = LombScargle(stamps, values, 1 / np.sqrt(weights))
    return lomb_scargle.power(frequency, method="fast", assume_regular_frequency=True)


def row(name, stamps, values, weights, rng):
    """Return the row of one series: CPU times, their ratio, and the largest difference from the formula."""
    ours(stamps, values, weights)  # the first call
    own, spectrum = timed(lambda: ours(stamps, values, weights))
    theirs = cpu(lambda: peer(stamps, values, weights, spectrum.frequency), 1)
    places = rng.integers(0, spectrum.frequency.size, PLACES)
    exact = [direct(stamps - stamps[0], values, weights, spectrum.frequency[k]) for k in places]
    off = np.abs(spectrum.share[places] / exact - 1).max()
    return (
        f"| {name} | {spectrum.frequency.size:,} | {own:.2f} s | {theirs:.1f} s | **{theirs / own:.1f}** | {off:.1e} | "
        f"at most {GOAL} s, at least {RATIO} times as fast, at most 1e-6 |"
    )


def finufft(turn, strengths, count):
    """Return the sums by finufft."""
    from finufft import nufft1d1

    pairs = np.zeros((-(-len(strengths) // 2), turn.size), np.complex128)
    pairs.real, pairs.imag[: len(strengths) // 2] = strengths[0::2], strengths[1::2]
    phase = 2 * np.pi * turn
    phase = np.remainder(phase + np.pi, 2 * np.pi) - np.pi
    modes = nufft1d1(phase, pairs, 2 * count + 1, eps=1e-11, isign=1, nthreads=1).reshape(len(pairs), -1)
    above, below = modes[:, count + 1 :], modes[:, count - 1 :: -1].conj()
    return np.stack([0.5 * (above + below), -0.5j * (above - below)], axis=1).reshape(-1, count)[: len(strengths)]


def transform_row(turn, count, series, rng):
    """Return the row of a transform: CPU times, their ratio, and the largest differences from the sum."""
    strengths = rng.standard_normal((series, turn.size))
    both = [lambda f=f: f(turn, strengths, count) for f in (uneven_sums, finufft)]
    for work in both:
        work()
    (own, found), (theirs, other) = map(timed, both)
    places = rng.integers(1, count, 20)
    exact = np.array([strengths[0] @ np.exp(2j * np.pi * ((k * turn) % 1)) for k in places])
    off = [np.abs(result[0, places - 1] - exact).max() / np.sqrt(turn.size) for result in (found, other)]
    return f"| {series} | {own:.3f} s | {theirs:.3f} s | **{theirs / own:.2f}** | {off[0]:.1e} | {off[1]:.1e} | at least 1 |"


def main():
    """Print the table."""
    rng = np.random.default_rng(0)
    even = np.arange(SAMPLES) / RATE
    values, weights = rng.standard_normal(SAMPLES) + 1 + 1e-4 * even, rng.uniform(0.5, 2, SAMPLES)
    print(f"{versions('imuwb', 'numpy', 'finufft', 'astropy')}; {SAMPLES:,} samples\n")
    print(
        "| stamps | frequencies | imuwb, CPU | astropy, CPU | astropy / imuwb | largest relative difference from the formula | goals |"
    )
    print("|" + " --- |" * 7)
    for name, stamps in (("even", even), ("uneven", even + rng.uniform(-2e-3, 2e-3, SAMPLES) + 2e-3)):
        print(row(name, stamps, values, weights, rng))
    print("\n| series | imuwb, CPU | finufft, CPU | finufft / imuwb | imuwb, error | finufft, error | goal |")
    print("|" + " --- |" * 7)
    turn = (even + rng.uniform(-2e-3, 2e-3, SAMPLES) + 2e-3) * RATE / SAMPLES
    for series in (1, 2, 6):
        print(transform_row(turn, SAMPLES // 2, series, rng))
    whole = cpu(lambda: extract(least_squares_spectrum(adjust(even, values, Constituents(), Noise("local")))), 1)
    print(f"\nWith local noise, two frequencies to each Fourier frequency, and the search for lines: {whole:.1f} s.")


if __name__ == "__main__":
    main()

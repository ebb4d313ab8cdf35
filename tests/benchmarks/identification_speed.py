"""Measure the CPU time of analyses and filters: imuwb against named peers, on the same samples.

Thinned Allan deviations (7 h at 100 Hz of the preset 3dm-gx3-25, six axes, 90 averaging times) are compared with
``allantools.oadev`` at the same times; Burg's models of orders 1 to 20 (1.08 million samples) with ``statsmodels``; SURE
denoising (db4, 8 levels, 2.52 million samples) with the forward and inverse transform of ``pywt``, and with ``skimage``; a
Kaiser low-pass (14 to 18 Hz, 100 dB, 2.52 million samples) with ``scipy.signal.lfilter``. Figures are CPU seconds
(``time.process_time``: all threads), the least of three runs, with compiled code from the cache. A part and its peer share a
process.

Command: ``python tests/benchmarks/identification_speed.py`` (about two minutes; needs ``pip install -e ".[bench]" statsmodels``,
and ``scikit-image`` for the row of skimage). Seed: 0.
"""

from __future__ import annotations

import tracemalloc

import numpy as np
from allan_speed import HOURS, RATE, simulated, times
from measure import cpu, resident, run_parts, versions

ORDERS, BURG_SAMPLES, LEVEL = 20, 1_080_000, 8
PACKAGES = ("imuwb", "numpy", "numba", "allantools", "statsmodels", "PyWavelets", "scikit-image", "scipy")


def curves(samples):
    """Return the CPU times of thinned curves of six axes, of their intervals alone, and of allantools at the same times."""
    import allantools
    from scipy import stats

    from imuwb.identification import allan, equivalent_degrees_of_freedom

    name, _ = times(samples.shape[1])

    def thinned():
        equivalent_degrees_of_freedom.cache_clear()
        return [allan(axis, 1 / RATE, name, fast=True) for axis in samples]

    def intervals():
        equivalent_degrees_of_freedom.cache_clear()
        for curve in results:
            pairs = zip(curve.factor, curve.noise_type, strict=True)
            edf = np.array([equivalent_degrees_of_freedom(int(m), curve.n, int(alpha)) for m, alpha in pairs])
            stats.chi2.ppf(0.975, edf), stats.chi2.ppf(0.025, edf)

    results = thinned()
    tau = results[0].averaging_time
    return {
        "times": name, "points": tau.size, "thinned": cpu(thinned), "intervals": cpu(intervals),
        "exact": cpu(lambda: [allan(axis, 1 / RATE, tau) for axis in samples]),
        "peer": cpu(lambda: [allantools.oadev(x, rate=RATE, data_type="freq", taus=tau) for x in samples]),
    }  # fmt: skip


def memory(samples):
    """Return the peak of memory above the input for thinned curves, by tracemalloc, and the growth of the process, bytes."""
    from imuwb.identification import allan

    name, _ = times(samples.shape[1])
    allan(samples[0, :1000], 1 / RATE, fast=True)
    before = resident()
    for axis in samples:
        allan(axis, 1 / RATE, name, fast=True)
    grown = resident() - before
    tracemalloc.start()
    for axis in samples:
        allan(axis, 1 / RATE, name, fast=True)
    return {"peak": tracemalloc.get_traced_memory()[1], "resident": grown}


def models(samples):
    """Return the CPU times of Burg's models of orders 1 to 20, and of statsmodels' model of order 20."""
    from statsmodels.regression.linear_model import burg as peer

    from imuwb.identification import burg, fit_autoregressive

    x = samples[3, :BURG_SAMPLES].copy()
    mine, (theirs, _) = burg(x, ORDERS), peer(x, order=ORDERS)
    return {
        "burg": cpu(lambda: burg(x, ORDERS)),
        "fit": cpu(lambda: fit_autoregressive(x, 1 / RATE, ORDERS)),
        "peer": cpu(lambda: peer(x, order=ORDERS)),
        "apart": float(np.abs(mine.alpha[-1] + theirs).max()),
    }


def denoising(samples):
    """Return the CPU times of SURE denoising (db4, 8 levels), of pywt's transform and of skimage."""
    import pywt

    from imuwb.conditioning import denoise

    x = samples[0].copy()

    def transform():
        return pywt.waverec(pywt.wavedec(x, "db4", level=LEVEL), "db4")

    denoise(x, LEVEL)
    spent = {"sure": cpu(lambda: denoise(x, LEVEL)), "peer": cpu(transform), "image": None}
    try:
        from skimage.restoration import denoise_wavelet
    except ImportError:
        return spent
    options = {"wavelet": "db4", "wavelet_levels": LEVEL, "method": "BayesShrink", "rescale_sigma": False}
    spent["image"] = cpu(lambda: denoise_wavelet(x, **options))
    return spent


def filtering(samples):
    """Return the CPU times of a Kaiser low-pass, without the samples at both ends, and of scipy."""
    from scipy import signal

    from imuwb.conditioning import design_kaiser, filtered

    x, taps = samples[0].copy(), design_kaiser(RATE, 14.0, 18.0, 100.0).taps
    apart = filtered(x, taps) - signal.lfilter(taps, 1.0, x)[taps.size - 1 :]
    return {
        "taps": taps.size, "filtered": cpu(lambda: filtered(x, taps)), "peer": cpu(lambda: signal.lfilter(taps, 1.0, x)),
        "apart": float(np.abs(apart).max() / np.std(x)),
    }  # fmt: skip


PARTS = {"curves": curves, "memory": memory, "models": models, "denoising": denoising, "filtering": filtering}


def table(measured):
    """Return the Markdown table: figures, goals, and ratios of peers."""
    c, m, b, d, k = (measured[part] for part in PARTS)
    rows = [
        ("allan, thinned, 6 axes", f"{c['thinned']:.3f} s", "", ""),
        ("  allantools.oadev", f"{c['peer']:.2f} s", "at least 40", f"**{c['peer'] / c['thinned']:.0f}**"),
        ("  allan, exact, at the same times", f"{c['exact']:.3f} s", "", f"{c['exact'] / c['thinned']:.1f}"),
        ("  the intervals of all curves alone", f"{c['intervals']:.3f} s", "at most 0.5 s", ""),
        ("  peak memory above the input", f"{m['peak'] / 1e6:.0f} MB", "at most 40 MB", ""),
        ("  growth of the process", f"{m['resident'] / 1e6:.0f} MB", "", ""),
        (f"burg, orders 1 to {ORDERS}", f"{b['burg']:.3f} s", "at most 0.1 s", ""),
        ("  fit_autoregressive, with errors and tests", f"{b['fit']:.3f} s", "", ""),
        (f"  statsmodels burg, order {ORDERS} only", f"{b['peer']:.3f} s", "", f"**{b['peer'] / b['burg']:.1f}**"),
        ("  largest difference of the coefficients", f"{b['apart']:.1e}", "", ""),
        (f"denoise, SURE, db4, {LEVEL} levels", f"{d['sure']:.3f} s", "at most 0.25 s", ""),
        ("  pywt, forward and inverse transform only", f"{d['peer']:.3f} s", "", f"**{d['peer'] / d['sure']:.2f}**"),
    ]
    if d["image"] is not None:
        rows.append(
            ("  skimage denoise_wavelet, BayesShrink", f"{d['image']:.3f} s", "", f"**{d['image'] / d['sure']:.2f}**")
        )
    rows += [
        (f"filtered, Kaiser, {k['taps']} taps", f"{k['filtered']:.3f} s", "at most 0.1 s", ""),
        ("  scipy.signal.lfilter", f"{k['peer']:.3f} s", "", f"**{k['peer'] / k['filtered']:.1f}**"),
        ("  largest difference over the samples' standard deviation", f"{k['apart']:.1e}", "", ""),
    ]
    head = (
        f"{versions(*PACKAGES)}; "
        f"{HOURS:g} h x 6 axes at {RATE:g} Hz, {c['points']} averaging times (`{c['times']}`, thinned)"
    )
    lines = ["| measured | CPU time, memory or difference | goal | peer / imuwb |", "| --- | --- | --- | --- |"]
    return "\n".join((head, "", *lines, *(f"| {' | '.join(row)} |" for row in rows)))


if __name__ == "__main__":
    run_parts(__file__, "CPU time of analyses", PARTS, simulated, table)

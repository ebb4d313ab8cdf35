"""How long do the analyses behind an Allan curve take? imuwb against named peers, on the same samples.

Thinned Allan deviations (7 h at 100 Hz of the preset 3dm-gx3-25, six axes, 90 averaging times) against
``allantools.oadev`` at the same times; Burg's models of orders 1 to 20 (1.08 million samples) against ``statsmodels``;
SURE denoising (db4, 8 levels, 2.52 million samples) against the bare transform of ``pywt`` there and back, and
``skimage``; a Kaiser low-pass (14 to 18 Hz, 100 dB, 2.52 million samples) against ``scipy.signal.lfilter``. CPU seconds
(``time.process_time``: all threads), least of three runs, compiled code from the cache. Each part and its peer share a process.

Command: ``python tests/benchmarks/identification_speed.py`` (about two minutes; needs ``pip install -e ".[bench]" statsmodels``;
with ``scikit-image`` its row too). Seed: 0.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import tracemalloc
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from allan_speed import HOURS, RATE, cpu, simulated, times

ORDERS, BURG_SAMPLES, LEVEL = 20, 1_080_000, 8
PACKAGES = ("imuwb", "numpy", "numba", "allantools", "statsmodels", "PyWavelets", "scikit-image", "scipy")


def main():
    """Write the samples, run every part in a process of its own, print the table."""
    parser = argparse.ArgumentParser(description="CPU time of analyses")
    parser.add_argument("--part", choices=("simulate", *PARTS), help=argparse.SUPPRESS)
    parser.add_argument("--samples", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.part == "simulate":
        np.save(given.samples, simulated())
        return
    if given.part:
        print(json.dumps(PARTS[given.part](np.load(given.samples))))
        return
    with tempfile.TemporaryDirectory() as folder:
        samples = Path(folder) / "samples.npy"
        # A process inherits its parent's largest memory, so this one stays small.
        subprocess.run([sys.executable, __file__, "--part", "simulate", "--samples", str(samples)], check=True)
        measured = {}
        for part in PARTS:
            print(f"{part} ...", file=sys.stderr)
            command = [sys.executable, __file__, "--part", part, "--samples", str(samples)]
            ended = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            measured[part] = json.loads(ended.stdout)
    print(table(measured))


def curves(samples):
    """Thinned curves of six axes, their intervals alone, and allantools at the same times."""
    import allantools
    from scipy import stats

    from imuwb.identification import allan, equivalent_degrees_of_freedom

    name, _ = times(samples.shape[1])

    def thinned():
        equivalent_degrees_of_freedom.cache_clear()
        return [allan(axis, 1 / RATE, name, fast=True) for axis in samples]

    def intervals():
        equivalent_degrees_of_freedom.cache_clear()
        for curve in found:
            pairs = zip(curve.factor, curve.noise_type, strict=True)
            edf = np.array([equivalent_degrees_of_freedom(int(m), curve.n, int(alpha)) for m, alpha in pairs])
            stats.chi2.ppf(0.975, edf), stats.chi2.ppf(0.025, edf)

    found = thinned()
    tau = found[0].averaging_time
    return {
        "times": name, "points": tau.size, "thinned": cpu(thinned), "intervals": cpu(intervals),
        "exact": cpu(lambda: [allan(axis, 1 / RATE, tau) for axis in samples]),
        "peer": cpu(lambda: [allantools.oadev(x, rate=RATE, data_type="freq", taus=tau) for x in samples]),
    }  # fmt: skip


def memory(samples):
    """Peak of what a thinned curve allocates above the input, as tracemalloc counts numpy's arrays, and growth of the process."""
    import resource

    from imuwb.identification import allan

    name, _ = times(samples.shape[1])
    allan(samples[0, :1000], 1 / RATE, fast=True)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for axis in samples:
        allan(axis, 1 / RATE, name, fast=True)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    tracemalloc.start()
    for axis in samples:
        allan(axis, 1 / RATE, name, fast=True)
    # ru_maxrss counts kilobytes on Linux, bytes on macOS
    return {
        "peak": tracemalloc.get_traced_memory()[1],
        "resident": grown * (1 if sys.platform == "darwin" else 1024),
    }


def models(samples):
    """Burg's models of orders 1 to 20; statsmodels computes that of order 20."""
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
    """SURE, db4, 8 levels."""
    import pywt

    from imuwb.conditioning import denoise

    x = samples[0].copy()

    def there_and_back():
        return pywt.waverec(pywt.wavedec(x, "db4", level=LEVEL), "db4")

    denoise(x, LEVEL)
    found = {"sure": cpu(lambda: denoise(x, LEVEL)), "peer": cpu(there_and_back), "image": None}
    try:
        from skimage.restoration import denoise_wavelet
    except ImportError:
        return found
    options = {"wavelet": "db4", "wavelet_levels": LEVEL, "method": "BayesShrink", "rescale_sigma": False}
    found["image"] = cpu(lambda: denoise_wavelet(x, **options))
    return found


def filtering(samples):
    """A Kaiser low-pass, where it lies on samples only."""
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
    """Return the Markdown table: figure, goal, and the peer over ours."""
    c, m, b, d, k = (measured[part] for part in PARTS)
    rows = [
        ("allan, thinned, 6 axes", f"{c['thinned']:.3f} s", "", ""),
        ("  allantools.oadev", f"{c['peer']:.2f} s", "at least 40", f"**{c['peer'] / c['thinned']:.0f}**"),
        ("  allan, exact, at the same times", f"{c['exact']:.3f} s", "", f"{c['exact'] / c['thinned']:.1f}"),
        ("  all intervals", f"{c['intervals']:.3f} s", "at most 0.5 s", ""),
        ("  peak above the input", f"{m['peak'] / 1e6:.0f} MB", "at most 40 MB", ""),
        ("  growth of the process", f"{m['resident'] / 1e6:.0f} MB", "", ""),
        (f"burg, orders 1 to {ORDERS}", f"{b['burg']:.3f} s", "at most 0.1 s", ""),
        ("  fit_autoregressive, with errors and tests", f"{b['fit']:.3f} s", "", ""),
        (f"  statsmodels burg, order {ORDERS} only", f"{b['peer']:.3f} s", "", f"**{b['peer'] / b['burg']:.1f}**"),
        ("  coefficients apart", f"{b['apart']:.1e}", "", ""),
        (f"denoise, SURE, db4, {LEVEL} levels", f"{d['sure']:.3f} s", "at most 0.25 s", ""),
        ("  pywt there and back, nothing between", f"{d['peer']:.3f} s", "", f"**{d['peer'] / d['sure']:.2f}**"),
    ]
    if d["image"] is not None:
        rows.append(
            ("  skimage denoise_wavelet, Bayes", f"{d['image']:.3f} s", "", f"**{d['image'] / d['sure']:.2f}**")
        )
    rows += [
        (f"filtered, Kaiser, {k['taps']} taps", f"{k['filtered']:.3f} s", "at most 0.1 s", ""),
        ("  scipy.signal.lfilter", f"{k['peer']:.3f} s", "", f"**{k['peer'] / k['filtered']:.1f}**"),
        ("  apart, of the samples' standard deviation", f"{k['apart']:.1e}", "", ""),
    ]
    head = (
        f"Python {platform.python_version()}, {', '.join(filter(None, map(_installed, PACKAGES)))}; {os.cpu_count()} processors; "
        f"{HOURS:g} h x 6 axes at {RATE:g} Hz, {c['points']} averaging times (`{c['times']}`, thinned)"
    )
    lines = ["| what | CPU | goal | peer / ours |", "| --- | --- | --- | --- |"]
    return "\n".join((head, "", *lines, *(f"| {' | '.join(row)} |" for row in rows)))


def _installed(package):
    try:
        return f"{package} {version(package)}"
    except PackageNotFoundError:
        return None


if __name__ == "__main__":
    main()

"""Measure the CPU time of Allan curves: imuwb against allantools, on the same samples and averaging times.

The samples are 7 h at 100 Hz of the preset 3dm-gx3-25: six axes of 2.52 million samples. There are 90 averaging times, spread
evenly on a log axis up to half the record. Figures are CPU seconds (``time.process_time``: all threads), the least of three runs;
the parts with an empty cache run once. Each part runs in a process of its own.

Command: ``python tests/benchmarks/allan_speed.py`` (about a minute; needs ``pip install -e ".[bench]"``).
Seed: 0.
"""

from __future__ import annotations

import time
import tracemalloc

import numpy as np
from measure import cpu, resident, run_parts, versions

HOURS, RATE, POINTS = 7.0, 100.0, 90


def simulated():
    """Return (6, n) samples, the same as ``imuwb.simulation.static`` draws with seed 0."""
    from imuwb.log import AXES
    from imuwb.simulation import preset

    axes, streams = preset("3dm-gx3-25").axes, np.random.SeedSequence(0).spawn(len(AXES))
    n = round(HOURS * 3600 * RATE)
    pairs = zip(AXES, streams, strict=True)
    return np.stack([axes[axis].processes.sample(n, 1 / RATE, np.random.default_rng(s)) for axis, s in pairs])


def times(n):
    """Return the ``log:N`` that gives 90 different averaging times, and the times (s); some of N short times coincide."""
    from imuwb.identification import averaging_factors

    for number in range(POINTS, 3 * POINTS):
        factors = averaging_factors(f"log:{number}", n, 1 / RATE)
        if factors.size == POINTS:
            return f"log:{number}", factors / RATE
    raise ValueError(f"no log:N gives {POINTS} averaging times of {n} samples")


def cold(samples):
    """Return the CPU times of the first call after installation, when numba compiles."""
    begin = time.process_time()
    from imuwb.identification import allan

    imported = time.process_time()
    name, _ = times(samples.shape[1])
    curves = cpu(lambda: [allan(axis, 1 / RATE, name) for axis in samples], 1)
    return {"import": imported - begin, "curves": curves}


def warm(samples):
    """Return the CPU times of a later process: compiled code comes from the cache, results kept in memory are cleared before each run."""
    from imuwb.identification import allan, allan_of_axes, equivalent_degrees_of_freedom, fit_allan
    from imuwb.identification.allan_variance.moments import moments
    from imuwb.identification.allan_variance.overlapping import sums_of_squares

    name, tau = times(samples.shape[1])

    def curves():
        equivalent_degrees_of_freedom.cache_clear()
        return [allan(axis, 1 / RATE, name) for axis in samples]

    def intervals():
        equivalent_degrees_of_freedom.cache_clear()
        for curve in results:
            for m, alpha in zip(curve.factor, curve.noise_type, strict=True):
                equivalent_degrees_of_freedom(int(m), curve.n, int(alpha))

    def fits():
        moments.cache_clear()
        return [fit_allan(curve) for curve in results]

    first = cpu(curves, 1)
    results = curves()
    factors = results[0].factor
    phase = np.concatenate([[0.0], np.cumsum(samples[0] - samples[0].mean())])
    equivalent_degrees_of_freedom.cache_clear()
    begin = time.perf_counter()
    allan_of_axes({str(i): (axis, 1 / RATE, ()) for i, axis in enumerate(samples)}, name)
    wall = time.perf_counter() - begin
    return {
        "times": name, "points": tau.size, "first": first, "curves": cpu(curves), "wall": wall,
        "kernel": 6 * cpu(lambda: sums_of_squares(phase, factors)), "intervals": cpu(intervals), "fits": cpu(fits),
    }  # fmt: skip


def memory(samples):
    """Return the peak of memory above the input, by tracemalloc (which counts numpy's arrays), and the growth of the process, bytes."""
    from imuwb.identification import allan, allan_of_axes

    name, _ = times(samples.shape[1])
    allan(samples[0, :1000], 1 / RATE)
    before = resident()
    tracemalloc.start()
    allan(samples[0], 1 / RATE, name)
    one = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    allan_of_axes({str(i): (axis, 1 / RATE, ()) for i, axis in enumerate(samples)}, name)
    six = tracemalloc.get_traced_memory()[1]
    return {"one": one, "six": six, "resident": resident() - before}


def peer(samples):
    """Return the CPU time of allantools.oadev on the same samples and times, and the largest relative difference of the deviations."""
    import allantools

    from imuwb.identification import allan

    name, tau = times(samples.shape[1])
    curves = []

    def work():
        curves[:] = [allantools.oadev(x, rate=RATE, data_type="freq", taus=tau) for x in samples]

    spent = cpu(work)
    # Half the record has one difference only, and allantools omits that time.
    kept = np.isin(np.rint(tau * RATE), np.rint(curves[0][0] * RATE))
    ours = [allan(x, 1 / RATE, name).deviation[kept] for x in samples]
    apart = [np.abs(theirs[1] / mine - 1).max() for theirs, mine in zip(curves, ours, strict=True)]
    return {"curves": spent, "points": len(curves[0][0]), "apart": float(max(apart))}


PARTS = {"cold": cold, "warm": warm, "memory": memory, "allantools": peer}


def table(measured):
    """Return the Markdown table."""
    first, warmed, used, theirs = (measured[part] for part in PARTS)
    ratio = theirs["curves"] / warmed["curves"]
    rows = [
        ("imuwb, empty compile cache: import", f"{first['import']:.2f} s"),
        ("imuwb, empty compile cache: 6 curves", f"{first['curves']:.2f} s"),
        ("imuwb, filled compile cache, first run of a process", f"{warmed['first']:.2f} s"),
        ("imuwb, warm", f"{warmed['curves']:.3f} s"),
        ("  the second differences alone", f"{warmed['kernel']:.3f} s"),
        ("  the degrees of freedom of all intervals alone", f"{warmed['intervals']:.3f} s"),
        ("imuwb.identification.allan_of_axes, wall clock", f"{warmed['wall']:.3f} s"),
        ("fit_allan of the 6 curves", f"{warmed['fits']:.2f} s"),
        ("allantools.oadev, with its own intervals, without noise types", f"{theirs['curves']:.2f} s"),
        ("**allantools / imuwb, warm**", f"**{ratio:.1f}**"),
        ("allantools / imuwb, empty compile cache", f"{theirs['curves'] / first['curves']:.1f}"),
        ("largest relative difference of the deviations", f"{theirs['apart']:.1e}"),
        ("peak memory above the input, one axis", f"{used['one'] / 1e6:.0f} MB"),
        ("peak memory above the input, 6 axes on two threads", f"{used['six'] / 1e6:.0f} MB"),
        ("growth of the process, 6 axes on two threads", f"{used['resident'] / 1e6:.0f} MB"),
    ]
    head = (
        f"{versions('imuwb', 'numpy', 'numba', 'allantools')}; "
        f"{HOURS:g} h x 6 axes at {RATE:g} Hz, {warmed['points']} averaging times (`{warmed['times']}`; "
        f"allantools kept {theirs['points']})"
    )
    return "\n".join(
        (head, "", "| measured | CPU time or memory |", "| --- | --- |", *(f"| {a} | {b} |" for a, b in rows))
    )


if __name__ == "__main__":
    run_parts(__file__, "CPU time of Allan curves", PARTS, simulated, table, empty_cache=True)

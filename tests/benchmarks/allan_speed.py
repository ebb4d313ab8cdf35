"""How long does an Allan curve take? imuwb against allantools, on the same samples and averaging times.

7 h at 100 Hz of the preset 3dm-gx3-25, six axes of 2.52 million samples, 90 averaging times spread
evenly on a log axis up to half the record. CPU seconds (``time.process_time``: all threads), least of
three runs but for what is cold. Each part runs in a fresh process.

Command: ``python tests/benchmarks/allan_speed.py`` (about a minute; needs ``pip install -e ".[bench]"``).
Seed: 0.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
import tracemalloc
from importlib.metadata import version
from pathlib import Path

import numpy as np

HOURS, RATE, POINTS, RUNS = 7.0, 100.0, 90, 3


def main():
    """Write the samples, run every part in a process of its own, print the table."""
    parser = argparse.ArgumentParser(description="CPU time of Allan curves")
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
        # The first imuwb part finds an empty compile cache, those behind it a filled one.
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(Path(folder) / "numba")}
        measured = {}
        for part in PARTS:
            print(f"{part} ...", file=sys.stderr)
            command = [sys.executable, __file__, "--part", part, "--samples", str(samples)]
            ended = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
            measured[part] = json.loads(ended.stdout)
    print(table(measured))


def simulated():
    """Return (6, n) samples, drawn as ``imuwb.simulation.static`` draws them from seed 0."""
    from imuwb.log import AXES
    from imuwb.simulation import preset

    axes, streams = preset("3dm-gx3-25").axes, np.random.SeedSequence(0).spawn(len(AXES))
    n = round(HOURS * 3600 * RATE)
    pairs = zip(AXES, streams, strict=True)
    return np.stack([axes[axis].processes.sample(n, 1 / RATE, np.random.default_rng(s)) for axis, s in pairs])


def times(n):
    """Return the ``log:N`` that gives 90 averaging times (short ones coincide), and the times in s."""
    from imuwb.identification import averaging_factors

    for number in range(POINTS, 3 * POINTS):
        factors = averaging_factors(f"log:{number}", n, 1 / RATE)
        if factors.size == POINTS:
            return f"log:{number}", factors / RATE
    message = f"no log:N gives {POINTS} averaging times of {n} samples"
    raise ValueError(message)


def cpu(work, runs=RUNS):
    """Return the least CPU time of some runs."""
    spent = []
    for _ in range(runs):
        begin = time.process_time()
        work()
        spent.append(time.process_time() - begin)
    return min(spent)


def cold(samples):
    """The first call after installation: numba compiles."""
    begin = time.process_time()
    from imuwb.identification import allan

    imported = time.process_time()
    name, _ = times(samples.shape[1])
    curves = cpu(lambda: [allan(axis, 1 / RATE, name) for axis in samples], 1)
    return {"import": imported - begin, "curves": curves}


def warm(samples):
    """Every later process: compiled code comes from the cache; what is cached in memory is cleared before each run."""
    from imuwb.identification import allan, allan_of_axes, equivalent_degrees_of_freedom, fit_allan
    from imuwb.identification.allan_variance.moments import moments
    from imuwb.identification.allan_variance.overlapping import sums_of_squares

    name, tau = times(samples.shape[1])

    def curves():
        equivalent_degrees_of_freedom.cache_clear()
        return [allan(axis, 1 / RATE, name) for axis in samples]

    def intervals():
        equivalent_degrees_of_freedom.cache_clear()
        for curve in found:
            for m, alpha in zip(curve.factor, curve.noise_type, strict=True):
                equivalent_degrees_of_freedom(int(m), curve.n, int(alpha))

    def fits():
        moments.cache_clear()
        return [fit_allan(curve) for curve in found]

    first = cpu(curves, 1)
    found = curves()
    factors = found[0].factor
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
    """Peak of what is allocated above the input, as tracemalloc counts numpy's arrays, and growth of the process."""
    import resource

    from imuwb.identification import allan, allan_of_axes

    name, _ = times(samples.shape[1])
    allan(samples[0, :1000], 1 / RATE)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    tracemalloc.start()
    allan(samples[0], 1 / RATE, name)
    one = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    allan_of_axes({str(i): (axis, 1 / RATE, ()) for i, axis in enumerate(samples)}, name)
    six = tracemalloc.get_traced_memory()[1]
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    # ru_maxrss counts kilobytes on Linux, bytes on macOS
    return {"one": one, "six": six, "resident": grown * (1 if sys.platform == "darwin" else 1024)}


def other(samples):
    """allantools.oadev on the same samples and times; and how far the deviations are apart."""
    import allantools

    from imuwb.identification import allan

    name, tau = times(samples.shape[1])
    found = []

    def curves():
        found[:] = [allantools.oadev(x, rate=RATE, data_type="freq", taus=tau) for x in samples]

    spent = cpu(curves)
    # Half the record has one difference only; allantools leaves that time out.
    kept = np.isin(np.rint(tau * RATE), np.rint(found[0][0] * RATE))
    ours = [allan(x, 1 / RATE, name).deviation[kept] for x in samples]
    apart = [np.abs(theirs[1] / mine - 1).max() for theirs, mine in zip(found, ours, strict=True)]
    return {"curves": spent, "points": len(found[0][0]), "apart": float(max(apart))}


PARTS = {"cold": cold, "warm": warm, "memory": memory, "allantools": other}


def table(measured):
    """Return the Markdown table."""
    first, warmed, used, theirs = (measured[part] for part in PARTS)
    ratio = theirs["curves"] / warmed["curves"]
    rows = [
        ("imuwb, empty compile cache: import", f"{first['import']:.2f} s"),
        ("imuwb, empty compile cache: 6 curves", f"{first['curves']:.2f} s"),
        ("imuwb, filled cache, first run of a process", f"{warmed['first']:.2f} s"),
        ("imuwb, warm", f"{warmed['curves']:.3f} s"),
        ("  of which the second differences", f"{warmed['kernel']:.3f} s"),
        ("  of which the degrees of freedom of all intervals", f"{warmed['intervals']:.3f} s"),
        ("imuwb.identification.allan_of_axes, wall clock", f"{warmed['wall']:.3f} s"),
        ("fit_allan of the 6 curves", f"{warmed['fits']:.2f} s"),
        ("allantools.oadev, its own intervals and no noise types", f"{theirs['curves']:.2f} s"),
        ("**allantools / imuwb, warm**", f"**{ratio:.1f}**"),
        ("allantools / imuwb, empty compile cache", f"{theirs['curves'] / first['curves']:.1f}"),
        ("deviations apart, relative", f"{theirs['apart']:.1e}"),
        ("peak above the input, one axis", f"{used['one'] / 1e6:.0f} MB"),
        ("peak above the input, 6 axes on two threads", f"{used['six'] / 1e6:.0f} MB"),
        ("growth of the process, 6 axes on two threads", f"{used['resident'] / 1e6:.0f} MB"),
    ]
    packages = ", ".join(f"{name} {version(name)}" for name in ("imuwb", "numpy", "numba", "allantools"))
    head = (
        f"Python {platform.python_version()}, {packages}; {os.cpu_count()} processors; "
        f"{HOURS:g} h x 6 axes at {RATE:g} Hz, {warmed['points']} averaging times (`{warmed['times']}`; "
        f"allantools kept {theirs['points']})"
    )
    return "\n".join((head, "", "| what | CPU |", "| --- | --- |", *(f"| {a} | {b} |" for a, b in rows)))


if __name__ == "__main__":
    main()

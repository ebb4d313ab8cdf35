"""How fast are filters and outages? Epochs a CPU second, against a plain numpy filter; and a whole sweep on the wall clock.

An epoch is one IMU sample: mechanization, states of all axes, and, at every sample or every tenth, the covariance; fixes once a
second. ``solve`` of 15, 18 and 27 states over an hour of a simulated drive at 100 Hz; the numpy filter is one step of dense
matrices, F P F' + Q, without the mechanization, which flatters it. sweep: five filters of Quinchia, every start, 30 and 60 s, with
covariances, on a drive of half an hour, with all that ``imuwb.replay.replay`` does. compile: the first run of an empty cache.

Least of three runs; compiled code from the cache, but for compile.

Command: ``python tests/benchmarks/filter_speed.py`` (about three minutes). Seed: 0.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version

import numpy as np

RATE = 100.0
FIVE = ("15AV", "18AV", "18AVWD", "15AR", "27AR")
GOALS = {(15, 1): 0.8, (15, 10): 3.0, (27, 1): 0.5}  #: M epochs a second
COMPILE = """
import time, resource
from imuwb.navigation import FilterModel
from imuwb.replay import model_named, prepare, replay, sweep
from imuwb.simulation import drive, mixed_route, preset
log = drive(preset("3dm-gx3-25-gm"), mixed_route(240), 0)
model = model_named("15AV", FilterModel("base", preset("3dm-gx3-25-gm")), interval=0.01)
begin = time.perf_counter()
prepared = prepare(log, model)
replay(prepared, [model], sweep(prepared, model, 30.0))
print(time.perf_counter() - begin)
"""


def least(work, clock, runs=3):
    """Return the least time of some runs."""
    spent = []
    for _ in range(runs):
        begin = clock()
        work()
        spent.append(clock() - begin)
    return min(spent)


def dense_steps(states, seconds=2.0):
    """Return how many steps of a plain numpy filter's covariance are done in a second."""
    rng = np.random.default_rng(0)
    f, q, p = (
        np.eye(states) + 1e-3 * rng.standard_normal((states, states)) / states,
        np.eye(states) * 1e-9,
        np.eye(states),
    )
    count, begin = 0, time.process_time()
    while time.process_time() - begin < seconds:
        for _ in range(100):
            f[3:6, 6:9] = f[6:9, 9:12] = np.eye(3) * 0.01  # the matrix is made anew at each step
            p = f @ p @ f.T + q
            p = (p + p.T) / 2
        count += 100
    return count / (time.process_time() - begin)


def main():
    """Measure and print the table."""
    from dataclasses import replace

    from imuwb.navigation import FilterModel, solve
    from imuwb.replay import model_named, prepare, sweep
    from imuwb.replay import replay as replayed
    from imuwb.simulation import drive, mixed_route, preset

    base = FilterModel("base", preset("3dm-gx3-25-gm"))
    log = drive(preset("3dm-gx3-25-gm"), mixed_route(3600), 0)
    packages = ", ".join(f"{name} {version(name)}" for name in ("imuwb", "numpy", "numba"))
    print(f"Python {platform.python_version()}, {packages}; {os.cpu_count()} processors\n")
    print("| what | M epochs a CPU second | over numpy's step | goal |\n| --- | --- | --- | --- |")
    for name, states in (("15AV", 15), ("18AV", 18), ("27AR", 27)):
        model = model_named(name, base, interval=1 / RATE)
        plain = dense_steps(states)
        for every in (1, 10):
            one = replace(model, settings=replace(model.settings, every=every))
            prepared = prepare(log, one)
            epochs = prepared.moves.time.size - prepared.start.sample
            solve(one, prepared.moves, prepared.found, prepared.start)
            spent = least(lambda m=one, p=prepared: solve(m, p.moves, p.found, p.start), time.process_time)
            speed = epochs / spent
            goal = f"at least {GOALS[states, every]}" if (states, every) in GOALS else ""
            print(
                f"| {states} states, covariance at every {every}. sample | {speed / 1e6:.2f} | {speed / plain:.0f} | {goal} |"
            )
    half = drive(preset("3dm-gx3-25-gm"), mixed_route(1800), 0)
    models = [model_named(name, base, interval=1 / RATE) for name in FIVE]
    prepared = prepare(half, models[0])
    outages = [o for duration in (30.0, 60.0) for o in sweep(prepared, models[0], duration)]
    wall = least(lambda: replayed(prepared, models, outages), time.perf_counter, 1)
    print(f"| sweep of {len(outages)} outages by five filters, half an hour | {wall:.1f} s wall | | at most 60 s |")
    with tempfile.TemporaryDirectory() as cache:
        ended = subprocess.run(
            [sys.executable, "-c", COMPILE], check=True, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "NUMBA_CACHE_DIR": cache},
        )  # fmt: skip
    print(
        f"| first run of an empty cache, a drive of four minutes | {float(ended.stdout):.1f} s wall | | at most 15 s |"
    )


if __name__ == "__main__":
    main()

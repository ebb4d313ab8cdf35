"""Speed of the filter: epochs a CPU second, against a numpy filter with the same result; and the duration of a whole sweep.

An epoch is one sample of the IMU: mechanization, states of all axes, and the covariance at every or every tenth sample; a fix
each second. ``solve`` with 15, 18 and 27 states runs over half an hour of a simulated drive at 100 Hz.

* numpy: the filter of tests/navigation/plain.py, with dense matrices and a covariance at every sample, over the first minute.
  Before the timing, both are compared at the last fix of that minute: states within 1e-6 of their sigma, and covariances
  within 1e-6 of the sigmas' product.
* plain loops: the same filter with the loops of ``_axis_columns`` over 1, 2 and 3 states not unrolled, in a copy of the package.
* sweep: five filters of Quinchia, an outage at every fix, 30 and 60 s, with covariances, on the same drive: all of ``replay``.
* compile: the first run with an empty cache.

The smallest of several runs, which alternate between the filter and its plain copy. Compiled code comes from the cache, except
for compile.

Command: ``python tests/benchmarks/filter_speed.py`` (about three minutes). Seed: 0.
"""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
RATE, SECONDS, RUNS = 100.0, 1800, 3
FIVE = ("15AV", "18AV", "18AVWD", "15AR", "27AR")
STATES = {"15AV": 15, "18AV": 18, "27AR": 27}
GOALS = {("15AV", 1): 0.8, ("15AV", 10): 3.0, ("27AR", 1): 0.5}  #: M epochs a second
COMPARED = 60.0  #: s
CLOSE = 1e-6  #: of sigma
WORKER = """
import json, sys, time
sys.path[:0] = [{folder!r}, {benchmarks!r}]
from filter_speed import filters
work = filters()
print("ready", flush=True)
for line in sys.stdin:
    spent = {{}}
    for name, solve in work.items():
        begin = time.process_time()
        solve()
        spent[name] = time.process_time() - begin
    print(json.dumps(spent), flush=True)
"""
COMPILE = """
import time
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


def prepared_filters():
    """Yield name, samples between covariances, filter and log as the filter takes it; the gate is open."""
    from dataclasses import replace

    from imuwb.navigation import FilterModel
    from imuwb.replay import model_named, prepare
    from imuwb.simulation import drive, mixed_route, preset

    base = FilterModel("base", preset("3dm-gx3-25-gm"))
    log = drive(preset("3dm-gx3-25-gm"), mixed_route(SECONDS), 0)
    for name in STATES:
        model = model_named(name, base, interval=1 / RATE)
        for every in (1, 10):
            tried = replace(model, settings=replace(model.settings, every=every, gate=1e9))
            yield name, every, tried, prepare(log, tried)


def filters():
    """Return a run of each filter, compiled and ready."""
    from imuwb.navigation import solve

    work = {}
    for name, every, model, p in prepared_filters():
        work[f"{name} {every}"] = lambda m=model, p=p: solve(m, p.measurement, p.corrections, p.alignment)
        work[f"{name} {every}"]()
    return work


def numpy_speed(model, prepared):
    """Return the epochs a CPU second of the numpy filter, whose result is that of the filter."""
    sys.path.insert(0, str(ROOT))
    from imuwb.navigation import solve
    from tests.navigation.plain import Plain

    c, start = prepared.corrections, prepared.alignment
    keep = c.time < c.time[start.event] + COMPARED
    events = type(c.events)(*(x[keep] for x in c.events))
    corrections = type(c)(events, c.time[keep], c.fix[keep])
    solution = solve(model, prepared.measurement, corrections, start)
    made = SimpleNamespace(measurement=prepared.measurement, corrections=corrections, alignment=start)
    track, at = solution.track, start.event
    plain = Plain(made, solution.tables, model.installation.lever_arm, track.axes[at], track.covariance[at])
    begin = time.process_time()
    *_, (e, state, axes, covariance) = plain.run()
    spent = time.process_time() - begin
    sigma = np.sqrt(np.diag(covariance))
    from tests.navigation.drives import errors

    apart = np.concatenate([errors(track.state[e, :10], state), track.axes[e] - axes]) / sigma
    spread = np.abs(track.covariance[e] - covariance) / np.outer(sigma, sigma)
    if not max(np.abs(apart).max(), spread.max()) < CLOSE:
        raise AssertionError(
            f"{model.name}: the numpy filter has another result: {np.abs(apart).max():.1e}, {spread.max():.1e}"
        )
    return (int(events.at[e]) + 1 - start.sample) / spent


def plain_copy(folder):
    """Make a copy of the package whose loops over an axis's columns are not unrolled."""
    shutil.copytree(ROOT / "imuwb", folder / "imuwb", ignore=shutil.ignore_patterns("__pycache__"))
    path = folder / "imuwb" / "navigation" / "covariance.py"
    text, count = re.subn(r"order == [123]:", "order == -1:", path.read_text("utf-8"))
    if count != 3:
        raise AssertionError(f"{path}: {count} unrolled loops, not 3")
    path.write_text(text, "utf-8")


def least_times(folders):
    """Return the least time of each filter in each folder's package."""
    workers = {}
    for name, folder in folders.items():
        code = WORKER.format(folder=str(folder), benchmarks=str(Path(__file__).parent))
        workers[name] = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "numba")} if name != "own" else None,
        )  # fmt: skip
        workers[name].stdout.readline()
    least = {name: {} for name in folders}
    for _ in range(RUNS):
        for name, worker in workers.items():
            worker.stdin.write("run\n")
            worker.stdin.flush()
            for key, spent in json.loads(worker.stdout.readline()).items():
                least[name][key] = min(spent, least[name].get(key, spent))
    for worker in workers.values():
        worker.communicate()
    return least


def sweep_time():
    """Return the number of outages of a sweep by five filters, and its wall time, s."""
    from imuwb.navigation import FilterModel
    from imuwb.replay import model_named, prepare, replay, sweep
    from imuwb.simulation import drive, mixed_route, preset

    base = FilterModel("base", preset("3dm-gx3-25-gm"))
    models = [model_named(name, base, interval=1 / RATE) for name in FIVE]
    prepared = prepare(drive(preset("3dm-gx3-25-gm"), mixed_route(SECONDS), 0), models[0])
    outages = [o for duration in (30.0, 60.0) for o in sweep(prepared, models[0], duration)]
    begin = time.perf_counter()
    replay(prepared, models, outages)
    return len(outages), time.perf_counter() - begin


def main():
    """Measure and print the table."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("imuwb", "numpy", "numba"))
    print(f"Python {platform.python_version()}, {packages}; {os.cpu_count()} processors\n")
    print("| filter | M epochs a CPU second | goal | over numpy | over plain loops |\n| --- | --- | --- | --- | --- |")
    prepared = list(prepared_filters())
    with tempfile.TemporaryDirectory() as folder:
        plain_copy(Path(folder))
        times = least_times({"own": ROOT, "plain": Path(folder)})
    peer = {name: numpy_speed(model, p) for name, every, model, p in prepared if every == 1}
    for name, every, _, p in prepared:
        own, plain = (times[variant][f"{name} {every}"] for variant in ("own", "plain"))
        speed = (p.measurement.time.size - p.alignment.sample) / own
        goal = f"at least {GOALS[name, every]}" if (name, every) in GOALS else ""
        print(
            f"| {STATES[name]} states, covariance at every {'' if every == 1 else f'{every}th '}sample | {speed / 1e6:.2f} "
            f"| {goal} | {speed / peer[name]:.0f} | {plain / own:.2f} |"
        )
    count, wall = sweep_time()
    print(f"| sweep of {count} outages by five filters, half an hour | {wall:.1f} s wall | at most 60 s | | |")
    with tempfile.TemporaryDirectory() as cache:
        ended = subprocess.run(
            [sys.executable, "-c", COMPILE], check=True, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "NUMBA_CACHE_DIR": cache},
        )  # fmt: skip
    print(
        f"| first run with an empty cache, a drive of four minutes | {float(ended.stdout):.1f} s wall | at most 15 s | | |"
    )


if __name__ == "__main__":
    main()

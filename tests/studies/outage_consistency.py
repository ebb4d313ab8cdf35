"""Is a filter's sigma right where its error model is? Matched simulation: NIS of the run, NEES and coverage in outages.

Drives of four hours (mixed routes, 100 Hz, fixes each second), sensors simulated by four processes and filtered with the same:
white noise and a Gauss-Markov bias; these and a random walk of the accelerometers; white noise and AR(1); white noise and a
stable AR(3), both Burg's of denoised static samples. Outages of 60 s every 90 s do not overlap. Beside them, on the first drives
of each: the readings "as printed", and wavelet denoising before a filter that knows nothing of it.

Bands: a mean over n outages of two degrees of freedom each lies within chi-squared's 95 % quantiles over 2n, were they independent.

Command: ``python tests/studies/outage_consistency.py [--drives 4] > tests/studies/outage_consistency.md`` (some 20 minutes on two cores).
Seeds: 0, 1, ...; of routes likewise.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from imuwb.navigation import FilterModel, drift
from imuwb.replay import model_named, prepare, run, scores, yardstick
from imuwb.replay.replay import Outage, events_of
from imuwb.simulation import drive, mixed_route, preset
from imuwb.statistics.distributions import chi_square_quantile
from imuwb.stochastic import AxisModel, ImuErrorModel

HOURS, EVERY, LENGTH, SETTLE = 4.0, 90.0, 60.0, 300.0
HORIZONS = (5, 10, 30, 60)
LIMIT = 5.991
INTERVAL = 0.01


TRUTHS = {"WN + GM": "15AV", "WN + GM + RW": "18AV", "WN + AR(1)": "15AR", "WN + AR(3)": "27AR"}


def filter_of(title):
    """Return the filter of a truth."""
    base = FilterModel("base", preset("3dm-gx3-25-gm"))
    return replace(model_named(TRUTHS[title], base, interval=INTERVAL), name=title)


def driven(model, hours, seed):
    """Return a drive whose sensor is what a filter believes."""
    sensor = ImuErrorModel(model.name, {a: AxisModel(m.processes) for a, m in model.error_model.axes.items()})
    return drive(sensor, mixed_route(hours * 3600, seed), seed)


def one(job):
    """Return what one filter does on one drive: NIS over its degrees of freedom, and NEES at the horizons, (s, 4)."""
    log, model = job
    prepared = prepare(log, model)
    solution = run(model, prepared)
    starts = np.arange(prepared.start_time + SETTLE, prepared.moves.time[-1] - LENGTH - 1, EVERY)
    drifted = drift(solution, events_of(solution, [Outage(float(t), LENGTH) for t in starts]), LENGTH)
    found = scores(drifted, yardstick(log, solution, "truth"))
    at = [h - 1 for h in HORIZONS]
    nis = solution.fix_nis[60:]
    return nis, found.nees[:, at], found.horizontal[:, at]


def band(freedom):
    """Return the 95 % band of a mean of chi-squared over its degrees of freedom."""
    return tuple(float(chi_square_quantile(p, freedom) / freedom) for p in (0.025, 0.975))


def rows(title, results):
    """Return the lines of one filter."""
    nis = np.concatenate([r[0] for r in results])
    nees = np.concatenate([r[1] for r in results])
    error = np.concatenate([r[2] for r in results])
    count = len(nees)
    low, high = band(6.0 * len(nis))
    mean = float(np.nansum(nis) / (6 * len(nis)))
    yield f"| {title} | NIS/6 of {len(nis):,} fixes | {mean:.4f} | {low:.4f} to {high:.4f} | | |"
    low, high = band(2.0 * count)
    for i, h in enumerate(HORIZONS):
        covered = float((nees[:, i] <= LIMIT).mean())
        yield (
            f"| | NEES/2 after {h} s, {count} outages | {nees[:, i].mean() / 2:.3f} | {low:.2f} to {high:.2f} "
            f"| {covered * 100:.1f} % | {np.median(error[:, i]):.3g} m |"
        )


def main():
    """Run and print the table."""
    parser = argparse.ArgumentParser(description="consistency of matched filters in outages")
    parser.add_argument("--drives", type=int, default=4)
    parser.add_argument("--hours", type=float, default=HOURS)
    given = parser.parse_args()
    print("# Consistency in matched simulation\n")
    print(f"{given.drives} drives of {given.hours:g} h for each truth; outages of {LENGTH:g} s every {EVERY:g} s.\n")
    print(
        "| truth and filter | what | mean | 95 % band | within the 95 % ellipse | median error |\n| --- | --- | --- | --- | --- | --- |"
    )
    for title in TRUTHS:
        model = filter_of(title)
        jobs, beside = [], {"as printed": [], "denoised first": []}
        for seed in range(given.drives):
            log = driven(model, given.hours, seed)
            jobs.append((log, model))
            if seed == 0:
                beside["as printed"].append((log, replace(model, reading="as printed")))
                beside["denoised first"].append((log, replace(model, wavelet_levels=(7, 7, 7, 7, 6, 6))))
        with ThreadPoolExecutor(2) as pool:
            print("\n".join(rows(title, list(pool.map(one, jobs)))), flush=True)
            for what, extra in beside.items():
                print("\n".join(rows(f"{title}, {what}", list(pool.map(one, extra)))), flush=True)


if __name__ == "__main__":
    main()

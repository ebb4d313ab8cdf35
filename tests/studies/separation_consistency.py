"""Test the smoothed trajectory: does the separation of the forward and the backward run agree with its own sigma?

Each drive lasts 20 minutes (mixed routes, 50 Hz, fixes each second), and has four gaps of 30 s without fixes. The sensor has white noise,
a Gauss-Markov bias and a turn-on bias, and the filter uses the same processes. The separation backward minus forward over its sigma
is judged each ten seconds outside of the gaps, and at the middle of each gap; 95 % of the values lie within 1.96 if sigma is right. The errors of
the forward and of the smoothed trajectory are against the truth, horizontal, at all times within the gaps.

Command: ``python tests/studies/separation_consistency.py`` (24 drives: about five minutes on two cores).
Seeds: seed r makes the sensor and the route of drive r.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from study_report import Table, main, over_records

from imuwb.geodesy import ned_scale
from imuwb.log import AXES, GnssStream
from imuwb.navigation import FilterModel, Settings, separation
from imuwb.replay import prepare, run
from imuwb.simulation import drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum, WhiteNoise

QUESTION = "Separation of forward and backward runs in matched simulation"
SECONDS, RATE, GAP = 1200.0, 50.0, 30.0
GAPS = (300.0, 500.0, 700.0, 900.0)  #: s, starts of the gaps
NOISE = {"gyro": (2e-4, 1e-4, 1e-3), "accel": (2e-3, 2e-3, 0.02)}  #: white, bias in SI, turn-on
EVERY = 10.0  #: s
QUANTITIES = (
    "position north",
    "position east",
    "position down",
    "velocity north",
    "velocity east",
    "roll",
    "pitch",
    "heading",
)
COLUMNS = (0, 1, 2, 3, 4, 6, 7, 8)


def sensor():
    """Return the error model of the sensor."""
    axes = {}
    for axis in AXES:
        white, slow, turn_on = NOISE[axis[:-2]]
        axes[axis] = AxisModel(Sum((WhiteNoise(white), GaussMarkov(slow, 100.0), Constant(turn_on))))
    return ImuErrorModel("known", axes)


def _without_gaps(gnss, zero):
    time = (gnss.time - zero) / 1e9
    kept = np.all([(time <= start) | (time > start + GAP) for start in GAPS], axis=0)
    names = ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    parts = {name: getattr(gnss, name) for name in names}
    return GnssStream(gnss.name, **{n: None if x is None else x[kept] for n, x in parts.items()}, origin=gnss.origin)


def record(seed, seconds):
    """Return the normalised separations and the errors in the gaps of one drive."""
    model = sensor()
    log = drive(model, mixed_route(seconds, seed), seed, rate=RATE)
    log = replace(log, gnss=(_without_gaps(log.gnss[0], log.zero),))
    known = FilterModel("known", model, settings=Settings(settling=60.0))
    found = separation(run(known, prepare(log, known)))
    with np.errstate(invalid="ignore"):
        ratio = found.off / found.off_sigma
    inside = np.any([(found.time > start) & (found.time <= start + GAP) for start in GAPS], axis=0)
    begin, end = found.time[0] + 60.0, found.time[-1] - 60.0
    grid = np.searchsorted(found.time, np.arange(begin, end, EVERY))
    middle = np.searchsorted(found.time, [start + GAP / 2 for start in GAPS if start + GAP < end])
    truth = log.references[0]
    time = (truth.time - log.zero) / 1e9
    rows = np.flatnonzero(np.any([(time > s) & (time < s + GAP) for s in GAPS], axis=0))
    at = np.searchsorted(found.time, time[rows] - 1e-6)
    scale = ned_scale(truth.position[rows, 0], truth.position[rows, 2])
    errors = [np.square(((t.position[at] - truth.position[rows]) * scale)[:, :2]).sum(axis=1).mean()
              for t in (found.forward, found.smoothed)]  # fmt: skip
    normal = [
        np.square(((t.position[at] - truth.position[rows]) * scale / t.sigma[at, :3])[:, :2]).mean()
        for t in (found.forward, found.smoothed)
    ]
    return SimpleNamespace(
        outside=ratio[grid[~inside[grid]]][:, COLUMNS], middle=ratio[middle][:, COLUMNS], squares=errors, normal=normal
    )


def study(records=24, seconds=SECONDS, workers=2):
    """Return the tables."""
    drives = over_records(record, [(seed, seconds) for seed in range(records)], workers)
    rows = []
    for title, name in (("outside of the gaps", "outside"), ("middle of the gaps", "middle")):
        parts = [getattr(d, name) for d in drives]
        for k, quantity in enumerate(QUANTITIES):
            shares = [float((np.abs(p[:, k]) < 1.96).mean()) for p in parts]
            every = np.concatenate([p[:, k] for p in parts])
            half = 1.96 * np.std(shares, ddof=1) / np.sqrt(len(shares)) * 100
            share = float((np.abs(every) < 1.96).mean()) * 100
            root = float(np.sqrt(np.mean(every**2)))
            rows.append((title, quantity, f"{every.size}", f"{share:.1f} ± {half:.1f} %", f"{root:.2f}"))
    forward, both = (np.sqrt([d.squares[k] for d in drives]) for k in (0, 1))
    normal = [float(np.sqrt(np.mean([d.normal[k] for d in drives]))) for k in (0, 1)]
    gaps = tuple(
        (name, f"{np.sqrt(np.mean(x**2)):.2f} m", f"{x.min():.2f} to {x.max():.2f} m", f"{n:.2f}")
        for name, x, n in (("forward", forward, normal[0]), ("smoothed", both, normal[1]))
    )
    ratio = both / forward
    last = (
        "smoothed over forward", f"{np.sqrt(np.mean(both**2) / np.mean(forward**2)):.3f}",
        f"{ratio.min():.3f} to {ratio.max():.3f}", "",
    )  # fmt: skip
    return (
        Table(
            "Separation over its own sigma",
            ("when", "quantity", "values", "within 95 %, with the interval over drives", "root mean square"), tuple(rows),
        ),
        Table(
            f"Horizontal errors in gaps of {GAP:g} s", ("trajectory", "rms", "drives", "error over sigma, rms"), (*gaps, last)
        ),
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 24,
        lambda n: f"seeds 0..{n - 1}; {n} drives of {SECONDS:g} s; gaps of {GAP:g} s at {', '.join(f'{g:g}' for g in GAPS)} s",
    )  # fmt: skip

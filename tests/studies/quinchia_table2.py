"""Make Quinchia's table 2 again, and measure how well a static record determines the AR processes of 15AR and 27AR.

Preset 3dm-gx3-25 (table 4): static records of 7 h at 100 Hz, six axes. Each axis is denoised as the paper can have done it (db4, the
levels of table 7, a SURE threshold that is not scaled by the noise, which removes all details), and Burg's method gives AR(1) and
AR(3). The first table shows table 2 beside the mean over the records; the second how far beta0² of one record is from the mean over
records (goal: within 5 %), and how far the mean is from ``imuwb.replay.noise.denoised_ar.expected``, which draws no record (goal:
within 2 %). The third table has the same with thresholds scaled by each level's own noise.

Command: ``python tests/studies/quinchia_table2.py`` (50 records: about 6 minutes in one process).
Seeds: record r uses ``SeedSequence(r).spawn(6)``, a stream for each axis in the order of ``AXES``, as quinchia.py.
"""

from __future__ import annotations

import numpy as np
from coverage_table4 import PRESET
from quinchia import HOURS, RATE, samples
from study_report import Table, main, over_records, published, verdict

from imuwb.conditioning import denoise
from imuwb.identification import burg
from imuwb.replay.noise.denoised_ar import LEVELS, ORDERS, WAVELET, expected, fitted
from imuwb.simulation import preset

QUESTION = "Quinchia's table 2 from simulated static records"
WITHIN, MEAN_WITHIN = 0.05, 0.02
SCALED = 4  #: records that are denoised with scaled thresholds too
PAPER_AXES = ("accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z")


def record(seed, axis, hours=HOURS):
    """Return {order: (alpha 1, ..., beta0²)} of an axis."""
    found = fitted(samples(PRESET, axis, seed, hours), axis, 1 / RATE)
    return {order: (*p.alpha, p.beta0**2) for order, p in zip(ORDERS, found, strict=True)}


def scaled(seed, axis, hours=HOURS):
    """Return the same with thresholds that are scaled by the noise of each level."""
    fit = burg(denoise(samples(PRESET, axis, seed, hours), LEVELS[axis], WAVELET).values, max(ORDERS))
    return {p: (*fit.alpha[p], fit.variance[p]) for p in ORDERS}


def study(records=50, hours=HOURS, workers=1, scaled_records=SCALED):
    """Return the tables: goals, table 2, the spread, and scaled thresholds."""
    values = _of(record, records, hours, workers)
    other = _of(scaled, min(scaled_records, records), hours, workers)
    table2, spread = _table(values, "Table 2", "thresholds without a scale"), _spread(values)
    farthest = max(float(x) for x in spread.column("largest distance of one record, %"))
    means = max(abs(float(x)) for x in spread.column("mean less expectation, %"))
    goals = Table(
        "Goals", ("figure", "goal", "result", "verdict"),
        (
            ("beta0² of one record from the mean of its axis, largest", f"{WITHIN:.0%}", f"{farthest:.1f} %", verdict(farthest <= 100 * WITHIN)),
            ("mean beta0² from its expectation, largest", f"{MEAN_WITHIN:.0%}", f"{means:.2f} %", verdict(means <= 100 * MEAN_WITHIN)),
        ),
    )  # fmt: skip
    return (
        goals,
        table2,
        spread,
        _table(other, "Thresholds scaled by each level", "thresholds scaled by the noise of each level"),
    )


def _of(function, records, hours, workers):
    """Return {axis: {order: (records, order + 1)}}."""
    jobs = [(seed, axis, hours) for seed in range(records) for axis in PAPER_AXES]
    done = over_records(function, jobs, workers)
    return {
        axis: {p: np.array([d[p] for (_, a, _), d in zip(jobs, done, strict=True) if a == axis]) for p in ORDERS}
        for axis in PAPER_AXES
    }


def _table(values, title, how):
    paper = published("quinchia2013")
    printed = paper and paper["table2_ar_after_wavelet_lod6"]
    rows = []
    for i, (axis, orders) in enumerate(values.items()):
        for order, found in orders.items():
            unit = "(rad/s)²" if axis.startswith("gyro") else "(m/s²)²"
            for k in range(order + 1):
                name, digits = (f"alpha {k + 1}", ".4f") if k < order else (f"beta0², {unit}", ".4g")
                own, spread = found[:, k].mean(), found[:, k].std(ddof=1) if len(found) > 1 else float("nan")
                theirs = printed and (
                    printed[f"ar{order}_alpha"][i][k] if k < order else printed[f"ar{order}_beta0_sq"][i]
                )
                rows.append((
                    axis, f"AR({order})", name, "–" if theirs is None else f"{theirs:.4g}", f"{own:{digits}}", f"{spread:.2g}",
                    "–" if theirs is None else f"{own / theirs:.3f}",
                ))  # fmt: skip
    note = f"Mean and standard deviation over {len(found)} records, {how}; ratio of the mean to the paper's value."
    return Table(
        title, ("axis", "process", "parameter", "table 2", "mean", "standard deviation", "ratio"), tuple(rows), note
    )


def _spread(values):
    rows = []
    for axis, orders in values.items():
        model = expected(preset(PRESET).axes[axis].processes, LEVELS[axis], 1 / RATE)
        for process, (order, found) in zip(model, orders.items(), strict=True):
            powers = found[:, -1]
            far = 100 * np.abs(powers / powers.mean() - 1).max()
            sd = 100 * powers.std(ddof=1) / powers.mean() if powers.size > 1 else float("nan")
            rows.append(
                (
                    axis,
                    f"AR({order})",
                    f"{sd:.2f}",
                    f"{far:.2f}",
                    f"{100 * (powers.mean() / process.beta0**2 - 1):+.2f}",
                )
            )
    headings = (
        "axis",
        "process",
        "standard deviation, %",
        "largest distance of one record, %",
        "mean less expectation, %",
    )
    return Table("beta0² over records", headings, tuple(rows), "Of the mean over the records of the same axis.")


if __name__ == "__main__":
    main(__file__, QUESTION, study, 50, lambda n: f"seeds 0..{n - 1} of {PRESET}; {HOURS:g} h at {RATE:g} Hz")

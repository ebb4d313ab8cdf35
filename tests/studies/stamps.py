"""Test rate and N of records whose stamps are not the times of their samples.

A record is a CSV file of a minute or more of white noise on six axes, from a sensor whose rate is up to 1 % off its nominal one.
Its stamps are those of recorders: times of arrival in bursts of 2 to 7 rows over a serial line; those of a clock of 1 ms at 300 Hz,
and of a clock of 1 s at 100 Hz; one stamp for each packet of 4 samples; seconds and nanoseconds in two columns. For comparison, the
same record has the stamps of its samples. Each file goes through ``imuwb.readers.read``, and each axis through ``fit_likelihood``,
the headline estimator of ``imuwb noise``. Goals: the rate within 0.1 %; intervals of N that contain the truth in 92 to 98 %.

Command: ``python tests/studies/stamps.py`` (200 records: about 5 minutes in one process).
Seeds: record r uses ``numpy.random.default_rng(r)``.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb import readers
from imuwb.identification import fit_likelihood
from imuwb.sampling import sampling

QUESTION = "Rate and N of records with bursty, coarse, repeated and split stamps"
WHITE = {"gyro": 0.0002, "accel": 0.003}  #: rad/s/√Hz and m/s²/√Hz, one-sided N
ROWS = 8000
NAMES = "gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"
KINDS = {
    "times of the samples": 100.0, "arrival in bursts": 100.0, "clock of 1 ms": 300.0, "clock of 1 s": 100.0,
    "packets of 4 samples": 104.0, "seconds and nanoseconds": 100.0,
}  # fmt: skip
RATE, COVERAGE = 1e-3, (0.92, 0.98)


def stamps(kind, time, rng):
    """Return the cells of the stamps of a record, and their header."""
    if kind == "arrival in bursts":
        ends = np.cumsum(rng.integers(2, 8, time.size))
        ends = np.append(ends[ends < time.size], time.size)
        arrived, first = np.empty(time.size), 0
        for end in ends:
            arrived[first:end] = time[end - 1] + 0.0001 + 0.0019 * np.arange(end - first)
            first = end
        time = np.maximum.accumulate(arrived)
    elif kind.startswith("clock"):
        tick = 0.001 if "ms" in kind else 1.0
        time = np.floor(time / tick) * tick
    elif kind.startswith("packets"):
        time = time[np.minimum(np.arange(time.size) // 4 * 4 + 3, time.size - 1)]
    if kind == "seconds and nanoseconds":
        whole = np.floor(time)
        nano = np.rint((time - whole) * 1e9)
        return [
            f"{int(s) + 1_700_000_000},{int(n)}" for s, n in zip(whole, nano, strict=True)
        ], "header.stamp.sec,header.stamp.nanosec"
    return [f"{t:.6f}" for t in time], "time_s"


def record(kind, seed):
    """Return the relative error of the rate, and for each axis whether its interval contains N."""
    rng = np.random.default_rng(seed)
    rate = KINDS[kind] * (1 + rng.uniform(-0.01, 0.01))
    time = rng.uniform(0, 1) + np.arange(ROWS) / rate
    sigma = np.repeat(list(WHITE.values()), 3) * np.sqrt(rate)
    values = rng.normal(0, sigma, (ROWS, 6)) - [0, 0, 0, 0, 0, 9.8]
    cells, header = stamps(kind, time, rng)
    lines = [f"{at}," + ",".join(f"{x:.9f}" for x in row) for at, row in zip(cells, values, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "log.csv"
        file.write_text("\n".join([f"{header},{NAMES}", *lines, ""]), "utf-8")
        imu = readers.read(file).imu()
    inside = []
    for axis, (times, series) in imu.axes().items():
        clock = sampling(times)
        n = fit_likelihood(np.ascontiguousarray(series), clock.interval).coefficients["N"]
        inside.append(bool((n.lower or 0.0) <= WHITE[axis.split("_")[0]] <= n.upper))
    return sampling(imu.angular_rate.time).rate / rate - 1, len(imu.angular_rate), inside


def study(records=200, workers=1):
    """Return the table of all kinds."""
    rows = []
    for kind, nominal in KINDS.items():
        found = over_records(record, [(kind, seed) for seed in range(records)], workers)
        inside = Share(sum(sum(one[2]) for one in found), 6 * records)
        worst = max(abs(one[0]) for one in found)
        lost = sum(ROWS - one[1] for one in found)
        rows.append(
            (
                kind,
                nominal,
                100 * worst,
                lost,
                inside,
                verdict(worst <= RATE and COVERAGE[0] <= inside.value <= COVERAGE[1]),
            )
        )
    return (
        Table(
            "Stamps", ("stamps", "nominal rate, Hz", "largest error of the rate, %", "rows left out", "coverage of N", "goals"), tuple(rows),
            "Coverage counts six axes of each record.",
        ),
    )  # fmt: skip


if __name__ == "__main__":
    main(__file__, QUESTION, study, 200, lambda records: f"{records} records of {ROWS} rows for each kind of stamps")

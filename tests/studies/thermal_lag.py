"""Simulate ramps of temperature with a lagging thermometer and hysteresis: the lag, and the false random walk that is left.

A still IMU of six axes warms from -20 to 60 °C and cools again in an hour, at 20 Hz. Each axis has white noise of 0.005 deg/s/√Hz or
1 mm/s²/√Hz and no other noise: the true K is 0. Its bias is a parabola of its own temperature, with random factors up to 0.02 deg/s/°C and
5 mm/s²/°C. Each axis also has a hysteresis, half of it added while the temperature rises and half taken off while it falls: up to 0.05
deg/s or 5 mm/s². The thermometer has 1 Hz, a noise of 0.02 °C and a lag of first order of 10 to 180 s; every fourth sensor lags its
thermometer instead. ``imuwb temperature`` analyses each of the first 100 records whole, as it does by default, and every fifth of these
also with ``--lag 0``; of the others only the lag is estimated. The same records with a thermometer of 0.1 °C make a second table.

Goals: the lag lies in its 95 % interval in 93 to 97 % of records; at least 95 % of axes have no K in the saved model; six cycles of
temperature in one hour take at most seven times the CPU of one.

Command: ``python tests/studies/thermal_lag.py`` (200 records: about 6 minutes in one process).
Seeds: ``numpy.random.default_rng(r)`` draws record r. The estimator was made with records 0 to 1099; those from 3000 on judge it.
"""

from __future__ import annotations

import time

import numpy as np
from scipy.signal import lfilter
from study_report import GOALS, Mean, Share, Table, main, over_records, verdict

from imuwb.log import AXES, SECOND, ImuStream, Log, Origin, Provenance, Scalars, Triad
from imuwb.stochastic import RandomWalk
from imuwb_plugins.temperature.compute import error_model, run
from imuwb_plugins.temperature.parameters import Parameters
from imuwb_plugins.temperature.sensor_temperature import lag_of

QUESTION = "Lag of a thermometer, hysteresis, and the random walk that they imitate"
RATE, MINUTES, COLD, SPAN, READINGS = 20.0, 60.0, -20.0, 80.0, 1.0
THERMOMETERS = (0.02, 0.1)  #: °C, noise of a reading
DEGREE = np.pi / 180
WHITE = {"gyro": 0.005 * DEGREE, "accel": 1e-3}
SLOPE = {"gyro": 0.02 * DEGREE, "accel": 5e-3}
LOOP = {"gyro": 0.05 * DEGREE, "accel": 5e-3}
LEFT = 5  #: the lag is also left in, in every fifth record
LAGS, LEADS = (10.0, 180.0), 4
FIRST = 3000  #: seed of the first record
WHOLE = 100  #: records that are analysed whole
LOW, HIGH, NULL, MOST, CYCLES = 0.93, 0.97, 0.95, 7.0, (1, 6)


def low_pass(values, seconds):
    """Return straight lines between the values through a low-pass of first order, exactly."""
    keep = np.exp(-1 / RATE / seconds)
    early = (1 - keep) * seconds * RATE
    return lfilter([1 - early, early - keep], [1, -keep], values - values[0]) + values[0]


def simulated(seed, minutes, cycles=1, *, lagging=True, noise=THERMOMETERS[0]):
    """Return a log, its lag (s) and the hysteresis of each axis."""
    rng = np.random.default_rng(seed)
    n = round(minutes * 60 * RATE)
    t = np.arange(n) / RATE
    phase = (t * cycles / (minutes * 60)) % 1
    celsius = COLD + SPAN * (1 - np.abs(2 * phase - 1))
    lag = rng.uniform(*LAGS) * minutes / MINUTES if lagging else 0.0
    leads = seed % LEADS == LEADS - 1
    own, read = celsius, celsius
    if lag:
        own, read = (low_pass(celsius, lag), celsius) if leads else (celsius, low_pass(celsius, lag))
    rising = np.sign(np.gradient(own))
    loops, columns = {}, []
    for axis in AXES:
        sensor = axis[:-2]
        slope, bend = rng.uniform(-1, 1, 2) * SLOPE[sensor] * (1, 5e-3)
        loops[axis] = 2 * float(rng.uniform(-1, 1)) * LOOP[sensor] if lagging else 0.0
        bias = slope * (own - 25) + bend * (own - 25) ** 2 + loops[axis] / 2 * rising
        columns.append(bias + WHITE[sensor] * RATE**0.5 * rng.standard_normal(n))
    stamps = np.rint(t * SECOND).astype(np.int64)
    every = slice(None, None, round(RATE / READINGS))
    seen = read[every] + noise * rng.standard_normal(read[every].size)
    triads = [Triad(stamps, np.stack(columns[k : k + 3], axis=1)) for k in (0, 3)]
    imu = ImuStream("/imu", *triads, Scalars("/temperature", stamps[every], seen), Origin())
    return Log(Provenance(f"record {seed}", "study", f"sha256:{seed}", 0), imus=(imu,)), (-lag if leads else lag), loops


def walks(result):
    """Return which axes have a random walk in the error model."""
    model = error_model(result)
    return {
        axis: any(isinstance(term, RandomWalk) for _, sums in own.thermal for term in sums.terms)
        or any(isinstance(term, RandomWalk) for term in own.processes.terms)
        for axis, own in model.axes.items()
    }


def record(seed, minutes, noise, whole):
    """Return the lag, its estimate, the hysteresis and their estimates, the walks with the lag removed, and those with it left."""
    log, lag, loops = simulated(seed, minutes, noise=noise)
    if not whole:
        found = lag_of(log, Parameters())
        return lag, found.lag, loops, found.hysteresis, {}, {}
    found = run([log], Parameters())
    left = {} if seed % LEFT else walks(run([log], Parameters(lag=0.0)))
    return lag, found.lags[0].lag, loops, found.lags[0].hysteresis, walks(found), left


def seconds(cycles, minutes):
    """Return the CPU time of an analysis, s."""
    log, *_ = simulated(0, minutes, cycles, lagging=False)
    begin = time.process_time()
    run([log], Parameters())
    return time.process_time() - begin


def lags(done):
    """Return the rows of a table about the lag and the hysteresis."""
    covered = Share(sum(lag in found for lag, found, *_ in done), len(done))
    z = np.array([(found.value - lag) / found.sigma for lag, found, *_ in done])
    loops = [(loops[a], estimates[a]) for _, _, loops, estimates, *_ in done for a in estimates]
    return (
        ("lag inside its 95 % interval", "93 to 97 %", covered, verdict(LOW <= covered.value <= HIGH)),
        ("error of the lag in standard errors, mean square", "–", Mean(float(np.mean(z**2)), float(np.std(z**2) / len(z) ** 0.5)), "–"),
        ("median standard error of the lag, s", "–", f"{np.median([f.sigma for _, f, *_ in done]):.2f}", "–"),
        ("hysteresis inside its 95 % interval, all axes", "–", Share(sum(h in e for h, e in loops), len(loops)), "–"),
    )  # fmt: skip


def study(records=200, minutes=MINUTES, workers=1):
    """Return the table of goals, and what is found with a noisier thermometer."""
    seconds(1, minutes)  # compiles the kernels
    times = [seconds(c, minutes) for c in CYCLES]
    quiet, noisy = (
        over_records(record, [(FIRST + k, minutes, noise, k < WHOLE and noise == THERMOMETERS[0]) for k in range(records)], workers)
        for noise in THERMOMETERS
    )  # fmt: skip
    whole = quiet[:WHOLE]
    clean = [not walk for *_, removed, _ in whole for walk in removed.values()]
    sound = [not any(removed.values()) for *_, removed, _ in whole]
    before = [not walk for *_, left in whole for walk in left.values()]
    null = Share(sum(clean), len(clean))
    ratio = times[1] / times[0]
    return (
        Table("Goals", GOALS, (
            *lags(quiet),
            ("axes without K in the saved model", "at least 95 %", null, verdict(null.value >= NULL)),
            ("records without K in any of six axes", "–", Share(sum(sound), len(sound)), "–"),
            ("axes without K if the lag is left in (--lag 0)", "–", Share(sum(before), len(before)), "–"),
            ("CPU of six cycles over that of one", "at most 7", f"{ratio:.1f} ({times[1]:.1f} s, {times[0]:.1f} s)", verdict(ratio <= MOST)),
        )),
        Table(f"A thermometer with a noise of {THERMOMETERS[1]:g} °C", GOALS, lags(noisy)),
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__,
        QUESTION,
        study,
        200,
        lambda n: f"records {FIRST} to {FIRST + n - 1}; the estimator was made with records 0 to 1099",
    )

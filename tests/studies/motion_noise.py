"""Estimate the noise in motion on simulated drives of known noise, and judge the filters with and without it in outages.

Each drive takes 8 minutes (mixed route, 50 Hz, fixes each second with their true sigmas). The sensor is one of three published ones
with a turn-on bias; in motion, white noise and random walks are added whose amplitudes are drawn for each drive, log-uniform in the
ranges of ``RANGES``. The filters know the sensor's model at rest: ``bench`` uses it alone, ``motion`` is what
``estimate_motion_noise`` returns. Outages of 60 s begin every 10 s from the second minute on, and are judged at 10, 30 and 60 s.

NEES/2 is 1 if sigma is right. Outages of a drive are dependent; its mean is one value, and the intervals of NEES/2 are those of the
mean over drives. An amplitude is held if the interval of 95 % has the true value. The variance of an estimate is the larger one of the
sandwich's and the curvature's, and an amplitude that is not shown has an interval from 0 on, which holds the truth in 97.5 %: intervals
hold it in 95 % or somewhat more by construction.

Command: ``python tests/studies/motion_noise.py`` (210 drives: about 25 minutes on two cores).
Seeds: seed r makes the amplitudes, the sensor and the route of drive r; the sensor of drive r is number r modulo 3.
"""

from dataclasses import dataclass, replace

import numpy as np
from study_report import Share, Table, main, over_records

from imuwb.navigation import FilterModel, Settings
from imuwb.replay import TURN_ON, Outage, estimate_motion_noise, model_named, prepare, replay, with_unidentified
from imuwb.simulation import MotionNoise, Receiver, drive, mixed_route, preset
from imuwb.stochastic import Constant, Sum

QUESTION = "Noise in motion, from the innovations of a filter"
SECONDS, RATE = 480.0, 50.0
FIRST, EVERY, DURATION = 120.0, 10.0, 60.0  #: s, of the outages
HORIZONS = (10, 30, 60)  #: s
LIMIT = 5.991  #: 95 % quantile of chi-squared with two degrees of freedom
SENSORS = ("mpu-6050", "3dm-gx3-25", "ahrs300cc")
#: N of gyros, N of accelerometers, K of gyros, K of accelerometers, SI
RANGES = ((3e-4, 3e-3), (3e-3, 3e-2), (5e-6, 5e-5), (1e-4, 1e-3))
NAMES = ("N of gyros", "N of accelerometers", "K of gyros", "K of accelerometers")
BAND = {"NEES/2": (0.8, 1.25), "within": (0.92, 0.98)}


@dataclass(frozen=True)
class Drive:
    """The results of one drive."""

    sensor: str
    nees: dict[str, np.ndarray]  #: filter -> (outages, horizons)
    drift: dict[str, np.ndarray]  #: filter -> (outages, horizons) m
    held: tuple[bool, ...]
    error: tuple[float, ...]  #: logarithm of the ratio of estimate to truth


def amplitudes(seed):
    """Return the noise that a drive adds in motion."""
    rng = np.random.default_rng([seed, 1])
    return tuple(float(np.exp(rng.uniform(*np.log(r)))) for r in RANGES)


def one(seed):
    """Return the results of the drive of a seed."""
    name = SENSORS[seed % len(SENSORS)]
    bench = at_rest(preset(name))
    true = amplitudes(seed)
    log = drive(
        with_turn_on(bench), mixed_route(SECONDS, seed), seed, rate=RATE, receiver=Receiver(),
        motion_noise=MotionNoise(true[:2], true[2:], when="always"),
    )  # fmt: skip
    base = FilterModel("base", bench, settings=Settings(spacing=1.0))
    prepared = prepare(log, base)
    full = model_named("full", base, interval=prepared.measurement.interval, turn_on=TURN_ON)
    full = replace(full, name="bench", error_model=with_unidentified(full.error_model, bench)[0])
    model, found = estimate_motion_noise(prepared, full, 0.95)
    fixes = prepared.fix_time
    starts = [float(fixes[np.argmin(np.abs(fixes - t))]) for t in np.arange(FIRST, SECONDS - DURATION - 5, EVERY)]
    done = replay(prepared, [full, model], [Outage(t, DURATION) for t in dict.fromkeys(starts)])
    marks = [h - 1 for h in HORIZONS]
    nees, drift = {}, {}
    for filter_name, run in done.runs.items():
        scores = run.outages[DURATION].scores.of(done.scored[DURATION], DURATION)
        nees[filter_name], drift[filter_name] = scores.nees[:, marks], scores.horizontal[:, marks]
    estimates = (*found.white, *found.walk)
    return Drive(
        name, nees, drift, tuple(e.lower <= t <= e.upper for e, t in zip(estimates, true, strict=True)),
        tuple(float(np.log(e.value / t)) for e, t in zip(estimates, true, strict=True)),
    )  # fmt: skip


def at_rest(model):
    """Return a sensor's noise without its turn-on biases, as a bench record shows it."""
    axes = {
        name: replace(own, processes=Sum(tuple(t for t in own.processes.terms if not isinstance(t, Constant))))
        for name, own in model.axes.items()
    }
    return replace(model, axes=axes)


def with_turn_on(model):
    """Return a sensor with the usual turn-on biases of the filter ``full``."""
    axes = {
        name: replace(own, processes=Sum((*own.processes.terms, Constant(TURN_ON[name[0] == "a"]))))
        for name, own in model.axes.items()
    }
    return replace(model, axes=axes)


def study(records, workers=2):
    """Return the tables of that many drives."""
    drives = over_records(one, [(seed,) for seed in range(records)], workers)
    return (*(_outages(drives, sensor) for sensor in (*SENSORS, "all")), _held(drives))


def _outages(drives, sensor):
    own = [d for d in drives if sensor in ("all", d.sensor)]
    rows = []
    for name in ("bench", "motion"):
        for k, horizon in enumerate(HORIZONS):
            means = np.array([d.nees[name][:, k].mean() / 2 for d in own if name in d.nees])
            values = np.concatenate([d.nees[name][:, k] for d in own if name in d.nees])
            drift = np.concatenate([d.drift[name][:, k] for d in own if name in d.drift])
            half = 1.96 * means.std(ddof=1) / np.sqrt(means.size) if means.size > 1 else np.nan
            rows.append((
                name, f"{horizon} s", f"{np.median(drift):.1f} m", f"{means.mean():.3g} ± {half:.2g}",
                f"{100 * (values <= LIMIT).mean():.1f} %",
            ))  # fmt: skip
    title = f"{sensor}: {len(own)} drives"
    return Table(title, ("filter", "after", "median drift", "NEES/2", "within the 95 % ellipse"), tuple(rows))


def _held(drives):
    rows = []
    for i, name in enumerate(NAMES):
        errors = np.array([d.error[i] for d in drives])
        share = Share(sum(d.held[i] for d in drives), len(drives))
        rows.append((name, share.text(), f"{np.exp(np.median(errors)):.3f}", f"{errors.std():.2f}"))
    together = Share(sum(sum(d.held) for d in drives), len(drives) * len(NAMES))
    rows.append(("all", together.text(), "", ""))
    headings = ("amplitude", "intervals that have the truth", "median of estimate / truth", "sd of its logarithm")
    return Table("Amplitudes in motion", headings, tuple(rows))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 210, lambda n: f"{n} drives, seeds 0 to {n - 1}")

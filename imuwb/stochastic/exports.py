"""Error models in the forms of other tools, in the units that the documentation of each tool states.

Where a tool takes one value for three axes, the largest is written, so that no axis is trusted too much; a comment states the
spread. A comment also states which terms a tool has no parameter for (bias instability in most).
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any, cast

from imuwb.errors import MissingDataError, UsageError
from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.error_model import ImuErrorModel
from imuwb.stochastic.flicker import FLICKER_LEVEL, FlickerNoise
from imuwb.stochastic.gauss_markov import GaussMarkov
from imuwb.stochastic.processes import Constant, RandomWalk, WhiteNoise

SENSORS = ("gyro", "accel")
UNEVEN = 1.5  #: ratio of the largest axis to the smallest, above which a comment states it
PEAK = 0.6174  #: largest Allan deviation of a Gauss-Markov process over its sigma


@dataclass(frozen=True, slots=True)
class Sensor:
    """The parameters of three axes that exports need, SI; None where an axis has none."""

    name: str
    white: tuple[float | None, ...]  #: N
    #: K; a Gauss-Markov process counts as a random walk of K = sigma √(2/Tc), because it grows like that walk until about Tc
    walk: tuple[float | None, ...]
    sigma: tuple[float | None, ...]  #: sigma of the Gauss-Markov process
    time: tuple[float | None, ...]  #: Tc of the Gauss-Markov process, s
    flicker: tuple[float | None, ...]  #: B

    @staticmethod
    def of(model: ImuErrorModel, name: str) -> Sensor:
        """Return the three axes of ``gyro`` or ``accel``."""
        axes = [model.axes.get(f"{name}_{axis}") for axis in "xyz"]

        def each(take: Callable[[AxisModel], float | None]) -> tuple[float | None, ...]:
            return tuple(None if a is None else take(a) for a in axes)

        kinds = ((WhiteNoise, "N"), (GaussMarkov, "sigma"), (GaussMarkov, "Tc"), (FlickerNoise, "B"))
        white, sigma, time, flicker = (each(partial(_first, kind=kind, parameter=p)) for kind, p in kinds)
        return Sensor(name, white, each(_walk), sigma, time, flicker)

    def largest(self, what: str, values: tuple[float | None, ...], notes: list[str]) -> float:
        """Return the largest of three values, with a note where they differ much.

        Raises:
            MissingDataError: no axis has a value.
        """
        known = [v for v in values if v]
        if not known:
            raise MissingDataError(
                f"the model has no {what} for the {self.name}; this tool needs it; 0 would be wrong; add the term to the model"
            )
        if len(known) < len(values):
            notes.append(f"{self.name} {what}: {len(values) - len(known)} of 3 axes have none")
        if max(known) > UNEVEN * min(known):
            notes.append(
                f"{self.name} {what}: the largest of three axes, {max(known) / min(known):.2g} times the smallest"
            )
        return max(known)

    def all_white(self, why: str) -> list[float]:
        """Return N of the three axes.

        Raises:
            MissingDataError: an axis has none; the message states why the tool needs it.
        """
        known = [n for n in self.white if n]
        if len(known) < len(self.white):
            raise MissingDataError(f"the model lacks N on an axis of the {self.name}; {why}; add the term to the model")
        return known


def _first(model: AxisModel, kind: type, parameter: str) -> float | None:
    return next((getattr(term, parameter) for term in model.processes.terms if isinstance(term, kind)), None)


def _walk(model: AxisModel) -> float | None:
    squares = [term.K**2 for term in model.processes.terms if isinstance(term, RandomWalk)]
    squares += [2 * term.sigma**2 / term.Tc for term in model.processes.terms if isinstance(term, GaussMarkov)]
    return math.sqrt(sum(squares)) if squares else None


def _walk_or_stated(sensor: Sensor, notes: list[str], horizon: float) -> float:
    """Return K; with flicker only, K of the walk whose Allan deviation reaches the flat level at a horizon, and a note."""
    if any(sensor.walk):
        if any(sensor.sigma):
            notes.append(
                f"{sensor.name}: a Gauss-Markov bias is written as a random walk with K = sigma √(2/Tc); after Tc this walk is too large"
            )
        return sensor.largest("K (random walk)", sensor.walk, notes)
    if any(sensor.flicker):
        b = sensor.largest("B (bias instability)", sensor.flicker, notes)
        notes.append(
            f"{sensor.name}: no random walk was identified; K is chosen so that the Allan deviation of the walk reaches the flat level of B at "
            f"{horizon:g} s (--horizon), √3 · 0.664 B / √horizon"
        )
        return math.sqrt(3 / horizon) * FLICKER_LEVEL * b
    return sensor.largest("K (random walk)", sensor.walk, notes)


def _bias(sensor: Sensor, notes: list[str]) -> tuple[list[float], float]:
    """Return sigma of each axis's Gauss-Markov bias, and the correlation time; without such a bias, sigma comes from flicker."""
    if all(sensor.sigma) and all(sensor.time):
        times = [t for t in sensor.time if t]
        longest = max(times)
        if longest > UNEVEN * min(times):
            notes.append(
                f"{sensor.name}: correlation times differ, {min(times):.3g} to {longest:.3g} s; the longest is written, with each axis's own sigma"
            )
        return [s for s in sensor.sigma if s], longest
    if all(sensor.flicker):
        notes.append(
            f"{sensor.name}: sigma is 1.076 B: the Allan deviation of this Gauss-Markov process peaks at the flat level of B; set the correlation time to your horizon"
        )
        return [FLICKER_LEVEL / PEAK * b for b in sensor.flicker if b], math.nan
    raise MissingDataError(
        f"the model lacks a Gauss-Markov process or a bias instability on an axis of the {sensor.name}; KF-GINS needs one on all three; 0 would be wrong"
    )


def kalibr(model: ImuErrorModel, rate: float, horizon: float) -> str:
    """Kalibr, imu.yaml: continuous densities, rad/s/√Hz, m/s²/√Hz and their random walks (wiki: IMU Noise Model)."""
    notes: list[str] = []
    gyro, accel = (Sensor.of(model, name) for name in SENSORS)
    rows = [
        f"accelerometer_noise_density: {accel.largest('N (white noise)', accel.white, notes):.10g}  # m/s^2/sqrt(Hz)",
        f"accelerometer_random_walk: {_walk_or_stated(accel, notes, horizon):.10g}  # m/s^3/sqrt(Hz)",
        f"gyroscope_noise_density: {gyro.largest('N (white noise)', gyro.white, notes):.10g}  # rad/s/sqrt(Hz)",
        f"gyroscope_random_walk: {_walk_or_stated(gyro, notes, horizon):.10g}  # rad/s^2/sqrt(Hz)",
        "rostopic: /imu0  # change to your topic",
        f"update_rate: {rate:g}  # Hz",
    ]
    head = "Kalibr imu.yaml; units as in its wiki, IMU Noise Model: https://github.com/ethz-asl/kalibr/wiki/IMU-Noise-Model"
    return _text(head, model, [*notes, *_left_out(model, (WhiteNoise, RandomWalk, GaussMarkov, Constant))], rows)


def ros(model: ImuErrorModel, rate: float, horizon: float) -> str:
    """ROS sensor_msgs/Imu: covariance matrices of a sample, row-major about x, y, z, (rad/s)² and (m/s²)²."""
    notes = [
        f"variance of a sample at {rate:g} Hz, N² times the rate; a sensor whose bandwidth is below half the rate has less"
    ]
    rows: list[str] = []
    for name, key in (("gyro", "angular_velocity_covariance"), ("accel", "linear_acceleration_covariance")):
        sensor = Sensor.of(model, name)
        sensor.largest("N (white noise)", sensor.white, notes)
        diagonal = [n**2 * rate for n in sensor.all_white("a covariance of 0 would mean: unknown")]
        matrix = [diagonal[i] if i == j else 0.0 for i in range(3) for j in range(3)]
        rows.append(f"{key}: [{', '.join(f'{v:.10g}' for v in matrix)}]")
    rows.append("orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0]  # no orientation")
    head = "ROS sensor_msgs/Imu covariances, per axis in the message's frame: https://docs.ros.org/en/jazzy/p/sensor_msgs/msg/Imu.html"
    return _text(head, model, [*notes, *_left_out(model, (WhiteNoise,))], rows)


def kf_gins(model: ImuErrorModel, rate: float, horizon: float) -> str:
    """KF-GINS, kf-gins.yaml, imunoise: deg/√h, m/s/√h, deg/h, mGal, ppm, h (comments of its own kf-gins.yaml)."""
    notes = [
        "gsstd, asstd (scale factors, ppm) are no noise: write your own; KF-GINS takes initbgstd and initbastd from gbstd and abstd unless you set them"
    ]
    gyro, accel = (Sensor.of(model, name) for name in SENSORS)
    arw, vrw = (sensor.all_white("KF-GINS needs all three; 0 would be wrong") for sensor in (gyro, accel))
    (gyro_sigma, gyro_time), (accel_sigma, accel_time) = _bias(gyro, notes), _bias(accel, notes)
    known = [t for t in (gyro_time, accel_time) if not math.isnan(t)]
    time = max(known) if known else horizon
    if len(known) == 2 and max(known) > UNEVEN * min(known):  # noqa: PLR2004 - both
        notes.append(f"KF-GINS has one correlation time for all: the longest, {time:.3g} s, is written")

    def row(values: list[float]) -> str:
        return f"[{', '.join(f'{v:.8g}' for v in values)}]"

    degrees = 180 / math.pi
    rows = [
        "imunoise:",
        f"  arw: {row([n * degrees * 60 for n in arw])}  # deg/sqrt(hr)",
        f"  vrw: {row([n * 60 for n in vrw])}  # m/s/sqrt(hr)",
        f"  gbstd: {row([s * degrees * 3600 for s in gyro_sigma])}  # deg/hr",
        f"  abstd: {row([s * 1e5 for s in accel_sigma])}  # mGal",
        "  gsstd: [0.0, 0.0, 0.0]  # ppm",
        "  asstd: [0.0, 0.0, 0.0]  # ppm",
        f"  corrtime: {time / 3600:.8g}  # hr",
    ]
    head = "KF-GINS imunoise, axes forward-right-down; units as in https://github.com/i2Nav-WHU/KF-GINS, dataset/kf-gins.yaml"
    return _text(head, model, [*notes, *_left_out(model, (WhiteNoise, GaussMarkov))], rows)


def _plain(term: Any) -> dict[str, object]:  # noqa: ANN401 - any process
    return {"process": term.name, **{f.name: getattr(term, f.name) for f in fields(term)}}


#: PX4's parameter -> (sensor, what, unit, lowest, highest)
_PX4 = {
    "EKF2_GYR_NOISE": ("gyro", "white", "rad/s", 0.0001, 0.1), "EKF2_ACC_NOISE": ("accel", "white", "m/s^2", 0.01, 1.0),
    "EKF2_GYR_B_NOISE": ("gyro", "walk", "rad/s^2", 0.0, 0.01), "EKF2_ACC_B_NOISE": ("accel", "walk", "m/s^3", 0.0, 0.01),
}  # fmt: skip
PX4_STEP = 0.01  #: s, of its filter: EKF2_PREDICT_US, 10000 by default


def px4(model: ImuErrorModel, rate: float, horizon: float) -> str:
    """PX4 EKF2: rad/s, m/s², rad/s², m/s³ at the filter's step of 10 ms: N/√dt and K/√dt (module.yaml; covariance.cpp)."""
    notes = [
        f"N/√dt and K/√dt are written, with the filter's step dt of {PX4_STEP:g} s (EKF2_PREDICT_US): the filter squares a parameter and multiplies it by its step squared",
        "values from a bench are lower bounds, because a vehicle vibrates; the noise of gyros and accelerometers also limits how fast biases are learned",
    ]
    sensors = {name: Sensor.of(model, name) for name in SENSORS}
    rows: list[str] = []
    for key, (name, what, unit, low, high) in _PX4.items():
        sensor = sensors[name]
        size = (
            sensor.largest("N (white noise)", sensor.white, notes)
            if what == "white"
            else _walk_or_stated(sensor, notes, horizon)
        )
        value = size / math.sqrt(PX4_STEP)
        held = min(max(value, low), high)
        if held != value:
            notes.append(
                f"{key}: {value:.3g} {unit} is outside the limits of PX4, {low:g} to {high:g}; {held:g} is written"
            )
        rows.append(f"{key}\t{held:.6g}\t# {unit}")
    head = "PX4 EKF2 parameters; units and limits as in PX4-Autopilot, src/modules/ekf2/module.yaml"
    return _text(head, model, [*notes, *_left_out(model, (WhiteNoise, RandomWalk, GaussMarkov, Constant))], rows)


def as_json(model: ImuErrorModel, rate: float, horizon: float) -> str:
    """JSON, SI: processes, intervals and limits of the model."""
    axes = {
        axis: {
            "processes": [_plain(term) for term in cast("tuple[Any, ...]", a.processes.terms)],
            "intervals": {key: list(ends) for key, ends in a.intervals.items()},
            "limits": dict(a.limits),
        }
        for axis, a in model.axes.items()
    }
    return (
        json.dumps(
            {
                "name": model.name,
                "provenance": dict(model.provenance),
                "doubts": list(model.doubts),
                "units": "SI",
                "axes": axes,
            },
            indent=1,
            ensure_ascii=False,
        )
        + "\n"
    )


FORMATS: dict[str, Callable[[ImuErrorModel, float, float], str]] = {
    "kalibr": kalibr, "ros": ros, "kf-gins": kf_gins, "px4": px4, "json": as_json,
}  # fmt: skip


def export(model: ImuErrorModel, tool: str, *, rate: float = 100.0, horizon: float = 60.0) -> str:
    """Return an error model in the form of a tool.

    Args:
        model: the error model.
        tool: ``"kalibr"``, ``"ros"``, ``"kf-gins"``, ``"px4"`` or ``"json"``.
        rate: Hz, of the sensor's samples, for tools that need it.
        horizon: s, over which a random walk stands for a bias instability, for tools that have random walks only.

    Raises:
        UsageError: no such tool, or a rate or horizon that is not positive.
        MissingDataError: the model lacks a term that the tool must have.
    """
    if tool not in FORMATS:
        raise UsageError(f"--to {tool}: it must be one of {', '.join(FORMATS)}")
    if not (0 < rate < math.inf and 0 < horizon < math.inf):
        raise UsageError(f"the rate is {rate} Hz, the horizon {horizon} s; both must be positive")
    return FORMATS[tool](model, rate, horizon)


def _left_out(model: ImuErrorModel, written: tuple[type, ...]) -> list[str]:
    """Return notes of the terms of the model that the tool has no parameter for."""
    names: dict[str, list[str]] = {}
    for axis, content in model.axes.items():
        seen: set[type] = set()
        for term in cast("tuple[Any, ...]", content.processes.terms):
            if not isinstance(term, written) or (isinstance(term, GaussMarkov) and GaussMarkov in seen):
                names.setdefault(term.name.replace("_", " "), []).append(axis)
            seen.add(type(term))
    return [
        f"left out, as the tool has no parameter for it: {name} of {', '.join(axes)}" for name, axes in names.items()
    ]


def _text(head: str, model: ImuErrorModel, notes: list[str], rows: list[str]) -> str:
    source = "; ".join(f"{k}: {v}" for k, v in model.provenance.items())
    comments = [
        head,
        f"model {model.name}" + (f", {source}" if source else ""),
        *(f"in doubt: {doubt}" for doubt in model.doubts),
        *dict.fromkeys(notes),
    ]
    return "\n".join([*(f"# {' '.join(comment.split())}" for comment in comments), *rows]) + "\n"

"""An IMU's samples in the form that a filter needs: even steps without gaps, in the vehicle's axes."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.axes import check_three_axes
from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.log import SECOND, ImuStream, Log, Triad
from imuwb.navigation.even_clock import even_clock
from imuwb.navigation.filter_model import Installation
from imuwb.navigation.tables import Samples
from imuwb.notes import Note
from imuwb.sampling import longest_part

LEAST = 100  #: samples that navigation needs
LONGEST_GAP = 10.0  #: s; a longer gap is not bridged: the longest part without such gaps is used
NOTED_GAP = 0.05  #: s; an outage with a longer bridged gap is not scored
OTHER_GAP = 1.8  #: intervals; a longer step of an accelerometer with its own clock is a gap
HOLDS = 0.5  #: s, correlation time of a vehicle's motion
AFTER = 10  #: samples after a gap that count as part of it
REGIME = 2.0  #: °C, width of a regime


@dataclass(frozen=True, eq=False, slots=True)
class Measurement:
    """An IMU's samples on an even clock, in the vehicle's axes."""

    time: Floats  #: (n,) s from the log's start, at the end of each step
    interval: float  #: s, the mean step
    samples: Samples
    celsius: tuple[float | None, ...]  #: °C, temperature of each regime; None: the log has no temperature
    bridged: Floats  #: (g, 2) s from the log's start: begin and end of the gaps that are bridged
    gap_noise: Floats | None  #: (6,) unit²/Hz; density of the unknown motion in bridged gaps, the last regime
    notes: tuple[Note, ...] = ()
    vibration: tuple[
        float, ...
    ] = ()  #: level of vibration of each regime over the filter's reference; empty: not divided

    def __repr__(self) -> str:
        """Return time, rate and gaps in a line."""
        return (
            f"Measurement: {self.time.size} samples, {self.time[0]:.1f} s to {self.time[-1]:.1f} s, "
            f"{1 / self.interval:.4g} Hz, {len(self.bridged)} bridged gaps"
        )


def measurement_of(log: Log, imu: ImuStream, installation: Installation, *, thermal: bool = False) -> Measurement:
    """Return an IMU's samples in the form that a filter needs.

    A sample is the average since the sample before. An even clock replaces stamps with jitter; straight lines bridge gaps.

    Args:
        log: the log of the IMU; times count from its start.
        imu: gyros and accelerometers.
        installation: mounting, clock rate and skew.
        thermal: whether the model's parameters depend on temperature; the samples then have regimes.

    Raises:
        MissingDataError: no gyros, no accelerometers, or too few samples.
    """
    if imu.angular_rate is None or imu.specific_force is None:
        lacks = "gyro" if imu.angular_rate is None else "accelerometer"
        remedy = next((n for n in log.notes if getattr(n, "id", "") == "parts_apart"), "choose another IMU with --imu")
        raise MissingDataError(f"{log.provenance.path}: {imu.name} has no {lacks}, and navigation needs both; {remedy}")
    return _measured(imu, log.zero or 0, log.provenance.path, installation, thermal)


@lru_cache(maxsize=1)  # a start, clocks and filters are found one after the other from the same samples
def _measured(imu: ImuStream, zero: int, path: str, installation: Installation, thermal: bool) -> Measurement:  # noqa: FBT001
    gyro, accel = _triads(path, imu)
    notes: list[Note] = []
    time, other = (gyro.time - zero) / SECOND, (accel.time - zero) / SECOND - installation.skew
    part = _longest(time, notes)
    own, interval, present = even_clock(time[part])
    step = np.diff(own, prepend=own[0] - interval)
    rate = _filled(gyro.value[part], present)
    gaps = _gaps(own, step, interval, present, notes)
    if other.size == time.size and np.array_equal(other, time):
        force = _filled(accel.value[part], present)
    else:
        force = _onto(own, step, other, accel.value)
        gaps += _gaps_of_other_clock(other, notes)
    # ``mounting`` turns vectors from the vehicle's axes to the IMU's; here they turn the other way.
    turn = rotation_of_euler(np.radians(installation.mounting))
    if any(installation.mounting):
        rate, force = np.ascontiguousarray(rate @ turn), np.ascontiguousarray(force @ turn)
    regime, celsius = _regimes(imu, own, zero, notes) if thermal else (np.zeros(own.size, np.int64), (None,))
    gap_noise = None
    if gaps:
        within = np.zeros(own.size, dtype=bool)
        for begin, end in gaps:
            within |= (own > begin) & (own <= end + AFTER * interval)
        # Assumption: the motion in a gap has the variance sigma² of the rest, and the correlation time T = HOLDS.
        # Its density is then 2 sigma² T.
        gap_noise = 2 * HOLDS * np.concatenate([part[~within].var(axis=0) for part in (rate, force)])
        regime, celsius = np.where(within, len(celsius), regime), (*celsius, celsius[int(np.bincount(regime).argmax())])
    true = own[0] + (own - own[0]) * installation.clock_rate
    bridged = own[0] + (np.array(gaps).reshape(-1, 2) - own[0]) * installation.clock_rate
    step = step * installation.clock_rate
    samples = Samples(step, rate * step[:, None], force * step[:, None], regime)
    return Measurement(true, interval * installation.clock_rate, samples, celsius, bridged, gap_noise, tuple(notes))


def with_rate(measurement: Measurement, ratio: float) -> Measurement:
    """Return a measurement whose clock's second lasts longer by a ratio; rates and forces stay."""
    own, begin = measurement.samples, measurement.time[0]
    samples = own._replace(interval=own.interval * ratio, angle=own.angle * ratio, velocity=own.velocity * ratio)
    return replace(
        measurement, time=begin + (measurement.time - begin) * ratio, interval=measurement.interval * ratio,
        samples=samples, bridged=begin + (measurement.bridged - begin) * ratio,
    )  # fmt: skip


def denoised(
    measurement: Measurement, levels: tuple[int, ...], scale: Literal["level", "first", "none"] = "level"
) -> Measurement:
    """Return a measurement after wavelet denoising of the whole record (db4, SURE, soft: Quinchia, 4.5); not causal.

    Args:
        measurement: in the vehicle's axes.
        levels: number of levels of decomposition of each axis, ``gyro_x`` ... ``accel_z``.
        scale: sigma of the noise, as in ``imuwb.conditioning.denoise``.
    """
    from imuwb.conditioning import denoise  # noqa: PLC0415 - pywt is slow to import, and seldom needed

    samples = measurement.samples
    angle, velocity = samples.angle.copy(), samples.velocity.copy()
    for axis, level in enumerate(levels):
        increments = (angle, velocity)[axis // 3]
        rate = denoise(np.ascontiguousarray(increments[:, axis % 3] / samples.interval), level, scale=scale).values
        increments[:, axis % 3] = rate * samples.interval
    return replace(measurement, samples=samples._replace(angle=angle, velocity=velocity))


def _triads(path: str, imu: ImuStream) -> tuple[Triad, Triad]:
    gyro, accel = imu.angular_rate, imu.specific_force
    if gyro is None or accel is None or min(len(gyro), len(accel)) < LEAST:
        raise MissingDataError(
            f"{path}: {imu.name} has fewer than {LEAST} samples of gyros or accelerometers; navigation "
            f"needs at least {LEAST} of each; choose another IMU with --imu"
        )
    check_three_axes(path, imu, "navigation")
    return gyro, accel


def _longest(time: Floats, notes: list[Note]) -> slice:
    """Return the longest part without a gap that is too long to be bridged."""
    ends = np.flatnonzero(np.diff(time) > LONGEST_GAP) + 1
    part = longest_part(ends.tolist(), time.size)
    if ends.size:
        text = (
            f"the IMU has {ends.size} gaps longer than {LONGEST_GAP:g} s: the longest part between them is used, "
            f"{time[part][0]:.1f} s to {time[part][-1]:.1f} s"
        )
        notes.append(Note("imu-part", text))
    return part


def _filled(values: Floats, present: Integers) -> Floats:
    """Return values at all steps; straight lines bridge the steps without a sample."""
    if present.size == present[-1] + 1:
        return values
    every = np.arange(present[-1] + 1)
    return np.stack([np.interp(every, present, values[:, i]) for i in range(values.shape[1])], axis=1)


def _gaps(
    time: Floats, step: Floats, interval: float, present: Integers, notes: list[Note]
) -> list[tuple[float, float]]:
    """Return begin and end of each gap that is long enough to be noted, s."""
    wide = np.flatnonzero(np.diff(present) > 1)
    first, last = present[wide] + 1, present[wide + 1]  # the last is excluded
    if wide.size:
        text = f"{int((last - first).sum())} samples are missing in {wide.size} gaps: straight lines bridge them"
        notes.append(Note("imu-gaps", text))
    return [
        (float(time[a] - step[a]), float(time[b - 1]))
        for a, b in zip(first, last, strict=True)
        if (b - a) * interval > NOTED_GAP
    ]


def _gaps_of_other_clock(time: Floats, notes: list[Note]) -> list[tuple[float, float]]:
    """Return begin and end of the gaps of an accelerometer with its own clock, s."""
    steps = np.diff(time)
    wide = np.flatnonzero((steps > OTHER_GAP * np.median(steps)) & (steps > NOTED_GAP))
    if wide.size:
        text = f"the accelerometer has {wide.size} gaps: straight lines bridge them"
        notes.append(Note("accelerometer-gaps", text))
    text = "the accelerometer has its own clock: its velocity increments are interpolated to the gyro's stamps"
    notes.append(Note("accelerometer-clock", text))
    return [(float(time[k]), float(time[k + 1])) for k in wide]


def _onto(time: Floats, step: Floats, other: Floats, values: Floats) -> Floats:
    """Return the averages, over the steps of one clock, of samples on another clock: differences of their integral."""
    dt = np.median(np.diff(other))
    width = np.diff(other, prepend=other[0] - dt)
    # A sample applies to the step that ends at it; over a gap, the mean of the samples on both sides applies.
    before = np.concatenate([values[:1], values[:-1]])
    held = np.where((width > OTHER_GAP * dt)[:, None], (before + values) / 2, values)
    edges = np.concatenate([[other[0] - width[0]], other])
    integral = np.concatenate([np.zeros((1, 3)), np.cumsum(held * width[:, None], axis=0)])
    ends = np.concatenate([[time[0] - step[0]], time])
    averages = np.stack([np.diff(np.interp(ends, edges, integral[:, i])) / step for i in range(3)], axis=1)
    outside = (time - step < edges[0]) | (time > edges[-1])
    inside = np.flatnonzero(~outside)
    if outside.any() and inside.size:
        averages[: inside[0]], averages[inside[-1] + 1 :] = averages[inside[0]], averages[inside[-1]]
    return averages


def _regimes(imu: ImuStream, time: Floats, zero: int, notes: list[Note]) -> tuple[Integers, tuple[float | None, ...]]:
    """Return the regime of each step, and the regimes' temperatures."""
    if imu.temperature is None or not len(imu.temperature):
        text = "the error model depends on temperature, but the log has none: the model's plain parameters are used"
        notes.append(Note("no-temperature", text))
        return np.zeros(time.size, np.int64), (None,)
    celsius = np.interp(time, (imu.temperature.time - zero) / SECOND, imu.temperature.value)
    levels, regime = np.unique(np.floor(celsius / REGIME).astype(np.int64), return_inverse=True)
    return regime.astype(np.int64), tuple(float((level + 0.5) * REGIME) for level in levels)

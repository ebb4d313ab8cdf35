"""From a log's IMU to the even steps that a filter takes: one clock, no gaps, axes of the vehicle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.conditioning import denoise
from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.log import SECOND
from imuwb.navigation.filter_model import degrees
from imuwb.navigation.tables import Samples
from imuwb.sampling import longest_part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats, ImuStream, Log
    from imuwb.navigation.filter_model import Installation

LEAST = 100  #: samples
FEW = 32  #: samples whose clock is told from their interval alone
LONGEST_GAP = 10.0  #: s, that is bridged by a straight line; behind a longer one a new log begins
NOTED_GAP = 0.05  #: s, from which on a bridged gap keeps an outage from being scored
OTHER_GAP = 1.8  #: intervals of an accelerometer on another clock, from which on samples are missing
EVEN = 0.6  #: of an interval, that stamps may stray from an even clock whose samples come at even steps
HOLDS, AFTER = 0.5, 10  #: s for which a vehicle's motion holds on; samples behind a gap that still count as within
REGIME = 2.0  #: °C, width of a regime


@dataclass(frozen=True, eq=False, slots=True)
class Measurement:
    """An IMU's samples on one even clock, in the vehicle's axes."""

    time: Floats  #: (n,) s from the log's start, at the end of each step
    interval: float  #: s, the mean step
    samples: Samples
    celsius: tuple[float | None, ...]  #: the temperature of each regime
    bridged: Floats  #: (g, 2) s from the log's start: gaps without samples, begin and end
    loose: Floats | None  #: (6,) unit²/Hz; white noise that stands for what is not known within them; the last regime's
    notes: tuple[str, ...] = ()


def measurement(log: Log, imu: ImuStream, installation: Installation, *, thermal: bool = False) -> Measurement:
    """Return what a filter takes of an IMU.

    A sample stands for the average since the one before. Stamps that stray by less than an interval from an even clock are
    set right; missing samples are put in by straight lines.

    Args:
        log: what the IMU belongs to: its zero counts.
        imu: gyros and accelerometers.
        installation: mounting, clock rate and skew.
        thermal: whether the model's parameters depend on temperature, so that regimes are made.

    Raises:
        MissingDataError: no gyro, no accelerometer, too few samples.
    """
    gyro, accel = imu.angular_rate, imu.specific_force
    if gyro is None or accel is None or min(len(gyro), len(accel)) < LEAST:
        message = f"{log.provenance.path}: navigation needs gyros and accelerometers; {imu.name} has not both, or too few samples"
        raise MissingDataError(message)
    notes: list[str] = []
    zero = log.zero or 0
    time = (gyro.time - zero) / SECOND
    part = _longest(time, notes)
    own, rate, present = _even(time[part])
    true = own[0] + (own - own[0]) * installation.clock_rate
    step = np.diff(own, prepend=own[0] - rate)
    angular = _filled(gyro.value[part], present)
    other = (accel.time - zero) / SECOND - installation.skew
    apart: list[tuple[float, float]] = []
    if other.size == time.size and np.array_equal(other, time):
        force = _filled(accel.value[part], present)
    else:
        force = _onto(own, step, other, accel.value)
        lacking = np.flatnonzero(np.diff(other) > OTHER_GAP * np.median(np.diff(other)))
        apart = [(other[k], other[k + 1]) for k in lacking if other[k + 1] - other[k] > NOTED_GAP]
        if apart:
            notes.append(f"the accelerometer lacks samples in {len(apart)} gaps: bridged by straight lines")
        notes.append(
            "the accelerometer has its own clock: its velocity increments are interpolated at the gyro's stamps"
        )
    turn = rotation_of_euler(degrees(installation.mounting)).T  # from the IMU's axes to the vehicle's
    regime, celsius = _regimes(imu, own, zero, notes) if thermal else (np.zeros(own.size, np.int64), (None,))
    gaps = _gaps(present)
    spans = [(own[a] - step[a], own[b - 1]) for a, b in gaps if (b - a) * rate > NOTED_GAP] + apart
    bridged = own[0] + (np.array(spans).reshape(-1, 2) - own[0]) * installation.clock_rate
    if gaps:
        notes.append(f"{sum(b - a for a, b in gaps)} samples missing in {len(gaps)} gaps: bridged by straight lines")
    step = step * installation.clock_rate
    loose = None
    if len(spans):
        within = np.zeros(own.size, dtype=bool)
        for begin, end in spans:
            within |= (own > begin) & (own <= end + AFTER * rate)
        # What the vehicle did meanwhile is like what it does else, and holds on for a while.
        usual = np.concatenate([(angular[~within] @ turn.T).var(axis=0), (force[~within] @ turn.T).var(axis=0)])
        loose = 2 * HOLDS * usual
        regime, celsius = np.where(within, len(celsius), regime), (*celsius, celsius[int(np.bincount(regime).argmax())])
    samples = Samples(
        interval=step,
        angle=np.ascontiguousarray(angular @ turn.T) * step[:, None],
        velocity=np.ascontiguousarray(force @ turn.T) * step[:, None],
        regime=regime,
    )
    return Measurement(true, rate * installation.clock_rate, samples, celsius, bridged, loose, tuple(notes))


def denoised(moves: Measurement, levels: tuple[int, ...]) -> Measurement:
    """Return a measurement whose axes went through wavelet denoising as a whole (db4, SURE, soft: Quinchia, 4.5).

    Args:
        moves: of the vehicle's axes.
        levels: of decomposition, ``gyro_x`` ... ``accel_z``.
    """
    step = moves.samples.interval
    angle, velocity = moves.samples.angle.copy(), moves.samples.velocity.copy()
    for axis, level in enumerate(levels):
        increments = (angle, velocity)[axis // 3]
        rate = denoise(np.ascontiguousarray(increments[:, axis % 3] / step), level).values
        increments[:, axis % 3] = rate * step
    return replace(moves, samples=moves.samples._replace(angle=angle, velocity=velocity))


def _longest(time: Floats, notes: list[str]) -> slice:
    """Return the longest part without a gap that cannot be bridged."""
    ends = np.flatnonzero(np.diff(time) > LONGEST_GAP) + 1
    if not ends.size:
        return slice(0, time.size)
    longest = longest_part(ends.tolist(), time.size)
    notes.append(
        f"the IMU stops {ends.size} times for more than {LONGEST_GAP:g} s: "
        f"the longest part is used, {time[longest][0]:.1f} s to {time[longest][-1]:.1f} s"
    )
    return longest


def _even(time: Floats) -> tuple[Floats, float, NDArray[np.int64]]:
    """Return even stamps, their interval, and which of them each sample has.

    Every sample takes the nearest stamp of an even clock, and no two the same; where the clock drifts too far for one, steps
    are counted one by one.
    """
    count = min(time.size - 1, FEW)
    dt = float(np.median(time[count:] - time[:-count])) / count  # gaps are few, and jitter is shared by many
    start = float(np.median(time[:count] - dt * np.arange(count)))
    while True:
        # A clock that is known over some samples is good for as many more.
        index = _rising(np.rint((time[:count] - start) / dt).astype(np.int64))
        slope, offset = np.polyfit(index, time[:count] - time[0], 1)
        dt, start = float(slope), float(time[0] + offset)
        if count == time.size:
            break
        count = min(2 * count, time.size)
    start, index = start + dt * index[0], index - index[0]
    if np.abs(time - (start + dt * index)).max() < EVEN * dt:
        return start + dt * np.arange(index[-1] + 1), dt, index
    steps = np.diff(time)
    dt = float(np.median(steps))
    index = np.concatenate([[0], np.cumsum(np.maximum(np.rint(steps / dt), 1))]).astype(np.int64)
    return np.interp(np.arange(index[-1] + 1), index, time), dt, index


def _rising(index: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return whole numbers that rise by one at least: the nearest from below."""
    count = np.arange(index.size)
    return np.maximum.accumulate(index - count) + count


def _filled(values: Floats, present: NDArray[np.int64]) -> Floats:
    """Return values at all steps; straight lines where there is no sample."""
    if present.size == present[-1] + 1:
        return values
    every = np.arange(present[-1] + 1)
    return np.stack([np.interp(every, present, values[:, i]) for i in range(values.shape[1])], axis=1)


def _onto(time: Floats, step: Floats, other: Floats, values: Floats) -> Floats:
    """Return averages over the steps of one clock of samples on another: differences of the interpolated integral."""
    dt = np.median(np.diff(other))
    width = np.diff(other, prepend=other[0] - dt)
    # Over a gap the mean of both its sides holds, else the sample behind.
    before = np.concatenate([values[:1], values[:-1]])
    held = np.where((width > OTHER_GAP * dt)[:, None], (before + values) / 2, values)
    edges = np.concatenate([[other[0] - width[0]], other])
    integral = np.concatenate([np.zeros((1, 3)), np.cumsum(held * width[:, None], axis=0)])
    found = np.empty((time.size, 3))
    for i in range(3):
        at = np.interp(np.concatenate([[time[0] - step[0]], time]), edges, integral[:, i])
        found[:, i] = np.diff(at) / step
    outside = (time - step < edges[0]) | (time > edges[-1])
    inside = np.flatnonzero(~outside)
    if outside.any() and inside.size:
        found[: inside[0]], found[inside[-1] + 1 :] = found[inside[0]], found[inside[-1]]
    return found


def _gaps(present: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Return first and last (excluded) step of each gap."""
    wide = np.flatnonzero(np.diff(present) > 1)
    return [(int(present[k]) + 1, int(present[k + 1])) for k in wide]


def _regimes(
    imu: ImuStream, time: Floats, zero: int, notes: list[str]
) -> tuple[NDArray[np.int64], tuple[float | None, ...]]:
    """Return which regime each step lies in, and the regimes' temperatures."""
    if imu.temperature is None or not len(imu.temperature):
        notes.append(
            "the error model depends on temperature, but the log has none: the model's own parameters are used"
        )
        return np.zeros(time.size, np.int64), (None,)
    celsius = np.interp(time, (imu.temperature.time - zero) / SECOND, imu.temperature.value)
    bins = np.floor(celsius / REGIME).astype(np.int64)
    levels, regime = np.unique(bins, return_inverse=True)
    return regime.astype(np.int64), tuple(float((level + 0.5) * REGIME) for level in levels)

"""One axis of an IMU as the checks need it: its clock in seconds, and the steps of its values."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.log import ImuStream, Log
from imuwb.sampling import Sampling, sampling
from imuwb.units import coefficient_units

LOOKED_AT = 200_000  #: number of samples that show the properties that do not change during a log
SINGLE = 2.0**-21  #: share of a value; a smaller difference may be one of a number of single precision
ROUNDING = 1e-9  #: share of the largest value; a smaller difference is due to rounding


@dataclass(frozen=True, eq=False, slots=True)
class Channel:
    """The samples of one axis that are not all equal."""

    axis: str  #: gyro_x ... accel_z
    where: str  #: the IMU's name and the axis
    time: Floats  #: (n,) s from the log's start
    values: Floats  #: (n,) rad/s or m/s²
    clock: Sampling
    levels: Floats  #: (k,) the different values of the first samples, rising

    @property
    def breaks(self) -> Integers:
        """Return the rows before which samples are missing."""
        return np.array(self.clock.breaks, np.int64)

    @property
    def step(self) -> float:
        """Return the smallest difference between two values: the LSB, where the sensor has one."""
        gaps = self.gaps
        return float(gaps.min()) if gaps.size else 0.0

    @property
    def gaps(self) -> Floats:
        """Return the differences between neighbouring values, without the differences that are due to rounding.

        Numbers of single precision are multiples of about 2⁻²³ of their size; such a difference is one of the number format, not
        of the sensor.
        """
        gaps = np.diff(self.levels)
        size = np.maximum(np.abs(self.levels[1:]), np.abs(self.levels[:-1]))
        return gaps[gaps > np.maximum(SINGLE * size, ROUNDING * max(float(size.max(initial=0.0)), 1e-12))]


def channels(log: Log, imu: ImuStream) -> dict[str, Channel]:
    """Return the axes of an IMU whose samples are not all equal, by name; the axes of one sensor share their time."""
    by_axis: dict[str, Channel] = {}
    times = sensor_seconds(log, imu)
    for sensor, triad in (("gyro", imu.angular_rate), ("accel", imu.specific_force)):
        if triad is None or not len(triad):
            continue
        time, clock = times[sensor], sampling(triad.time)
        for letter in triad.axes:
            axis, values = f"{sensor}_{letter}", triad.value[:, "xyz".index(letter)]
            if np.ptp(values) > 0:
                by_axis[axis] = Channel(axis, f"{imu.name} {axis}", time, values, clock, np.unique(values[:LOOKED_AT]))
    return by_axis


def sensor_seconds(log: Log, imu: ImuStream) -> dict[str, Floats]:
    """Return the times of the gyro and of the accelerometer, s from the log's start; with one clock both are one array."""
    rate, force = imu.angular_rate, imu.specific_force
    one = rate is not None and force is not None and np.array_equal(rate.time, force.time)
    times = {} if rate is None else {"gyro": log.seconds(rate.time)}
    return times if force is None else {**times, "accel": times["gyro"] if one else log.seconds(force.time)}


def value_text(axis: str, value: float) -> str:
    """Return a rad/s or m/s² value of an axis in its display unit."""
    unit = coefficient_units(axis, "rate")[1]
    return f"{unit.from_si(value):.4g} {unit.name}"

"""The axes of an IMU as evenly sampled series: the input of most analyses."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import ImuStream, Nanoseconds
from imuwb.notes import Note
from imuwb.progress import tracked
from imuwb.sampling import Sampling, longest_part, sampling
from imuwb.texts import counted

Outcome = TypeVar("Outcome")

THREADS = 2


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of an IMU."""

    name: str  #: ``gyro_x`` ... ``accel_z``
    time: Nanoseconds  #: (n,) ns
    values: Floats  #: (n,) rad/s or m/s²
    clock: Sampling

    @property
    def sensor(self) -> str:
        """Return ``gyro`` or ``accel``."""
        return self.name.partition("_")[0]

    @property
    def longest(self) -> Floats:
        """Return the samples of the longest part without gaps, contiguous in memory; each call makes a copy of its own."""
        return np.ascontiguousarray(self.values[self.longest_rows])

    @property
    def longest_rows(self) -> slice:
        """Return the rows of the longest part without gaps."""
        return longest_part(self.clock.breaks, self.values.size)

    def __repr__(self) -> str:
        """Return name, samples and clock in a line."""
        return f"{self.name}: {self.values.size} samples, {self.clock}"


def axes_of(imu: ImuStream) -> dict[str, Axis]:
    """Return the axes of an IMU whose sensors have at least two samples each."""
    series = imu.axes()
    times = {name.partition("_")[0]: time for name, (time, _) in series.items()}
    clocks = {sensor: sampling(time) for sensor, time in times.items()}
    return {name: Axis(name, time, values, clocks[name.partition("_")[0]]) for name, (time, values) in series.items()}


def check_three_axes(path: str, imu: ImuStream, what: str) -> None:
    """Raise MissingDataError, which names the axes that exist, if a sensor of an IMU lacks an axis.

    Args:
        path: the log's path.
        imu: the IMU.
        what: what needs three axes, for the message.
    """
    triads = [triad for triad in (imu.angular_rate, imu.specific_force) if triad is not None]
    if any(triad.axes != "xyz" for triad in triads):
        raise MissingDataError(
            f"{path}: {imu.name} has only {', '.join(imu.axes())}; {what} needs three axes of each sensor"
        )


def check_scaled(path: str, imu: ImuStream, what: str) -> None:
    """Raise UsageError, which names the sensors, if samples of an IMU are counts.

    Args:
        path: the log's path.
        imu: the IMU.
        what: what needs values in a unit, for the message.
    """
    if imu.origin.counts:
        raise UsageError(
            f"{path}: {imu.name}: {' and '.join(imu.origin.counts)} are in counts, and {what} needs values in a unit; give the scale of the data sheet, "
            "such as --units gyro=131LSB/(deg/s),accel=16384LSB/g, or calibrate the log and read it --through correction:model=MODEL.toml"
        )


def rates(axes: Mapping[str, Axis]) -> dict[str, float]:
    """Return {sensor: sampling rate in Hz}."""
    return {axis.sensor: 1 / axis.clock.interval for axis in axes.values()}


def gap_notes(axes: Mapping[str, Axis], result: str) -> list[Note]:
    """Return a note for each sensor with gaps; it states that the named result uses the longest part without gaps."""
    clocks = {axis.sensor: axis.clock for axis in axes.values()}
    return [
        Note("gaps", f"{sensor}: {counted(len(clock.breaks), 'gap')}; {result} uses the longest part without gaps")
        for sensor, clock in clocks.items()
        if clock.breaks
    ]


def for_each(axes: Mapping[str, Axis], function: Callable[[Axis], Outcome]) -> dict[str, Outcome]:
    """Return {name: function(axis)}; two axes are computed at a time."""
    with ThreadPoolExecutor(THREADS) as pool:
        return dict(zip(axes, tracked(pool.map(function, axes.values()), len(axes)), strict=True))

"""The axes of an IMU as even series, which is what most analyses begin with."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from imuwb.progress import tracked
from imuwb.sampling import Sampling, longest_part, sampling

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from imuwb.log import Floats, ImuStream, Nanoseconds

    Found = TypeVar("Found")

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

    @cached_property
    def longest(self) -> Floats:
        """Return the samples of the longest part without gaps, contiguous in memory."""
        return np.ascontiguousarray(self.values[longest_part(self.clock.breaks, self.values.size)])


def axes_of(imu: ImuStream) -> dict[str, Axis]:
    """Return the axes of an IMU that has at least two samples of each sensor there is."""
    found = imu.axes()
    clocks = {sensor: sampling(found[f"{sensor}_x"][0]) for sensor in ("gyro", "accel") if f"{sensor}_x" in found}
    return {name: Axis(name, time, values, clocks[name.partition("_")[0]]) for name, (time, values) in found.items()}


def rates(axes: Mapping[str, Axis]) -> dict[str, float]:
    """Return {sensor: Hz}."""
    return {axis.sensor: 1 / axis.clock.interval for axis in axes.values()}


def gap_notes(axes: Mapping[str, Axis], what: str) -> list[str]:
    """Return, for each sensor with gaps, that ``what`` is of its longest part without."""
    clocks = {axis.sensor: axis.clock for axis in axes.values()}
    return [
        f"{sensor}: {len(clock.breaks)} gaps; {what} is of the longest part without"
        for sensor, clock in clocks.items()
        if clock.breaks
    ]


def for_each(axes: Mapping[str, Axis], function: Callable[[Axis], Found]) -> dict[str, Found]:
    """Return {name: function(axis)}, two axes at a time."""
    with ThreadPoolExecutor(THREADS) as pool:
        return dict(zip(axes, tracked(pool.map(function, axes.values()), len(axes)), strict=True))

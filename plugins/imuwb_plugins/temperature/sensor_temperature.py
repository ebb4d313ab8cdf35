"""The temperature of the sensor over each log: the lag of its thermometer, from the record itself."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.axes import Axis, axes_of
from imuwb.identification.temperature import ThermalLag, thermal_lag, thermometer_curve
from imuwb.log import SECOND, Log
from imuwb_plugins.temperature.parameters import Parameters

BLOCKS = 1500  #: means of each axis over a log
SHORTEST = 0.5  #: s, of a mean
SAMPLES = 4  #: samples in a mean, at least


def lags_of(logs: Sequence[Log], parameters: Parameters) -> list[ThermalLag | None]:
    """Return the lag of each log's thermometer; None where the temperatures are given, or the log does not show any."""
    return [None if parameters.celsius else lag_of(log, parameters) for log in logs]


def lag_of(log: Log, parameters: Parameters) -> ThermalLag | None:
    """Return the lag of a log's thermometer; None where the log does not show any."""
    thermometer = log.imu().temperature
    axes = axes_of(log.imu())
    if thermometer is None or len(thermometer) < 2 or not axes:  # noqa: PLR2004 - a change needs two readings
        return None
    between = float(thermometer.time[-1] - thermometer.time[0]) / SECOND / (len(thermometer) - 1)
    blocks = _means(list(axes.values()), between)
    if blocks is None:
        return None
    times, means = blocks
    ends = log.seconds(times[[0, -1]])
    # Even but for less than the time between two samples.
    at = np.linspace(ends[0], ends[1], times.size)
    curve = thermometer_curve(log.seconds(thermometer.time), thermometer.value, at)
    return thermal_lag(curve, means, given=parameters.lag, level=parameters.level)


def _means(axes: Sequence[Axis], between: float) -> tuple[Integers, dict[str, Floats]] | None:
    """Return the mean time of each block (ns) and the means of each axis, from the longest part that all axes have.

    The time is that of the samples of the last axis; those of the others differ by less than a sample.
    """
    parts = [axis.time[axis.longest_rows] for axis in axes]
    first, last = max(int(p[0]) for p in parts), min(int(p[-1]) for p in parts)
    seconds = (last - first) / SECOND
    slowest = max(axis.clock.interval for axis in axes)
    length = max(seconds / BLOCKS, SHORTEST, SAMPLES * slowest, between)
    count = int(seconds / length)
    if count < 1:
        return None
    edges = np.linspace(first, last, count + 1).astype(np.int64)
    means: dict[str, Floats] = {}
    times = np.empty(count, dtype=np.int64)
    for axis in axes:
        rows = np.searchsorted(axis.time, edges)
        size = np.diff(rows)
        if not size.all():
            return None
        means[axis.name] = np.add.reduceat(axis.values[: rows[-1]], rows[:-1]) / size
        times = first + np.add.reduceat(axis.time[: rows[-1]] - first, rows[:-1]) // size
    return times, means

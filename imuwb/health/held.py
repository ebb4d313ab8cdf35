"""Faults of a sensor that is slower than its rows: rows that repeat the row before, under a new stamp."""

from collections.abc import Iterator, Mapping

import numpy as np

from imuwb.health.channel import LOOKED_AT, Channel
from imuwb.health.fault import Fault

HELD = 0.02  #: share of the rows; with a larger share of repeated rows, this is a fault
TOGETHER = 0.9  #: least share of an axis's repeated values at which the other axes repeat theirs; a coarse axis repeats on its own


def held_rows(imu: str, channels: Mapping[str, Channel]) -> Iterator[Fault]:
    """Yield a fault for each sensor, of at least two axes, many of whose rows repeat the row before.

    Args:
        imu: name of the IMU.
        channels: its axes whose samples are not all equal.
    """
    for sensor, name in (("gyro", "gyros"), ("accel", "accelerometers")):
        axes = [channel for axis, channel in channels.items() if axis.startswith(sensor)]
        if len(axes) < 2:  # noqa: PLR2004 - one axis may be coarse
            continue
        alike = np.stack([np.diff(channel.values[:LOOKED_AT]) == 0 for channel in axes])
        all_alike = alike.all(axis=0)
        share = float(all_alike.mean())
        if share <= HELD or share < TOGETHER * float(alike.mean(axis=1).max()):
            continue
        rate = 1 / axes[0].clock.interval
        what = f"{100 * share:.2g} % of the rows repeat the values of the row before, at a new time"
        consequence = f"the sensor has about {rate * (1 - share):.3g} Hz, not {rate:.4g} Hz: noise coefficients are off by some per cent"
        yield Fault(f"{imu} {name}", "held rows", what, "warning", consequence=consequence)

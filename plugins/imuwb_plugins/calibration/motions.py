"""From logs and their still positions to the motions between neighbouring positions."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.identification.calibration import Motion
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.sampling import runs, sampling
from imuwb_plugins.calibration.stretches import SteadyStretch

LONGEST = 60.0  #: s, longest motion; the gyros' slow noise spoils longer ones
WINDOW = 30.0  #: s, longest part of a position that is used beside a motion
STUCK = 3  #: equal samples in sequence, at the end of a gyro's values in the log, that show the end of its range


def motions_of(logs: Sequence[Log], stretches: Sequence[SteadyStretch]) -> tuple[list[Motion], list[Note]]:
    """Return the motions between neighbouring positions of the same log, and a note on those that are left out.

    A motion is left out if it lasts more than a minute, if samples are missing in it, or if a gyro stands at the end of its range.

    Args:
        logs: the logs; each has gyros.
        stretches: the P positions, in order.
    """
    motions: list[Motion] = []
    left: dict[str, int] = {}
    full = [_full(log) for log in logs]
    for i, (one, other) in enumerate(pairwise(stretches)):
        if one.log != other.log:
            continue
        made = _motion(logs[one.log], full[one.log], i, (one.span, other.span))
        if isinstance(made, str):
            left[made] = left.get(made, 0) + 1
        else:
            motions.append(made.trimmed(WINDOW))
    text = ", ".join(f"{count} {why}" for why, count in left.items())
    return motions, [Note("motions-left-out", f"motions that are left out: {text}")] if left else []


def _full(log: Log) -> Booleans:
    """Return which samples of the gyros stand at the end of the range, (n,)."""
    gyro = log.imu().angular_rate
    assert gyro is not None  # noqa: S101 - the caller has checked
    full = np.zeros(len(gyro), dtype=np.bool_)
    for column in gyro.value.T:
        for end in (column.min(), column.max()):
            for first, count in zip(*runs(column == end), strict=True):
                if count >= STUCK:
                    full[int(first) : int(first + count)] = True
    return full


def _motion(
    log: Log, full: Booleans, number: int, spans: tuple[tuple[float, float], tuple[float, float]]
) -> Motion | str:
    """Return the motion between two positions, or why it is left out."""
    imu = log.imu()
    gyro, force = imu.angular_rate, imu.specific_force
    assert gyro is not None  # noqa: S101 - the caller has checked
    assert force is not None  # noqa: S101 - the caller has checked
    (begin, still), (stopped, end) = spans
    if stopped - still > LONGEST:
        return f"longer than {LONGEST:g} s"
    seconds = log.seconds(gyro.time)
    first, a, b, last = (int(k) for k in np.searchsorted(seconds, [begin, still, stopped, end]))
    clock = sampling(gyro.time)
    if any(first < k < last for k in clock.breaks):
        return "with missing samples"
    if full[first:last].any():
        return "with a gyro at the end of its range"
    here = seconds[first:last]
    accel = _at(log.seconds(force.time), force.value, here)
    return Motion(number, gyro.value[first:last], accel, np.gradient(here), a - first, last - b, a - first, last - b)


def _at(time: Floats, values: Floats, wanted: Floats) -> Floats:
    """Return samples, (m, 3), at other times by linear interpolation."""
    return np.stack([np.interp(wanted, time, column) for column in values.T], axis=1)

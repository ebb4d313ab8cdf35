"""Finds values that a still IMU cannot measure: a wrong gravity, a large rate."""

from collections.abc import Iterator, Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.health.fault import Fault
from imuwb.health.motion import Segment
from imuwb.log import ImuStream, Log, Triad
from imuwb.units import STANDARD_GRAVITY

GRAVITY = 0.02  #: share of standard gravity; a still accelerometer may differ from gravity by this
WRONG = 0.1  #: share of standard gravity; no bias explains a larger difference
BIAS = 0.05  #: rad/s; a larger rate of a still gyro is a fault
STILL_ENOUGH = 5.0  #: s; shortest still segment that is examined


def implausible(log: Log, imu: ImuStream, segments: Sequence[Segment]) -> Iterator[Fault]:
    """Yield the values that the sensors of an IMU cannot have measured.

    Args:
        log: the log whose start times count from.
        imu: the IMU.
        segments: when it is still and when it moves; empty where the record does not show it.
    """
    longest = max((s for s in segments if not s.moving), key=lambda s: s.length, default=None)
    if longest is None or longest.length < STILL_ENOUGH:
        return
    rate = _mean(log, imu.angular_rate, longest)
    if rate is not None and float(np.nanmax(np.abs(rate))) > BIAS:
        worst = float(rate[int(np.nanargmax(np.abs(rate)))])
        yield Fault(f"{imu.name} gyros", "rate", f"turns by {np.degrees(worst):.3g} deg/s while still", "warning", 1,
                    longest.start, longest.length, "subtract this bias, unless the IMU turns at a constant rate")  # fmt: skip
    force = _mean(log, imu.specific_force, longest)
    # One or two axes do not show the size of gravity.
    size = STANDARD_GRAVITY if force is None or np.isnan(force).any() else float(np.linalg.norm(force))
    off = size / STANDARD_GRAVITY - 1
    if abs(off) > GRAVITY:
        wrong = abs(off) > WRONG
        yield Fault(f"{imu.name} accelerometers", "gravity", f"gravity is {size:.4g} m/s² while still",
                    "fault" if wrong else "warning", 1, longest.start, longest.length,
                    "units or scale are wrong, or the stream is no accelerometer" if wrong
                    else f"off by {1000 * off:+.0f} mg: a bias or a scale factor to be calibrated")  # fmt: skip


def _mean(log: Log, triad: Triad | None, segment: Segment) -> Floats | None:
    """Return a triad's mean over a segment, (3,), nan for an axis that it lacks; None if it has no sample there."""
    if triad is None:
        return None
    time = log.seconds(triad.time)
    inside = (time >= segment.start) & (time <= segment.end)
    return triad.value[inside].mean(axis=0) if inside.any() else None

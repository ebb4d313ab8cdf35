"""Finds values that an IMU cannot measure: no gravity, a wrong gravity, a large rate while it is still."""

from collections.abc import Iterator, Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.health.fault import Fault
from imuwb.health.motion import Segment
from imuwb.log import ImuStream, Log, Triad
from imuwb.units import SECOND, STANDARD_GRAVITY, UNITS

GRAVITY = 0.02  #: share of standard gravity; a still accelerometer may differ from gravity by this
WRONG = 0.1  #: share of standard gravity; no bias explains a larger difference
BIAS = 0.05  #: rad/s; a larger rate of a still gyro is a fault
MISSING = 0.25 * STANDARD_GRAVITY  #: m/s²; a smaller specific force does not contain gravity
NEAR = 0.03  #: share of gravity; a still accelerometer in another unit differs from gravity by less
USUAL = 1.5  #: factor between the usual specific force of an IMU that moves and that of gravity and its accelerations
LOOKED_AT = 200_000  #: samples
FEWEST = 30  #: velocities that show the accelerations
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
        yield from felt_gravity(log, imu)
        return
    rate = _mean(log, imu.angular_rate, longest)
    if rate is not None and float(np.nanmax(np.abs(rate))) > BIAS:
        worst = float(rate[int(np.nanargmax(np.abs(rate)))])
        yield Fault(f"{imu.name} gyros", "rate", f"turns by {np.degrees(worst):.3g} deg/s while still", "warning", 1,
                    longest.start, longest.length, "subtract this bias, unless the IMU turns at a constant rate")  # fmt: skip
    if _is_centred(log):
        return
    size = _size(log, imu.specific_force, longest)
    off = size / STANDARD_GRAVITY - 1
    likely = _likely(size)
    if 0 < size < MISSING and not likely:
        yield _no_gravity(imu, size, longest)
    elif size and abs(off) > GRAVITY:
        wrong = abs(off) > WRONG
        consequence = f"off by {1000 * off:+.0f} mg: a bias or a scale factor to be calibrated"
        if wrong:
            consequence = "units or scale are wrong, or the stream is no accelerometer"
            consequence += f"; the unit is likely {likely}" if likely else ""
        yield Fault(f"{imu.name} accelerometers", "gravity", f"gravity is {size:.4g} m/s² while still",
                    "fault" if wrong else "warning", 1, longest.start, longest.length, consequence)  # fmt: skip


def felt_gravity(log: Log, imu: ImuStream) -> Iterator[Fault]:
    """Yield a fault if the usual specific force of an IMU is not of the size of gravity and of its accelerations."""
    triad = imu.specific_force
    if _is_centred(log):
        return
    if "accel" in imu.origin.counts or triad is None or len(triad.axes) < 3 or not len(triad):  # noqa: PLR2004 - the size needs three axes
        return
    size = float(np.median(np.linalg.norm(triad.value[:: len(triad) // LOOKED_AT + 1], axis=1)))
    expected = _accelerated(log)
    if size == 0:  # not connected, which each axis tells
        return
    if size < MISSING:
        yield _no_gravity(imu, size, None)
    elif not expected / USUAL < size < expected * USUAL:
        likely = _likely(size)
        text = f"the specific force is usually {size:.4g} m/s²; gravity and the accelerations make {expected:.3g} m/s²"
        consequence = "units or scale are wrong" + (f"; the unit is likely {likely}" if likely else "")
        yield Fault(f"{imu.name} accelerometers", "gravity", text, "fault", consequence=consequence)


def _is_centred(log: Log) -> bool:
    """Return whether a conditioner removed the mean of the accelerometers, so that their size shows no fault of the log."""
    return any("accel" in step.without_mean for step in log.conditioning)


def _no_gravity(imu: ImuStream, size: float, where: Segment | None) -> Fault:
    """Return the fault of an accelerometer that does not feel gravity; no unit explains it."""
    what = f"no specific force: gravity is missing (it is usually {size:.3g} m/s²)"
    consequence = "these are accelerations without gravity, or increments: log what the accelerometer measures"
    place = (None, None) if where is None else (where.start, where.length)
    return Fault(f"{imu.name} accelerometers", "no gravity", what, "fault", 1, *place, consequence)


def _likely(size: float) -> str:
    """Return the unit in which a specific force is one gravity; empty: in none."""
    off = {unit: abs(size * UNITS[unit].factor / STANDARD_GRAVITY - 1) for unit in ("g", "mg", "cm/s²")}
    nearest = min(off, key=lambda unit: off[unit])
    return nearest if off[nearest] < NEAR else ""


def _accelerated(log: Log) -> float:
    """Return the usual size of the specific force by the velocities of a receiver; that of gravity without them."""
    for gnss in log.gnss:
        if gnss.velocity is not None and len(gnss) > FEWEST:
            acceleration = np.diff(gnss.velocity, axis=0) / np.diff(log.seconds(gnss.time))[:, None]
            size = np.linalg.norm(acceleration - [0, 0, STANDARD_GRAVITY], axis=1)
            if np.isfinite(size).sum() > FEWEST:
                return max(float(np.nanmedian(size)), STANDARD_GRAVITY)
    return STANDARD_GRAVITY


def _size(log: Log, triad: Triad | None, segment: Segment) -> float:
    """Return the usual size of the specific force in a segment, m/s², by means over a second, for the IMU may tilt slowly."""
    if triad is None or len(triad.axes) < 3:  # noqa: PLR2004 - one or two axes do not show the size of gravity
        return STANDARD_GRAVITY
    edges = np.rint(np.arange(segment.start, segment.end, 1.0) * SECOND).astype(np.int64) + (log.zero or 0)
    rows = np.searchsorted(triad.time, edges)
    rows = rows[: int(np.searchsorted(rows, len(triad)))]
    rows = rows[np.append(True, np.diff(rows) > 0)] if rows.size else rows
    if rows.size < 2:  # noqa: PLR2004 - the last rows may be of less than a second
        return STANDARD_GRAVITY
    means = np.add.reduceat(triad.value, rows, axis=0)[:-1] / np.diff(rows)[:, None]
    return float(np.median(np.linalg.norm(means, axis=1)))


def _mean(log: Log, triad: Triad | None, segment: Segment) -> Floats | None:
    """Return a triad's mean over a segment, (3,), nan for an axis that it lacks; None if it has no sample there."""
    if triad is None:
        return None
    time = log.seconds(triad.time)
    inside = triad.value[np.searchsorted(time, segment.start) : np.searchsorted(time, segment.end, side="right")]
    return inside.mean(axis=0) if len(inside) else None

"""The gyros of logs with still positions: from the positions, and from the motions between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification import calibration
from imuwb.identification.calibration import AxisCalibration, Means, MovedGyros, PositionCalibration
from imuwb.log import Log
from imuwb.notes import Note
from imuwb_plugins.calibration.motions import motions_of
from imuwb_plugins.calibration.notes import gyro_note, red_notes
from imuwb_plugins.calibration.parameters import Positions
from imuwb_plugins.calibration.result import Motions
from imuwb_plugins.calibration.stretches import SteadyStretch, check_clipping


@dataclass(frozen=True, eq=False, slots=True)
class GyroCalibration:
    """The calibration of the gyros; empty if there are none."""

    axes: Mapping[str, AxisCalibration]
    means: Means | None
    residual: Floats | None  #: (P, 3) of the means, in the unit of the samples
    moved: Motions | None
    notes: tuple[Note, ...]


NONE = GyroCalibration({}, None, None, None, ())


def calibrated_gyros(
    logs: Sequence[Log],
    stretches: Sequence[SteadyStretch],
    accel: PositionCalibration,
    gravity: float,
    p: Positions,
) -> GyroCalibration:
    """Return the calibration of the gyros.

    Args:
        logs: the logs.
        stretches: the P positions.
        accel: calibration of the accelerometers.
        gravity: m/s².
        p: the options.
    """
    samples = [s.gyro for s in stretches if s.gyro is not None]
    if not samples:
        return NONE
    check_clipping(stretches, "gyro")
    stuck = np.ptp(np.concatenate(samples), axis=0) == 0
    if stuck.any():
        names = ", ".join(k for k, s in zip("xyz", stuck, strict=True) if s)
        note = Note("gyro-constant", f"gyro {names} is constant: gyros are left out")
        return GyroCalibration({}, None, None, None, (note,))
    means = calibration.means(samples)
    latitude = None if p.latitude is None else float(np.radians(p.latitude))
    axes, residual = calibration.static_gyros(means, accel.force, gravity, p.level, latitude)
    moved, motions, notes = _moved(logs, stretches, means, accel, gravity, p)
    if moved is not None:
        axes = moved.axes
    return GyroCalibration(
        {f"gyro_{k}": c for k, c in zip("xyz", axes, strict=True)}, means, residual, motions,
        (gyro_note(p, moved), *notes, *red_notes("gyro", means)),
    )  # fmt: skip


def _moved(
    logs: Sequence[Log],
    stretches: Sequence[SteadyStretch],
    gyro: Means,
    accel: PositionCalibration,
    gravity: float,
    p: Positions,
) -> tuple[MovedGyros | None, Motions | None, list[Note]]:
    """Return the calibration by motions, the motions, and notes; None if the logs have no motions that determine it."""
    if accel.covariance is None or len({s.log for s in stretches}) == len(stretches):
        return None, None, []
    motions, notes = motions_of(logs, stretches)
    seconds = np.array([s.seconds for s in stretches])
    latitude = None if p.latitude is None else float(np.radians(p.latitude))
    try:
        moved = calibration.moved_gyros(motions, gyro, seconds, accel, gravity, p.level, latitude, raw=bool(p.raw))
    except ValueError as error:
        return None, None, [*notes, Note("motions-unused", f"the motions between positions are not used: {error}")]
    begin = tuple(m.before + 1 for m in motions)
    return moved, Motions(begin, tuple(float(a) for a in moved.apart), moved.window, moved.excess), notes

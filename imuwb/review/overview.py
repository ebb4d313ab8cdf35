"""The first tab of every recording: what the log holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Series
from imuwb.colors import AXIS_COLORS
from imuwb.readers import summarize
from imuwb.review.tables import streams_of_many, streams_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import ImuStream, Log, Triad
    from imuwb.review.recording import RecordingReview

TRACKS = ((242, 142, 43), (118, 183, 178), (176, 122, 161))
MANY = 3  #: logs; more have no tab each
LOOKED_AT = 100_000  #: samples, for the middle and the spread of what is drawn
STILL = 0.1  #: largest spread of an axis, as a share of the distance between axes, that is drawn about its median


def overview(logs: Sequence[Log], review: RecordingReview) -> None:
    """Show the streams of each log over time, its tracks, and a table of what was read; of many logs the first stands for all."""
    many = len(logs) > MANY
    if many:
        review.tab("Overview")
        review.table(streams_of_many([summarize(log) for log in logs]))
    for log in logs[:1] if many else logs:
        review.tab("Overview" if len(logs) == 1 else f"Overview {log.provenance.path}")
        _streams(log, review)
        if not many:
            review.table(streams_table(summarize(log)))
    for note in dict.fromkeys(note for log in logs for note in log.notes):
        review.note(note)


def _streams(log: Log, review: RecordingReview) -> None:
    for imu in log.imus:
        if imu.angular_rate is not None:
            review.series(_triad(imu, imu.angular_rate, "angular rate", "gyro", "deg/s", np.degrees(1.0)))
        if imu.specific_force is not None:
            review.series(_triad(imu, imu.specific_force, "specific force", "accel", "m/s²", 1.0))
        if imu.temperature is not None:
            t, epoch = imu.temperature, imu.origin.epoch
            title = f"{imu.name} temperature"
            review.series(Series(title, "°C", t.time, t.value[:, None], ("temperature",), ((200, 200, 200),), epoch))
    for gnss, color in zip(log.gnss, TRACKS, strict=False):
        review.track(gnss.name, gnss.position, color)


def _triad(imu: ImuStream, triad: Triad, what: str, sensor: str, unit: str, scale: float) -> Series:
    """Return three axes over time; those of a still sensor about their medians, which would dwarf the rest."""
    values = triad.value * scale
    some = values[:: max(len(values) // LOOKED_AT, 1)]
    middle = np.median(some, axis=0)
    spread = np.quantile(np.abs(some - middle), 0.99, axis=0).max()
    names = tuple(f"{sensor} {axis}" for axis in "xyz")
    title = f"{imu.name} {what}"
    if spread < STILL * np.ptp(middle):
        values = values - middle
        names = tuple(f"{name}, about {m:.3f}" for name, m in zip(names, middle, strict=True))
        title += ", each axis about its median"
    colors = tuple((*AXIS_COLORS[axis], 150) for axis in "xyz")
    return Series(title, unit, triad.time, values, names, colors, imu.origin.epoch)

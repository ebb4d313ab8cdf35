"""The first tab of every recording: what the log holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import AXIS_COLORS, Series
from imuwb.review.tables import streams_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Log
    from imuwb.review.recording import RecordingReview

RATE_UNIT, FORCE_UNIT = "deg/s", "m/s²"
TRACKS = ((242, 142, 43), (118, 183, 178), (176, 122, 161))


def overview(logs: Sequence[Log], review: RecordingReview) -> None:
    """Show the streams of each log over time, its tracks, and a table of what was read."""
    for log in logs:
        review.tab("Overview" if len(logs) == 1 else f"Overview {log.provenance.path}")
        for imu in log.imus:
            colors = tuple(AXIS_COLORS[axis] for axis in "xyz")
            epoch = imu.origin.epoch
            if imu.angular_rate is not None:
                values = np.degrees(imu.angular_rate.value)
                review.series(Series(f"{imu.name} angular rate", RATE_UNIT, imu.angular_rate.time, values, ("gyro x", "gyro y", "gyro z"), colors, epoch))  # fmt: skip
            if imu.specific_force is not None:
                names = ("accel x", "accel y", "accel z")
                review.series(Series(f"{imu.name} specific force", FORCE_UNIT, imu.specific_force.time, imu.specific_force.value, names, colors, epoch))  # fmt: skip
            if imu.temperature is not None:
                t = imu.temperature
                review.series(Series(f"{imu.name} temperature", "°C", t.time, t.value[:, None], ("temperature",), ((200, 200, 200),), epoch))  # fmt: skip
        for gnss, color in zip(log.gnss, TRACKS, strict=False):
            review.track(gnss.name, gnss.position, color)
        review.table(streams_table(log))
        for note in log.notes:
            review.note(note)

"""The first tab of every recording; it shows the content of the logs."""

from collections.abc import Sequence

import numpy as np

from imuwb.analysis import Review, Series
from imuwb.colors import AXIS_COLORS, PALE, TRACK_COLORS
from imuwb.log import ImuStream, Log, Triad
from imuwb.review.envelope import extremes
from imuwb.review.tables import streams_of_many, streams_table
from imuwb.summary import summarize

MANY = 3  #: up to this number of logs, each is shown over time
SAMPLES = 100_000  #: least number of samples that the median and the spread of an axis are estimated from
SPREAD = 0.99  #: the spread of an axis is this quantile of the distances from its median
STILL = 0.1  #: up to this spread, as a share of the distance between the axes' medians, axes are drawn without their medians
ALPHA = 150  #: opacity of the lines of three axes, which cross each other


def overview(logs: Sequence[Log], review: Review) -> None:
    """Show the streams of each log over time, its tracks, and a table of its streams.

    Of more than three logs only the first is shown over time, and one table lists the streams of all.
    """
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


def _streams(log: Log, review: Review) -> None:
    for imu in log.imus:
        if imu.angular_rate is not None:
            review.series(_triad(imu, imu.angular_rate, "angular rate", "gyro", "deg/s", np.degrees(1.0)))
        if imu.specific_force is not None:
            review.series(_triad(imu, imu.specific_force, "specific force", "accel", "m/s²", 1.0))
        if imu.temperature is not None:
            t, title = imu.temperature, f"{imu.name} temperature"
            review.series(Series(title, "°C", t.time, t.value[:, None], ("temperature",), (PALE,), imu.origin.epoch))
    for gnss, color in zip(log.gnss, TRACK_COLORS, strict=False):
        review.track(gnss.name, gnss.position, color)


def _triad(imu: ImuStream, triad: Triad, quantity: str, sensor: str, unit: str, scale: float) -> Series:
    """Return three axes over time, without their medians if the sensor is still, because different medians would hide the noise."""
    axes = triad.axes
    columns = ["xyz".index(axis) for axis in axes]
    sample = triad.value[:: max(len(triad) // SAMPLES, 1), columns] * scale
    median = np.median(sample, axis=0)
    spread = np.quantile(np.abs(sample - median), SPREAD, axis=0).max()
    # Of a long series only the extremes are drawn, so only these are scaled.
    time, drawn = extremes(triad.time, triad.value)
    values = drawn[:, columns] * scale
    names = tuple(f"{sensor} {axis}" for axis in axes)
    title = f"{imu.name} {quantity}"
    if spread < STILL * np.ptp(median):
        values = values - median
        names = tuple(f"{name}, about {m:.3f}" for name, m in zip(names, median, strict=True))
        title += ", each axis about its median"
    colors = tuple((*AXIS_COLORS[axis], ALPHA) for axis in axes)
    return Series(title, unit, time, values, names, colors, imu.origin.epoch)

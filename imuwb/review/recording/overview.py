"""The tabs of every recording that show the content of the logs: the IMU that is analysed, axis by axis, and all streams."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from imuwb.analysis import Review, Series
from imuwb.arrays import Floats
from imuwb.colors import AXIS_COLORS, GREY, TRACK_COLORS
from imuwb.log import ImuStream, Log, Triad
from imuwb.names import distinct
from imuwb.review.drawn.envelope import extremes
from imuwb.review.scene.clock import Clock
from imuwb.review.tables.streams import streams_of_many, streams_table
from imuwb.summary import summarize
from imuwb.units import COUNT

NAMED = 24  #: columns of the name of a log among several
MANY = 3  #: up to this number of logs, each is shown over time
SPANS = 600  #: of an axis, whose chart fills half a screen
ALPHA = 150  #: opacity of the lines of three axes in one chart
#: sensor -> quantity, display unit, value of one SI unit in the display unit
SENSORS = {"gyro": ("angular rate", "deg/s", float(np.degrees(1.0))), "accel": ("specific force", "m/s²", 1.0)}


def overview(logs: Sequence[Log], review: Review) -> None:
    """Show each log: at most six charts of the first IMU, one for each axis, and a tab of the streams of all logs.

    Of more than three logs only the first is shown over time.
    """
    clock = Clock.of(logs)
    summaries = [summarize(log) for log in logs]
    shown = logs[:1] if len(logs) > MANY else logs
    names = names_of(logs)
    if len(logs) > MANY:
        review.tab("Logs")
        review.table(streams_of_many(summaries))
    for log, name in zip(shown, names, strict=False):
        review.tab(f"Overview {name}".strip())
        _show((s for imu in log.imus[:1] for s in _axes(imu)), log, clock, review)
    review.tab(f"Streams {names[0]}" if len(logs) > MANY else "Streams")
    if len(logs) <= MANY:
        review.table(streams_table(summaries[0]) if len(logs) == 1 else streams_of_many(summaries))
    for note in dict.fromkeys(note for log in logs for note in log.notes):
        review.note(note)
    for log, name in zip(shown, names, strict=False):
        of = f", {name}" if len(shown) > 1 else ""
        for gnss, color in zip(log.gnss, TRACK_COLORS, strict=False):
            review.track(f"{gnss.name}{of}", gnss.position, color)
        _show((replace(series, title=f"{series.title}{of}") for series in _others(log)), log, clock, review)


def names_of(logs: Sequence[Log]) -> tuple[str, ...]:
    """Return short names of several logs, which tell them apart; one log needs no name."""
    if len(logs) == 1:
        return ("",)
    paths = [log.provenance.path.replace("\\", "/") for log in logs]
    files = [path.rpartition("/")[2] for path in paths]
    return distinct(files if len(set(files)) == len(files) else paths, NAMED)


def _show(all_series: Iterable[Series], log: Log, clock: Clock, review: Review) -> None:
    """Show series; one whose values are all equal is a note, because its chart would be empty."""
    for series in all_series:
        known = series.values[np.isfinite(series.values)]
        if series.values.shape[1] == 1 and known.size and known.min() == known.max():
            review.note(f"{series.title}: {known[0]:.6g} {series.unit} throughout")
        elif series.time.size:
            review.series(clock.moved(series, log))


def _axes(imu: ImuStream) -> Iterator[Series]:
    """Yield a chart for each axis, because the extremes of one axis would hide the others."""
    for sensor, triad in _triads(imu):
        _, unit, scale = _shown(imu, sensor)
        time, drawn = extremes(triad.time, triad.value, SPANS)
        for axis in triad.axes:
            values = drawn[:, "xyz".index(axis)] * scale
            # The viewer may label a single tick of an axis, so the title has the range.
            title = f"{sensor} {axis} of {imu.name}, {_range_text(values)}"
            yield Series(title, unit, time, values[:, None], (f"{sensor} {axis}",), (AXIS_COLORS[axis],))


def _shown(imu: ImuStream, sensor: str) -> tuple[str, str, float]:
    """Return quantity, display unit, and the value of one stored unit in the display unit."""
    return (sensor, COUNT, 1.0) if sensor in imu.origin.counts else SENSORS[sensor]


def _range_text(values: Floats) -> str:
    """Return the smallest and the largest value, with digits that tell them apart: -9.825 to -9.793."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    spread, largest = high - low, max(abs(low), abs(high))
    digits = max(2 - math.floor(math.log10(spread)), 0) if spread > 0 and largest > 0 else 3
    return f"{low:.{digits}f} to {high:.{digits}f}"


def _triads(imu: ImuStream) -> Iterator[tuple[str, Triad]]:
    triads = {"gyro": imu.angular_rate, "accel": imu.specific_force}
    yield from ((sensor, triad) for sensor, triad in triads.items() if triad is not None and len(triad))


def _others(log: Log) -> Iterator[Series]:
    """Yield temperatures, speeds, and the other IMUs with their axes in one chart."""
    for imu in log.imus:
        if imu.temperature is not None:
            t = imu.temperature
            yield Series(f"temperature of {imu.name}", "°C", t.time, t.value[:, None], ("temperature",), (GREY,))
    for speed in log.speeds:
        yield Series(f"speed: {speed.name}", "m/s", speed.time, speed.value[:, None], ("speed",), (GREY,))
    for imu in log.imus[1:]:
        for sensor, triad in _triads(imu):
            quantity, unit, scale = _shown(imu, sensor)
            time, drawn = extremes(triad.time, triad.value, SPANS)
            values = drawn[:, ["xyz".index(axis) for axis in triad.axes]] * scale
            names = tuple(f"{sensor} {axis}" for axis in triad.axes)
            colors = tuple((*AXIS_COLORS[axis], ALPHA) for axis in triad.axes)
            yield Series(f"{quantity} of {imu.name}", unit, time, values, names, colors)

"""From logs to the records of each axis at each temperature."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from imuwb.arrays import Floats
from imuwb.axes import Axis, axes_of
from imuwb.errors import MissingDataError
from imuwb.health import Doubts, record_doubts, stillness_of
from imuwb.identification.temperature import Record, Stretch, ThermalLag, smooth_temperature, stretches
from imuwb.log import SECOND, Log
from imuwb.sampling import longest_part
from imuwb_plugins.temperature.parameters import Parameters

Item = TypeVar("Item")
TOGETHER = 1.0  #: °C; set-points that differ by no more have one temperature
FEWEST = 1024  #: fewest samples of a record
WINDOWS = 2.0  #: windows of the smoothed temperature on both sides of its turn, which smooth the turn
STEADY = 0.2  #: °C; a smoothed temperature that spans no more is constant


@dataclass(frozen=True, eq=False)
class LogPart:
    """A stretch of a log, with its arrays still in the log."""

    number: int  #: number of the log
    log: Log
    axes: dict[str, Axis]
    stretch: Stretch
    thermometer: tuple[Floats, Floats] | None  #: s and °C; None: one temperature

    def rows(self, name: str) -> slice:
        """Return the longest part of an axis without gaps within the stretch."""
        axis = self.axes[name]
        first, last = 0, axis.values.size
        if self.thermometer is not None:
            begin = self.log.zero or 0
            first = int(np.searchsorted(axis.time, round(self.stretch.start * SECOND) + begin, "left"))
            last = int(np.searchsorted(axis.time, round(self.stretch.end * SECOND) + begin, "right"))
        return longest_part(axis.clock.breaks, last, first)

    def has_enough(self) -> bool:
        """Return whether some axis has enough samples."""
        return any((rows := self.rows(name)).stop - rows.start >= FEWEST for name in self.axes)

    def record(self, name: str) -> Record | None:
        """Return the longest part of an axis without gaps; None if it has too few samples."""
        if name not in self.axes:
            return None
        axis, rows = self.axes[name], self.rows(name)
        if rows.stop - rows.start < FEWEST:
            return None
        values, seconds = np.ascontiguousarray(axis.values[rows]), self.log.seconds(axis.time[rows])
        warm = None if self.thermometer is None else smooth_temperature(*self.thermometer, seconds)
        warm = warm if warm is not None and np.ptp(warm) > STEADY else None
        celsius = self.stretch.celsius if warm is None else float(warm.mean())
        since = (self.log.zero or 0) / SECOND if self.log.imu().origin.epoch == "unix" else 0.0
        return Record(values, since + float(seconds[0]), celsius, warm, self.stretch.rising, self.number)


def parts_of(
    number: int, log: Log, given: float | None, parameters: Parameters, thermal: ThermalLag | None = None
) -> tuple[str, tuple[LogPart, ...], Doubts]:
    """Return how a log was divided, its stretches, and what the record shows against their noise.

    Args:
        number: number of the log.
        log: a log of a still sensor.
        given: °C, temperature of the log; None: by its thermometer.
        parameters: options.
        thermal: temperature of the sensor, in place of that of a thermometer which lags; None: not known.

    Raises:
        MissingDataError: the log has no temperature, or the sensor moves.
    """
    imu, path = log.imu(), log.provenance.path
    axes = axes_of(imu)
    doubts = _check_stillness(log, thermal)
    if given is not None:
        begin, end = log.seconds(next(iter(axes.values())).time[[0, -1]]).tolist()
        stretch = Stretch(begin, end, given, 0.0, given, None)
        return "set-point", (LogPart(number, log, axes, stretch, None),), doubts
    if imu.temperature is None or not len(imu.temperature):
        raise MissingDataError(
            f"{path}: {imu.name} has no temperature; give it: --celsius with one number for each log, such as -30,0,30"
        )
    time, celsius = log.seconds(imu.temperature.time), imu.temperature.value
    if thermal is not None and thermal.evident:
        time, celsius = thermal.time, thermal.celsius
    rate = 1 / next(iter(axes.values())).clock.interval
    wanted = None if parameters.cut == "auto" else parameters.cut
    cut, parts = stretches(time, celsius, rate, wanted, parameters.bins, near_turns(thermal))
    thermometer = None if cut == "set-point" and np.ptp(celsius) == 0 else (time, celsius)
    return cut, tuple(LogPart(number, log, axes, stretch, thermometer) for stretch in parts), doubts


def near_turns(thermal: ThermalLag | None) -> float:
    """Return the time on both sides of a turn of the temperature that is left out, s.

    There an error of the lag, or a hysteresis that takes time to change, would look like a random walk.
    """
    if thermal is None or not thermal.turns:
        return 0.0
    window = WINDOWS * thermal.window.width
    return max(abs(thermal.lag.value), window) if thermal.evident else window


def _check_stillness(log: Log, thermal: ThermalLag | None) -> Doubts:
    """Return what the record shows against its noise; raise MissingDataError if the sensor moves in most of the log."""

    def drift(name: str, at: Floats) -> Floats:
        if thermal is None or name not in thermal.drift:
            return np.zeros(at.size)
        return np.interp(at, thermal.time, thermal.drift[name])

    still = stillness_of(log, drift if thermal is not None else None)
    if still is not None and still.moving:
        raise MissingDataError(
            f"{log.provenance.path}: the sensor moves in most parts of the log; noise needs a still sensor. Its longest quiet part: "
            f"--start {np.ceil(still.quiet_start):.0f} --end {np.floor(still.quiet_end):.0f}"
        )
    return record_doubts(log, still).of(log.provenance.path)


def grouped(items: Iterable[Item], celsius: Callable[[Item], float]) -> list[list[Item]]:
    """Return the items at each temperature, in rising order."""
    groups: list[list[Item]] = []
    for item in sorted(items, key=celsius):
        if groups and celsius(item) - celsius(groups[-1][0]) <= TOGETHER:
            groups[-1].append(item)
        else:
            groups.append([item])
    return groups

"""From logs to the records of each axis at each temperature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.axes import axes_of
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import stillness
from imuwb.identification.temperature import Record, Stretch, smooth_temperature, stretches
from imuwb.log import SECOND
from imuwb.sampling import longest_part

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.axes import Axis
    from imuwb.log import Floats, Log
    from imuwb_plugins.temperature.parameters import Parameters

TOGETHER = 1.0  #: °C, that set-points of one temperature are apart at most
FEWEST = 1024  #: samples of a record
SAME_RATE = 0.01
STEADY = 0.2  #: °C


@dataclass(frozen=True, eq=False)
class Part:
    """A stretch of a log, not yet read out of its arrays."""

    number: int  #: of the log
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
        """Return an axis's longest part without gaps; None where there is none, or too little of it."""
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
    number: int, log: Log, given: float | None, parameters: Parameters
) -> tuple[str, tuple[Part, ...], list[str]]:
    """Return how a log was cut, its stretches, and notes.

    Raises:
        MissingDataError: it has no temperature, or moves.
    """
    imu, where = log.imu(), log.provenance.path
    axes = axes_of(imu)
    still = stillness(
        {name: (log.seconds(axis.time), axis.values) for name, axis in axes.items() if np.ptp(axis.values)}
    )
    notes: list[str] = []
    if still is not None and still.moving:
        message = (
            f"{where}: it moves in most of its parts, and the noise of a motion is none of the sensor's; its longest quiet part: "
            f"--start {np.ceil(still.quiet_start):.0f} --end {np.floor(still.quiet_end):.0f}"
        )
        raise MissingDataError(message)
    if still is not None and still.disturbances:
        worst = max(still.disturbances, key=lambda d: d.largest)
        notes.append(
            f"{where}: {len(still.disturbances)} shocks or movements, the largest at {worst.start:.0f} s ({worst.largest:.0f} times the "
            f"usual scatter): what is found at that temperature is not the sensor's alone"
        )
    if given is not None:
        begin, end = log.seconds(next(iter(axes.values())).time[[0, -1]]).tolist()
        return "set-point", (Part(number, log, axes, Stretch(begin, end, given, 0.0, given, None), None),), notes
    if imu.temperature is None or not len(imu.temperature):
        message = f"{where}: {imu.name} has no temperature; say it: --celsius with one figure a log, as -30,0,30"
        raise MissingDataError(message)
    time, celsius = log.seconds(imu.temperature.time), imu.temperature.value
    rate = 1 / next(iter(axes.values())).clock.interval
    cut, found = stretches(time, celsius, rate, None if parameters.cut == "auto" else parameters.cut, parameters.bins)
    thermometer = None if cut == "set-point" and np.ptp(celsius) == 0 else (time, celsius)
    return cut, tuple(Part(number, log, axes, stretch, thermometer) for stretch in found), notes


def grouped(parts: Sequence[Part]) -> list[list[Part]]:
    """Return the parts of each temperature, rising."""
    groups: list[list[Part]] = []
    for part in sorted(parts, key=lambda p: p.stretch.nominal):
        if groups and part.stretch.nominal - groups[-1][0].stretch.nominal <= TOGETHER:
            groups[-1].append(part)
        else:
            groups.append([part])
    return groups


def check_together(logs: Sequence[Log], parameters: Parameters) -> list[str]:
    """Return what must be said of logs that are taken together.

    Raises:
        UsageError: one is given twice, at different rates, or with other than one temperature each.
    """
    given = parameters.temperatures()
    if given is not None and len(given) != len(logs):
        message = f"--celsius has {len(given)} temperatures for {len(logs)} logs; give one for each, in their order"
        raise UsageError(message)
    paths = {log.provenance.hash: log.provenance.path for log in logs}
    if len(paths) < len(logs):
        twice = [log.provenance.path for log in logs if paths[log.provenance.hash] != log.provenance.path]
        same = twice[0] if twice else logs[0].provenance.path
        message = f"{same} is the same as another of the logs; the same noise twice tells no more: give it once"
        raise UsageError(message)
    _check_rates(logs)
    names = {log.imu().name for log in logs}
    if len(names) > 1:
        return [f"the logs name their IMU differently ({', '.join(sorted(names))}): they are taken for one sensor"]
    return []


def _check_rates(logs: Sequence[Log]) -> None:
    first: dict[str, tuple[float, str]] = {}
    for log in logs:
        for axis in axes_of(log.imu()).values():
            rate, where = 1 / axis.clock.interval, log.provenance.path
            known, there = first.setdefault(axis.sensor, (rate, where))
            if abs(rate / known - 1) > SAME_RATE:
                message = (
                    f"{axis.sensor}: {known:.6g} Hz in {there}, {rate:.6g} Hz in {where}; AR(1) and sigma hold at one rate only: "
                    f"bring the logs to one with --through decimate:rate={min(rate, known):.4g}"
                )
                raise UsageError(message)


def check_thermometers(logs: Sequence[Log], parameters: Parameters) -> list[str]:
    """Return notes on thermometers that read 0 throughout.

    Raises:
        MissingDataError: all do, as one does that is not connected.
    """
    if parameters.celsius is not None:
        return []
    readings = [t for log in logs if (t := log.imu().temperature) is not None and len(t)]
    dead = [not t.value.any() for t in readings]
    if readings and all(dead):
        message = (
            f"{logs[0].provenance.path}: its temperature is 0 °C throughout{', as in all logs' if len(logs) > 1 else ''}: a thermometer "
            f"that is not connected reads so; say the temperature: --celsius with one figure a log"
        )
        raise MissingDataError(message)
    return [
        f"{log.provenance.path}: its temperature is exactly 0 °C throughout, as of a set-point at 0 °C, or of a thermometer that is not connected"
        for log in logs
        if (t := log.imu().temperature) is not None and len(t) and not t.value.any()
    ]

"""Scatter: how much each axis scatters within short pieces of a log, and in how many pieces it is quiet.

A piece in which the sensor is at rest scatters by its noise alone; a disturbed piece scatters more. The median over all pieces is
what the sensor does usually, and the range is from the quietest piece to the loudest one.

Example: imuwb plugin_name LOG --length 2
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from imuwb.analysis import Answer, Curve, Figure, Review, Series, Table
from imuwb.arrays import Floats, Integers
from imuwb.colors import AXIS_COLORS
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.options import Between, Options
from imuwb.statistics import Estimate
from imuwb.texts import interval_text

LEAST = 3  #: samples of a piece


@dataclass(frozen=True)
class Parameters(Options):
    """Options of the analysis."""

    length: Annotated[float, "length of a piece (s)", Between(0.01, 3600.0)] = 1.0


@dataclass(frozen=True, eq=False)
class Axis:
    """The scatter of one axis."""

    time: Integers  #: (n,) ns, where each piece begins
    scatter: Floats  #: (n,) standard deviation of each piece, rad/s or m/s²
    usual: Estimate  #: median, from the quietest to the loudest piece


@dataclass(frozen=True, eq=False)
class Result:
    """The scatter of all axes of one IMU."""

    imu: str
    length: float  #: s
    axes: dict[str, Axis]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the scatter of each axis of the first IMU.

    Raises:
        MissingDataError: no IMU, or no piece with enough samples.
    """
    log = logs[0]
    imu = log.imu()
    axes: dict[str, Axis] = {}
    for name, (time, values) in imu.axes().items():
        unit = "rad/s" if name.startswith("gyro") else "m/s²"
        begin, scatter = _pieces(time, values, parameters.length)
        if not scatter.size:
            raise MissingDataError(
                f"{log.provenance.path}: {name} has no {parameters.length:g} s with {LEAST} samples; give a longer --length"
            )
        usual = Estimate(float(np.median(scatter)), float(scatter.min()), float(scatter.max()), unit=unit)
        axes[name] = Axis(begin, scatter, usual)
    return Result(imu.name, parameters.length, axes)


def _pieces(time: Integers, values: Floats, length: float) -> tuple[Integers, Floats]:
    """Return where each piece begins, and its standard deviation; pieces with few samples are left out."""
    number = (time - time[0]) // round(length * 1e9)
    starts = np.flatnonzero(np.diff(number, prepend=-1))
    count = np.diff(starts, append=time.size)
    mean = np.add.reduceat(values, starts) / count
    square = np.add.reduceat((values - np.repeat(mean, count)) ** 2, starts)
    enough = count >= LEAST
    return time[starts][enough], np.sqrt(square[enough] / (count[enough] - 1))


def answer(result: Result) -> Answer:
    """Return what a person must know first."""
    rows = tuple((name, interval_text(axis.usual)) for name, axis in result.axes.items())
    times = {n: axis.usual.upper / axis.usual.value for n, axis in result.axes.items() if axis.usual.value > 0}
    loud = max(times, key=lambda name: times[name], default="")
    sentence = "No axis scatters: the values do not change."
    if loud:
        sentence = f"{loud} has the loudest piece: {times[loud]:.3g} times its usual scatter."
    return Answer(
        f"pieces of {result.length:g} s", ("axis", "scatter [quietest, loudest]"), rows, (sentence,),
        numbers={f"scatter of {name}": axis.usual for name, axis in result.axes.items()},
    )  # fmt: skip


def draw(result: Result, review: Review) -> None:
    """Show the scatter over time, its distribution, and the table."""
    for sensor, unit in (("gyro", "rad/s"), ("accel", "m/s²")):
        axes = {name: axis for name, axis in result.axes.items() if name.startswith(sensor)}
        if not axes:
            continue
        curves = tuple(
            Curve(name, np.linspace(0.0, 100.0, axis.scatter.size), np.sort(axis.scatter), AXIS_COLORS[name[-1]])
            for name, axis in axes.items()
        )
        title = f"{sensor}: share of pieces that scatter less"
        review.figure(Figure(title, "share of pieces [%]", f"scatter [{unit}]", curves, x_scale="linear"))
        for name, axis in axes.items():
            values = axis.scatter[:, np.newaxis]
            review.series(Series(f"Scatter of {name}", unit, axis.time, values, (name,)))
    rows = tuple((name, interval_text(axis.usual), str(axis.scatter.size)) for name, axis in result.axes.items())
    review.table(Table(f"Scatter of {result.imu}", ("axis", "median [quietest, loudest]", "pieces"), rows))

"""The charts beside the drive, on the same cursor: errors with sigma, speed, heading, and the biases with theirs."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from imuwb.analysis import Series
from imuwb.arrays import Floats, Integers
from imuwb.colors import AXIS_COLORS, GREY
from imuwb.geodesy import euler_of_quaternion
from imuwb.log import SECOND
from imuwb.navigation.filter import axis_errors
from imuwb.replay import FilterRun, Replay, Scores, true_errors
from imuwb.scene import Pose
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.outage.drive_outages import Shown, stamps
from imuwb_plugins.outage.figures import color_of

KMH = 3.6
MOST = 400  #: times at which biases are shown: they change slowly
SIGMAS = 3.0  #: of the lines beside headings and biases
FAINT = 110  #: opacity of lines of sigma
SENSORS = (
    ("Gyro bias", "deg/h", float(np.degrees(3600.0)), 0),
    ("Accelerometer bias", "mg", 1e3 / STANDARD_GRAVITY, 3),
)


def charts(replay: Replay, names: Sequence[str], outages: Sequence[Shown], body: Pose) -> Iterator[Series]:
    """Yield the charts.

    Args:
        replay: all filters in the same outages.
        names: the filters, the best first.
        outages: that are shown.
        body: the vehicle.
    """
    if outages:
        yield _errors(replay, names, outages)
        yield _heading_error(replay, names[0], outages)
    yield _speed(replay, names[0], outages, body)
    yield from _biases(replay, names[0])


def _in_outages(
    replay: Replay, outages: Sequence[Shown], values: Callable[[Shown], Floats]
) -> tuple[Integers, Floats]:  # fmt: skip
    """Return values at the seconds of all outages that are shown, in order of time, with a break after each outage."""
    drifts = next(iter(replay.runs.values())).outages
    time, rows = [], []
    for own in sorted(outages, key=lambda own: own.start):
        found = values(own)
        elapsed = drifts[own.duration].drift.elapsed
        time += [own.start + elapsed, own.start + elapsed[-1:] + 0.1]
        rows += [found, np.full((1, found.shape[1]), np.nan)]
    return stamps(replay, np.concatenate(time)), np.concatenate(rows)


def _scores(run: FilterRun, own: Shown) -> Scores:
    return run.outages[own.duration].scores


def _series(
    title: str, unit: str, data: tuple[Integers, Floats], looks: Sequence[tuple[str, tuple[int, ...]]]
) -> Series:
    time, values = data
    return Series(title, unit, time, values, tuple(name for name, _ in looks), tuple(c for _, c in looks))


def _errors(replay: Replay, names: Sequence[str], outages: Sequence[Shown]) -> Series:
    best = names[0]

    def values(own: Shown) -> Floats:
        sigma = _scores(replay.runs[best], own).sigma[own.row]
        each = [_scores(replay.runs[name], own).horizontal[own.row] for name in names]
        return np.stack([*each, sigma, SIGMAS * sigma], axis=1)

    looks = [(name, (*color_of(name), 255)) for name in names]
    looks += [(f"1 and 3 sigma of {best}", (*color_of(best), FAINT))] * 2
    return _series("Horizontal error", "m", _in_outages(replay, outages, values), looks)


def _heading_error(replay: Replay, best: str, outages: Sequence[Shown]) -> Series:
    """Return the best filter's error in heading; without a heading of the reference, against its run over all fixes."""
    run, known = replay.runs[best], replay.reference.heading is not None

    def values(own: Shown) -> Floats:
        drift = run.outages[own.duration].drift
        error = _scores(run, own).heading[own.row]
        if not known:
            whole = np.interp(drift.time[own.row], run.solution.time, np.unwrap(run.solution.euler[:, 2]))
            error = euler_of_quaternion(drift.state[own.row, :, 6:10])[:, 2] - whole
            error = np.angle(np.exp(1j * error))
        sigma = SIGMAS * np.sqrt(drift.covariance[own.row, :, 8, 8])
        return np.degrees(np.stack([error, sigma, -sigma], axis=1))

    color, against = color_of(best), "" if known else " against all fixes"
    looks = [(best, (*color, 255)), *(("3 sigma", (*color, FAINT)),) * 2]
    return _series(f"Heading error{against}", "deg", _in_outages(replay, outages, values), looks)


def _speed(replay: Replay, best: str, outages: Sequence[Shown], body: Pose) -> Series:
    """Return the speed of the reference over the whole drive, and that of the best filter in the outages."""
    seconds = (body.time - (replay.prepared.log.zero or 0)) / SECOND
    velocity = replay.reference.at(seconds)[1]
    believed = np.full(seconds.size, np.nan)
    for own in outages:
        drift = replay.runs[best].outages[own.duration].drift
        inside = (seconds >= own.start + drift.elapsed[0]) & (seconds <= own.start + own.duration)
        north, east = drift.state[own.row, :, 3:5].T
        believed[inside] = np.interp(seconds[inside], own.start + drift.elapsed, np.hypot(north, east))
    values = KMH * np.stack([np.hypot(velocity[:, 0], velocity[:, 1]), believed], axis=1)
    looks = [("reference", (*GREY, 255)), (best, (*color_of(best), 255))]
    return _series("Speed", "km/h", (body.time, values), looks)


def _biases(replay: Replay, best: str) -> Iterator[Series]:
    """Yield the biases that the best filter estimates with all fixes, with three sigma, and the true ones of a simulated log."""
    solution = replay.runs[best].solution
    errors, sigma = axis_errors(solution)
    true = true_errors(replay.prepared)
    for title, unit, factor, first in SENSORS:
        parts: list[Floats] = []
        looks: list[tuple[str, tuple[int, ...]]] = []
        for i, axis in enumerate("xyz"):
            value, wide = errors[:, first + i], SIGMAS * sigma[:, first + i]
            parts += [value, value - wide, value + wide]
            looks += [(axis, (*AXIS_COLORS[axis], 255)), *((axis, (*AXIS_COLORS[axis], FAINT)),) * 2]
            if true is not None:
                parts.append(np.interp(solution.time, true[0], true[1][:, first + i]))
                looks.append(("true", (*GREY, 255)))  # visible on a light background too
        kept = slice(None, None, -(-solution.time.size // MOST))
        values = np.stack(parts, axis=1)[kept] * factor
        yield _series(
            f"{title} of {best} with all fixes, 3 sigma faint",
            unit,
            (stamps(replay, solution.time[kept]), values),
            looks,
        )

"""From logs to stretches in which the sensor stays as it is."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.calibration import clipped, shared, steady
from imuwb.sampling import sampling

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Floats, ImuStream, Log, Triad

FEWEST = 64  #: samples of a stretch, for the scatter of its parts
LEANS = 0.005  #: of gravity, by which a position held by hand may wander in half a second
CREEPS = 0.01  #: of the gyros' span in the log, likewise
SAME_RATE = 0.02  #: relative, between logs
LOOSE = 1e3  #: standard deviations; a still gyro is not judged by its slow drift
STILL = 3.0  #: deg/s; a log whose means span less never turned
MOVES = 0.005  #: of the span of all means: an error of a mean that no still sensor has


@dataclass(frozen=True, eq=False, slots=True)
class Stretch:
    """Samples between two times, SI or as they are."""

    name: str
    seconds: float
    accel: Floats | None  #: (n, 3)
    gyro: Floats | None  #: (m, 3)
    celsius: float | None


def still(logs: Sequence[Log], shortest: float) -> tuple[list[Stretch], list[str]]:
    """Return every still position of the logs, and notes.

    Raises:
        MissingDataError: a log without accelerometer, or in which nothing is still.
        UsageError: logs of different rates.
    """
    notes: list[str] = []
    imus = [log.imu() for log in logs]
    for log, imu in zip(logs, imus, strict=True):
        if imu.specific_force is None or len(imu.specific_force) < FEWEST:
            message = f"{log.provenance.path}: {imu.name} has no accelerometer; still positions calibrate accelerometers, gyros alone need a rate table"
            raise MissingDataError(message)
    with_gyro = all(imu.angular_rate is not None and len(imu.angular_rate) >= FEWEST for imu in imus)
    if not with_gyro and any(imu.angular_rate is not None for imu in imus):
        notes.append("not every log has gyro samples: gyros are left out")
    _same_rate(logs, [imu.specific_force for imu in imus if imu.specific_force is not None], "accelerometer")
    if with_gyro:
        _same_rate(logs, [imu.angular_rate for imu in imus if imu.angular_rate is not None], "gyro")
    found: list[Stretch] = []
    for log, imu in zip(logs, imus, strict=True):
        spans = _still_spans(log, imu, shortest, with_gyro=with_gyro)
        here = [
            s
            for i, span in enumerate(spans)
            if (s := _stretch(log, imu, span, i, len(spans), with_gyro=with_gyro)) is not None
        ]
        if not here:
            message = (
                f"{log.provenance.path}: nothing in it stays still for {shortest:g} s; a position is a stretch in which neither "
                "accelerometer nor gyro moves (--shortest asks for less)"
            )
            raise MissingDataError(message)
        found.extend(here)
    return found, notes


def steps(log: Log, shortest: float, raw: str) -> list[Stretch]:
    """Return every step of a rate table's staircase.

    Args:
        log: a run of the table.
        shortest: s, of a step.
        raw: the unit of the samples; "" for SI.

    Raises:
        MissingDataError: no gyro, one that never turns, or fewer than two steps.
    """
    imu = log.imu()
    gyro = imu.angular_rate
    if gyro is None or len(gyro) < FEWEST:
        message = f"{log.provenance.path}: {imu.name} has no gyro; a rate table calibrates gyros, accelerometers need positions"
        raise MissingDataError(message)
    _check_turns(log, gyro, raw)
    span = np.full(3, float(np.ptp(gyro.value, axis=0).max()))
    spans = _spans(log, gyro, shortest, span)
    found = [
        s for i, one in enumerate(spans)
        if (s := _stretch(log, imu, one, i, len(spans), with_gyro=True, with_accel=imu.specific_force is not None)) is not None
    ]  # fmt: skip
    if len(found) < 2:  # noqa: PLR2004 - nothing to compare
        message = (
            f"{log.provenance.path}: {len(found)} step{'s' if len(found) != 1 else ''} of {shortest:g} s or more; a rate table's log holds "
            "several steady rates (--shortest asks for less)"
        )
        raise MissingDataError(message)
    return found


def _check_turns(log: Log, gyro: Triad, raw: str) -> None:
    second = min(max(round(sampling(gyro.time).rate or 1.0), 1), len(gyro))
    means = gyro.value[: len(gyro) // second * second].reshape(-1, second, 3).mean(axis=1)
    span = float(np.degrees(np.ptp(means, axis=0).max()))
    if not raw and span < STILL:
        message = (
            f"{log.provenance.path}: it never turns: means of its gyros over a second differ by {span:.3g} deg/s at most; "
            "a rate table turns both ways at known rates"
        )
        raise MissingDataError(message)


def check_clipping(stretches: Sequence[Stretch], sensor: str) -> None:
    """Raise MissingDataError where an axis stands at the end of its range."""
    values = [v for s in stretches if (v := s.accel if sensor == "accel" else s.gyro) is not None]
    bad = clipped(values)
    if bad.any():
        at, axis = (int(k) for k in np.argwhere(bad)[0])
        column = values[at][:, axis]
        end = column[np.argmax(np.abs(column))]
        rest = int(bad.any(axis=1).sum()) - 1
        more = f", and {rest} more stretches are clipped" if rest else ""
        message = f"{stretches[at].name}: {sensor} {'xyz'[axis]} is clipped at {end:.6g}{more}; the sensor needs a larger range, or less input"
        raise MissingDataError(message)


def check_still(stretches: Sequence[Stretch], mean: Floats, variance: Floats) -> None:
    """Raise MissingDataError where a position's mean is so uncertain that it was none."""
    span = float(np.ptp(mean, axis=0).max()) if len(mean) > 1 else float(np.linalg.norm(mean[0]))
    worst = int(np.argmax(variance.max(axis=1)))
    sigma = float(variance[worst].max()) ** 0.5
    if sigma > MOVES * span:
        message = (
            f"{stretches[worst].name}: it is not still: its quarters scatter so that the mean is uncertain by {sigma:.3g}, "
            f"of {span:.3g} between positions"
        )
        raise MissingDataError(message)


def temperature_of(stretches: Sequence[Stretch]) -> tuple[float | None, list[str]]:
    """Return the mean temperature, °C, and a note where it changes."""
    known = [s.celsius for s in stretches if s.celsius is not None]
    if not known:
        return None, []
    low, high = min(known), max(known)
    changes = high - low > 2  # noqa: PLR2004 - °C; bias and scale of cheap sensors move by as much as their intervals
    note = f"temperature went from {low:.1f} to {high:.1f} °C: bias and scale factor may have moved with it"
    return float(np.mean(known)), [note] if changes else []


def _same_rate(logs: Sequence[Log], triads: Sequence[Triad], sensor: str) -> None:
    rates = [sampling(t.time).rate or 0.0 for t in triads]
    if max(rates) > (1 + SAME_RATE) * min(rates):
        low, high = int(np.argmin(rates)), int(np.argmax(rates))
        message = (
            f"{sensor} rates differ: {rates[low]:.4g} Hz in {logs[low].provenance.path}, {rates[high]:.4g} Hz in "
            f"{logs[high].provenance.path}; one calibration takes logs of one setting"
        )
        raise UsageError(message)


def _still_spans(log: Log, imu: ImuStream, shortest: float, *, with_gyro: bool) -> list[tuple[float, float]]:
    force, gyro = imu.specific_force, imu.angular_rate
    assert force is not None  # noqa: S101 - the caller has looked
    size = np.full(3, float(np.median(np.linalg.norm(force.value, axis=1))))
    spans = _spans(log, force, shortest, size, LEANS * size)
    if with_gyro and gyro is not None:
        loose = LOOSE * gyro.value.std(axis=0)
        spans = shared(spans, _spans(log, gyro, shortest, loose, CREEPS * np.ptp(gyro.value, axis=0)))
    return [(a, b) for a, b in spans if b - a >= shortest]


def _spans(
    log: Log, triad: Triad, shortest: float, span: Floats, tolerance: Floats | float = 0.0
) -> list[tuple[float, float]]:
    """Return the times, s from the log's start, of what is steady in a triad, between its gaps."""
    clock, seconds = sampling(triad.time), log.seconds(triad.time)
    found: list[tuple[float, float]] = []
    for begin, end in pairwise([0, *clock.breaks, len(triad)]):
        for first, last in steady(triad.value[begin:end], clock.interval, shortest, span, tolerance):
            found.append((float(seconds[begin + first]), float(seconds[begin + last - 1]) + clock.interval))
    return found


def _stretch(
    log: Log,
    imu: ImuStream,
    span: tuple[float, float],
    number: int,
    count: int,
    *,
    with_gyro: bool,
    with_accel: bool = True,
) -> Stretch | None:
    begin, end = span
    name = Path(log.provenance.path).name
    if count > 1:
        name = f"{name} {begin:.0f}-{end:.0f} s" if number < count else name

    def inside(triad: Triad | None) -> Floats | None:
        if triad is None:
            return None
        rows = np.searchsorted(log.seconds(triad.time), span)
        return triad.value[rows[0] : rows[1]]

    accel = inside(imu.specific_force) if with_accel else None
    gyro = inside(imu.angular_rate) if with_gyro else None
    if any(part is not None and len(part) < FEWEST for part in (accel, gyro)):
        return None
    celsius = None
    if imu.temperature is not None:
        at = log.seconds(imu.temperature.time)
        near = imu.temperature.value[(at >= begin) & (at <= end)]
        celsius = float(near.mean()) if near.size else float(np.interp((begin + end) / 2, at, imu.temperature.value))
    return Stretch(name, end - begin, accel, gyro, celsius)

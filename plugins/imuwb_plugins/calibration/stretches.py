"""From logs to the stretches in which the sensor does not move, or turns at a constant rate."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.axes import check_three_axes
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.calibration import clipped, shared, steady
from imuwb.log import ImuStream, Log, Triad
from imuwb.notes import Note
from imuwb.sampling import sampling
from imuwb.units import COUNT, SENSORS

FEWEST = 64  #: fewest samples of a stretch, for the scatter of its parts
LEAST, USUAL = 1.0, 10.0  #: s, limits of the shortest duration of a position that is found from a log
LOOSENED = (1.0, 2.0, 4.0)  #: times the limits of stillness that are tried
MOST = 0.9  #: share of the positions that the loosest limit finds
LEANS = 0.005  #: share of gravity by which a position held by hand may vary in half a second
CREEPS = 0.01  #: share of the gyros' span in the log by which their means may vary in half a second
SAME_RATE = 0.02  #: largest relative difference of sampling rates between logs
LOOSE = 1e3  #: standard deviations, by which a still gyro may drift
STILL = 3.0  #: deg/s; a log whose means span less does not turn
MOVES = 0.005  #: share of the span of all means; a more uncertain mean shows that the sensor was not still
WARMED = 2.0  #: °C; bias and scale factor of cheap sensors change by as much as their intervals


@dataclass(frozen=True, slots=True)
class _Stillness:
    """What makes a stretch a position."""

    shortest: float | None  #: s; None: a third of the median duration
    gravity: float  #: in the unit of the samples
    loosened: float  #: times the usual limits


@dataclass(frozen=True, eq=False, slots=True)
class SteadyStretch:
    """Samples between two times, in SI or in counts or volts."""

    name: str
    seconds: float
    accel: Floats | None  #: (n, 3)
    gyro: Floats | None  #: (m, 3)
    celsius: float | None
    log: int = 0  #: number of the log
    span: tuple[float, float] = (0.0, 0.0)  #: s from the log's start, begin and end


def still_positions(
    logs: Sequence[Log], shortest: float | None, wanted: int, raw: str
) -> tuple[list[SteadyStretch], list[Note]]:
    """Return every still position of the logs, and notes.

    A sensor that is held by hand sways. The strictest limit of stillness is used with which there are as many
    positions as wanted, and nine tenths of those with the loosest one.

    Args:
        logs: logs of one sensor.
        shortest: s, shortest duration of a position; None: a third of the median duration in a log, from 1 to 10 s.
        wanted: positions that the method needs.
        raw: unit of the samples; "" for SI.

    Raises:
        MissingDataError: a log without accelerometer, or without a still position.
        UsageError: logs of different rates.
    """
    imus = [log.imu() for log in logs]
    for log, imu in zip(logs, imus, strict=True):
        if imu.specific_force is None or len(imu.specific_force) < FEWEST:
            raise MissingDataError(
                f"{log.provenance.path}: {imu.name} has no accelerometer; still positions calibrate accelerometers, "
                "and gyros alone need a rate table"
            )
        check_three_axes(log.provenance.path, imu, "a calibration")
    with_gyro = all(imu.angular_rate is not None and len(imu.angular_rate) >= FEWEST for imu in imus)
    lacking = not with_gyro and any(imu.angular_rate is not None for imu in imus)
    notes = [Note("no-gyro", "not every log has gyro samples: gyros are left out")] if lacking else []
    _same_rate(logs, [imu.specific_force for imu in imus if imu.specific_force is not None], "accelerometer")
    if with_gyro:
        _same_rate(logs, [imu.angular_rate for imu in imus if imu.angular_rate is not None], "gyro")
    size = _size([imu.specific_force.value for imu in imus if imu.specific_force is not None], raw)
    found = [_positions(logs, imus, _Stillness(shortest, size, loosened), with_gyro=with_gyro) for loosened in LOOSENED]
    counts = np.array([len(f) for f in found])
    best = int(np.argmax(counts >= max(min(wanted, counts.max()), MOST * counts.max())))
    stretches = found[best]
    for number, log in enumerate(logs):
        if all(s.log != number for s in stretches):
            least = f"for {shortest:g} s" if shortest is not None else f"for {LEAST:g} s"
            raise MissingDataError(
                f"{log.provenance.path}: the sensor is never still {least}; in a position neither accelerometer nor "
                "gyro moves; use --shortest for shorter positions"
            )
    return stretches, [*notes, *_stillness_notes(stretches, shortest, LOOSENED[best])]


def _stillness_notes(stretches: Sequence[SteadyStretch], shortest: float | None, loosened: float) -> list[Note]:
    notes: list[Note] = []
    if shortest is None and len({s.log for s in stretches}) < len(stretches):
        seconds = [s.seconds for s in stretches]
        text = f"still positions last {min(seconds):.1f} to {max(seconds):.1f} s, median {np.median(seconds):.1f} s; --shortest sets a limit"
        notes.append(Note("holds", text))
    if loosened > 1:
        notes.append(
            Note("sways", f"positions may sway by {loosened:g} times the usual limit, since fewer are still within it")
        )
    return notes


def _size(values: Sequence[Floats], raw: str) -> float:
    """Return the reading that gravity makes: the norm in SI; in counts or volts, half the range of the axis with the largest."""
    if not raw:
        return float(np.median(np.concatenate([np.linalg.norm(v, axis=1) for v in values])))
    low, high = np.quantile(np.concatenate(values), [0.005, 0.995], axis=0)
    return float((high - low).max()) / 2


def _positions(
    logs: Sequence[Log], imus: Sequence[ImuStream], stillness: "_Stillness", *, with_gyro: bool
) -> list[SteadyStretch]:
    return [
        s
        for number, (log, imu) in enumerate(zip(logs, imus, strict=True))
        for spans in [_still_spans(log, imu, stillness, with_gyro=with_gyro)]
        for span in spans
        if (s := _stretch(log, imu, span, len(spans), with_gyro=with_gyro, number=number)) is not None
    ]


def unit_of_counts(logs: Sequence[Log], raw: str) -> str:
    """Return the unit of samples that are not in SI: the given one, or that which the logs state; "" for SI.

    Raises:
        UsageError: some sensors are in counts, and others are not.
    """
    stated = {sensor in log.imu().origin.counts for log in logs for sensor in _sensors(log)}
    if len(stated) > 1:
        raise UsageError(
            "some sensors of the logs are in counts and others are not; read all in counts: --units gyro=count,accel=count"
        )
    return raw or (COUNT if True in stated else "")


def _sensors(log: Log) -> list[str]:
    imu = log.imu()
    return [s for s, triad in zip(SENSORS, (imu.angular_rate, imu.specific_force), strict=True) if triad is not None]


def steps_of(log: Log, shortest: float, raw: str) -> list[SteadyStretch]:
    """Return every step of a rate table's staircase.

    Args:
        log: a run of the table.
        shortest: s, duration of a step at least.
        raw: unit of the samples; "" for SI.

    Raises:
        MissingDataError: no gyro, no rotation, or fewer than two steps.
    """
    imu = log.imu()
    gyro = imu.angular_rate
    if gyro is None or len(gyro) < FEWEST:
        raise MissingDataError(
            f"{log.provenance.path}: {imu.name} has no gyro; a rate table calibrates gyros, and accelerometers need positions"
        )
    check_three_axes(log.provenance.path, imu, "a calibration")
    _check_turns(log, gyro, raw)
    span = np.full(3, float(np.ptp(gyro.value, axis=0).max()))
    spans = _spans(log, gyro, shortest, span)
    steps = [
        s for one in spans
        if (s := _stretch(log, imu, one, len(spans), with_gyro=True, with_accel=imu.specific_force is not None)) is not None
    ]  # fmt: skip
    if len(steps) < 2:  # noqa: PLR2004 - a line has two points
        raise MissingDataError(
            f"{log.provenance.path}: {len(steps)} step{'s' if len(steps) != 1 else ''} of {shortest:g} s or more; the log of a rate "
            "table has several steady rates; use --shortest for shorter steps"
        )
    return steps


def _check_turns(log: Log, gyro: Triad, raw: str) -> None:
    second = min(max(round(sampling(gyro.time).rate or 1.0), 1), len(gyro))
    means = gyro.value[: len(gyro) // second * second].reshape(-1, second, 3).mean(axis=1)
    span = float(np.degrees(np.ptp(means, axis=0).max()))
    if not raw and span < STILL:
        raise MissingDataError(
            f"{log.provenance.path}: the sensor never turns: means of its gyros over a second differ by {span:.3g} deg/s at most; "
            "a rate table turns in both directions at known rates"
        )


def check_clipping(stretches: Sequence[SteadyStretch], sensor: str) -> None:
    """Raise MissingDataError if an axis stands at the end of its range."""
    values = [v for s in stretches if (v := s.accel if sensor == "accel" else s.gyro) is not None]
    bad = clipped(values)
    if bad.any():
        at, axis = (int(k) for k in np.argwhere(bad)[0])
        column = values[at][:, axis]
        end = column[np.argmax(np.abs(column))]
        rest = int(bad.any(axis=1).sum()) - 1
        more = f", and {rest} more stretches are clipped" if rest else ""
        raise MissingDataError(
            f"{stretches[at].name}: {sensor} {'xyz'[axis]} is clipped at {end:.6g}{more}; set a larger range, or use a smaller input"
        )


def check_still(stretches: Sequence[SteadyStretch], mean: Floats, variance: Floats) -> None:
    """Raise MissingDataError if the mean of a position is so uncertain that the sensor was not still."""
    span = float(np.ptp(mean, axis=0).max()) if len(mean) > 1 else float(np.linalg.norm(mean[0]))
    worst = int(np.argmax(variance.max(axis=1)))
    sigma = float(variance[worst].max()) ** 0.5
    if sigma > MOVES * span:
        raise MissingDataError(
            f"{stretches[worst].name}: it is not still: by the scatter of its quarters the mean is uncertain by {sigma:.3g}; "
            f"the means of all positions span {span:.3g}"
        )


def temperature_of(stretches: Sequence[SteadyStretch]) -> tuple[float | None, list[Note]]:
    """Return the mean temperature, °C, and a note if it changes; None if it is not known."""
    known = [s.celsius for s in stretches if s.celsius is not None]
    if not known:
        return None, []
    low, high = min(known), max(known)
    text = f"the temperature went from {low:.1f} to {high:.1f} °C: bias and scale factor may have changed with it"
    return float(np.mean(known)), [Note("warmed", text)] if high - low > WARMED else []


def _same_rate(logs: Sequence[Log], triads: Sequence[Triad], sensor: str) -> None:
    rates = [sampling(t.time).rate or 0.0 for t in triads]
    if max(rates) > (1 + SAME_RATE) * min(rates):
        low, high = int(np.argmin(rates)), int(np.argmax(rates))
        raise UsageError(
            f"{sensor} rates differ: {rates[low]:.4g} Hz in {logs[low].provenance.path}, {rates[high]:.4g} Hz in "
            f"{logs[high].provenance.path}; all logs of a calibration must have the same sampling rate"
        )


def _still_spans(log: Log, imu: ImuStream, stillness: _Stillness, *, with_gyro: bool) -> list[tuple[float, float]]:
    """Return the times, s from the log's start, in which neither accelerometer nor gyro moves."""
    force, gyro, loosened = imu.specific_force, imu.angular_rate, stillness.loosened
    assert force is not None  # noqa: S101 - still_positions has checked
    shortest = LEAST if stillness.shortest is None else stillness.shortest
    size = np.full(3, stillness.gravity)
    spans = _spans(log, force, shortest, loosened * size, loosened * LEANS * size)
    if with_gyro and gyro is not None:
        loose = LOOSE * gyro.value.std(axis=0)
        creeps = loosened * CREEPS * np.ptp(gyro.value, axis=0)
        spans = shared(spans, _spans(log, gyro, shortest, loose, creeps))
    if stillness.shortest is None:
        longer = [b - a for a, b in spans if b - a >= LEAST]
        shortest = float(np.clip(np.median(longer) / 3, LEAST, USUAL)) if longer else LEAST
    return [(a, b) for a, b in spans if b - a >= shortest]


def _spans(
    log: Log, triad: Triad, shortest: float, span: Floats, tolerance: Floats | float = 0.0
) -> list[tuple[float, float]]:
    """Return the times, s from the log's start, in which a triad is steady, within each part between gaps."""
    clock, seconds = sampling(triad.time), log.seconds(triad.time)
    times: list[tuple[float, float]] = []
    for begin, end in pairwise([0, *clock.breaks, len(triad)]):
        for first, last in steady(triad.value[begin:end], clock.interval, shortest, span, tolerance):
            times.append((float(seconds[begin + first]), float(seconds[begin + last - 1]) + clock.interval))
    return times


def _stretch(
    log: Log,
    imu: ImuStream,
    span: tuple[float, float],
    count: int,
    *,
    with_gyro: bool,
    with_accel: bool = True,
    number: int = 0,
) -> SteadyStretch | None:
    """Return the samples of one of ``count`` stretches of a log; None if there are too few."""
    begin, end = span
    name = Path(log.provenance.path).name
    if count > 1:
        name = f"{name} {begin:.0f}-{end:.0f} s"

    def inside(triad: Triad | None) -> Floats | None:
        if triad is None:
            return None
        rows = np.searchsorted(log.seconds(triad.time), span)
        return triad.value[rows[0] : rows[1]]

    accel = inside(imu.specific_force) if with_accel else None
    gyro = inside(imu.angular_rate) if with_gyro else None
    if any(part is not None and len(part) < FEWEST for part in (accel, gyro)):
        return None
    return SteadyStretch(name, end - begin, accel, gyro, _celsius(log, imu, begin, end), number, span)


def _celsius(log: Log, imu: ImuStream, begin: float, end: float) -> float | None:
    """Return the mean temperature between two times, °C; None if the IMU has no thermometer."""
    if imu.temperature is None:
        return None
    at = log.seconds(imu.temperature.time)
    near = imu.temperature.value[(at >= begin) & (at <= end)]
    return float(near.mean()) if near.size else float(np.interp((begin + end) / 2, at, imu.temperature.value))

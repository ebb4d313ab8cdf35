"""Faults of inertial channels: stuck, saturated, coarse, struck, or of a gravity that cannot be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.health.fault import Fault, runs
from imuwb.identification import find_lines, stillness
from imuwb.sampling import sampling
from imuwb.units import STANDARD_GRAVITY, coefficient_units

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from imuwb.identification import Stillness
    from imuwb.log import Floats, ImuStream, Log, Nanoseconds

STUCK = 2.0  #: s; equal samples for longer, and for much longer than usual, are a stuck channel
LONGER = 20.0  #: times the usual run of equal samples
SATURATED = 3  #: equal samples in a row at the end of a channel's range
FINE = 1000  #: values in a channel, from which on it is not coarse
FAR = 8.0  #: standard deviations that such an end lies out
STRUCK = 40.0  #: times the usual change, of a lone sample off both neighbours
AROUND = 12  #: samples on each side of a lone one
MOST = 10_000  #: samples that are looked at as lone ones
FEW = 0.002  #: share of lone samples, above which they are motion
COARSE = 1000  #: samples for each value there is, from which on a channel is said to be coarse
GRAVITY = 0.02  #: of it, by which a still accelerometer may be off
BIAS = 0.05  #: rad/s of a still gyro
CONSTANT = 600.0  #: s, over which a temperature must change at all
MOVES = 0.2  #: share of a record, from which on its periods are those of a motion
STILL_ENOUGH = 5.0  #: s
LOOKED_AT = 200_000  #: samples, for what need not be looked for in all


@dataclass(frozen=True, slots=True)
class Segment:
    """A span in which the IMU is still, or moves."""

    start: float  #: s from the log's start
    end: float
    moving: bool


def segments(log: Log, imu: ImuStream) -> tuple[Segment, ...]:
    """Return when the IMU is still and when it moves."""
    found = _stillness(log, imu)
    if found is None:
        return ()
    axes = imu.axes()
    start = min(float(log.seconds(time[:1])[0]) for time, _ in axes.values())
    end = max(float(log.seconds(time[-1:])[0]) for time, _ in axes.values())
    edges = [start]
    parts: list[Segment] = []
    for span in found.disturbances:
        if span.start > edges[-1]:
            parts.append(Segment(edges[-1], span.start, moving=False))
        parts.append(Segment(span.start, span.end, moving=True))
        edges.append(span.end)
    if end > edges[-1]:
        parts.append(Segment(edges[-1], end, moving=False))
    return tuple(parts)


def _stillness(log: Log, imu: ImuStream) -> Stillness | None:
    axes = {name: (log.seconds(time), values) for name, (time, values) in imu.axes().items() if np.ptp(values) > 0}
    return stillness(axes) if axes else None


def inertial_faults(log: Log, imu: ImuStream, parts: tuple[Segment, ...], *, lines: bool) -> Iterator[Fault]:
    """Yield what is wrong with the samples of an IMU, axis by axis; lines of one that hardly moves."""
    whole, moving = (sum(s.end - s.start for s in parts if s.moving >= least) for least in (False, True))
    lines = lines and moving < MOVES * whole
    for name, (stamp, values) in imu.axes().items():
        where = f"{imu.name} {name}"
        time = log.seconds(stamp)
        if np.ptp(values) == 0:
            word = "all zero: not connected" if values[0] == 0 else f"stuck at {_shown(name, float(values[0]))}"
            yield Fault(where, word, "fault", values.size, consequence="there is nothing to analyse")
            continue
        breaks = np.array(sampling(stamp).breaks, np.int64)
        yield from _stuck(where, time, values, breaks)
        yield from _saturated(where, name, time, values)
        yield from _struck(where, name, time, values, breaks)
        yield from _coarse(where, name, values)
        if lines and not breaks.size:
            yield from _lines(where, name, stamp, values)
    if imu.temperature is not None:
        warmth = imu.temperature
        span = float(log.seconds(warmth.time[-1:])[0] - log.seconds(warmth.time[:1])[0])
        if np.ptp(warmth.value) == 0 and span > CONSTANT:
            what = f"temperature stays at {warmth.value[0]:g} °C for {span / 60:.0f} min"
            yield Fault(imu.name, what, "note", consequence="likely no sensor's; nothing can be said of temperature")
    yield from _plausible(log, imu, parts)


def _stuck(where: str, time: Floats, values: Floats, breaks: NDArray[np.int64]) -> Iterator[Fault]:
    alike = np.diff(values) == 0
    alike[breaks - 1] = False  # nobody knows what it was in a gap
    first, length = runs(alike)
    if not first.size:
        return
    spans = time[first + length] - time[first]
    # What is usual, of all runs: samples that did change are runs of none.
    usual = float(np.quantile(np.concatenate([spans, np.zeros(np.count_nonzero(~alike))]), 0.99))
    long = spans > max(STUCK, LONGER * usual)
    if long.any():
        at = int(np.argmax(spans))
        yield Fault(where, "the same value for seconds: stuck", "fault", int(long.sum()), float(time[first[at]]), float(spans[at]),
                    "leave these spans out")  # fmt: skip


def _saturated(where: str, name: str, time: Floats, values: Floats) -> Iterator[Fault]:
    middle, spread = float(np.median(values)), float(np.std(values))
    fine = np.unique(values[:LOOKED_AT]).size > FINE  # then no two samples are alike by chance
    for end in (float(values.max()), float(values.min())):
        if not fine and abs(end - middle) < FAR * spread / 2:
            continue
        first, length = runs(values == end)
        held = length >= SATURATED
        if held.any():
            at = first[held][0]
            yield Fault(where, f"saturated at {_shown(name, end)}", "fault", int(length[held].sum()), float(time[at]),
                        consequence="what was beyond is lost; attitude and velocity behind it are off")  # fmt: skip


def _struck(where: str, name: str, time: Floats, values: Floats, breaks: NDArray[np.int64]) -> Iterator[Fault]:
    if values.size < 100:  # noqa: PLR2004 - too few to know what is usual
        return
    # A step is off one neighbour alone: the smaller difference counts, and none where the two have different signs.
    before, behind = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off = np.where(before * behind > 0, np.sign(before) * np.minimum(np.abs(before), np.abs(behind)), 0.0)
    off[np.concatenate([breaks - 2, breaks - 1]).clip(0, off.size - 1)] = 0.0  # beside a gap there are no neighbours
    some = np.abs(before[:: max(before.size // LOOKED_AT, 1)])
    usual = float(np.median(some)) * 1.4826 / 2**0.5
    usual = max(usual, float(np.ptp(values[:LOOKED_AT])) * 1e-6)
    far = np.flatnonzero(np.abs(off) > STRUCK * usual) + 1
    # Of one struck sample both neighbours are off as well: it is the largest of the three.
    lone = [k for k in far[:MOST] if _is_lone(np.abs(off), np.abs(before), int(k) - 1)]
    if lone and len(lone) < max(FEW * values.size, 3):
        largest = max(lone, key=lambda k: abs(off[k - 1]))
        what = f"lone samples off by up to {_shown(name, abs(float(off[largest - 1])))}"
        yield Fault(
            where, what, "warning", len(lone), float(time[lone[0]]), consequence="each shows in every averaging time"
        )


def _is_lone(off: Floats, changes: Floats, k: int) -> bool:
    """Return whether a sample stands out of those around it too, and more than its neighbours: motion shakes many."""
    # Where a motion begins, one side of it is quiet.
    around = max(
        np.median(changes[max(k - AROUND, 0) : k]) if k else 0.0,
        np.median(changes[k + 2 : k + 2 + AROUND]) if k + 2 < changes.size else 0.0,
    )
    return bool(off[k] >= off[max(k - 1, 0) : k + 2].max() and off[k] > STRUCK / 2 * around)


def _coarse(where: str, name: str, values: Floats) -> Iterator[Fault]:
    steps = np.unique(values[:LOOKED_AT])
    if steps.size * COARSE > min(values.size, LOOKED_AT) * 20 and steps.size > 1000:  # noqa: PLR2004 - fine enough
        return
    gaps = np.diff(steps)
    gaps = gaps[gaps > 1e-9 * max(abs(float(steps[0])), abs(float(steps[-1])), 1e-12)]
    if not gaps.size:
        return
    lsb = float(gaps.min())
    even = np.abs(gaps / lsb - np.rint(gaps / lsb)) < 0.1  # noqa: PLR2004 - of a step
    if even.mean() < 0.9:  # noqa: PLR2004 - else it is no grid
        return
    scatter = float(np.std(np.diff(values[:LOOKED_AT]))) / 2**0.5
    limited = lsb > scatter
    follows = f"from sample to sample it changes by {_shown(name, scatter)}"
    yield Fault(
        where,
        f"smallest step (LSB) {_shown(name, lsb)}",
        "warning" if limited else "note",
        consequence=follows + (": quantization-limited" if limited else ""),
    )


def _lines(where: str, name: str, stamp: Nanoseconds, values: Floats) -> Iterator[Fault]:
    clock = sampling(stamp)
    for line in find_lines(np.ascontiguousarray(values), clock.interval)[:3]:
        what = f"line at {line.frequency:.4g} Hz, amplitude {_shown(name, line.amplitude)}"
        yield Fault(where, what, "note", consequence="a vibration or a disturbance, no noise")


def _plausible(log: Log, imu: ImuStream, parts: tuple[Segment, ...]) -> Iterator[Fault]:
    """Yield a gravity or a bias that a still IMU cannot have."""
    longest = max((s for s in parts if not s.moving), key=lambda s: s.end - s.start, default=None)
    if longest is None or longest.end - longest.start < STILL_ENOUGH:
        return
    for sensor, triad in (("gyro", imu.angular_rate), ("accel", imu.specific_force)):
        if triad is None:
            continue
        time = log.seconds(triad.time)
        inside = (time >= longest.start) & (time <= longest.end)
        if not inside.any():
            continue
        mean = triad.value[inside].mean(axis=0)
        size = float(np.linalg.norm(mean))
        if sensor == "accel" and abs(size / STANDARD_GRAVITY - 1) > GRAVITY:
            yield Fault(f"{imu.name} accelerometers", f"gravity is {size:.4g} m/s² while still", "fault", 1, longest.start,
                        longest.end - longest.start, "scale, units or bias are off")  # fmt: skip
        if sensor == "gyro" and float(np.abs(mean).max()) > BIAS:
            worst = float(mean[int(np.argmax(np.abs(mean)))])
            yield Fault(f"{imu.name} gyros", f"turns by {np.degrees(worst):.3g} deg/s while still", "warning", 1, longest.start,
                        longest.end - longest.start, "a bias to be taken off, or it does turn evenly")  # fmt: skip


def _shown(axis: str, value: float) -> str:
    unit = coefficient_units(axis, "rate")[1]
    return f"{unit.from_si(value):.4g} {unit.name}"

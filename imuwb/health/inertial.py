"""Faults of inertial channels: stuck, saturated, coarse, struck, or of a gravity that cannot be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.health.channel import LOOKED_AT, shown
from imuwb.health.fault import Fault, runs
from imuwb.health.spikes import spikes
from imuwb.identification import find_lines
from imuwb.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from imuwb.health.channel import Channel
    from imuwb.health.motion import Segment
    from imuwb.health.spikes import Lone
    from imuwb.log import ImuStream, Log

STUCK = 2.0  #: s; equal samples for longer, and for much longer than usual, are a stuck channel
LONGER = 20.0  #: times the usual run of equal samples
SATURATED = 3  #: equal samples in a row at the end of a channel's range
SEVERAL = 3  #: such runs; a motion's top is not that often the same to a step
LEAP = 4.0  #: steps (LSB) into such a run or out of it, which a smooth motion's top has not
FINE = 1000  #: values in a channel, from which on it is not coarse
FAR = 8.0  #: standard deviations that such an end lies out
COARSE = 1000  #: samples for each value there is, from which on a channel is said to be coarse
GRAVITY = 0.02  #: of it, by which a still accelerometer may be off
WRONG = 0.1  #: of it, from which on no bias explains it
BIAS = 0.05  #: rad/s of a still gyro
CONSTANT = 600.0  #: s, over which a temperature must change at all
MOVES = 0.2  #: share of a record, from which on its periods are those of a motion
STILL_ENOUGH = 5.0  #: s


def inertial_faults(
    log: Log,
    imu: ImuStream,
    channels: Mapping[str, Channel],
    lone: Mapping[str, Lone],
    parts: Sequence[Segment],
    *,
    lines: bool,
) -> Iterator[Fault]:
    """Yield what is wrong with the samples of an IMU, axis by axis.

    Args:
        log: whose start seconds count from.
        imu: what is looked at.
        channels: its axes that change.
        lone: their lone samples.
        parts: when it is still and when it moves; none where that cannot be told.
        lines: look for periodic lines too, where it hardly moves.
    """
    whole, moving = (sum(s.end - s.start for s in parts if s.moving >= least) for least in (False, True))
    lines = lines and moving < MOVES * whole
    for axis, (_, values) in imu.axes().items():
        channel = channels.get(axis)
        if channel is None:
            word = "all zero: not connected" if values[0] == 0 else f"stuck at {shown(axis, float(values[0]))}"
            yield Fault(f"{imu.name} {axis}", word, "fault", values.size, consequence="there is nothing to analyse")
            continue
        yield from _stuck(channel)
        yield from _saturated(channel)
        yield from spikes(channel, lone[axis], parts)
        yield from _coarse(channel)
        if lines and not channel.breaks.size:
            yield from _lines(channel)
    if imu.temperature is not None:
        warmth = imu.temperature
        span = float(log.seconds(warmth.time[-1:])[0] - log.seconds(warmth.time[:1])[0])
        if np.ptp(warmth.value) == 0 and span > CONSTANT:
            what = f"temperature stays at {warmth.value[0]:g} °C for {span / 60:.0f} min"
            yield Fault(imu.name, what, "note", consequence="likely no sensor's; nothing can be said of temperature")
    yield from _plausible(log, imu, parts)


def _stuck(channel: Channel) -> Iterator[Fault]:
    time = channel.time
    alike = np.diff(channel.values) == 0
    alike[channel.breaks - 1] = False  # nobody knows what it was in a gap
    first, length = runs(alike)
    if not first.size:
        return
    spans = time[first + length] - time[first]
    # What is usual, of all runs: samples that did change are runs of none.
    usual = float(np.quantile(np.concatenate([spans, np.zeros(np.count_nonzero(~alike))]), 0.99))
    long = spans > max(STUCK, LONGER * usual)
    if long.any():
        at = int(np.argmax(spans))
        yield Fault(channel.where, "the same value for seconds: stuck", "fault", int(long.sum()), float(time[first[at]]), float(spans[at]),
                    "leave these spans out")  # fmt: skip


def _saturated(channel: Channel) -> Iterator[Fault]:
    values = channel.values
    middle, spread = float(np.median(values)), float(np.std(values))
    fine = channel.levels.size > FINE  # then no two samples are alike by chance
    for end in (float(values.max()), float(values.min())):
        if not fine and abs(end - middle) < FAR * spread / 2:
            continue
        first, length = runs(values == end)
        first, length = first[length >= SATURATED], length[length >= SATURATED]
        if not first.size:
            continue
        # The top of a smooth motion is as flat as the sensor's step is coarse, but nothing leaps up to it.
        edges = np.concatenate([first - 1, first + length])
        leap = float(np.abs(values[edges[(edges >= 0) & (edges < values.size)]] - end).max(initial=0.0))
        if first.size >= SEVERAL or leap > LEAP * channel.step:
            yield Fault(channel.where, f"saturated at {shown(channel.axis, end)}", "fault", int(length.sum()), float(channel.time[first[0]]),
                        consequence="what was beyond is lost; attitude and velocity behind it are off")  # fmt: skip


def _coarse(channel: Channel) -> Iterator[Fault]:
    size = min(channel.values.size, LOOKED_AT)
    if channel.levels.size * COARSE > size * 20 and channel.levels.size > 1000:  # noqa: PLR2004 - fine enough
        return
    gaps, lsb = channel.gaps, channel.step
    if not gaps.size:
        return
    even = np.abs(gaps / lsb - np.rint(gaps / lsb)) < 0.1  # noqa: PLR2004 - of a step
    if even.mean() < 0.9:  # noqa: PLR2004 - else it is no grid
        return
    scatter = float(np.std(np.diff(channel.values[:LOOKED_AT]))) / 2**0.5
    limited = lsb > scatter
    follows = f"from sample to sample it changes by {shown(channel.axis, scatter)}"
    yield Fault(
        channel.where,
        f"smallest step (LSB) {shown(channel.axis, lsb)}",
        "warning" if limited else "note",
        consequence=follows + (": quantization-limited" if limited else ""),
    )


def _lines(channel: Channel) -> Iterator[Fault]:
    for line in find_lines(np.ascontiguousarray(channel.values), channel.clock.interval)[:3]:
        what = f"line at {line.frequency:.4g} Hz, amplitude {shown(channel.axis, line.amplitude)}"
        yield Fault(channel.where, what, "note", consequence="a vibration or a disturbance, no noise")


def _plausible(log: Log, imu: ImuStream, parts: Sequence[Segment]) -> Iterator[Fault]:
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
        off = size / STANDARD_GRAVITY - 1
        if sensor == "accel" and abs(off) > GRAVITY:
            severity, follows = (
                ("fault", "units or scale are off, or it is no accelerometer")
                if abs(off) > WRONG
                else ("warning", f"off by {1000 * off:+.0f} mg: a bias or a scale factor to be calibrated")
            )
            yield Fault(f"{imu.name} accelerometers", f"gravity is {size:.4g} m/s² while still", severity, 1, longest.start,
                        longest.end - longest.start, follows)  # fmt: skip
        if sensor == "gyro" and float(np.abs(mean).max()) > BIAS:
            worst = float(mean[int(np.argmax(np.abs(mean)))])
            yield Fault(f"{imu.name} gyros", f"turns by {np.degrees(worst):.3g} deg/s while still", "warning", 1, longest.start,
                        longest.end - longest.start, "a bias to be taken off, or it does turn evenly")  # fmt: skip

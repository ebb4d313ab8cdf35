"""Faults of the axes of an IMU: constant, stuck, saturated, struck or coarse samples, and periodic lines."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from imuwb.health.channel import LOOKED_AT, Channel, value_text
from imuwb.health.fault import Fault
from imuwb.health.lone import Lone
from imuwb.health.motion import Segment
from imuwb.identification import find_lines
from imuwb.log import ImuStream
from imuwb.sampling import runs

STUCK = 2.0  #: s; a channel with equal samples for longer than this, and for much longer than usual, is stuck
LONGER = 20.0  #: times the usual run of equal samples; a longer run is "much longer than usual"
USUAL = 0.99  #: the usual run is this quantile of all runs
SATURATED = 3  #: least number of equal samples in a row, at the end of a channel's range, that show saturation
SEVERAL = 3  #: number of such runs that show saturation; the peaks of a motion are not equal so often
LEAP = 4.0  #: steps (LSB); a larger change before or after such a run shows saturation, for the peak of a smooth motion has none
FINE = 1000  #: number of different values; a channel with more is not coarse
FAR = 4.0  #: standard deviations; the end of the range of a coarse channel is further than this from the median
COARSE = 50  #: samples for each different value; with at least as many, the step of a channel is reported
#: steps: a difference that is nearer to a whole number of steps is on the grid; and the least share of differences on the grid
GRID, MOSTLY = 0.1, 0.9
MOVES = 0.2  #: share of a record; if the IMU moves for longer, the lines may be those of the motion
MOST_LINES = 3  #: largest number of lines that are reported for an axis


def inertial_faults(
    imu: ImuStream,
    channels: Mapping[str, Channel],
    lone: Mapping[str, Lone],
    segments: Sequence[Segment],
    *,
    lines: bool,
) -> Iterator[Fault]:
    """Yield what is wrong with the samples of an IMU, axis by axis.

    Args:
        imu: the IMU.
        channels: its axes whose samples are not all equal.
        lone: the lone samples of each channel.
        segments: when the IMU is still and when it moves; empty where the record does not show it.
        lines: look for periodic lines too, where the IMU hardly moves.
    """
    whole, moving = (sum(s.length for s in segments if s.moving >= least) for least in (False, True))
    lines = lines and moving < MOVES * whole
    for axis, (_, values) in imu.axes().items():
        channel = channels.get(axis)
        if channel is None:
            value = float(values[0])
            what = "all zero: not connected" if value == 0 else f"stuck at {value_text(axis, value)}"
            yield Fault(f"{imu.name} {axis}", "constant", what, "fault", values.size, consequence="there is nothing to analyse")  # fmt: skip
            continue
        yield from _stuck(channel)
        yield from _saturated(channel)
        yield from _struck(channel, lone[axis], segments)
        yield from _coarse(channel)
        if lines and not channel.breaks.size:
            yield from _lines(channel)


def _stuck(channel: Channel) -> Iterator[Fault]:
    time = channel.time
    alike = np.diff(channel.values) == 0
    alike[channel.breaks - 1] = False  # the values within a gap are unknown
    first, length = runs(alike)
    if not first.size:
        return
    spans = time[first + length] - time[first]
    # Samples that did change count as runs of length 0.
    usual = float(np.quantile(np.concatenate([spans, np.zeros(np.count_nonzero(~alike))]), USUAL))
    long = spans > max(STUCK, LONGER * usual)
    if long.any():
        at = int(np.argmax(spans))
        yield Fault(channel.where, "stuck", "stuck: the value does not change for seconds", "fault", int(long.sum()),
                    float(time[first[at]]), float(spans[at]), "leave these spans out")  # fmt: skip


def _saturated(channel: Channel) -> Iterator[Fault]:
    values = channel.values
    middle, spread = float(np.median(values)), float(np.std(values))
    fine = channel.levels.size > FINE  # with so many values, equal samples do not follow each other by chance
    for end in (float(values.max()), float(values.min())):
        if not fine and abs(end - middle) < FAR * spread:
            continue
        first, length = runs(values == end)
        first, length = first[length >= SATURATED], length[length >= SATURATED]
        if not first.size:
            continue
        # The rounded peak of a smooth motion is flat too, but no large change leads to it.
        edges = np.concatenate([first - 1, first + length])
        leap = float(np.abs(values[edges[(edges >= 0) & (edges < values.size)]] - end).max(initial=0.0))
        if first.size >= SEVERAL or leap > LEAP * channel.step:
            yield Fault(channel.where, "saturated", f"saturated at {value_text(channel.axis, end)}", "fault", int(length.sum()),
                        float(channel.time[first[0]]), consequence="larger values are lost; attitude and velocity are wrong from there on")  # fmt: skip


def _struck(channel: Channel, lone: Lone, segments: Sequence[Segment]) -> Iterator[Fault]:
    """Yield the lone samples of a channel while the IMU is quiet: during a motion they may be part of the motion."""
    at = channel.time[lone.rows]
    still = np.zeros(at.size, dtype=bool)
    for segment in segments:
        if not segment.moving or segment.even:
            still |= (at >= segment.start) & (at <= segment.end)
    if still.any():
        what = f"lone samples that differ from their neighbours by up to {value_text(channel.axis, float(lone.off[still].max()))}"
        yield Fault(channel.where, "lone samples", what, "warning", int(still.sum()), float(at[still][0]),
                    consequence="each one disturbs the results at every averaging time")  # fmt: skip


def _coarse(channel: Channel) -> Iterator[Fault]:
    size, gaps, lsb = min(channel.values.size, LOOKED_AT), channel.gaps, channel.step
    if not gaps.size or (channel.levels.size > FINE and channel.levels.size * COARSE > size):
        return
    if np.mean(np.abs(gaps / lsb - np.rint(gaps / lsb)) < GRID) < MOSTLY:  # no grid of steps
        return
    scatter = float(np.std(np.diff(channel.values[:LOOKED_AT]))) / 2**0.5
    limited = lsb > scatter
    consequence = f"from sample to sample the values change by {value_text(channel.axis, scatter)}"
    yield Fault(channel.where, "step", f"smallest step (LSB) {value_text(channel.axis, lsb)}", "warning" if limited else "note",
                consequence=consequence + (": quantization-limited" if limited else ""))  # fmt: skip


def _lines(channel: Channel) -> Iterator[Fault]:
    for line in find_lines(np.ascontiguousarray(channel.values), channel.clock.interval)[:MOST_LINES]:
        what = f"line at {line.frequency:.4g} Hz, amplitude {value_text(channel.axis, line.amplitude.value)}"
        what += "" if line.in_both_halves else ", not in both halves of the record"
        yield Fault(channel.where, "line", what, "note", consequence="a vibration or a disturbance, not noise")

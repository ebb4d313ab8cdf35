"""Faults of the axes of an IMU: constant, stuck, saturated, struck or coarse samples, and periodic lines."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from imuwb.arrays import Booleans, Floats, standard_deviation
from imuwb.health.channel import LOOKED_AT, Channel, value_text
from imuwb.health.fault import Fault
from imuwb.health.lone import Lone
from imuwb.health.motion import Segment
from imuwb.health.tails import FAR as FAR_OFF
from imuwb.health.tails import tails
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
SPOILT = 0.5  #: share by which tails may raise the mean square; a coefficient is then wrong by a quarter
MOVES = 0.2  #: share of a record; if the IMU moves for longer, lines and tails may be those of the motion
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
    whole, moving, shaken = (sum(s.length for s in part) for part in _parts(segments))
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
        quiet = _quiet(channel, segments)
        yield from _struck(channel, lone[axis], quiet)
        if shaken < MOVES * whole:  # the seconds beside a motion are not quite quiet
            yield from _tails(channel, lone[axis], quiet)
        yield from _coarse(channel)
        if lines and not channel.breaks.size:
            yield from _lines(channel)


def _stuck(channel: Channel) -> Iterator[Fault]:
    time = channel.time
    alike = channel.values[1:] == channel.values[:-1]
    alike[channel.breaks - 1] = False  # the values within a gap are unknown
    first, length = runs(alike)
    if not first.size:
        return
    spans = time[first + length] - time[first]
    usual = _usual_run(spans, int(alike.size - np.count_nonzero(alike)))
    long = spans > max(STUCK, LONGER * usual)
    if long.any():
        at = int(np.argmax(spans))
        yield Fault(channel.where, "stuck", "stuck: the value does not change for seconds", "fault", int(long.sum()),
                    float(time[first[at]]), float(spans[at]), "leave these spans out")  # fmt: skip


def _usual_run(spans: Floats, changes: int) -> float:
    """Return the usual length of a run of equal samples, s; samples that did change count as runs of length 0."""
    at = USUAL * (spans.size + changes - 1)
    spans = np.sort(spans)
    below, above = (float(spans[i - changes]) if i >= changes else 0.0 for i in (int(at), int(np.ceil(at))))
    return below + (above - below) * (at - int(at))


def _saturated(channel: Channel) -> Iterator[Fault]:
    values = channel.values
    middle, spread = float(np.median(values)), standard_deviation(values)
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


def _parts(segments: Sequence[Segment]) -> tuple[list[Segment], list[Segment], list[Segment]]:
    """Return all segments, those that move, and those whose motion the samples show."""
    moving = [segment for segment in segments if segment.moving]
    return list(segments), moving, [segment for segment in moving if not segment.even]


def _quiet(channel: Channel, segments: Sequence[Segment]) -> Booleans:
    """Return which samples are of a quiet time: during a motion, samples that are far off may be part of the motion."""
    quiet = np.zeros(channel.time.size, dtype=bool)
    for segment in segments:
        if not segment.moving or segment.even:
            quiet[slice(*np.searchsorted(channel.time, (segment.start, segment.end + 1e-9)))] = True
    return quiet


def _struck(channel: Channel, lone: Lone, quiet: Booleans) -> Iterator[Fault]:
    """Yield the lone samples of a channel while the IMU is quiet."""
    own = quiet[lone.rows]
    if own.any():
        what = f"lone samples that differ from their neighbours by up to {value_text(channel.axis, float(lone.off[own].max()))}"
        yield Fault(channel.where, "lone samples", what, "warning", int(own.sum()), float(channel.time[lone.rows[own][0]]),
                    consequence="each one disturbs the results at every averaging time")  # fmt: skip


def _tails(channel: Channel, lone: Lone, quiet: Booleans) -> Iterator[Fault]:
    """Yield the samples of a quiet time that are further off than noise is."""
    found = tails(channel, lone.without(channel.values), quiet)
    if found is not None:
        what = f"{100 * found.share:.2g} % of the samples are more than {FAR_OFF:g} sigmas off ({value_text(channel.axis, found.sigma)})"
        consequence = f"they raise the mean square by {100 * found.excess:.0f} %, and the noise coefficients with it"
        yield Fault(channel.where, "tails", what, "warning" if found.excess > SPOILT else "note", found.count, found.first,
                    consequence=consequence)  # fmt: skip


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
    from imuwb.identification import find_lines  # noqa: PLC0415 - it imports scipy.ndimage and scipy.fft, and lines are seldom looked for

    for line in find_lines(channel.values, channel.clock.interval)[:MOST_LINES]:
        what = f"line at {line.frequency:.4g} Hz, amplitude {value_text(channel.axis, line.amplitude.value)}"
        what += "" if line.in_both_halves else ", not in both halves of the record"
        yield Fault(channel.where, "line", what, "note", consequence="a vibration or a disturbance, not noise")

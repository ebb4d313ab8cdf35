"""Faults that the turns of an IMU show: gyros in another unit, and a receiver whose clock is off.

A factor near 180/π, or its inverse, between the turns by the gyros and those by others shows rates in deg/s that were taken as rad/s,
or the reverse. Courses that turn at another time than the gyros show a clock that is off, as by leap seconds.
"""

from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy import EARTH_RATE
from imuwb.health.fault import Fault
from imuwb.health.motion import Segment
from imuwb.health.turns import (
    BLOCK,
    DEGREES,
    FEWEST,
    WINDOWS,
    Blocks,
    Courses,
    course_turns,
    gravity_turns,
    orientation_turns,
)
from imuwb.log import GnssStream, ImuStream, Log, Triad
from imuwb.sampling import sampling
from imuwb.units import SECOND

SLOWEST = 15.0  #: Hz; at a lower rate, turns are not measured as they happen
STILL = 120.0  #: s; over a shorter rest, noise hides the Earth's rate
NEAR = 0.03  #: relative difference between a measured rate and the Earth's
LAGS, STEP = 30.0, 0.25  #: s; offsets of a clock that are tried, and the step between them
OFF = 0.75  #: s; a smaller offset may be a delay of the receiver
ALIKE, TOGETHER = 0.98, 0.95  #: correlation of the turns that shows a right clock; least one with the clock shifted
BETTER = 0.25  #: share of what the correlation lacks as it is, that it may lack with the clock shifted


def turning_faults(log: Log, imu: ImuStream, segments: tuple[Segment, ...]) -> Iterator[Fault]:
    """Yield a fault if the gyros of an IMU are in another unit than rad/s, and for each receiver whose clock is off.

    Args:
        log: the log, with its receivers and orientations.
        imu: the IMU; without three gyros and three accelerometers nothing is found.
        segments: when it is still and when it moves.
    """
    rate, force = imu.angular_rate, imu.specific_force
    if rate is None or force is None or len(rate.axes) + len(force.axes) < 6:  # noqa: PLR2004 - two triads
        return
    count = float(rate.time[-1] - rate.time[0]) / SECOND / BLOCK
    if not 1 / sampling(rate.time).interval >= SLOWEST or count > len(rate):  # too slow, or the clock jumps
        return
    blocks = Blocks.of(log, rate, force)
    yield from (fault for gnss in log.gnss for fault in _offset(log, gnss, blocks))
    measured = [gravity_turns(blocks, window) for window in WINDOWS]
    measured += [course_turns(Courses.of(log, gnss), blocks, f"the course of {gnss.name}") for gnss in log.gnss]
    measured += [
        course_turns(Courses.of_headings(log, track), blocks, f"the heading of {track.name}")
        for track in log.references
    ]
    measured += [orientation_turns(log, o, blocks) for o in log.orientations if o.name == imu.name]
    factors = [(turns.source, turns.factor) for turns in measured if turns is not None]
    factors.append(("the Earth's rotation", _earth(log, rate, force, segments)))
    if any(factor == 1 for _, factor in factors):  # one that agrees outweighs the others
        return
    for source, factor in factors:
        if not factor:
            continue
        stated, likely = ("rad/s", "deg/s") if factor < 1 else ("deg/s", "rad/s")
        what = f"{source} shows turns that are {factor:.3g} times those of the gyros"
        consequence = f"the gyros are likely in {likely}, taken as {stated}: --units gyro={likely}"
        yield Fault(f"{imu.name} gyros", "rate unit", what, "fault", consequence=consequence)
        return


def _offset(log: Log, gnss: GnssStream, blocks: Blocks) -> Iterator[Fault]:
    """Yield a fault if a receiver's courses turn at another time than the gyros; only where both records overlap."""
    courses = Courses.of(log, gnss)
    if courses is None or not blocks.force.size:
        return
    as_is = _correlation(courses.turned(blocks), courses.changed)
    if as_is > ALIKE:
        return
    lags = np.arange(-LAGS, LAGS + STEP / 2, STEP)
    alike = [_correlation(courses.turned(blocks, float(lag)), courses.changed) for lag in lags]
    best = int(np.argmax(alike))
    if alike[best] < TOGETHER or 1 - alike[best] > BETTER * (1 - as_is) or abs(lags[best]) < OFF:
        return
    what = f"its courses turn {abs(lags[best]):.1f} s {'before' if lags[best] > 0 else 'after'} the gyros"
    consequence = f"its clock is off, as by leap seconds or a delay: --gnss-shift {lags[best]:.1f}"
    yield Fault(gnss.name, "clock offset", what, "fault", consequence=consequence)


def _correlation(turned: Floats, changed: Floats) -> float:
    """Return the correlation of two measurements of the same turns; 0 where fewer than half of them overlap."""
    known = np.isfinite(turned)
    if np.count_nonzero(known) < max(FEWEST, changed.size // 2):
        return 0.0
    x, y = turned[known], changed[known]
    spread = float(x.std() * y.std())
    return float(np.mean((x - x.mean()) * (y - y.mean()))) / spread if spread > 0 else 0.0


def _earth(log: Log, rate: Triad, force: Triad, segments: tuple[Segment, ...]) -> float:
    """Return the factor that makes the mean rate of a rest the Earth's, at the latitude of a receiver; 0: none does."""
    longest = max((s for s in segments if not s.moving), key=lambda s: s.length, default=None)
    if longest is None or longest.length < STILL or not log.gnss:
        return 0.0
    latitude = float(np.median(log.gnss[0].position[:, 0]))
    mean, up = (_mean(log, triad, longest) for triad in (rate, force))
    up = up / np.linalg.norm(up)  # the specific force of a rest points up
    expected = np.array([EARTH_RATE, EARTH_RATE * np.sin(latitude)])
    measured = np.array([np.linalg.norm(mean), mean @ up])
    for factor in (1.0, 1 / DEGREES, DEGREES):
        if np.abs(measured * factor - expected).max() < NEAR * EARTH_RATE:
            return factor
    return 0.0


def _mean(log: Log, triad: Triad, segment: Segment) -> Floats:
    time = log.seconds(triad.time)
    rows = slice(*np.searchsorted(time, (segment.start, segment.end)))
    return triad.value[rows].mean(axis=0)

"""The turns of an IMU in short windows, by its gyros and by others: gravity, a receiver's course, the IMU's own orientation.

Where the IMU turns by a small vector φ, the direction of a constant specific force changes by f̂ × φ in its axes. Where the vehicle
drives, the course changes by the angle about the vertical. They differ by noise, by accelerations and by slip, so single turns
prove nothing; but over a log the turns by the gyros are proportional to the others.
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy import rotation_of_quaternion
from imuwb.log import GnssStream, Log, Orientation, Reference, Triad
from imuwb.units import SECOND, STANDARD_GRAVITY

DEGREES = 180 / np.pi
BLOCK = 0.1  #: s; samples are averaged over this time
WINDOW = 10  #: blocks of a turn that is compared with an orientation
WINDOWS = (
    10,
    4,
    40,
)  #: blocks of a turn that is compared with gravity: of a usual turn, of a fast one, and of a slow one
COURSE = 50  #: blocks of a turn that is compared with a course; offsets of the clocks matter less over a longer time
SMALL = 0.7  #: rad; larger turns in a window are not proportional to the change of a direction
FEWEST = 30  #: windows, and a fifth of all
ALIKE = 0.9  #: correlation of two measurements of one turn
LEAST, MOST = 0.7, 1.4  #: factor between two measurements of one turn in the same unit
TILTED = 0.35  #: rad; a smaller change of the specific force may be an acceleration
AT_REST = 0.05  #: share of gravity; where the specific force differs by less, its direction is that of gravity
FAST, PACE = 2.0, 0.5  #: m/s; the course of a slower receiver is noise; the same for one that states small sigmas
SURE = 10.0  #: sigmas of a velocity that shows a course
TURNED = 0.2  #: rad; turns of the course by more ...
TURNS = 5  #: ... in so many windows show the scale of the gyros


@dataclass(frozen=True, eq=False, slots=True)
class Turns:
    """The turns of windows, measured twice."""

    gyro: Floats  #: (n, k) rad
    other: Floats  #: (n, k) rad
    source: str  #: what shows the others

    def fits(self, factor: float) -> float:
        """Return the slope of the other turns over the gyros' times a factor; 0: they are not proportional, or too few."""
        gyro = self.gyro * factor
        small = np.ones(gyro.shape[0], dtype=bool)
        if gyro.shape[1] > 1:  # about one axis, turns of any size are proportional
            small = (np.linalg.norm(gyro, axis=1) < SMALL) & (np.linalg.norm(self.other, axis=1) < SMALL)
        if np.count_nonzero(small) < max(FEWEST, gyro.shape[0] // 5):
            return 0.0
        x, y = (a[small] - np.median(a[small], axis=0) for a in (gyro, self.other))
        squares = float((x**2).sum() * (y**2).sum())
        product = float((x * y).sum())
        if squares <= 0 or product < ALIKE * np.sqrt(squares):
            return 0.0
        return product / float((x**2).sum())

    @property
    def factor(self) -> float:
        """Return the factor that makes the gyros' turns equal to the others: 1, π/180, 180/π, or 0 if none does."""
        good = (k for k in (1.0, 1 / DEGREES, DEGREES) if LEAST < self.fits(k) < MOST)
        return next(good, 0.0)


@dataclass(frozen=True, eq=False, slots=True)
class Blocks:
    """The samples of an IMU in blocks of equal length."""

    start: float  #: s from the log's start
    angle: Floats  #: (b, 3) rad, turned in each block; nan: too few samples
    force: Floats  #: (b, 3) m/s², mean of each block

    @staticmethod
    def of(log: Log, rate: Triad, force: Triad) -> "Blocks":
        """Return the blocks of the time that both triads have."""
        start = max(float(log.seconds(t.time[:1])[0]) for t in (rate, force))
        end = min(float(log.seconds(t.time[-1:])[0]) for t in (rate, force))
        edges: Floats = start + BLOCK * np.arange(max(int((end - start) / BLOCK), 0) + 1, dtype=np.float64)
        return Blocks(start, _means(log, rate, edges) * BLOCK, _means(log, force, edges))

    def turned(self, first: Floats, last: Floats) -> Floats:
        """Return the angles (n, 3) that are turned between times, s from the log's start; nan outside the blocks."""
        lost = np.isnan(self.angle).any(axis=1, keepdims=True)
        columns = np.hstack([np.nan_to_num(self.angle), lost])
        whole = np.vstack([np.zeros((1, 4)), np.cumsum(columns, axis=0)])
        edges = self.start + BLOCK * np.arange(whole.shape[0])
        at = [np.column_stack([np.interp(t, edges, c, left=np.nan, right=np.nan) for c in whole.T]) for t in (first, last)]  # fmt: skip
        change: Floats = at[1] - at[0]
        change[change[:, 3] > 0] = np.nan
        return change[:, :3]


def _means(log: Log, triad: Triad, edges: Floats) -> Floats:
    """Return the means of a triad between edges, (b, 3); nan where there is no sample."""
    rows = np.searchsorted(triad.time, np.rint(edges * SECOND).astype(np.int64) + (log.zero or 0))
    count = np.diff(rows)
    if not count.size:
        return np.zeros((0, 3))
    sums = np.add.reduceat(triad.value, rows[:-1].clip(max=len(triad) - 1), axis=0)
    return np.where(count[:, None] > 0, sums / np.maximum(count, 1)[:, None], np.nan)


def gravity_turns(blocks: Blocks, window: int) -> Turns | None:
    """Return the turns across the specific force, by the gyros and by its change of direction."""
    if blocks.force.shape[0] < window + FEWEST:
        return None
    smooth = (blocks.force[1:] + blocks.force[:-1]) / 2
    size = np.linalg.norm(smooth, axis=1)
    direction = smooth / size[:, None]
    before, after = direction[:-window:2], direction[window::2]
    middle = blocks.start + BLOCK * (1 + np.arange(smooth.shape[0]))
    turned = blocks.turned(middle[:-window:2], middle[window::2])
    across = turned - before * (before * turned).sum(axis=1, keepdims=True)
    changed = np.cross(after, before)
    off = np.abs(size / STANDARD_GRAVITY - 1)
    calm = np.maximum(off[:-window:2], off[window::2]) < AT_REST
    sound = np.isfinite(across).all(axis=1) & np.isfinite(changed).all(axis=1)
    if not (sound & calm & (np.linalg.norm(changed, axis=1) > TILTED)).any():
        # Such small changes may be accelerations, which no gyro measures, so only gyros that turn far too much are found.
        large = np.linalg.norm(across, axis=1) > TILTED
        if np.count_nonzero(sound & calm & large) < FEWEST:
            return None
    return Turns(across[sound & calm], changed[sound & calm], "gravity")


@dataclass(frozen=True, eq=False, slots=True)
class Courses:
    """The changes of a receiver's course in windows without a stop."""

    first: Floats  #: (n,) s from the log's start
    last: Floats
    changed: Floats  #: (n,) rad, to the right

    @staticmethod
    def of(log: Log, gnss: GnssStream) -> "Courses | None":
        """Return the changes of a receiver's course; None if it is too slow, or hardly turns."""
        if gnss.velocity is None or len(gnss) < FEWEST:
            return None
        speed = np.linalg.norm(gnss.velocity[:, :2], axis=1)
        stated = np.full((speed.size, 2), np.nan) if gnss.velocity_sigma is None else gnss.velocity_sigma[:, :2]
        sigma = np.linalg.norm(stated, axis=1)
        fast = speed > np.where(np.isfinite(sigma), np.maximum(SURE * sigma, PACE), FAST)  # nan is not
        course = np.full(speed.size, np.nan)
        course[fast] = np.unwrap(np.arctan2(gnss.velocity[fast, 1], gnss.velocity[fast, 0]))
        return Courses._of_angles(log.seconds(gnss.time), course)

    @staticmethod
    def of_headings(log: Log, reference: Reference) -> "Courses | None":
        """Return the changes of the heading of a trajectory; None if it has no attitude, or hardly turns."""
        if reference.attitude is None or len(reference) < FEWEST:
            return None
        heading = reference.attitude[:, 2]
        known = np.isfinite(heading)
        turned = np.full(heading.size, np.nan)
        turned[known] = np.unwrap(heading[known])
        return Courses._of_angles(log.seconds(reference.time), turned)

    @staticmethod
    def _of_angles(time: Floats, angle: Floats) -> "Courses | None":
        """Return the changes of an angle (n,) rad without jumps of a turn; nan: not known."""
        step = max(1, round(COURSE * BLOCK / float(np.median(np.diff(time)))))
        first, last = time[:-step], time[step:]
        stops = np.concatenate([[0], np.cumsum(np.isnan(angle))])
        sound = stops[step + 1 :] == stops[: -step - 1]
        sound &= last - first < LEAST * 2 * COURSE * BLOCK
        changed = (angle[step:] - angle[:-step])[sound]
        if np.count_nonzero(np.abs(changed) > TURNED) < TURNS:
            return None
        return Courses(first[sound], last[sound], changed)

    def turned(self, blocks: Blocks, lag: float = 0.0) -> Floats:
        """Return the gyros' turns about the vertical, (n,) rad, in the windows ``lag`` s later; nan outside the IMU's record."""
        down = -np.nanmedian(blocks.force, axis=0)  # the specific force of a level drive points up
        return blocks.turned(self.first + lag, self.last + lag) @ (down / np.linalg.norm(down))


def course_turns(courses: Courses | None, blocks: Blocks, source: str) -> Turns | None:
    """Return the turns about the vertical, by the gyros and by the courses of a receiver or the headings of a trajectory."""
    if courses is None or not blocks.force.size:
        return None
    turned = courses.turned(blocks)
    known = np.isfinite(turned)
    if np.count_nonzero(np.abs(courses.changed[known]) > TURNED) < TURNS:
        return None
    return Turns(turned[known][:, None], courses.changed[known][:, None], source)


def orientation_turns(log: Log, orientation: Orientation, blocks: Blocks) -> Turns | None:
    """Return the turns by the gyros and by the orientation that the IMU states."""
    time = log.seconds(orientation.time)
    if time.size < FEWEST or not blocks.angle.size:
        return None
    step = max(1, round(WINDOW * BLOCK / float(np.median(np.diff(time)))))
    rows = np.arange(0, time.size - step, max(step // 2, 1))
    rotation = rotation_of_quaternion(orientation.quaternion)
    change = rotation[rows].transpose(0, 2, 1) @ rotation[rows + step]
    skew = np.stack([change[:, 2, 1] - change[:, 1, 2], change[:, 0, 2] - change[:, 2, 0], change[:, 1, 0] - change[:, 0, 1]], axis=1) / 2  # fmt: skip
    turned = blocks.turned(time[rows], time[rows + step])
    sound = np.isfinite(turned).all(axis=1) & np.isfinite(skew).all(axis=1)
    if np.count_nonzero(sound & (np.linalg.norm(skew, axis=1) > TURNED / 2)) < TURNS:
        return None
    return Turns(turned[sound], skew[sound], "the IMU's own orientation")

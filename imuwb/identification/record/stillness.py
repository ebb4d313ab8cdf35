"""Finds motion and shocks in a record that should be still, and its longest quiet part."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers, blocks_of
from imuwb.compiled import compiled
from imuwb.sampling import runs
from imuwb.statistics.running import closed, running_median
from imuwb.texts import counted

BLOCK = 1.0  #: s
SCATTER = 3.0  #: ratio of a block's standard deviation to the median, above which the block is disturbed
JUMP = 8.0  #: standard errors between a block's mean and the running median of the means, above which the block is disturbed
TURNS = 0.05  #: rad/s; the mean rate of a second that differs by more from the running median is a turn, in any record
LOOKED_AT, NOISY = (
    200_000,
    8.0,
)  #: samples that show the noise; and times the standard error of a mean, at least, of such a turn
WINDOW = 61  #: blocks of that running median
FEWEST_BLOCKS = 10
FEWEST_SAMPLES = 4  #: samples of a block that is tested
JOIN = 5  #: blocks; disturbances up to twice this apart are one
MOVING = 0.5  #: share of disturbed blocks, above which the record is not static
SPOILT = 0.5  #: share by which disturbances may raise a mean square; a coefficient is then wrong by a quarter


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A span that is not still; times in s, on the clock of the samples."""

    start: float
    end: float
    axes: tuple[str, ...]
    largest: float  #: ratio to the usual scatter


@dataclass(frozen=True, slots=True)
class Stillness:
    """The disturbances of a record, and its longest quiet part."""

    disturbances: tuple[Disturbance, ...]
    quiet_start: float  #: s, on the clock of the samples
    quiet_end: float  #: s
    moving: bool  #: most of the record is not still, so it is not a static record
    recorded: tuple[
        tuple[float, float], ...
    ]  #: s, (start, end) of the spans with samples; short breaks do not divide a span
    excess: float = (
        0.0  #: share by which the disturbances raise the mean square within seconds, or between seconds, of some axis
    )
    #: s, (start, end) of the spans whose samples are quiet although the vehicle travels: it moves evenly
    even: tuple[tuple[float, float], ...] = ()

    @property
    def spoilt(self) -> bool:
        """Return whether noise coefficients of the whole record would be those of its disturbances."""
        return self.moving or self.excess > SPOILT

    def __str__(self) -> str:
        """Return the number of disturbances and the longest quiet part."""
        state = "moving" if self.moving else counted(len(self.disturbances), "disturbance")
        return f"{state}; longest quiet part from {self.quiet_start:.0f} to {self.quiet_end:.0f} s"


def stillness(axes: Mapping[str, tuple[Floats, Floats]], travels: Floats | None = None) -> Stillness | None:
    """Return the disturbances of a record of several axes; None where the record is too short, or its rate too low.

    A block of one second is disturbed if its standard deviation is three times the usual one of the record, or if its mean is
    eight standard errors, and one usual deviation, from the running median. Seconds without samples are no blocks. A record without a
    rest has no quiet blocks to compare with; so a block of a gyro (an axis of that name, in rad/s) is also disturbed if its mean rate
    differs by 3 deg/s from the running median.

    Args:
        axes: name -> (time in s, values); the axes need not share a clock, and may have gaps.
        travels: (k, 2) s on the same clock, spans in which the vehicle is known to travel; they are never quiet.
    """
    begin = min(float(time[0]) for time, _ in axes.values())
    finish = max(float(time[-1]) for time, _ in axes.values())
    blocks = _occupied([time for time, _ in axes.values()], begin, finish)
    count = blocks.size
    starts: Floats = begin + BLOCK * blocks.astype(np.float64)
    ends = starts + BLOCK
    # No samples lie between two blocks, so the rows of a block end where those of the next block begin.
    edges = np.append(starts, ends[-1:])
    rows = {axis: np.searchsorted(time, edges) for axis, (time, _) in axes.items()}
    judged = [axis for axis, row in rows.items() if np.count_nonzero(np.diff(row) >= FEWEST_SAMPLES) >= FEWEST_BLOCKS]
    if not judged:
        return None
    scored = {axis: _seconds(rows[axis], axes[axis][1], _turning(axis)) for axis in judged}
    scores = {axis: own.score for axis, own in scored.items()}
    moving = any(own.restless for own in scored.values())
    worst = np.max(list(scores.values()), axis=0)
    bad = closed(worst > 1, JOIN) | (worst > 1)
    first, length = runs(bad)
    last_end = finish if finish < ends[-1] + JOIN * BLOCK else float(ends[-1])
    until = np.append(ends[:-1], last_end)  # what is left of a second at the end is like the second before it
    disturbances = tuple(
        Disturbance(
            float(starts[start]), float(until[stop - 1]),
            tuple(axis for axis, score in scores.items() if score[start:stop].max() > 1),
            float(worst[start:stop].max() * SCATTER),
        )
        for start, stop in zip(first, first + length, strict=True)
    )  # fmt: skip
    even = ~bad & _within(starts + BLOCK / 2, travels)
    first, length = runs(even)
    spans = tuple((float(starts[a]), float(until[a + n - 1])) for a, n in zip(first, length, strict=True))
    far = np.flatnonzero(np.diff(blocks) > JOIN)
    recorded = tuple(zip(starts[np.append(0, far + 1)].tolist(), [*ends[far].tolist(), last_end], strict=True))
    calm, length = runs(~(bad | even))
    if not calm.size:
        return Stillness(disturbances, begin, begin, moving=True, recorded=recorded, even=spans)
    longest = int(np.argmax(length))
    last = calm[longest] + length[longest]
    moving |= float((bad | even).mean()) > MOVING
    end = finish if last == count else float(starts[last])
    excess = max(own.excess(bad) for own in scored.values())
    return Stillness(
        disturbances, float(starts[calm[longest]]), end, moving=moving, recorded=recorded, excess=excess, even=spans
    )


def _within(at: Floats, spans: Floats | None) -> Booleans:
    """Return which times are within a span."""
    if spans is None or not len(spans):
        return np.zeros(at.size, dtype=bool)
    before = np.searchsorted(spans[:, 0], at, "right") - 1
    return (before >= 0) & (at < spans[before.clip(0), 1])


def _occupied(times: Iterable[Floats], begin: float, finish: float) -> Integers:
    """Return the indices of the whole blocks that contain a sample of any axis."""
    occupied: list[Integers] = []
    for time in {id(time): time for time in times}.values():
        for rows in blocks_of(time.size):
            block = ((time[rows] - begin) / BLOCK).astype(np.int64)
            occupied.append(block[np.append(True, np.diff(block) > 0)])
    blocks = np.unique(np.concatenate(occupied))
    return blocks[blocks < int((finish - begin) / BLOCK)]


@dataclass(frozen=True, eq=False, slots=True)
class _Seconds:
    """The blocks of one axis."""

    score: Floats  #: (n,) disturbance, disturbed above 1; 0 where the block has too few samples
    restless: bool = False  #: the axis moves most of the time
    within: Floats = field(default_factory=lambda: np.empty(0))  #: (n,) variance of the samples; nan: too few samples
    between: Floats = field(
        default_factory=lambda: np.empty(0)
    )  #: (n,) square of the mean less the running median; nan likewise

    def excess(self, bad: Booleans) -> float:
        """Return by which share the disturbed blocks raise the mean of ``within`` or of ``between``."""
        most = 0.0
        for squares in (self.within, self.between):
            quiet = squares[~bad] if squares.size else squares
            usual = float(np.nanmean(quiet)) if np.isfinite(quiet).any() else 0.0
            if usual > 0:
                most = max(most, float(np.nanmean(squares)) / usual - 1)
        return most


def _turning(axis: str) -> float:
    """Return the rate from which a second of a gyro is disturbed however the others are; infinite for other axes."""
    return TURNS if axis.startswith("gyro") else float("inf")


def _seconds(rows: Integers, values: Floats, turning: float) -> _Seconds:
    """Return what the blocks of an axis show.

    Args:
        rows: first row of each block, and the row after the last block.
        values: (n,) samples of the axis.
        turning: a second whose mean is further than this from the running median is disturbed.
    """
    sizes = np.diff(rows)
    score = np.zeros(sizes.size)
    full = sizes >= FEWEST_SAMPLES
    if not full.any():
        return _Seconds(score)
    sums, squares = _block_sums(values, rows)
    mean = sums[full] / sizes[full]
    deviation = np.sqrt(np.maximum(squares[full] / sizes[full] - mean**2, 0.0))
    usual = float(np.median(deviation))
    if usual == 0:
        return _Seconds(score)
    # The blocks of a still sensor scatter alike, so their quietest tenth is near the median. If not, that tenth is the scale.
    calm = float(np.quantile(deviation, 0.1))
    restless = calm < usual / SCATTER
    usual = calm if restless and calm > 0 else usual
    drift = np.abs(mean - running_median(mean, min(WINDOW, mean.size | 1), "nearest"))
    wobble = max(float(np.median(drift)) * 1.4826, usual / np.sqrt(float(np.median(sizes[full]))))
    score[full] = np.maximum(deviation / (usual * SCATTER), np.minimum(drift / (wobble * JUMP), drift / usual))
    changes = np.abs(np.diff(values[:LOOKED_AT]))
    noise = float(np.median(changes)) / np.sqrt(float(np.median(sizes[full])))
    score[full] = np.maximum(score[full], drift / max(turning, NOISY * noise))
    within, between = np.full((2, sizes.size), np.nan)
    within[full], between[full] = deviation**2, drift**2
    return _Seconds(score, restless, within, between)


@compiled()
def _block_sums(values: Floats, rows: Integers) -> tuple[Floats, Floats]:  # pragma: no cover - compiled
    """Return the sums and the sums of squares between rows, of values less the first one (to keep digits)."""
    sums, squares = np.zeros(rows.size - 1), np.zeros(rows.size - 1)
    for block in range(rows.size - 1):
        for k in range(rows[block], rows[block + 1]):
            x = values[k] - values[0]
            sums[block] += x
            squares[block] += x * x
    return sums, squares

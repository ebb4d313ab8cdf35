"""Finds motion and shocks in a record that should be still, and the longest quiet part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

BLOCK = 1.0  #: s
SCATTER = 3.0  #: times the median standard deviation of a block
JUMP = 8.0  #: standard errors between a block's mean and the running median of the means
WINDOW = 61  #: blocks of that running median
FEWEST_BLOCKS = 10
JOIN = 5  #: blocks between two disturbances that are one


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A span that is not still; times in s from the first sample."""

    start: float
    end: float
    axes: tuple[str, ...]
    largest: float  #: times the usual scatter


@dataclass(frozen=True, slots=True)
class Stillness:
    """What disturbs a record, and its longest part without."""

    disturbances: tuple[Disturbance, ...]
    quiet_start: float  #: s
    quiet_end: float  #: s
    moving: bool  #: most of the record is not still: it is no static record at all


def stillness(axes: Mapping[str, Floats], dt: float) -> Stillness:
    """Return the disturbances of a record of several axes.

    A block of a second is disturbed when its standard deviation is three times the record's usual one,
    or its mean stands eight standard errors (and a usual deviation) off the running median.
    """
    size = max(round(BLOCK / dt), 4)
    duration = min(values.size for values in axes.values()) * dt
    scores: dict[str, Floats] = {}
    moving = False
    for axis, values in axes.items():
        count = values.size // size
        if count < FEWEST_BLOCKS:
            return Stillness((), 0.0, duration, moving=False)
        blocks = values[: count * size].reshape(count, size)
        deviation, mean = blocks.std(axis=1), blocks.mean(axis=1)
        usual = float(np.median(deviation))
        if usual == 0:
            continue
        # A still sensor's blocks scatter alike: its quietest tenth is near its median.
        moving |= bool(np.quantile(deviation, 0.1) < usual / SCATTER)
        drift = np.abs(mean - ndimage.median_filter(mean, min(WINDOW, count | 1), mode="nearest"))
        wobble = max(float(np.median(drift)) * 1.4826, usual / np.sqrt(size))
        scores[axis] = np.maximum(deviation / (usual * SCATTER), np.minimum(drift / (wobble * JUMP), drift / usual))
    if not scores:
        return Stillness((), 0.0, duration, moving=False)
    length = min(score.size for score in scores.values())
    worst = np.max([score[:length] for score in scores.values()], axis=0)
    bad = ndimage.binary_closing(worst > 1, iterations=JOIN) | (worst > 1)
    labels, number = ndimage.label(bad)
    found: list[Disturbance] = []
    for span in ndimage.find_objects(labels)[:number]:
        inside = span[0]
        guilty = tuple(axis for axis, score in scores.items() if score[:length][inside].max() > 1)
        found.append(
            Disturbance(inside.start * size * dt, inside.stop * size * dt, guilty, float(worst[inside].max() * SCATTER))
        )
    quiet, quiet_count = ndimage.label(~bad)
    if not quiet_count:
        return Stillness(tuple(found), 0.0, 0.0, moving=True)
    spans = [(int(span[0].start), int(span[0].stop)) for span in ndimage.find_objects(quiet)]
    begin, stop = max(spans, key=_length)
    end = duration if stop == length else stop * size * dt
    moving |= float(bad.mean()) > 0.5  # noqa: PLR2004 - most of it
    return Stillness(tuple(found), begin * size * dt, end, moving=moving)


def _length(span: tuple[int, int]) -> int:
    return span[1] - span[0]

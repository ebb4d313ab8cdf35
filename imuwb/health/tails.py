"""Samples of a quiet sensor that are further from the others than noise is, and what they do to its mean square."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.health.channel import LOOKED_AT, Channel

SLOWEST = 20.0  #: Hz; at a lower rate, a block contains more than noise
BLOCK = 1.0  #: s; samples are compared with the median of a block of this length
FEWEST = 16  #: samples of a block
WITHIN = (0.16, 0.84)  #: quantiles of one sigma, which samples that are far off hardly move
FAR = 5.0  #: sigmas
ENOUGH = 1000  #: samples that show the tails
SHARE, COUNT = 1e-3, 10  #: least share and number of samples that are far off; normal noise has a share of 6e-7


@dataclass(frozen=True, slots=True)
class Tails:
    """The samples of a channel that are more than five sigmas off; sigma is by quantiles, not by the mean square."""

    count: int
    share: float  #: of the quiet samples
    first: float  #: s from the log's start
    sigma: float  #: rad/s or m/s²
    excess: float  #: by which share they raise the mean square


def tails(channel: Channel, values: Floats, quiet: Booleans) -> Tails | None:
    """Return the heavy tails of a channel; None if its samples are those of one noise, or too few.

    Args:
        channel: clock of the samples.
        values: (n,) the samples, without lone ones.
        quiet: (n,) whether the sensor is quiet: in motion, samples may be of any size.
    """
    if not 1 / channel.clock.interval >= SLOWEST:
        return None
    size = max(FEWEST, round(BLOCK / channel.clock.interval))
    count = values.size // size
    if count * size < ENOUGH:
        return None
    blocks = values[: count * size].reshape(count, size)
    calm = np.flatnonzero(quiet[: count * size].reshape(count, size).all(axis=1))
    if calm.size * size < ENOUGH:
        return None
    some = _off(blocks, calm[:: calm.size * size // LOOKED_AT + 1])
    low, high = np.quantile(some, WITHIN)
    sigma = float(high - low) / 2 + channel.step / 2  # of a coarse channel, a quantile is off by up to half a step
    if sigma <= 0:
        return None
    beyond, first, squares, usual = 0, -1, 0.0, 0.0
    for rows in np.array_split(calm, calm.size * size // LOOKED_AT + 1):
        off = _off(blocks, rows)
        far = np.abs(off) > FAR * sigma
        beyond += int(np.count_nonzero(far))
        if first < 0 and far.any():
            at = int(np.argmax(far))
            first = int(rows[at // size]) * size + at % size
        off *= off
        squares += float(off.sum())
        usual += float(off[~far].sum())
    total = calm.size * size
    if beyond < COUNT or beyond < SHARE * total:
        return None
    excess = squares / total / max(usual / max(total - beyond, 1), 1e-300) - 1
    return Tails(beyond, beyond / total, float(channel.time[first]), sigma, excess)


def _off(blocks: Floats, rows: Integers) -> Floats:
    """Return the samples of some blocks less the median of their block."""
    own = blocks[rows]
    return (own - np.median(own, axis=1, keepdims=True)).ravel()

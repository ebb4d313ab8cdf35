"""Samples of a quiet sensor that are further from the others than noise is, and what they do to its mean square."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, blocks_of
from imuwb.health.channel import Channel

SLOWEST = 20.0  #: Hz; at a lower rate, a block contains more than noise
BLOCK = 1.0  #: s; samples are compared with the median of a block of this length
FEWEST = 16  #: samples of a block
WITHIN = (0.16, 0.84)  #: quantiles of one sigma, which samples that are far off hardly move
FAR = 5.0  #: sigmas
GROUP = 256  #: blocks whose medians are found at once
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
    calm = quiet[: count * size].reshape(count, size).all(axis=1)
    if np.count_nonzero(calm) * size < ENOUGH:
        return None
    off = _off(blocks[calm])
    low, high = np.quantile(off, WITHIN)
    sigma = max(float(high - low) / 2, channel.step / 2)
    far = (off > FAR * sigma) | (off < -FAR * sigma)
    beyond = int(np.count_nonzero(far))
    if sigma <= 0 or beyond < COUNT or beyond < SHARE * off.size:
        return None
    at = np.flatnonzero(np.repeat(calm, size))[int(np.argmax(far))]
    usual = _sum_of_squares(off, ~far) / (off.size - beyond)
    every = _sum_of_squares(off, np.ones_like(far)) / off.size
    return Tails(beyond, beyond / off.size, float(channel.time[at]), sigma, every / max(usual, 1e-300) - 1)


def _off(off: Floats) -> Floats:
    """Return the samples of blocks, (b, k), less the median of their block, (n,), in the same memory."""
    for first in range(0, len(off), GROUP):
        group = off[first : first + GROUP]
        group -= np.median(group, axis=1, keepdims=True)
    return off.ravel()


def _sum_of_squares(values: Floats, chosen: Booleans) -> float:
    return sum(float(np.square(values[rows][chosen[rows]]).sum()) for rows in blocks_of(values.size))

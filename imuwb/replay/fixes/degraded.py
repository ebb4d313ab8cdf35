"""Fixes made worse on purpose: added noise, and jumps that last for a while, as multipath causes them."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.geodesy.earth import displaced
from imuwb.log import SECOND, GnssStream

LASTS = 5.0  #: s, duration of a jump


@dataclass(frozen=True, slots=True)
class Degradation:
    """How fixes are made worse; the receiver's own sigmas stay as they are."""

    noise: float = 0.0  #: m, sigma of the white noise that is added on each axis
    jump: float = 0.0  #: m, length of the jumps, in random horizontal directions
    every: float = 60.0  #: s, mean time between jumps
    seed: int = 0


def degraded(gnss: GnssStream, degradation: Degradation) -> GnssStream:
    """Return a receiver with worse positions."""
    rng = np.random.default_rng(degradation.seed)
    error = degradation.noise * rng.standard_normal((len(gnss), 3))
    time = (gnss.time - gnss.time[0]) / SECOND
    at = 0.0
    while degradation.jump and at < time[-1]:
        at += LASTS + rng.exponential(max(degradation.every - LASTS, 0.0))
        angle = rng.uniform(0, 2 * np.pi)
        rows = (time >= at) & (time < at + LASTS)
        error[rows, :2] += degradation.jump * np.array([np.cos(angle), np.sin(angle)])
    return replace(gnss, position=displaced(gnss.position, error))

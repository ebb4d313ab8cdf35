"""Fixes made worse on purpose: more noise, and jumps that stay for a while, as multipath brings them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.geodesy.earth import displaced
from imuwb.log import SECOND

if TYPE_CHECKING:
    from imuwb.log import GnssStream

STAYS = 5.0  #: s, for which a jump stays


@dataclass(frozen=True, slots=True)
class Degradation:
    """How fixes are made worse; the receiver goes on claiming what it did."""

    noise: float = 0.0  #: m, sigma of white noise that is added on each axis
    jump: float = 0.0  #: m, in a direction of chance, in the plane
    every: float = 60.0  #: s between jumps, in the mean
    seed: int = 0


def degraded(gnss: GnssStream, how: Degradation) -> GnssStream:
    """Return a receiver whose positions are worse."""
    rng = np.random.default_rng(how.seed)
    off = how.noise * rng.standard_normal((len(gnss), 3))
    time = (gnss.time - gnss.time[0]) / SECOND
    at = 0.0
    while how.jump and at < time[-1]:
        at += STAYS + rng.exponential(max(how.every - STAYS, 0.0))
        angle = rng.uniform(0, 2 * np.pi)
        rows = (time >= at) & (time < at + STAYS)
        off[rows, :2] += how.jump * np.array([np.cos(angle), np.sin(angle)])
    return replace(gnss, position=displaced(gnss.position, off))

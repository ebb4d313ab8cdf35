"""How far a filter is off in outages, and what it thought of that itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.geodesy.earth import radii_of_curvature

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats
    from imuwb.navigation.outages import Drift
    from imuwb.replay.reference import Yardstick

HORIZONS = (5.0, 10.0, 30.0, 60.0)  #: s
LEAST = 0.01  #: of a covariance's trace, that a difference of two keeps


@dataclass(frozen=True, eq=False, slots=True)
class Scores:
    """Errors of s outages at L marks, each second; nan where the reference is missing or the outage was not scored."""

    start: Floats  #: (s,) s from the log's start, of the last fix
    elapsed: Floats  #: (L,) s
    north_east: Floats  #: (s, L, 2) m, estimate less reference
    covariance: Floats  #: (s, L, 2, 2) m², the filter's and the reference's
    vertical: Floats  #: (s, L) m
    velocity: Floats  #: (s, L) m/s, of the horizontal velocity's error
    heading: Floats  #: (s, L) rad
    distance: Floats  #: (s, L) m, driven since the start

    @property
    def horizontal(self) -> Floats:
        """Return the horizontal error, (s, L) m."""
        return np.hypot(self.north_east[..., 0], self.north_east[..., 1])

    @property
    def nees(self) -> Floats:
        """Return the normalised estimation error squared of the horizontal position, (s, L); two degrees of freedom."""
        (a, b), (_, d) = np.moveaxis(self.covariance, (-2, -1), (0, 1))
        x, y = np.moveaxis(self.north_east, -1, 0)
        return (d * x * x - 2 * b * x * y + a * y * y) / (a * d - b * b)

    @property
    def sigma(self) -> Floats:
        """Return the filter's horizontal sigma, (s, L) m: the root of the sum of both variances."""
        return np.sqrt(self.covariance[..., 0, 0] + self.covariance[..., 1, 1])

    def of(self, rows: NDArray[np.bool_] | NDArray[np.int64], duration: float) -> Scores:
        """Return some of the outages, up to a duration."""
        kept = self.elapsed <= duration + 1e-6
        return Scores(
            self.start[rows], self.elapsed[kept], *(
                part[rows][:, kept]
                for part in (self.north_east, self.covariance, self.vertical, self.velocity, self.heading, self.distance)
            )
        )  # fmt: skip


def _difference(covariance: Floats, sigma: Floats, against: Yardstick) -> Floats:
    """Return the covariance of a drift less its reference.

    An independent reference's own adds. A run over all fixes knows all that the drift knows, and more: its error is what is left
    of the drift's, and theirs differ by what the fixes brought, the difference of the covariances.
    """
    own = sigma[..., None] ** 2 * np.eye(2)
    if against.kind in ("truth", "fixed"):
        return covariance + own
    values, vectors = np.linalg.eigh(covariance - own)
    least = LEAST * np.trace(covariance, axis1=-2, axis2=-1)[..., None]
    return (vectors * np.maximum(values, least)[..., None, :]) @ np.swapaxes(vectors, -1, -2)


def scores(drift: Drift, against: Yardstick) -> Scores:
    """Return a drift's errors against a reference."""
    position, velocity, heading, sigma = against.at(drift.time)
    meridian, transverse = radii_of_curvature(position[..., 0])
    off = drift.state[..., :3] - position
    north = off[..., 0] * (meridian + position[..., 2])
    east = off[..., 1] * (transverse + position[..., 2]) * np.cos(position[..., 0])
    covariance = _difference(drift.covariance[..., :2, :2], sigma[..., :2], against)
    turned = euler_of_quaternion(drift.state[..., 6:10])[..., 2] - heading
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    step = np.diff(np.concatenate([drift.start[:, None], drift.time], axis=1), axis=1)
    unsound = ~drift.sound[:, None]
    return Scores(
        drift.start, drift.elapsed,
        np.where(unsound[..., None], np.nan, np.stack([north, east], axis=-1)), covariance,
        np.where(unsound, np.nan, off[..., 2]),
        np.hypot(*np.moveaxis(drift.state[..., 3:5] - velocity[..., :2], -1, 0)),
        np.angle(np.exp(1j * turned)), np.cumsum(speed * step, axis=1),
    )  # fmt: skip

"""The errors of a filter in outages, and the filter's own covariance of these errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation.outages import Drift
from imuwb.replay.references.reference import ReferenceTrack

HORIZONS = (5.0, 10.0, 30.0, 60.0)  #: s since the start of an outage, at which results are listed
LEAST = 0.01  #: least ratio of an eigenvalue of a difference of covariances to the trace of the larger covariance


@dataclass(frozen=True, eq=False, slots=True)
class Scores:
    """Errors in s outages at L marks; nan where there is no reference or the filter failed."""

    start: Floats  #: (s,) s from the log's start, the last fix before each outage
    elapsed: Floats  #: (L,) s
    north_east: Floats  #: (s, L, 2) m, estimate minus reference
    covariance: Floats  #: (s, L, 2, 2) m², of this error: from the filter's covariance and the reference's
    vertical: Floats  #: (s, L) m, up
    velocity: Floats  #: (s, L) m/s, length of the horizontal velocity's error
    heading: Floats  #: (s, L) rad
    distance: Floats  #: (s, L) m, driven since the start of the outage
    discrepancy: Floats | None = None  #: (s, L) m, by which the reference contradicts itself; None: not examined

    @property
    def horizontal(self) -> Floats:
        """Return the horizontal error, (s, L) m."""
        return np.hypot(self.north_east[..., 0], self.north_east[..., 1])

    @property
    def nees(self) -> Floats:
        """Return the normalised estimation error squared (NEES) of the horizontal position, (s, L); two degrees of freedom."""
        (a, b), (_, d) = np.moveaxis(self.covariance, (-2, -1), (0, 1))
        x, y = np.moveaxis(self.north_east, -1, 0)
        return (d * x * x - 2 * b * x * y + a * y * y) / (a * d - b * b)

    @property
    def sigma(self) -> Floats:
        """Return the horizontal sigma, (s, L) m: the square root of the sum of both variances."""
        return np.sqrt(self.covariance[..., 0, 0] + self.covariance[..., 1, 1])

    def of(self, rows: Booleans | Integers, duration: float) -> Scores:
        """Return some of the outages, up to a duration."""
        kept = self.elapsed <= duration + 1e-6
        own = None if self.discrepancy is None else self.discrepancy[rows][:, kept]
        return Scores(
            self.start[rows], self.elapsed[kept], *(
                part[rows][:, kept]
                for part in (self.north_east, self.covariance, self.vertical, self.velocity, self.heading, self.distance)
            ), discrepancy=own,
        )  # fmt: skip


def _difference(covariance: Floats, sigma: Floats, reference: ReferenceTrack) -> Floats:
    """Return the covariance of the difference between a drift and its reference.

    The covariance of an independent reference is added. A run over all fixes has all the information of the drift, and more:
    the difference of the two is then independent of the run's own error, and the covariance of the run is subtracted.
    """
    own = sigma[..., None] ** 2 * np.eye(2)
    if reference.kind in ("truth", "fixed", "estimate"):
        return covariance + own
    values, vectors = np.linalg.eigh(covariance - own)
    least = LEAST * np.trace(covariance, axis1=-2, axis2=-1)[..., None]
    return (vectors * np.maximum(values, least)[..., None, :]) @ np.swapaxes(vectors, -1, -2)


def scores(drift: Drift, reference: ReferenceTrack, discrepancy: Floats | None = None) -> Scores:
    """Return the errors of a drift against a reference.

    Args:
        drift: s outages with L marks.
        reference: the reference.
        discrepancy: (s, L) m, by which the reference contradicts itself; a quarter of its square is added to each variance.
    """
    position, velocity, heading, sigma = reference.at(drift.time)
    error = (drift.state[..., :3] - position) * ned_scale(position[..., 0], position[..., 2])
    covariance = _difference(drift.covariance[..., :2, :2], sigma[..., :2], reference)
    if discrepancy is not None:
        covariance = covariance + np.nan_to_num(discrepancy)[..., None, None] ** 2 / 4 * np.eye(2)
    turned = euler_of_quaternion(drift.state[..., 6:10])[..., 2] - heading
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    step = np.diff(np.concatenate([drift.start[:, None], drift.time], axis=1), axis=1)
    unsound = ~drift.sound[:, None]
    return Scores(
        drift.start, drift.elapsed,
        np.where(unsound[..., None], np.nan, error[..., :2]), covariance,
        np.where(unsound, np.nan, -error[..., 2]),
        np.hypot(*np.moveaxis(drift.state[..., 3:5] - velocity[..., :2], -1, 0)),
        np.angle(np.exp(1j * turned)), np.cumsum(speed * step, axis=1), discrepancy,
    )  # fmt: skip

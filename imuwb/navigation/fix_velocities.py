"""The velocities of a receiver's fixes at the filter's start: its own, or those that its positions give."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.filter_model import Settings

LONGEST = 5.0  #: s; positions at most this far apart give a velocity
JERK = (
    1.0  #: m/s³, usual change of a vehicle's acceleration: a mean over a longer baseline differs more from the velocity
)
CLIMB = 3.0  #: m/s, sigma of a velocity down that neither the receiver nor its positions give


@dataclass(frozen=True, eq=False, slots=True)
class FixVelocities:
    """The fixes whose velocity is known, f of them."""

    event: Integers  #: (f,) among the corrections
    time: Floats  #: (f,) s from the log's start
    value: Floats  #: (f, 3) m/s, NED
    sigma: Floats  #: (f, 3) m/s, NED

    @property
    def speed(self) -> Floats:
        """Return the horizontal speed, (f,) m/s."""
        return np.hypot(self.value[:, 0], self.value[:, 1])

    @property
    def spread(self) -> Floats:
        """Return the larger one of the horizontal sigmas, (f,) m/s."""
        return self.sigma[:, :2].max(axis=1)

    def __repr__(self) -> str:
        """Return number, speed and sigma in a line."""
        if not self.event.size:
            return "FixVelocities: none"
        return (
            f"FixVelocities: {self.event.size}, median speed {np.median(self.speed):.2f} m/s, "
            f"median sigma {np.median(self.spread):.2f} m/s"
        )


def fix_velocities(corrections: Corrections, settings: Settings) -> FixVelocities:
    """Return the fixes with a horizontal velocity; if no fix has one, the velocities that the positions give.

    If the velocity of a fix is a separate event, the event of its position has a copy of the velocity. A velocity down that
    the receiver does not report comes from the positions, or is 0 with a wide sigma.

    Args:
        corrections: the log's fixes.
        settings: the sigmas of velocities without a sigma of their own.
    """
    events = corrections.events
    fixes = np.flatnonzero(corrections.fix >= 0)
    measured = (events.variance[fixes, 3:] > 0) | (events.value[fixes, 3:] != 0)
    positions = velocities_of_positions(corrections, fixes)
    known = measured[:, :2].any(axis=1)
    if not known.any():
        return positions
    rows = fixes[known]
    flat, down = settings.velocity_sigma
    sigma = np.sqrt(events.variance[rows, 3:])
    sigma = np.where(sigma > 0, sigma, [flat, flat, down])
    own = FixVelocities(rows, corrections.time[rows], events.value[rows, 3:], sigma)
    return _with_down(own, positions, ~measured[known, 2])


def _with_down(own: FixVelocities, positions: FixVelocities, lacking: Booleans) -> FixVelocities:
    """Return velocities whose part down, where it is lacking, comes from the positions."""
    if not lacking.any():
        return own
    value, sigma = own.value.copy(), own.sigma.copy()
    value[lacking, 2], sigma[lacking, 2] = 0.0, CLIMB
    _, here, there = np.intersect1d(own.event, positions.event, return_indices=True)
    here, there = here[lacking[here]], there[lacking[here]]
    value[here, 2], sigma[here, 2] = positions.value[there, 2], positions.sigma[there, 2]
    return replace(own, value=value, sigma=sigma)


def velocities_of_positions(corrections: Corrections, fixes: Integers) -> FixVelocities:
    """Return the velocities that positions give: the slope, at each fix, of the parabola through it and two other fixes.

    With a baseline T between the two others, the error is sqrt(2) sigma / T from the positions and J T² / 24 from the
    vehicle's jerk J. Both are smallest together at T = (24 sigma / J)^(1/3): 3.9 s for 2.5 m, 0.6 s for 1 cm.

    Args:
        corrections: the log's fixes.
        fixes: (k,) their events, in order of time.
    """
    time = corrections.time[fixes]
    sigma = np.sqrt(corrections.events.variance[fixes, :3])
    half = np.minimum(np.cbrt(24 * sigma[:, :2].max(axis=1, initial=0.0) / JERK), LONGEST) / 2
    row = np.arange(time.size)
    before = np.minimum(_nearest(time, time - half), row - 1)
    after = np.maximum(_nearest(time, time + half), row + 1)
    inside = (before >= 0) & (after < time.size)
    row, before, after = row[inside], before[inside], after[inside]
    near = time[after] - time[before] < LONGEST
    row, before, after = row[near], before[near], after[near]
    back, ahead = time[row] - time[before], time[after] - time[row]
    weights = np.stack([-ahead / back, (ahead - back) * (ahead + back) / (ahead * back), back / ahead]) / (back + ahead)
    position = corrections.events.value[fixes, :3]
    scale = ned_scale(position[row, 0], position[row, 2])
    others = np.stack([before, row, after])
    # Relative to the middle position, so that the differences have all their digits.
    value = np.einsum("kf,kfi->fi", weights, position[others] - position[row]) * scale
    spread = np.sqrt(np.einsum("kf,kfi->fi", weights**2, sigma[others] ** 2))
    return FixVelocities(fixes[row], time[row], value, np.hypot(spread, (JERK * back * ahead / 6)[:, None]))


def _nearest(time: Floats, wanted: Floats) -> Integers:
    """Return the row of the time nearest to each wanted time."""
    if time.size < 2:  # noqa: PLR2004 - a single time is the nearest
        return np.zeros(wanted.size, np.int64)
    after = np.clip(np.searchsorted(time, wanted), 1, time.size - 1)
    return after - (wanted - time[after - 1] < time[after] - wanted)

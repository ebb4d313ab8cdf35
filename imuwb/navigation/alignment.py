"""Where a filter starts: level from specific force less the receiver's acceleration, heading from its velocity (Groves, 5.6)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import gravity, radii_of_curvature
from imuwb.log import SECOND

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats, GnssStream, Log
    from imuwb.navigation.events import Corrections
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.navigation.measurement import Measurement

AROUND = 1.0  #: s before and after the start over which accelerations are taken
SLOW = 0.5  #: m/s, below which a receiver may stand still
QUIET = 4.0  #: times the quietest tenth's scatter, up to which a second is still
NEAR = 5.0  #: s between positions that tell a velocity
CLEAR = 3.0  #: sigmas of a velocity
HARDEST = 8.0  #: m/s², of a vehicle
SECONDS_STILL = 5.0  #: s of stillness that tell the gyros' bias


@dataclass(frozen=True, eq=False, slots=True)
class Alignment:
    """A filter's first state, with sigmas."""

    event: int  #: of the corrections, at which it starts
    sample: int  #: the first sample behind it
    position: Floats  #: (3,) latitude rad, longitude rad, height m, of the IMU
    velocity: Floats  #: (3,) m/s, NED
    euler: Floats  #: (3,) roll, pitch, heading, rad
    covariance: Floats  #: (9, 9) of the error states
    gyro_bias: Floats  #: (3,) rad/s, mean over a stillness before the start, the earth's rate within; 0 without
    standing: tuple[int, int] | None  #: first and last (excluded) sample of that stillness
    note: str


def standing(moves: Measurement, log: Log, gnss: GnssStream | None) -> Floats:
    """Return when the IMU stands still.

    A second is still when both triads scatter no more than a few times as in the quietest tenth of all, and the receiver,
    where it tells a velocity, does not move.

    Returns:
        (s, 2) begin and end, s from the log's start.
    """
    per = max(1, round(1 / moves.interval))
    blocks = moves.time.size // per
    if not blocks:
        return np.zeros((0, 2))
    still = np.ones(blocks, dtype=bool)
    for increments in (moves.samples.angle, moves.samples.velocity):
        scatter = np.sqrt(increments[: blocks * per].reshape(blocks, per, 3).var(axis=1).sum(axis=1))
        still &= scatter <= QUIET * np.quantile(scatter, 0.1)
    begin = moves.time[: blocks * per : per] - moves.interval
    if gnss is not None and gnss.velocity is not None:
        time = (gnss.time - (log.zero or 0)) / SECOND
        speed = np.hypot(gnss.velocity[:, 0], gnss.velocity[:, 1])
        known = np.isfinite(speed)
        if known.any():
            still &= np.interp(begin + 0.5, time[known], speed[known]) < SLOW
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    ends = np.append(begin, begin[-1] + per * moves.interval)
    return np.stack([ends[edges[::2]], ends[edges[1::2]]], axis=1)


def align(
    moves: Measurement, found: Corrections, still: Floats, model: FilterModel, after: float = -np.inf
) -> Alignment:
    """Return the start at the first fix that moves fast enough to tell the heading.

    Args:
        moves: the IMU.
        found: the log's fixes.
        still: (s, 2) when it stands still, before which the gyros' bias is taken.
        model: sigmas, lever arm and the speed that is enough.
        after: s from the log's start, before which no start is looked for.

    Raises:
        MissingDataError: no fix has a velocity, or none moves fast enough.
    """
    events, settings = found.events, model.settings
    fixes, velocities, spread = _velocities(found, settings.velocity_sigma)
    first = _first_fast(moves, found, fixes, velocities, spread, settings.start_speed, after)
    event, time = int(fixes[first]), found.time[fixes]
    near = np.abs(time - time[first]) <= 2 * AROUND
    acceleration = _slope(time[near], velocities[near])
    velocity = velocities[first] + acceleration * model.installation.velocity_delay
    pace = float(np.hypot(velocity[0], velocity[1]))
    heading = float(np.arctan2(velocity[1], velocity[0]))
    latitude, height = events.value[event, 0], events.value[event, 2]
    down = float(gravity(latitude, height))
    begin, end = np.searchsorted(moves.time, found.time[event] + np.array([-AROUND, AROUND]))
    length = moves.samples.interval[begin:end].sum()
    force = moves.samples.velocity[begin:end].sum(axis=0) / length
    rate = moves.samples.angle[begin:end].sum(axis=0) / length
    roll, pitch = _level(force, acceleration - np.array([0.0, 0.0, down]), heading)
    euler = np.array([roll, pitch, heading])
    turn = rotation_of_euler(euler)
    lever = np.array(model.installation.lever_arm)
    arm = turn @ lever
    meridian, transverse = radii_of_curvature(latitude)
    to_degrees = np.array([1 / (meridian + height), 1 / ((transverse + height) * np.cos(latitude)), -1.0])
    late = events.late[event]
    position = events.value[event, :3] - (arm + velocity * late) * to_degrees
    sigma = np.sqrt(events.variance[event])
    sigma[3:] = np.where(sigma[3:] > 0, sigma[3:], spread[first])
    tilt = np.hypot(np.radians(settings.tilt), sigma[3:5].max() / AROUND / down)
    wide = np.hypot(np.radians(settings.heading), min(sigma[3:5].max() / pace, np.pi))
    covariance = np.diag(np.square([*sigma[:3], *sigma[3:], tilt, tilt, wide]))
    standing = _stillness(moves, still, found.time[event])
    bias = np.zeros(3)
    if standing is not None:
        rows = slice(*standing)
        bias = moves.samples.angle[rows].sum(axis=0) / moves.samples.interval[rows].sum()
    note = (
        f"the filter starts at {found.time[event]:.1f} s, at {pace:.1f} m/s; roll {np.degrees(roll):.1f}, "
        f"pitch {np.degrees(pitch):.1f}, heading {np.degrees(heading) % 360:.1f} deg; "
        + (
            f"gyro biases from {(standing[1] - standing[0]) * moves.interval:.0f} s of standing before"
            if standing is not None
            else "no stillness before: gyro biases unknown"
        )
    )
    swing = turn @ np.cross(rate - bias, lever)
    return Alignment(
        event, int(events.at[event]) + 1, position, velocity - swing, euler, covariance, bias, standing, note
    )


def _first_fast(
    moves: Measurement, found: Corrections, fixes: NDArray[np.int64], velocities: Floats, spread: Floats, enough: float,
    after: float,
) -> int:  # fmt: skip
    """Return the first of some fixes that moves fast enough, as does the next."""
    if not fixes.size:
        message = "no fix has a velocity, nor do positions follow each other: the heading at the start cannot be told"
        raise MissingDataError(message)
    time, speed = found.time[fixes], np.hypot(velocities[:, 0], velocities[:, 1])
    inside = (time > moves.time[0] + AROUND) & (time < moves.time[-1] - AROUND)
    fast = (speed > np.maximum(enough, CLEAR * spread)) & inside
    # One that stands alone is a spike: the next must move alike.
    step = np.hypot(*np.diff(velocities[:, :2], axis=0).T)
    alike = np.append(step < HARDEST * np.diff(time) + CLEAR * spread[1:], False)
    fast &= alike & np.append(fast[1:], False)
    if not fast.any():
        message = (
            f"the receiver never moves faster than {enough:g} m/s for two fixes (its median speed is "
            f"{np.median(speed):.2f} m/s): heading cannot be observed, and a drift without it means nothing"
        )
        raise MissingDataError(message)
    fast &= time > after
    if not fast.any():
        message = f"no fix behind {after:.1f} s moves faster than {enough:g} m/s within the IMU's time"
        raise MissingDataError(message)
    return int(np.argmax(fast))


def _velocities(found: Corrections, usual: tuple[float, float]) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Return the fixes with a velocity, (k,) events, the velocities, (k, 3) m/s NED, and their horizontal sigmas, (k,).

    A position whose velocity is an event of its own carries it along. Where no fix tells one, positions do: each from its
    neighbours.
    """
    events = found.events
    places = np.flatnonzero(found.fix >= 0)
    told = (events.variance[places, 3] > 0) | (events.value[places, 3:] != 0).any(axis=1)
    if told.any():
        fixes = places[told]
        spread = np.sqrt(events.variance[fixes, 3:5].max(axis=1))
        return fixes, events.value[fixes, 3:], np.where(spread > 0, spread, usual[0])
    span = found.time[places[2:]] - found.time[places[:-2]]
    meridian, transverse = radii_of_curvature(events.value[places[1:-1], 0])
    moved = events.value[places[2:], :3] - events.value[places[:-2], :3]
    height, latitude = events.value[places[1:-1], 2], events.value[places[1:-1], 0]
    ned = np.stack([
        moved[:, 0] * (meridian + height), moved[:, 1] * (transverse + height) * np.cos(latitude), -moved[:, 2]
    ], axis=1)  # fmt: skip
    near = span < NEAR
    spread = np.sqrt(2 * events.variance[places[1:-1], :2].max(axis=1)) / span
    return places[1:-1][near], (ned / span[:, None])[near], spread[near]


def _stillness(moves: Measurement, still: Floats, until: float) -> tuple[int, int] | None:
    """Return the samples of the last stillness that is long enough."""
    long = [(a, b) for a, b in still if b < until and b - a >= SECONDS_STILL]
    if not long:
        return None
    begin, end = np.searchsorted(moves.time, long[-1], side="right")
    return int(begin), int(end)


def _slope(time: Floats, values: Floats) -> Floats:
    if time.size < 2:  # noqa: PLR2004 - a slope needs two
        return np.zeros(values.shape[1])
    centred = time - time.mean()
    return centred @ values / (centred @ centred)


def _level(force: Floats, wanted: Floats, heading: float) -> tuple[float, float]:
    """Return the roll and pitch that, with a heading, turn a body's specific force into what it is in NED."""
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y, z = cosine * wanted[0] + sine * wanted[1], cosine * wanted[1] - sine * wanted[0], wanted[2]
    # Pitch does not change what is across: f_y cos(roll) - f_z sin(roll) = y.
    across = np.hypot(force[1], force[2])
    roll = -np.arccos(np.clip(y / across, -1, 1)) - np.arctan2(force[2], force[1])
    roll = np.arctan2(np.sin(roll), np.cos(roll))
    down = force[1] * np.sin(roll) + force[2] * np.cos(roll)
    pitch = np.angle((z + 1j * x) * (down - 1j * force[0]))
    return float(roll), float(pitch)

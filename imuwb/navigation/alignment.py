"""The filter's first state: roll and pitch from specific force and the receiver's acceleration, heading from its velocity.

Source: Groves, 5.6.
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import gravity, ned_scale
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.fix_velocities import FixVelocities, fix_velocities
from imuwb.navigation.measurement import Measurement
from imuwb.notes import Note

AROUND = 1.0  #: s before and after the alignment over which specific force and angular rate are averaged
CLEAR = 3.0  #: a speed above this many of its sigmas counts as motion
HARDEST = 8.0  #: m/s², the largest acceleration of a vehicle
SECONDS_STILL = 5.0  #: s; a shorter standstill does not give the gyros' bias


@dataclass(frozen=True, eq=False, slots=True)
class Alignment:
    """A filter's first state, with its covariance."""

    event: int  #: the correction at which the filter starts
    sample: int  #: the first sample after that correction
    position: Floats  #: (3,) latitude rad, longitude rad, height m, of the IMU
    velocity: Floats  #: (3,) m/s, NED, of the IMU
    euler: Floats  #: (3,) roll, pitch, heading, rad
    covariance: Floats  #: (9, 9) of the navigation error states
    gyro_bias: Floats  #: (3,) rad/s, mean rate over the standstill, including the Earth's rate; 0 without a standstill
    standstill: tuple[int, int] | None  #: first sample of the last standstill, and first one after it
    note: Note

    def __repr__(self) -> str:
        """Return the note that a report shows."""
        return self.note


def align(
    measurement: Measurement, corrections: Corrections, stills: Floats, model: FilterModel, after: float = -np.inf
) -> Alignment:
    """Return the alignment at the first fix that is fast enough to give the heading, or, with a known heading, at the first fix.

    A start with a known heading in a standstill is at the last fix of the standstill, so that the standstill gives the gyros'
    bias. The heading is that of the whole standstill.

    Args:
        measurement: the IMU.
        corrections: the log's fixes.
        stills: (s, 2) s from the log's start, the standstills; the last one before the fix gives the gyros' bias.
        model: its settings give the sigmas, the lever arm, the lowest speed that gives the heading, or the known start.
        after: s from the log's start; the fix must be later than this time.

    Raises:
        MissingDataError: no fix has a velocity, or none is fast enough.
    """
    settings, lever = model.settings, np.array(model.installation.lever_arm)
    velocities = fix_velocities(corrections, settings)
    begin, heading, spread = settings.known_start
    if spread:
        first = _first_known(measurement, velocities, stills, max(after, begin))
    else:
        first = _first_fast(measurement, velocities, settings.start_speed, after)
    event, time = int(velocities.event[first]), float(velocities.time[first])
    acceleration = _acceleration(velocities, time)
    antenna = velocities.value[first] + acceleration * model.installation.velocity_delay
    latitude, height = corrections.events.value[event, [0, 2]]
    down = float(gravity(latitude, height))
    force, rate = _means(measurement, time)
    course = float(np.radians(heading) if spread else np.arctan2(antenna[1], antenna[0]))
    euler = _level(force, acceleration - np.array([0.0, 0.0, down]), course)
    rotation = rotation_of_euler(euler)
    late = corrections.events.late[event]
    position = corrections.events.value[event, :3] - (rotation @ lever + antenna * late) / ned_scale(latitude, height)
    standstill = _last_standstill(measurement, stills, time, within=spread > 0)
    bias = np.zeros(3)
    if standstill is not None:
        rows = slice(*standstill)
        bias = measurement.samples.angle[rows].sum(axis=0) / measurement.samples.interval[rows].sum()
    sigma = np.sqrt(corrections.events.variance[event])
    sigma[3:] = np.where(sigma[3:] > 0, sigma[3:], velocities.sigma[first])
    speed = float(np.hypot(antenna[0], antenna[1]))
    covariance = np.diag(np.square([*sigma, *_attitude_sigmas(sigma[3:5].max(), speed, down, settings)]))
    if spread:
        covariance[8, 8] = np.radians(spread) ** 2
    # The receiver's velocity is that of the antenna, which turns around the IMU.
    velocity = antenna - rotation @ np.cross(rate - bias, lever)
    note = _note(time, speed, euler, spread, None if standstill is None else np.ptp(standstill) * measurement.interval)
    sample = int(corrections.events.at[event]) + 1
    return Alignment(event, sample, position, velocity, euler, covariance, bias, standstill, note)


def _first_fast(measurement: Measurement, velocities: FixVelocities, enough: float, after: float) -> int:
    """Return the first fix that is fast enough, and whose successor is fast enough too."""
    if not velocities.event.size:
        raise MissingDataError(
            "no fix has a velocity, and no positions are near enough in time to give one: the heading at the start is "
            "unknown; use a receiver that reports velocities"
        )
    time, speed, inside = velocities.time, velocities.speed, _inside(measurement, velocities)
    fast = (speed > np.maximum(enough, CLEAR * velocities.spread)) & inside
    # A single fast fix may be a spike: the velocity of the next fix must agree with it.
    step = np.hypot(*np.diff(velocities.value[:, :2], axis=0).T)
    agrees = np.append(step < HARDEST * np.diff(time) + CLEAR * velocities.spread[1:], False)
    fast &= agrees & np.append(fast[1:], False)
    if not fast.any():
        raise MissingDataError(
            f"the receiver is never faster than {enough:g} m/s for two fixes (its median speed is {np.median(speed):.2f} m/s): "
            "the heading cannot be observed, and without a heading the drift cannot be computed; use a log in which the vehicle drives"
        )
    fast &= time > after
    if not fast.any():
        raise MissingDataError(f"no fix after {after:.1f} s and within the IMU's time is faster than {enough:g} m/s")
    return int(np.argmax(fast))


def _inside(measurement: Measurement, velocities: FixVelocities) -> Booleans:
    """Return which fixes have samples of the IMU around them."""
    time = velocities.time
    return (time > measurement.time[0] + AROUND) & (time < measurement.time[-1] - AROUND)


def _first_known(measurement: Measurement, velocities: FixVelocities, stills: Floats, after: float) -> int:
    """Return the first fix from a time on, or the last fix of the standstill that it is in."""
    rows = np.flatnonzero(_inside(measurement, velocities) & (velocities.time >= after))
    if not rows.size:
        raise MissingDataError(
            f"no fix after {max(after, 0.0):.1f} s and within the IMU's time has a velocity, and no positions are near enough in "
            "time to give one"
        )
    time = velocities.time[rows]
    for begin, end in stills:
        if begin <= time[0] < end:
            return int(rows[max(np.searchsorted(time, end - AROUND) - 1, 0)])
    return int(rows[0])


def _acceleration(velocities: FixVelocities, time: float) -> Floats:
    """Return the receiver's acceleration around a time, (3,) m/s² NED: the slope of a straight line."""
    near = np.abs(velocities.time - time) <= 2 * AROUND
    at, values = velocities.time[near], velocities.value[near]
    if at.size < 2:  # noqa: PLR2004 - a slope needs two points
        return np.zeros(3)
    centred = at - at.mean()
    return centred @ values / (centred @ centred)


def _means(measurement: Measurement, time: float) -> tuple[Floats, Floats]:
    """Return mean specific force, (3,) m/s², and mean angular rate, (3,) rad/s, around a time."""
    samples = measurement.samples
    rows = slice(*np.searchsorted(measurement.time, time + np.array([-AROUND, AROUND])))
    length = samples.interval[rows].sum()
    return samples.velocity[rows].sum(axis=0) / length, samples.angle[rows].sum(axis=0) / length


def _level(force: Floats, wanted: Floats, heading: float) -> Floats:
    """Return the attitude, (3,) rad, with a given heading, that turns the force in body axes into the wanted one in NED."""
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y, z = cosine * wanted[0] + sine * wanted[1], cosine * wanted[1] - sine * wanted[0], wanted[2]
    # Pitch does not change the force component across the vehicle: f_y cos(roll) - f_z sin(roll) = y.
    across = np.hypot(force[1], force[2])
    roll = -np.arccos(np.clip(y / across, -1, 1)) - np.arctan2(force[2], force[1])
    roll = np.arctan2(np.sin(roll), np.cos(roll))
    down = force[1] * np.sin(roll) + force[2] * np.cos(roll)
    pitch = np.angle((z + 1j * x) * (down - 1j * force[0]))
    return np.array([float(roll), float(pitch), heading])


def _attitude_sigmas(velocity: float, speed: float, down: float, settings: Settings) -> tuple[float, float, float]:
    """Return the sigmas of the attitude errors, rad: those of the settings plus the effect of the velocity's sigma."""
    tilt = float(np.hypot(np.radians(settings.tilt), velocity / AROUND / down))
    return tilt, tilt, float(np.hypot(np.radians(settings.heading), min(velocity / speed, np.pi)))


def _last_standstill(measurement: Measurement, stills: Floats, until: float, *, within: bool) -> tuple[int, int] | None:
    """Return the samples of the last standstill before a time that is long enough.

    Args:
        measurement: the IMU.
        stills: (s, 2) s from the log's start.
        until: s; a standstill must end before this time.
        within: whether a standstill that contains this time counts up to it.
    """
    past = [(begin, min(end, until) if within else end) for begin, end in stills if begin < until]
    long = [(begin, end) for begin, end in past if end <= until and end - begin >= SECONDS_STILL]
    if not long:
        return None
    begin, end = np.searchsorted(measurement.time, long[-1], side="right")
    return int(begin), int(end)


def _note(time: float, speed: float, euler: Floats, spread: float, still: float | None) -> Note:
    roll, pitch, heading = np.degrees(euler)
    known = f" (known, sigma {spread:.2g} deg)" if spread else ""
    bias = (
        "there is no standstill before: the gyro biases are unknown"
        if still is None
        else f"the gyro biases come from a standstill of {still:.0f} s before"
    )
    return Note(
        "alignment" if still is None else "alignment-after-standstill",
        f"the filter starts at {time:.1f} s, at {speed:.1f} m/s, with roll {roll:.1f}, pitch {pitch:.1f}, "
        f"heading {heading % 360:.1f} deg{known}; {bias}",
    )

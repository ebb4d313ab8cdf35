"""A car's motion on the rotating earth as functions of time, and what an ideal IMU in it measures.

The body axes are those of the car: it moves along its x axis. The position is that of the IMU. On a rough road the body also
moves on its suspension: up and down, in pitch and in roll.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from imuwb.arrays import Floats
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import EARTH_RATE, gravity, radii_of_curvature
from imuwb.simulation.profile import Profile
from imuwb.simulation.suspension import Ride

TURIN = (np.radians(45.06), np.radians(7.66), 240.0)  #: rad, rad, m
CELL = 0.1  #: s; a cubic over a cell misses a car's position by a micrometre
#: Gauss-Legendre on (-1, 1), weights for a mean
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)[0], np.polynomial.legendre.leggauss(4)[1] / 2
PASSES = 5  #: each pass leaves less than a thousandth of the error of latitude that the pass before left
BLOCK = 1 << 14  #: samples that are computed at once


@dataclass(frozen=True, eq=False, slots=True)
class State:
    """Position, velocity and attitude of a car over time."""

    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (n, 3) m/s, NED
    attitude: Floats  #: (n, 3) roll, pitch, heading of C_b_n, rad; heading in [-pi, pi)


@dataclass(frozen=True, eq=False, slots=True)
class Route:
    """A drive made of its profile; before time 0 the car stands at its start."""

    name: str
    duration: float  #: s
    profile: Profile
    start: tuple[float, float, float] = TURIN  #: latitude rad, longitude rad, height m
    ride: Ride | None = None  #: motion of the body on its suspension; None: the road is smooth
    _driven: Any = field(init=False, repr=False)  #: s -> m
    _track: Any = field(init=False, repr=False)  #: s -> latitude, longitude, height

    def __post_init__(self) -> None:
        """Integrate the position."""
        object.__setattr__(self, "_driven", self.profile.manoeuvres.antiderivative())
        object.__setattr__(self, "_track", self._integrated())

    def state(self, t: Floats) -> State:
        """Return the true state.

        Args:
            t: (n,) s from the start.

        Raises:
            ValueError: a time after the end.
        """
        moving = self._riding(t)
        attitude = moving.attitude.copy()
        attitude[:, 2] = np.remainder(attitude[:, 2] + np.pi, 2 * np.pi) - np.pi
        position = self._track(np.maximum(t, 0.0))
        if self.ride is not None:
            position[:, 2] += self.ride.at(np.maximum(t, 0.0))[:, 0]
        return State(position, moving.velocity, attitude)

    def distance(self, t: Floats) -> Floats:
        """Return the distance driven, (n,) m, at times (n,) s."""
        return self._driven(np.maximum(t, 0.0))[:, 0] - self._driven(0.0)[0]

    def speed(self, t: Floats) -> Floats:
        """Return the speed along the road, (n,) m/s, at times (n,) s."""
        return self._moving(t).speed

    def inertial(self, t: Floats) -> tuple[Floats, Floats]:
        """Return what an ideal IMU measures at instants: omega_ib^b, (n, 3) rad/s, and f^b, (n, 3) m/s².

        omega_ib^b is the rate of the Euler angles plus C_n_b (omega_ie + omega_en) (Groves, 2.3 and 5.4); the specific force is
        C_n_b (dv/dt + (2 omega_ie + omega_en) x v - g) (Groves, eq. 5.53).

        Args:
            t: (n,) s from the start.

        Raises:
            ValueError: a time after the end.
        """
        moving = self._riding(t)
        latitude, _, height = self._track(np.maximum(t, 0.0)).T
        meridian, transverse = radii_of_curvature(latitude)
        north, east, _ = moving.velocity.T
        earth = earth_rate(latitude)
        to_east = east / (transverse + height)
        transport = np.stack([to_east, -north / (meridian + height), -to_east * np.tan(latitude)], axis=1)
        to_body = rotation_of_euler(moving.attitude)
        force = moving.acceleration + np.cross(2 * earth + transport, moving.velocity)
        force[:, 2] -= gravity(latitude, height)
        turning = _body_rate(moving.attitude, moving.attitude_rate)
        # A row times C_b_n is C_n_b times a column.
        turning += np.einsum("ij,ijk->ik", earth + transport, to_body)
        return turning, np.einsum("ij,ijk->ik", force, to_body)

    def averages(self, count: int, rate: float) -> tuple[Floats, Floats]:
        """Return the averages of what an ideal IMU measures over (t_(k-1), t_k], t_k = k / rate.

        Args:
            count: samples, from k = 0 on.
            rate: Hz, at least 20: at lower rates the four integration nodes of a sample do not follow the motion.

        Returns:
            (n, 3) rad/s and (n, 3) m/s²
        """
        rates, forces = np.empty((count, 3)), np.empty((count, 3))
        for first in range(0, count, BLOCK):
            part = slice(first, min(first + BLOCK, count))
            at = (np.arange(part.start, part.stop)[:, None] + (NODES - 1) / 2) / rate
            measured = self.inertial(at.ravel())
            for averages, values in zip((rates, forces), measured, strict=True):
                averages[part] = np.einsum("j,ijk->ik", WEIGHTS, values.reshape(-1, NODES.size, 3))
        return rates, forces

    def _riding(self, t: Floats) -> _Moving:
        """Return the motion with that of the body on its suspension. The heave is vertical; its effect on the track is nil."""
        moving = self._moving(t)
        if self.ride is None:
            return moving
        t = np.maximum(t, 0.0)
        turned, rates, accelerations = (self.ride.at(t, order) for order in range(3))
        moving.velocity[:, 2] -= rates[:, 0]
        moving.acceleration[:, 2] -= accelerations[:, 0]
        moving.attitude[:, :2] += turned[:, 1:]
        moving.attitude_rate[:, :2] += rates[:, 1:]
        return moving

    def _moving(self, t: Floats) -> _Moving:
        if t.size and not t.max() <= self.duration:
            raise ValueError(f"the time is {t.max()} s; it must not be after the end of the route, {self.duration} s")
        t = np.maximum(t, 0.0)
        (speed, turned), (speeding, turning) = self.profile.manoeuvres(t).T, self.profile.manoeuvres(t, 1).T
        driven = self._driven(t)[:, 0]
        slope, bank, bend = self.profile.road(driven).T
        sloping, banking, bending = self.profile.road(driven, 1).T * speed
        heading, heading_rate = turned + bend, turning + bending
        ss, cs, sh, ch = np.sin(slope), np.cos(slope), np.sin(heading), np.cos(heading)
        ahead = np.stack([cs * ch, cs * sh, -ss], axis=1)
        swung = np.stack(
            [-ss * ch * sloping - cs * sh * heading_rate, -ss * sh * sloping + cs * ch * heading_rate, -cs * sloping],
            axis=1,
        )
        return _Moving(
            speed,
            speed[:, None] * ahead,
            speeding[:, None] * ahead + speed[:, None] * swung,
            np.stack([bank, slope, heading], axis=1),
            np.stack([banking, sloping, heading_rate], axis=1),
        )

    def _integrated(self) -> CubicHermiteSpline:
        """Return latitude, longitude and height over time (Groves, eq. 2.111), by quadrature cell by cell.

        The rate of latitude depends on latitude only through the radius of curvature. This effect is so small that a few passes
        give the exact result.
        """
        ends = np.linspace(0.0, self.duration, int(np.ceil(self.duration / CELL)) + 1)
        cell = ends[1]
        at = (ends[:-1, None] + cell * (NODES + 1) / 2).ravel()
        inside, outside = self._moving(at).velocity, self._moving(ends).velocity

        def path(start: float, rates: Floats, at_ends: Floats) -> CubicHermiteSpline:
            steps = rates.reshape(-1, NODES.size) @ WEIGHTS * cell
            return CubicHermiteSpline(ends, start + np.concatenate([[0.0], np.cumsum(steps)]), at_ends)

        height = path(self.start[2], -inside[:, 2], -outside[:, 2])
        up, up_outside = height(at), height(ends)
        latitude = path(self.start[0], np.zeros(at.size), np.zeros(ends.size))
        for _ in range(PASSES):
            latitude = path(
                self.start[0],
                inside[:, 0] / (radii_of_curvature(latitude(at))[0] + up),
                outside[:, 0] / (radii_of_curvature(latitude(ends))[0] + up_outside),
            )
        longitude = path(
            self.start[1],
            inside[:, 1] / ((radii_of_curvature(latitude(at))[1] + up) * np.cos(latitude(at))),
            outside[:, 1] / ((radii_of_curvature(latitude(ends))[1] + up_outside) * np.cos(latitude(ends))),
        )
        paths = (latitude, longitude, height)
        return CubicHermiteSpline(
            ends, np.stack([p(ends) for p in paths], axis=1), np.stack([p(ends, 1) for p in paths], axis=1)
        )


@dataclass(frozen=True, eq=False, slots=True)
class _Moving:
    """The motion that the profile alone gives: NED, without the earth's shape and rotation."""

    speed: Floats  #: (n,) m/s
    velocity: Floats  #: (n, 3) m/s
    acceleration: Floats  #: (n, 3) m/s²
    attitude: Floats  #: (n, 3) rad
    attitude_rate: Floats  #: (n, 3) rad/s, of roll, pitch and heading


def earth_rate(latitude: Floats) -> Floats:
    """Return omega_ie in NED, (n, 3) rad/s, at latitudes (n,) rad (Groves, eq. 2.123)."""
    return EARTH_RATE * np.stack([np.cos(latitude), np.zeros_like(latitude), -np.sin(latitude)], axis=1)


def _body_rate(attitude: Floats, rate: Floats) -> Floats:
    """Return omega_nb^b of Euler angles and their rates (Groves, eq. 2.57)."""
    roll, pitch, _ = attitude.T
    banking, sloping, turning = rate.T
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    return np.stack(
        [banking - turning * sp, sloping * cr + turning * cp * sr, -sloping * sr + turning * cp * cr], axis=1
    )

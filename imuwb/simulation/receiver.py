"""The other sensors of a car: a GNSS receiver and an odometer."""

import math
from dataclasses import dataclass, field

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import displaced
from imuwb.log import GnssStream, Origin, Scalars
from imuwb.simulation.gnss_errors import GnssErrors, triple
from imuwb.simulation.route import Route, earth_rate
from imuwb.simulation.sensor import stamps

FIX_3D = 3
HIGHEST_RATE = 1000.0  #: Hz
LONGEST_ARM, LONGEST_LATENCY = 1000.0, 60.0  #: m, s
WHITE = GnssErrors()  #: no error but the white noise


@dataclass(frozen=True, slots=True)
class Receiver:
    """A GNSS receiver. Without ``errors``, its noise is white, and the sigmas in its fixes are the true ones.

    Raises:
        UsageError: a value out of its range.
    """

    rate: float = 1.0  #: Hz
    position_sigma: tuple[float, float, float] = (2.0, 2.0, 3.5)  #: m, NED
    velocity_sigma: tuple[float, float, float] = (0.1, 0.1, 0.15)  #: m/s, NED
    latency: float = 0.0  #: s; a fix stamped t shows the antenna at t - latency
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: m, FRD, from the IMU to the antenna
    errors: GnssErrors = field(default=WHITE, repr=False)  #: errors beyond the white noise

    def __post_init__(self) -> None:
        """Check the values."""
        _require("a receiver's rate", self.rate, HIGHEST_RATE, "Hz", above_zero=True)
        for sigma in (*self.position_sigma, *self.velocity_sigma):
            _require("a receiver's sigma", sigma, 1e6, "m or m/s")
        _require("a receiver's latency", self.latency, LONGEST_LATENCY, "s")
        for arm in self.lever_arm:
            _require("the length of a lever arm", abs(arm), LONGEST_ARM, "m")

    def truth(self) -> dict[str, str]:
        """Return the true parameters, {name: value with its SI unit}; none without errors beyond the white noise."""
        if self.errors == WHITE:
            return {}
        return {
            "gnss.position.white.sigma": triple(self.position_sigma, "m"),
            "gnss.velocity.white.sigma": triple(self.velocity_sigma, "m/s"),
            "gnss.latency": f"{self.latency:.12g} s",
            **self.errors.truth(),
        }

    def fixes(self, route: Route, rng: np.random.Generator) -> GnssStream:
        """Return the fixes of a whole route; the first one is at its start."""
        count = _count(route, self.rate)
        noise = rng.standard_normal((2, count, 3))
        delay = self.latency if not self.errors.jitter else self.errors.delays(count, self.latency, rng)
        position, velocity = antenna(route, np.arange(count) / self.rate - delay, self.lever_arm)
        error = noise * np.array([self.position_sigma, self.velocity_sigma])[:, None]
        if self.errors != WHITE:
            error += self.errors.sample(count, self.rate, rng)
        claimed = self.errors.claimed(self.position_sigma, self.velocity_sigma)
        return GnssStream(
            "/gnss/fix",
            stamps(count, self.rate),
            displaced(position, error[0]),
            velocity + error[1],
            np.tile(claimed[0], (count, 1)),
            np.tile(claimed[1], (count, 1)),
            np.full(count, FIX_3D),
            Origin("SI", "NED", "unix"),
        )


@dataclass(frozen=True, slots=True)
class Odometer:
    """Forward speed from the wheels.

    Raises:
        UsageError: a value out of its range.
    """

    rate: float = 10.0  #: Hz
    scale_error: float = 0.0  #: measured = (1 + s) true, rounded
    step: float = 0.0  #: m/s, to which it rounds; 0: no rounding

    def __post_init__(self) -> None:
        """Check the values."""
        _require("an odometer's rate", self.rate, HIGHEST_RATE, "Hz", above_zero=True)
        _require("the size of an odometer's scale error", abs(self.scale_error), 1.0, "")
        _require("an odometer's step", self.step, 100.0, "m/s")

    def speeds(self, route: Route) -> Scalars:
        """Return the speeds of a whole route; the first one is at its start."""
        count = _count(route, self.rate)
        speed = (1 + self.scale_error) * route.speed(np.arange(count) / self.rate)
        if self.step:
            speed = np.rint(speed / self.step) * self.step
        return Scalars("/odometer/speed", stamps(count, self.rate), speed)


def antenna(route: Route, t: Floats, lever_arm: tuple[float, float, float]) -> tuple[Floats, Floats]:
    """Return the position and velocity of a point of the car (Groves, eq. 14.122 and 14.123, without their approximations).

    Args:
        route: the route of the IMU.
        t: (n,) s.
        lever_arm: m, FRD, from the IMU to the point.

    Returns:
        (n, 3) latitude rad, longitude rad, height m; (n, 3) m/s, NED
    """
    state = route.state(t)
    to_navigation = rotation_of_euler(state.attitude)
    arm = to_navigation @ np.array(lever_arm)
    turning = np.einsum("ijk,ik->ij", to_navigation, route.inertial(t)[0]) - earth_rate(state.position[:, 0])
    return displaced(state.position, arm), state.velocity + np.cross(turning, arm)


def _count(route: Route, rate: float) -> int:
    """Return the number of samples from time 0 to the end."""
    return max(1, math.ceil(round(route.duration * rate, 6)))


def _require(what: str, value: float, most: float, unit: str, *, above_zero: bool = False) -> None:
    if not (0 < value <= most if above_zero else 0 <= value <= most):
        message = (
            f"{what} is {value}; it must be {'above 0' if above_zero else 'at least 0'} and at most {most:g} {unit}"
        )
        raise UsageError(message.rstrip())

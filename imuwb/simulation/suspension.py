"""The motion of a car's body on its suspension over a rough road: heave, pitch and roll."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal
from scipy.interpolate import CubicSpline

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.simulation.roughness import STEP

FINE = 500.0  #: Hz; the body is computed at this rate. It follows a road up to some 30 Hz.
MARGIN = 10.0  #: m of road before the start and after the end; more than a wheelbase
SHORTEST, LONGEST = 0.3, 5.0  #: m


@dataclass(frozen=True, slots=True)
class Suspension:
    """A quarter-car at each wheel: a sprung mass on a spring and a damper, an unsprung mass on a tyre.

    All values are per sprung mass. The defaults are those of the reference vehicle of the International Roughness Index (Sayers,
    "On the calculation of International Roughness Index from longitudinal road profile", 1995): bounce at 1.2 Hz, wheel hop at
    11 Hz. The quarter-cars do not act on each other. This is exact for a body whose radius of gyration in pitch is half the
    wheelbase, and in roll half the track; there is no anti-roll bar.

    Raises:
        UsageError: a value that is not above 0, or a vehicle that is not 0.3 to 5 m wide and long.
    """

    spring: float = 63.3  #: stiffness per sprung mass, 1/s²
    damper: float = 6.0  #: damping per sprung mass, 1/s
    tyre: float = 653.0  #: stiffness of the tyre per sprung mass, 1/s²
    unsprung: float = 0.15  #: unsprung mass per sprung mass
    wheelbase: float = 2.7  #: m
    track: float = 1.5  #: m, between the left and the right wheels

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("spring", "damper", "tyre", "unsprung"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise UsageError(f"the suspension has {name} = {value}; it must be above 0")
        for name in ("wheelbase", "track"):
            value = getattr(self, name)
            if not SHORTEST <= value <= LONGEST:
                raise UsageError(f"the suspension has {name} = {value} m; it must be {SHORTEST} to {LONGEST} m")

    def transfer_function(self) -> tuple[Floats, Floats]:
        """Return numerator and denominator, powers of s from the highest, from the road's elevation to that of the body."""
        k, c, t, m = self.spring, self.damper, self.tyre, self.unsprung
        return np.array([t * c, t * k]), np.array([m, c * (1 + m), t + k * (1 + m), t * c, t * k])

    def response(self, elevation: Floats) -> Floats:
        """Return the body's motion over elevations of the road, both (n,) at ``FINE`` Hz; it starts at rest."""
        zeros, poles, gain = signal.bilinear_zpk(*signal.tf2zpk(*self.transfer_function()), FINE)
        sections = signal.zpk2sos(zeros, poles, gain)
        settled = signal.sosfilt_zi(sections) * elevation[0]
        return signal.sosfilt(sections, elevation, zi=settled)[0]

    def ride(self, profile: Floats, distance: Floats) -> "Ride":
        """Return the body's motion.

        Args:
            profile: (m, 2) m up, under the tyres on the left and the right, every ``STEP`` m from ``-MARGIN`` on.
            distance: (n,) m, of the body's centre, at ``FINE`` Hz.
        """
        at = -MARGIN + STEP * np.arange(profile.shape[0])
        t = np.arange(distance.size) / FINE

        def elevation(way: int, side: int) -> Floats:
            """Return the elevation under a tyre at the front (1) or rear (-1), on the left (0) or right (1)."""
            return np.interp(distance + way * self.wheelbase / 2, at, profile[:, side])

        def moved(signs: tuple[int, int, int, int], over: float) -> CubicSpline:
            """Return the motion that the tyres' elevations, each with its sign, cause."""
            wheels = ((1, 0), (1, 1), (-1, 0), (-1, 1))
            total = sum(sign * elevation(*wheel) for sign, wheel in zip(signs, wheels, strict=True))
            return CubicSpline(t, self.response(np.asarray(total) / over))

        return Ride((
            moved((1, 1, 1, 1), 4), moved((1, -1, 1, -1), 2 * self.track), moved((1, 1, -1, -1), 2 * self.wheelbase)
        ))  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class Ride:
    """Heave (m, up), roll and pitch (rad) of a body over time, relative to a road without roughness."""

    splines: tuple[CubicSpline, CubicSpline, CubicSpline]  #: s -> heave, roll, pitch

    def at(self, t: Floats, derivative: int = 0) -> Floats:
        """Return heave, roll and pitch, or a derivative, (n, 3), at times (n,) s from the start on."""
        return np.stack([spline(t, derivative) for spline in self.splines], axis=-1)

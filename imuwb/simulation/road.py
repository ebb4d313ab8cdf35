"""A rough road: it moves the car's body on its suspension, and makes the car's structure vibrate."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.simulation.motion_noise import STANDING
from imuwb.simulation.road_vibration import RoadVibration
from imuwb.simulation.roughness import CLASSES, STEP, tracks, under_tyre
from imuwb.simulation.route import Route
from imuwb.simulation.suspension import FINE, MARGIN, Suspension

SMOOTHEST, ROUGHEST = 1e-7, 1e-1  #: m³
DRAWS = 0x80AD  #: keeps these draws apart from those of the route with the same seed


@dataclass(frozen=True, slots=True)
class Road:
    """A road by its roughness, the suspension of the car on it, and the vibration that it causes.

    Heave, pitch and roll of the body are true motion: they are in the truth, in the samples of the IMU, and in the motion of the
    antenna. The vibration of the structure is an error of the samples.

    Raises:
        UsageError: another class, or a density out of its range.
    """

    #: class of ISO 8608, or the density G_d(n0) of the elevation at 0.1 1/m, m³
    roughness: Literal["A", "B", "C", "D", "E"] | float = "C"
    seed: int = 0  #: of the profile
    suspension: Suspension = field(default_factory=Suspension)
    vibration: RoadVibration = field(default_factory=RoadVibration)

    def __post_init__(self) -> None:
        """Check the roughness."""
        if isinstance(self.roughness, str):
            if self.roughness not in CLASSES:
                raise UsageError(f"the class of the road is {self.roughness!r}; it must be one of {', '.join(CLASSES)}")
        elif not SMOOTHEST <= self.roughness <= ROUGHEST:
            raise UsageError(
                f"the roughness of the road is {self.roughness} m³; it must be {SMOOTHEST:g} to {ROUGHEST:g} m³ at 0.1 1/m"
            )

    @property
    def density(self) -> float:
        """Return G_d(n0), the one-sided density of the elevation at n0 = 0.1 1/m, in m³."""
        return CLASSES[self.roughness] if isinstance(self.roughness, str) else self.roughness

    def vibration_errors(
        self, speed: Floats, rate: float, bandwidths: Mapping[str, float | None], seeds: np.random.SeedSequence
    ) -> tuple[tuple[Floats, Floats], dict[str, str]]:
        """Return the vibration in the samples of an IMU, and the true parameters of the road.

        Args:
            speed: (n,) m/s, at each sample.
            rate: Hz, of the samples.
            bandwidths: Hz, of each axis's low-pass; None: no low-pass.
            seeds: for all draws.

        Returns:
            (n, 3) rad/s and (n, 3) m/s²; {name: value with its SI unit}. The densities N are the root mean squares over the axes of a
            triad and over the samples in motion.
        """
        level = self.vibration.level(speed, self.density)
        values = np.empty((2, speed.size, 3))
        squares = np.zeros(2)
        for place, (axis, seed) in enumerate(zip(AXES, seeds.spawn(len(AXES)), strict=True)):
            sensor, bandwidth = place // 3, bandwidths[axis]
            rms = (self.vibration.gyro, self.vibration.accel)[sensor]
            unit = self.vibration.sample(speed.size, rate, bandwidth, np.random.default_rng(seed))
            values[sensor, :, place % 3] = rms * level * unit
            squares[sensor] += self.vibration.density(rms, rate, bandwidth) ** 2 / 3
        in_motion = level[speed > STANDING]
        gyro, accel = np.sqrt(squares * (in_motion**2).mean() if in_motion.size else squares * 0)
        return (values[0], values[1]), {
            "road.Gd(n0)": f"{self.density:.12g} m³",
            "road.seed": str(self.seed),
            "road.vibration.gyro.N": f"{gyro:.6g} rad/s/√Hz",
            "road.vibration.accel.N": f"{accel:.6g} m/s²/√Hz",
        }

    def under(self, route: Route) -> Route:
        """Return a route on this road: the same drive, with the motion of the body on its suspension."""
        t = np.arange(math.ceil(route.duration * FINE) + 2) / FINE
        distance = route.distance(np.minimum(t, route.duration))
        rng = np.random.default_rng([self.seed, DRAWS])
        elevation = tracks(self.density, float(distance[-1]) + 2 * MARGIN + STEP, self.suspension.track, rng)
        return replace(route, ride=self.suspension.ride(under_tyre(elevation), distance))

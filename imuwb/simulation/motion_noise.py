"""Noise that the sensors of a moving vehicle have in addition to that of a bench: white noise and a random walk, by triad."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.errors import UsageError

STANDING = 0.1  #: m/s; below this speed a vehicle stands
MOST_WHITE, MOST_WALK = 10.0, 1.0  #: unit/√Hz and unit/√s


@dataclass(frozen=True, slots=True)
class MotionNoise:
    """White noise and a random walk that are added to all three axes of a triad, independently.

    The error of an axis is that of the error model, plus w + r: w is white with density N², and dr/dt is white with density K².
    A sample has the average over its interval, so w has the variance N² / dt, and its integral is a random walk of density N.
    The bandwidth of the sensor does not change w and r.

    Raises:
        UsageError: a value that is negative or too large.
    """

    white: tuple[float, float] = (1e-3, 1e-2)  #: N of the gyros, rad/s/√Hz, and of the accelerometers, m/s²/√Hz
    walk: tuple[float, float] = (0.0, 0.0)  #: K of the gyros, rad/s/√s, and of the accelerometers, m/s²/√s
    #: "moving": while the vehicle stands, w is zero and r keeps its value; "always": also while it stands
    when: Literal["moving", "always"] = "moving"

    def __post_init__(self) -> None:
        """Check the values."""
        for what, values, most in (("white", self.white, MOST_WHITE), ("walk", self.walk, MOST_WALK)):
            if not all(math.isfinite(value) and 0 <= value <= most for value in values):
                raise UsageError(
                    f"the motion noise has {what} = {values}; both values, of the gyros and of the accelerometers, must be 0 to {most:g}"
                )
        if self.when not in ("moving", "always"):
            raise UsageError(f"the motion noise acts {self.when!r}; it must be 'moving' or 'always'")

    def sample(self, moving: Booleans, dt: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Return w + r.

        Args:
            moving: (n,) whether the vehicle moves in the interval of each sample.
            dt: s, interval of the samples.
            rng: for all draws.

        Returns:
            (n, 3) rad/s and (n, 3) m/s²
        """
        acts = np.ones((moving.size, 1)) if self.when == "always" else moving[:, None].astype(float)
        white, steps, bridge = rng.standard_normal((3, moving.size, 6))
        white *= acts * np.repeat(self.white, 3) / math.sqrt(dt)
        scale = acts * np.repeat(self.walk, 3) * math.sqrt(dt)
        steps *= scale
        # As for ``RandomWalk``: the mean of both ends of a step, plus the mean of a Brownian bridge, variance 1/12.
        both = white + np.cumsum(steps, axis=0) - steps / 2 + bridge * scale / math.sqrt(12)
        return both[:, :3], both[:, 3:]

    def truth(self) -> dict[str, str]:
        """Return the true parameters: {name: value with its SI unit}."""
        return {
            "motion_noise.gyro.N": f"{self.white[0]:.12g} rad/s/√Hz",
            "motion_noise.accel.N": f"{self.white[1]:.12g} m/s²/√Hz",
            "motion_noise.gyro.K": f"{self.walk[0]:.12g} rad/s/√s",
            "motion_noise.accel.K": f"{self.walk[1]:.12g} m/s²/√s",
            "motion_noise.when": self.when,
        }

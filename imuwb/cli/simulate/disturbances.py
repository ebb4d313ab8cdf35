"""Options for what a real drive has in addition: a rough road, noise in motion, errors of the receiver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from imuwb.errors import UsageError
from imuwb.options import NOT_NEGATIVE, Form, Options

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.simulation import GnssErrors, MotionNoise, Road

#: key of --gnss-errors -> the key without which it has no effect, or none
KEYS = {
    "sigma": "", "tau": "sigma", "velocity_sigma": "", "velocity_tau": "velocity_sigma", "steps": "", "step_sigma": "steps",
    "step_time": "steps", "jitter": "", "claim": "", "velocity_claim": "",
}  # fmt: skip
DOWN = 2.0  #: sigma of a position error down over that north or east
ErrorsOfFixes: TypeAlias = Annotated[
    Mapping[str, float] | None,
    "errors of the fixes in addition to white noise; brackets give unit and default. sigma (m), tau (s; 60): a position error that "
    "is correlated in time. velocity_sigma (m/s), velocity_tau (s; 10): the same of the velocity. steps: multipath steps per minute; "
    "they move the positions by step_sigma (m; 5) for step_time (s; 10). jitter (s): sigma of the delay. claim: true sigma over the "
    "sigma that a fix states; velocity_claim: the same for velocities, if it differs. Positions err twice as much down as north or "
    "east",
    NOT_NEGATIVE,
    Form("KEY=VALUE,...", "sigma=2,tau=60,steps=0.5,claim=3"),
]


@dataclass(frozen=True)
class Disturbances(Options):
    """A rough road, and noise of the sensors in motion."""

    road: Annotated[
        Literal["A", "B", "C", "D", "E"] | None,
        "class of the road's roughness by ISO 8608, from A (smooth) to E (very rough). The car's body moves on its suspension; "
        "the true trajectory has this motion. The sensors vibrate up to 250 Hz, more at a higher speed",
    ] = None
    motion_noise: Annotated[
        tuple[float, ...] | None,
        "noise of the sensors in motion, in addition to their error model: white noise of the gyros (rad/s/√Hz) and of the "
        "accelerometers (m/s²/√Hz); then, if wanted, a random walk of the gyros (rad/s/√s) and of the accelerometers (m/s²/√s). "
        "A car has about 1e-3,1e-2,2e-5,3e-4",
        Form("N_G,N_A[,K_G,K_A]", "1e-3,1e-2 or 1e-3,1e-2,2e-5,3e-4"),
    ] = None
    noise_acts: Annotated[
        Literal["moving", "always"], "whether the noise of --motion-noise acts only while the car moves, or always"
    ] = "moving"

    def noise(self) -> MotionNoise | None:
        """Return the noise in motion, if there is any.

        Raises:
            UsageError: neither two nor four values, a value out of its range, or ``noise_acts`` without noise.
        """
        from imuwb.simulation import MotionNoise  # noqa: PLC0415 - help must not wait for numpy

        values = self.motion_noise
        if values is None:
            if self.noise_acts != "moving":
                raise UsageError(f"--noise-acts {self.noise_acts} needs --motion-noise")
            return None
        white, walk = values[:2], values[2:] or (0.0, 0.0)
        if len(white) != 2 or len(walk) != 2:  # noqa: PLR2004 - gyros and accelerometers
            raise UsageError(
                f"--motion-noise has {len(values)} values; it must have two, N_G,N_A, or four, N_G,N_A,K_G,K_A, such as 1e-3,1e-2,2e-5,3e-4"
            )
        try:
            return MotionNoise((white[0], white[1]), (walk[0], walk[1]), self.noise_acts)
        except UsageError as error:
            raise UsageError(f"--motion-noise: {error}") from error

    def surface(self, seed: int) -> Road | None:
        """Return the road, if one is given; its profile has the seed of the route."""
        from imuwb.simulation import Road  # noqa: PLC0415 - help must not wait for numpy

        return None if self.road is None else Road(self.road, seed)


def gnss_errors(values: Mapping[str, float]) -> GnssErrors:
    """Return the errors that the values of ``--gnss-errors`` state.

    Raises:
        UsageError: an unknown key, a key without the one that it belongs to, or a value out of its range.
    """
    from imuwb.simulation import GnssErrors  # noqa: PLC0415 - help must not wait for numpy

    for key in values:
        if key not in KEYS:
            other = "; the delay is --latency" if key == "latency" else ""
            raise UsageError(f"--gnss-errors has the key {key!r}; the keys are {', '.join(KEYS)}{other}")
        if KEYS[key] and KEYS[key] not in values:
            raise UsageError(f"--gnss-errors: {key} has no effect without {KEYS[key]}; give {KEYS[key]} as well")
    sigma, velocity, step = (
        values.get(key, other) for key, other in (("sigma", 0.0), ("velocity_sigma", 0.0), ("step_sigma", 5.0))
    )
    claim = values.get("claim", 1.0)
    try:
        return GnssErrors(
            position_sigma=(sigma, sigma, DOWN * sigma),
            position_time=values.get("tau", 60.0),
            velocity_sigma=(velocity, velocity, velocity),
            velocity_time=values.get("velocity_tau", 10.0),
            step_rate=values.get("steps", 0.0),
            step_sigma=(step, step, DOWN * step),
            step_duration=values.get("step_time", 10.0),
            jitter=values.get("jitter", 0.0),
            claim=(claim, values.get("velocity_claim", claim)),
        )
    except UsageError as error:
        raise UsageError(f"--gnss-errors: {error}") from error

"""A still IMU on a bench."""

import hashlib
from collections.abc import Callable

import numpy as np

from imuwb.errors import UsageError
from imuwb.log import AXES, Log, Provenance
from imuwb.simulation.sensor import LONGEST, Sensor, stamps
from imuwb.simulation.thermal import Temperature, recipe_of, temperature
from imuwb.stochastic import ImuErrorModel
from imuwb.units import STANDARD_GRAVITY


def static(
    model: ImuErrorModel,
    duration: float,
    rate: float,
    seed: int,
    *,
    celsius: float | Temperature | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Log:
    """Return the log of a level, still IMU: gravity on z with the model's deterministic terms, noise, no earth rate.

    Args:
        model: the sensor.
        duration: s.
        rate: Hz.
        seed: the same seed, model, rate and duration give the same log.
        celsius: the sensor's temperature, constant or over time; None: 25 °C.
        quantize: round to each axis's ``lsb``, and clip to its ``range``.
        bandwidth: Hz; each axis's noise goes through a Butterworth low-pass of second order. None: the
            bandwidth that the axis states, if any.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a duration, rate or bandwidth out of its range, or an axis that states no ``lsb``.
    """
    samples = duration * rate
    if not 1e-3 <= rate <= 1e6 or not 2 <= samples <= LONGEST:  # noqa: PLR2004 - a rate needs two samples
        raise UsageError(
            f"{duration} s at {rate} Hz are {samples} samples; there must be 2 to {LONGEST} samples, at 0.001 Hz to 1 MHz"
        )
    sensor = Sensor(model, temperature(celsius), quantize, bandwidth)
    n = round(samples)
    still = np.broadcast_to(np.zeros(3), (n, 3)), np.broadcast_to(np.array([0.0, 0.0, -STANDARD_GRAVITY]), (n, 3))
    imu = sensor.measure(stamps(n, rate), rate, still, np.random.SeedSequence(seed).spawn(len(AXES)), progress)
    recipe = f"{model.to_toml()}|{duration}|{rate}|{seed}|{recipe_of(celsius)}|{quantize}|{bandwidth}"
    digest = hashlib.sha256(recipe.encode()).hexdigest()
    return Log(Provenance(f"simulation of {model.name}", "simulation", f"sha256:{digest}", 0), imus=(imu,))

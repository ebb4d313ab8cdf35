"""Vibration by an engine and a road: its mean is zero, and it is no part of the true trajectory."""

import numpy as np
from scipy import signal

from imuwb.arrays import Floats
from imuwb.errors import UsageError

BAND = (5.0, 50.0)  #: Hz, of the road
ENGINE = 27.0  #: Hz, at which a four-cylinder engine fires when it idles
ENGINE_SHARE = 0.5  #: share of the engine in the variance
ROTATION = 0.01  #: rad/s for each m/s²
LOWEST_RATE = 60.0  #: Hz, at which the engine is still below half the rate
STRONGEST = 100.0  #: m/s²


def vibration(count: int, rate: float, strength: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return vibration: broad-band from 5 to 50 Hz (or 0.45 of the rate), and the engine's line.

    Args:
        count: samples.
        rate: Hz.
        strength: m/s², rms of each accelerometer axis; a gyro's is 0.01 rad/s for each m/s².
        rng: for all draws.

    Returns:
        (n, 3) rad/s and (n, 3) m/s², FRD

    Raises:
        UsageError: a strength out of its range, or a rate too low to show the engine.
    """
    if not 0 <= strength <= STRONGEST or rate < LOWEST_RATE:
        raise UsageError(
            f"the vibration is {strength} m/s² at {rate} Hz; it must be 0 to {STRONGEST:g} m/s², at {LOWEST_RATE:g} Hz or more"
        )
    sections = signal.butter(4, (BAND[0], min(BAND[1], 0.45 * rate)), "bandpass", fs=rate, output="sos")
    broad = signal.sosfilt(sections, rng.standard_normal((count, 6)), axis=0)
    broad *= np.sqrt(1 - ENGINE_SHARE) / broad.std(axis=0)
    phase = rng.uniform(0, 2 * np.pi, 6)
    line = np.sin(2 * np.pi * ENGINE / rate * np.arange(count)[:, None] + phase)
    shaking = strength * (broad + np.sqrt(2 * ENGINE_SHARE) * line)
    return ROTATION * shaking[:, :3], shaking[:, 3:]

"""Broad-band vibration of a vehicle's structure, as an inertial sensor samples it.

The vibration lies between 20 and 250 Hz. Its displacements are below micrometres, so it is no part of the true trajectory. The
sensor takes its value at the instant of each sample, after the sensor's own low-pass (``bandwidth``), as a MEMS sensor does whose
output is read at the rate of the log. What lies above half the rate is aliased. Near frequency 0 the samples then have the
density N² = sum of S(k rate) over k = ±1, ±2, ..., where S is the vibration's two-sided density after the low-pass. Over seconds the
samples act as if the sensor's white noise had this density in addition.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal

from imuwb.arrays import Floats
from imuwb.errors import UsageError

BLOCK = 1 << 16  #: samples that are drawn at once
OVERSAMPLING = 4.0  #: least ratio of the rate of computation to the end of the band
GRID = 1 << 14  #: frequencies of an integral over the spectrum
SETTLING = 1.0  #: s before the first sample
REFERENCE_SPEED = 15.0  #: m/s
REFERENCE_DENSITY = 256e-6  #: m³, class C
HIGHEST, STRONGEST = 5000.0, 100.0  #: Hz; m/s² or rad/s


@dataclass(frozen=True, slots=True)
class RoadVibration:
    """Broad-band vibration of each axis, independent, whose level grows with the speed and with the road's roughness.

    The rms of an axis at a speed v is the stated one times sqrt(idle² + G_d(n0) / 256e-6 m³ · (v / 15 m/s)^(2 exponent)). An
    exponent of 1/2 is that of a road of ISO 8608: at any frequency its excitation is proportional to the speed.

    Raises:
        UsageError: a value out of its range.
    """

    accel: float = 0.1  #: m/s², rms of an axis at 15 m/s on a road of class C, before the sensor's low-pass
    gyro: float = 0.01  #: rad/s, likewise
    band: tuple[float, float] = (20.0, 250.0)  #: Hz, Butterworth of fourth order
    exponent: float = 0.5  #: of the speed in the rms
    idle: float = 0.05  #: share of the engine, at any speed

    def __post_init__(self) -> None:
        """Check the values."""
        for what, value, most in (
            ("rms of the accelerometers", self.accel, STRONGEST), ("rms of the gyros", self.gyro, STRONGEST),
            ("exponent of the speed", self.exponent, 4.0), ("share of the engine", self.idle, 10.0),
        ):  # fmt: skip
            if not 0 <= value <= most:
                raise UsageError(f"the {what} of the vibration is {value}; it must be 0 to {most:g}")
        if not 1 <= self.band[0] < self.band[1] <= HIGHEST:
            raise UsageError(
                f"the band of the vibration is {self.band} Hz; it must rise, and be within 1 to {HIGHEST:g} Hz"
            )

    def level(self, speed: Floats, density: float) -> Floats:
        """Return the rms over the stated one, (n,), at speeds (n,) m/s on a road of G_d(n0) = ``density`` m³."""
        return np.sqrt(self.idle**2 + density / REFERENCE_DENSITY * (speed / REFERENCE_SPEED) ** (2 * self.exponent))

    def density(self, rms: float, rate: float, bandwidth: float | None) -> float:
        """Return N, the root of the samples' density near frequency 0 (unit/√Hz), of a vibration with this rms."""
        fine = self._fine(rate)
        multiples = np.arange(1.0, round(fine / rate)) * rate
        return rms * math.sqrt(self._gain(multiples, fine, bandwidth).sum() / fine)

    def sample(self, count: int, rate: float, bandwidth: float | None, rng: np.random.Generator) -> Floats:
        """Return samples of a vibration of rms 1 before the low-pass.

        Args:
            count: samples.
            rate: Hz.
            bandwidth: Hz, of the sensor's low-pass, a Butterworth of second order; None: it does not matter in the band.
            rng: for all draws.

        Returns:
            (n,)
        """
        fine = self._fine(rate)
        each = round(fine / rate)
        filters = self._filters(fine, bandwidth)
        scale = 1 / math.sqrt(self._power(fine))
        states = [np.zeros((sections.shape[0], 2)) for sections in filters]
        parts: list[Floats] = []
        settling = math.ceil(SETTLING * rate)
        for first in range(0, settling + count, BLOCK):
            values = scale * rng.standard_normal(min(BLOCK, settling + count - first) * each)
            for place, sections in enumerate(filters):
                values, states[place] = signal.sosfilt(sections, values, zi=states[place])
            parts.append(values[::each])
        return np.concatenate(parts)[settling:]

    def _fine(self, rate: float) -> float:
        """Return the rate of computation, Hz: a multiple of the sensor's rate."""
        return rate * max(1, math.ceil(OVERSAMPLING * self.band[1] / rate))

    def _filters(self, fine: float, bandwidth: float | None) -> list[Floats]:
        band = signal.butter(4, self.band, "bandpass", fs=fine, output="sos")
        if bandwidth is None or bandwidth >= fine / 2:
            return [band]
        return [band, signal.butter(2, bandwidth, fs=fine, output="sos")]

    def _power(self, fine: float) -> float:
        """Return the variance of the band-pass of white noise of variance 1."""
        at = (np.arange(GRID) + 0.5) / GRID * fine / 2
        response = signal.sosfreqz(self._filters(fine, None)[0], at, fs=fine)[1]
        return float((np.abs(response) ** 2).mean())

    def _gain(self, f: Floats, fine: float, bandwidth: float | None) -> Floats:
        """Return the variance of the samples for each of their frequencies, so that its mean over all is the variance."""
        gain = np.full(f.size, 1 / self._power(fine))
        for sections in self._filters(fine, bandwidth):
            gain *= np.abs(signal.sosfreqz(sections, f, fs=fine)[1]) ** 2
        return gain

"""The low-pass within a sensor: Butterworth, or a moving average (of 15 samples in the 3DM-GX3-25)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import signal

from imuwb.arrays import Complexes, Floats

SETTLED = 1e-7  #: remaining share of the slowest mode; earlier output is left out
HALF_POWER = 0.4429  #: argument at which sinc is 1/√2
LOST = 0.01  #: largest share of a power that is lost within the band
GRID = 1000  #: frequencies at which the band is looked for
LOW = 1e-3  #: share of the cutoff: the frequency whose phase gives the delay
MOST_ORDER = 8  #: higher orders are not stable in this form


@dataclass(frozen=True, eq=False, slots=True)
class Lowpass:
    """A causal filter: sections of second order, or a moving average."""

    sections: Floats | None  #: (s, 6); None: a moving average
    width: int  #: samples, width of the moving average
    rate: float  #: Hz
    cutoff: float  #: Hz, -3 dB
    delay: float  #: s, group delay at low frequencies
    settling: int  #: samples until the output follows a step to a millionth

    def apply(self, values: Floats) -> Floats:
        """Return the output for (n, k) samples, without those before it has settled."""
        if self.sections is None:
            sums = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), values - values[0]]), axis=0)
            return (sums[self.width :] - sums[: -self.width]) / self.width + values[0]
        start = signal.sosfilt_zi(self.sections)[:, :, None] * values[0]
        return signal.sosfilt(self.sections, values, axis=0, zi=start)[0][self.settling :]

    @property
    def band(self) -> float:
        """Return the frequency, Hz, up to which at least 99 % of a power passes."""
        frequency = np.linspace(0.0, self.cutoff, GRID)
        power = np.abs(self.response(frequency)) ** 2
        return float(frequency[np.argmax(power < 1 - LOST) - 1])

    def response(self, frequency: Floats) -> Complexes:
        """Return the response at frequencies in Hz."""
        w = 2 * np.pi * frequency / self.rate
        if self.sections is None:
            return signal.freqz(np.full(self.width, 1 / self.width), worN=w)[1]
        return signal.sosfreqz(self.sections, worN=w)[1]


def design_lowpass(
    rate: float, cutoff: float, kind: Literal["butterworth", "moving-average"] = "butterworth", order: int = 2
) -> Lowpass:
    """Return a causal low-pass.

    Args:
        rate: Hz.
        cutoff: Hz, where the gain is -3 dB; a moving average gets the width nearest to it.
        kind: kind of filter.
        order: order of a Butterworth filter.

    Raises:
        ValueError: a cutoff that is not between 0 and half the rate, or an order that is not 1 to 8.
    """
    if not 0 < cutoff < rate / 2:
        raise ValueError(
            f"the cutoff is {cutoff:g} Hz at a rate of {rate:g} Hz; it must be above 0 and below half the rate, {rate / 2:g} Hz"
        )
    if not 1 <= order <= MOST_ORDER:
        raise ValueError(f"the order is {order}; it must be 1 to {MOST_ORDER}")
    if kind == "moving-average":
        width = round(HALF_POWER * rate / cutoff)
        if width < 2:  # noqa: PLR2004 - one sample is no average
            raise ValueError(
                f"a moving average of {cutoff:g} Hz at a rate of {rate:g} Hz would have one sample; its cutoff must be at most {HALF_POWER * rate / 1.5:.3g} Hz"
            )
        return Lowpass(None, width, rate, HALF_POWER * rate / width, (width - 1) / 2 / rate, width - 1)
    sections = signal.butter(order, cutoff, fs=rate, output="sos")
    slowest = float(np.abs(signal.butter(order, cutoff, fs=rate, output="zpk")[1]).max())
    settling = int(np.ceil(np.log(SETTLED) / np.log(slowest))) + order if slowest > 0 else order
    low = LOW * cutoff
    phase = float(np.angle(signal.sosfreqz(sections, worN=[2 * np.pi * low / rate])[1][0]))
    return Lowpass(sections, 0, rate, cutoff, -phase / (2 * np.pi * low), settling)

"""The low-pass that a sensor has inside: Butterworth, or a moving average (the 3DM-GX3-25's, 15 samples wide)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy import signal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

SETTLED = 1e-6  #: of a step; what is not yet settled is left out


@dataclass(frozen=True, eq=False, slots=True)
class Lowpass:
    """A causal filter."""

    b: Floats
    a: Floats
    rate: float  #: Hz
    cutoff: float  #: Hz, -3 dB
    delay: float  #: s, group delay at low frequencies
    settling: int  #: samples after which a step is followed

    def apply(self, values: Floats) -> Floats:
        """Return the output for (n, k) samples, those before it has settled left out."""
        zi = signal.lfilter_zi(self.b, self.a) if max(self.a.size, self.b.size) > 1 else np.zeros(0)
        start = zi[:, None] * values[:1] if zi.size else None
        out = signal.lfilter(self.b, self.a, values, axis=0, zi=start)[0] if start is not None else values
        return out[self.settling :]

    def response(self, frequency: Floats) -> NDArray[np.complex128]:
        """Return the response at frequencies in Hz."""
        return signal.freqz(self.b, self.a, worN=2 * np.pi * frequency / self.rate)[1]


def design_lowpass(
    rate: float, cutoff: float, kind: Literal["butterworth", "moving-average"] = "butterworth", order: int = 2
) -> Lowpass:
    """Return a causal low-pass.

    Args:
        rate: Hz.
        cutoff: Hz, -3 dB. A moving average gets the width whose -3 dB lies nearest.
        kind: of filter.
        order: of a Butterworth filter.

    Raises:
        ValueError: a cutoff that is not between 0 and half the rate, or an order that is not 1 to 8.
    """
    if not 0 < cutoff < rate / 2:
        message = f"a bandwidth of {cutoff:g} Hz at a rate of {rate:g} Hz: it must be above 0 and below half the rate, {rate / 2:g} Hz"
        raise ValueError(message)
    if not 1 <= order <= 8:  # noqa: PLR2004 - more are not stable in this form
        message = f"order {order}; it must be 1 to 8"
        raise ValueError(message)
    if kind == "moving-average":
        width = max(round(0.4429 * rate / cutoff), 1)  # sinc(0.4429) = 1/√2
        return Lowpass(np.full(width, 1 / width), np.ones(1), rate, cutoff, (width - 1) / 2 / rate, width - 1)
    b, a = signal.butter(order, cutoff, fs=rate)
    step = np.abs(signal.lfilter(b, a, np.ones(int(20 * order * rate / cutoff) + 2)) - 1)
    late = np.flatnonzero(step > SETTLED)
    tiny = 1e-4 * rate
    delay = float(signal.group_delay((b, a), w=[tiny], fs=rate)[1][0]) / rate
    return Lowpass(b, a, rate, cutoff, delay, int(late[-1]) + 1 if late.size else 0)

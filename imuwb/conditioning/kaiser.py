"""Linear-phase low-pass filters with Kaiser's window (El-Diasty, 2.3, eq. 14 to 17).

As printed, eq. 17 has A_pass where A_stop belongs in delta_stop, and eq. 15 k = 0 in its second branch; here is Kaiser's own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft, signal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LONGEST = 1_000_001  #: taps
GRID = 128  #: frequencies a tap at which the gain is checked
MARGIN = 0.98  #: of the gain allowed in the stop band, for what lies between them


@dataclass(frozen=True, eq=False, slots=True)
class KaiserFilter:
    """A symmetric filter of odd length."""

    taps: Floats  #: (2 d + 1,)
    rate: float  #: Hz
    cutoff: float  #: Hz, midway between pass and stop band: -6 dB
    f_pass: float  #: Hz
    f_stop: float  #: Hz
    beta: float  #: of the window

    @property
    def delay(self) -> float:
        """Return the group delay, s."""
        return (self.taps.size - 1) / 2 / self.rate

    def response(self, frequency: Floats) -> NDArray[np.complex128]:
        """Return the response of the causal filter at frequencies in Hz."""
        return signal.freqz(self.taps, worN=2 * np.pi * frequency / self.rate)[1]

    def autocorrelation(self, lags: int) -> Floats:
        """Return the normalised autocorrelation, at lags 0, 1, ..., of white noise behind the filter."""
        full = signal.correlate(self.taps, self.taps)[self.taps.size - 1 :]
        full = np.append(full, np.zeros(max(lags + 1 - full.size, 0)))
        return full[: lags + 1] / full[0]


def design_kaiser(
    rate: float, f_pass: float, f_stop: float, a_stop: float = 100.0, a_pass: float = 0.0001
) -> KaiserFilter:
    """Return the shortest odd low-pass that Kaiser's formulas give.

    Args:
        rate: Hz.
        f_pass: Hz, up to which the gain is 1 within ``a_pass``.
        f_stop: Hz, from which on it is below ``a_stop``.
        a_stop: dB.
        a_pass: dB, ripple from peak to peak.

    Raises:
        ValueError: bands that do not rise to at most the Nyquist frequency, or attenuations that are not positive.
    """
    if not 0 < f_pass < f_stop <= rate / 2 or not (a_stop > 0 and a_pass > 0):
        message = (
            f"f_pass {f_pass:g} Hz, f_stop {f_stop:g} Hz at a rate of {rate:g} Hz, a_stop {a_stop:g} dB, a_pass {a_pass:g} dB: "
            f"it must be 0 < f_pass < f_stop <= {rate / 2:g} Hz (half the rate), and both attenuations positive"
        )
        raise ValueError(message)
    ripple = 10 ** (a_pass / 20)
    delta = min((ripple - 1) / (ripple + 1), 10 ** (-a_stop / 20))
    attenuation = -20 * np.log10(delta)
    beta = float(signal.kaiser_beta(attenuation))
    width = (f_stop - f_pass) / rate
    # Kaiser's length is an estimate, up to a decibel short: the filter is lengthened until it keeps its promise.
    size = int(np.ceil((attenuation - 7.95) / (14.36 * width) if attenuation > 21 else 0.9222 / width)) | 1  # noqa: PLR2004 - Kaiser's
    if size > LONGEST:
        message = f"the filter would have {size} taps; widen the transition from {f_pass:g} to {f_stop:g} Hz"
        raise ValueError(message)
    cutoff = (f_pass + f_stop) / 2
    while True:
        taps = signal.firwin(size, cutoff, window=("kaiser", beta), fs=rate)
        edges = np.array([f_pass, f_stop])
        gain = np.append(
            np.abs(fft.rfft(taps, GRID * size)), np.abs(signal.freqz(taps, worN=2 * np.pi * edges / rate)[1])
        )
        f = np.append(np.arange(gain.size - 2) * rate / (GRID * size), edges)
        inside = gain[f <= f_pass]
        kept = (
            gain[f >= f_stop].max(initial=0.0) <= MARGIN * 10 ** (-a_stop / 20)
            and inside.max() <= inside.min() * ripple
        )
        if kept or size > LONGEST:
            return KaiserFilter(taps, rate, cutoff, f_pass, f_stop, beta)
        size += 2


def filtered(values: Floats, taps: Floats) -> Floats:
    """Return (n + 1 - taps) values: each where the filter lies on samples only.

    Args:
        values: (n,) or (n, k) samples.
        taps: (t,), at most n.
    """
    if values.ndim == 1:
        return signal.oaconvolve(values, taps, mode="valid")
    return np.stack(
        [signal.oaconvolve(column, taps, mode="valid") for column in np.ascontiguousarray(values.T)], axis=1
    )

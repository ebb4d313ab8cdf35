"""Linear-phase low-pass filters with Kaiser's window (El-Diasty, 2.3, eq. 14 to 17).

The printed eq. 17 has A_pass in delta_stop, where A_stop is correct, and the printed eq. 15 has k = 0 in its second branch.
This module uses Kaiser's own formulas.
"""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from imuwb.arrays import Complexes, Floats
from imuwb.conditioning.streams import Change

LONGEST = 400_001  #: largest number of taps
LOBES = 8  #: number of lobes of the response on each side of the transition, in which the gain is checked
GRID = 1024  #: number of frequencies in these lobes
DEEPEST = 200.0  #: dB; with more, rounding fills the stop band
MARGIN = 0.98  #: share of the gain allowed in the stop band; the rest is for frequencies between those that are checked


@dataclass(frozen=True, eq=False, slots=True)
class KaiserFilter:
    """A symmetric filter of odd length."""

    taps: Floats  #: (2 d + 1,)
    rate: float  #: Hz
    cutoff: float  #: Hz, midway between pass and stop band: -6 dB
    f_pass: float  #: Hz
    f_stop: float  #: Hz
    beta: float  #: beta of the window

    @property
    def delay(self) -> float:
        """Return the group delay, s."""
        return (self.taps.size - 1) / 2 / self.rate

    def response(self, frequency: Floats) -> Complexes:
        """Return the response of the causal filter at frequencies in Hz."""
        return signal.freqz(self.taps, worN=2 * np.pi * frequency / self.rate)[1]

    def autocorrelation(self, lags: int) -> Floats:
        """Return the normalised autocorrelation, at lags 0, 1, ..., of white noise after the filter."""
        full = signal.correlate(self.taps, self.taps)[self.taps.size - 1 :]
        full = np.append(full, np.zeros(max(lags + 1 - full.size, 0)))
        return full[: lags + 1] / full[0]


def design_kaiser(
    rate: float, f_pass: float, f_stop: float, a_stop: float = 100.0, a_pass: float = 0.0001
) -> KaiserFilter:
    """Return the shortest low-pass of odd length that Kaiser's formulas give.

    Args:
        rate: Hz.
        f_pass: Hz, end of the pass band, where the gain is 1 within ``a_pass``.
        f_stop: Hz, beginning of the stop band, where the gain is below ``a_stop``.
        a_stop: dB, attenuation.
        a_pass: dB, ripple from peak to peak.

    Raises:
        ValueError: bands that do not rise to at most the Nyquist frequency, or attenuations that are not positive.
    """
    if not 0 < f_pass < f_stop <= rate / 2 or not (0 < a_stop <= DEEPEST and 0 < a_pass < DEEPEST):
        raise ValueError(
            f"f_pass {f_pass:g} Hz, f_stop {f_stop:g} Hz at a rate of {rate:g} Hz, a_stop {a_stop:g} dB, a_pass {a_pass:g} dB: "
            f"the rule is 0 < f_pass < f_stop <= {rate / 2:g} Hz (half the rate), and attenuations above 0 and at most {DEEPEST:g} dB"
        )
    ripple = 10 ** (a_pass / 20)
    delta = min((ripple - 1) / (ripple + 1), 10 ** (-a_stop / 20))
    attenuation = -20 * np.log10(delta)
    beta = float(signal.kaiser_beta(attenuation))
    width = (f_stop - f_pass) / rate
    # Kaiser's length is an estimate; the attenuation may lack a decibel. The filter grows until it keeps its bands.
    size = int(np.ceil((attenuation - 7.95) / (14.36 * width) if attenuation > 21 else 0.9222 / width)) | 1  # noqa: PLR2004 - Kaiser's
    cutoff = (f_pass + f_stop) / 2
    while size <= LONGEST:
        taps = signal.firwin(size, cutoff, window=("kaiser", beta), fs=rate)
        if _keeps(taps, rate, (f_pass, f_stop), ripple, 10 ** (-a_stop / 20)):
            return KaiserFilter(taps, rate, cutoff, f_pass, f_stop, beta)
        size += max(2, size // 200 * 2)
    raise ValueError(
        f"the filter needs more than {LONGEST} taps; widen the transition from {f_pass:g} to {f_stop:g} Hz"
    )


def _keeps(taps: Floats, rate: float, edges: tuple[float, float], ripple: float, stop: float) -> bool:
    """Return whether a filter keeps its bands: gain and ripple are worst within a few lobes of the edges."""
    reach = LOBES * rate / taps.size
    low, high = max(edges[0] - reach, 0.0), min(edges[1] + reach, rate / 2)
    inside, outside = (
        np.abs(signal.zoom_fft(taps, ends, GRID, fs=rate, endpoint=True))
        for ends in ((low, edges[0]), (edges[1], high))
    )
    return bool(outside.max() <= MARGIN * stop and max(inside.max(), 1.0) <= min(inside.min(), 1.0) * ripple)


def filtered(values: Floats, taps: Floats) -> Floats:
    """Return filtered values, (n + 1 - taps): those for which all taps lie on samples.

    Args:
        values: (n,) or (n, k) samples.
        taps: (t,), at most n.
    """
    if values.ndim == 1:
        return signal.oaconvolve(values, taps, mode="valid")
    return np.stack(
        [signal.oaconvolve(column, taps, mode="valid") for column in np.ascontiguousarray(values.T)], axis=1
    )


def fir_change(kaiser: KaiserFilter, *, causal: bool, step: int = 1) -> Change:
    """Return a filter as a change of streams; every ``step``-th value is kept.

    Args:
        kaiser: symmetric, of odd length.
        causal: whether a value has the time of the last sample that it depends on, or of the middle one.
        step: one of this many samples is kept.
    """
    size = kaiser.taps.size
    first, last = (size - 1, 0) if causal else (size // 2, size // 2)
    return Change(lambda values: filtered(values, kaiser.taps)[::step], size, first, last, step)

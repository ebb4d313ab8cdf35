"""Wavelet denoising: details below a threshold are taken as noise (Quinchia, 4.5 and 5.6).

Level k keeps frequencies below rate/2^(k+1). Stein's unbiased risk estimate (SURE; Donoho and Johnstone 1995) gives each level
the threshold with the least expected error; the common libraries do not have it. What the noise is taken to be is a choice of its
own (``Scale``): each level's median of magnitudes, that of the finest level for all, or 1 in the unit of the samples. The last one
(MATLAB's "one") makes the threshold of SI data larger than every detail, so that all are removed. Quinchia's table 2 can only have
been made so: its AR models then say what the low-pass of the wavelet does, not what the sensor does.
"""

import warnings
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pywt

from imuwb.arrays import Floats
from imuwb.compiled import compiled

Rule = Literal["sure", "universal", "bayes", "all", "none"]
Shrinkage = Literal["soft", "hard"]
Scale = Literal["level", "first", "none"]
MEDIAN = 0.6745  #: median magnitude of a standard normal value
WAVELETS = 16  #: number of wavelets of the last level in a sliding window
BATCH = 1 << 22  #: samples in the windows that are denoised at once
CLEAR = 4.0  #: standard errors by which a density is above the noise, where there is motion
MOTION_SHARE = 0.99  #: share of the motion's energy within a measured band


@dataclass(frozen=True, eq=False, slots=True)
class Denoised:
    """A denoised series."""

    values: Floats  #: (n,)
    thresholds: tuple[float, ...]  #: unit, finest level first


def band_limit(rate: float, level: int) -> float:
    """Return the frequency below which level k keeps everything, rate/2^(k+1), Hz (Quinchia, 5.6)."""
    return rate / 2.0 ** (level + 1)


def level_of_band(rate: float, band: float) -> int:
    """Return the deepest level that keeps frequencies up to ``band`` Hz; 0 where level 1 does not."""
    return max(int(np.floor(np.log2(rate / band) - 1 + 1e-9)), 0)


def measured_band(values: Floats, rate: float, noise: float) -> float:
    """Return the frequency below which 99 % of a moving record's energy above its white noise lies, Hz.

    Args:
        values: (n,) samples.
        rate: Hz.
        noise: white-noise density N of the sensor, unit/√Hz (two-sided).
    """
    from scipy import signal  # noqa: PLC0415 - not needed to denoise

    size = min(1 << 12, values.size)
    f, density = signal.welch(values, rate, "hann", size, detrend="linear")
    # Only densities clearly above the noise are motion: the scatter of the others would add up.
    segments = max(2 * values.size / size - 1, 1.0)
    excess = density[1:] - 2 * noise**2
    energy = np.cumsum(np.where(excess > CLEAR / segments**0.5 * 2 * noise**2, excess, 0.0))
    if energy[-1] == 0:
        return float(f[1])
    return float(f[1:][np.searchsorted(energy, MOTION_SHARE * energy[-1])])


def denoise(
    values: Floats,
    level: int,
    wavelet: str = "db4",
    rule: Rule = "sure",
    shrinkage: Shrinkage = "soft",
    scale: Scale = "level",
) -> Denoised:
    """Return a series denoised as a whole: every value depends on all later ones.

    Args:
        values: (n,) evenly spaced samples.
        level: level of decomposition; 0 leaves the series as it is.
        wavelet: a discrete wavelet of PyWavelets.
        rule: ``"sure"``, ``"universal"`` (σ√(2 ln n)), ``"bayes"`` (σ²/σ_x), ``"all"`` (no detail is kept), ``"none"``.
        shrinkage: ``"soft"`` or ``"hard"``.
        scale: sigma of the noise: of each level (``"level"``), of the finest one (``"first"``), or 1 unit (``"none"``).

    Raises:
        ValueError: an unknown wavelet, or a series too short for the level.
    """
    check(values.shape[-1], level, wavelet)
    if level == 0:
        return Denoised(values, ())
    # Level by level, so that of a long series no more arrays stand in memory than a level needs.
    details: list[Floats] = []
    thresholds: list[float] = []
    whole, sigma = values, None
    for _ in range(level):  # finest first
        whole, detail = pywt.dwt(whole, wavelet)
        if not thresholds:
            sigma = _sigma_of(detail, scale)
        thresholds.append(threshold(detail, rule, sigma))
        _shrink(detail, thresholds[-1], shrinkage)
        details.append(detail)
        del detail
    while details:
        whole = pywt.idwt(whole[: details[-1].size], details.pop(), wavelet)
    return Denoised(np.ascontiguousarray(whole[: values.size]), tuple(thresholds))


def denoise_causally(
    values: Floats,
    level: int,
    wavelet: str = "db4",
    rule: Rule = "sure",
    shrinkage: Shrinkage = "soft",
    scale: Scale = "level",
    hop: int = 1,
) -> Denoised:
    """Return a series denoised in a sliding window: no value depends on one more than ``hop - 1`` samples later.

    Each window of 16 wavelets of the last level is denoised by itself, and its last ``hop`` values are kept. The first
    windows are shorter: they begin with the series.

    Args:
        values: (n,) evenly spaced samples.
        level: level of decomposition.
        wavelet: a discrete wavelet of PyWavelets.
        rule: as in ``denoise``.
        shrinkage: as in ``denoise``.
        scale: as in ``denoise``; the finest level is that of each window.
        hop: samples between windows; the output is late by ``hop - 1`` samples at most.

    Raises:
        ValueError: as in ``denoise``, or a hop longer than a window.
    """
    check(values.size, level, wavelet)
    if level == 0:
        return Denoised(values, ())
    if not 1 <= hop <= WAVELETS * 2**level:
        raise ValueError(
            f"hop is {hop} samples; it must be 1 to {WAVELETS * 2**level}, the length of a window at level {level}"
        )
    length = min(WAVELETS * 2**level, values.size)
    out = np.empty_like(values)
    out[:length] = values[:length]  # where a first window is too short for the level
    for end in range(hop, length, hop):
        if end >= _shortest(level, wavelet):
            out[end - hop : end] = denoise(values[:end], level, wavelet, rule, shrinkage, scale).values[-hop:]
    ends = np.arange(length, values.size + 1, hop)
    if ends.size == 0 or ends[-1] != values.size:
        ends = np.append(ends, values.size)
    windows = np.lib.stride_tricks.sliding_window_view(values, length)
    for start in range(0, ends.size, max(BATCH // length, 1)):
        batch = ends[start : start + max(BATCH // length, 1)]
        last = _denoised_windows(windows[batch - length], level, wavelet, rule, shrinkage, scale)[:, -hop:]
        out[(batch[:, None] - hop + np.arange(hop)).clip(0)] = last
    return Denoised(out, ())


def _denoised_windows(
    windows: Floats, level: int, wavelet: str, rule: Rule, shrinkage: Shrinkage, scale: Scale
) -> Floats:
    """Return windows, (w, n), each denoised by itself."""
    approximation, *details = _parted(windows, wavelet, level)
    sigmas = [_sigma_of(finest, scale) for finest in details[-1]]
    for detail in details:
        limits = [threshold(row, rule, sigma) for row, sigma in zip(detail, sigmas, strict=True)]
        _shrink(detail, np.array(limits)[:, None], shrinkage)
    return pywt.waverec([approximation, *details], wavelet, axis=-1)[:, : windows.shape[1]]


def check(n: int, level: int, wavelet: str) -> None:
    """Raise ValueError unless a series of n samples has so many levels of a wavelet."""
    if wavelet not in pywt.wavelist(kind="discrete"):
        raise ValueError(
            f"there is no discrete wavelet {wavelet!r}; there are db1 ... db38, sym2 ... sym20, coif1 ... coif17, bior..., dmey, haar"
        )
    if level < 0 or n < _shortest(level, wavelet):
        most = pywt.dwt_max_level(n, wavelet)
        raise ValueError(f"the level is {level}; for {n} samples and {wavelet} it must be 0 to {most}")


def _shortest(level: int, wavelet: str) -> int:
    return (pywt.Wavelet(wavelet).dec_len - 1) * 2**level if level else 1


def _parted(values: Floats, wavelet: str, level: int) -> list[Floats]:
    with warnings.catch_warnings():
        # A window may be just long enough: the effects of its edges reach into it.
        warnings.simplefilter("ignore", UserWarning)
        return list(pywt.wavedec(values, wavelet, level=level, axis=-1))


def _sigma_of(finest: Floats, scale: Scale) -> float | None:
    """Return the sigma of the noise that all levels have; None where each has its own."""
    if scale == "level":
        return None
    return 1.0 if scale == "none" else float(np.median(np.abs(finest))) / MEDIAN


def threshold(detail: Floats, rule: Rule, sigma: float | None = None) -> float:
    """Return the threshold of one level's details; sigma is that of its noise, or None: from their median magnitude."""
    if rule in ("all", "none"):
        return np.inf if rule == "all" else 0.0
    size = np.abs(detail)
    size.sort()
    if sigma is None:
        half = size.size // 2
        sigma = float(size[half] if size.size % 2 else (size[half - 1] + size[half]) / 2) / MEDIAN
    if sigma == 0:
        return 0.0
    if rule == "universal":
        return sigma * float(np.sqrt(2 * np.log(detail.size)))
    if rule == "bayes":
        rest = float(np.mean(detail**2)) - sigma**2
        return sigma**2 / rest**0.5 if rest > 0 else float(size[-1])
    size /= sigma
    return sigma * sure_threshold(size)


@compiled()
def sure_threshold(size: Floats) -> float:  # pragma: no cover - compiled
    """Return the soft threshold with the least Stein risk for details of unit noise.

    risk(t) = n - 2 #(|x| <= t) + sum min(x², t²), evaluated at the magnitudes.

    Args:
        size: (n,) magnitudes, rising.
    """
    total = best = 0.0
    least = np.inf
    for i in range(size.size):
        larger = float(size.size - 1 - i)
        square = size[i] * size[i]
        total += square
        risk = total + square * larger + 2.0 * larger  # 2 n less than the risk
        if risk < least:
            least, best = risk, size[i]
    return best


def _shrink(detail: Floats, limit: float | Floats, shrinkage: Shrinkage) -> None:
    """Take the threshold off the magnitudes (soft), or put those below it to 0 (hard), in place."""
    if shrinkage == "hard":
        detail[np.abs(detail) <= limit] = 0.0
        return
    detail -= np.clip(detail, -np.asarray(limit), limit)

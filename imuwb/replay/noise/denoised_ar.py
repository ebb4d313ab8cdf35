"""The autoregressive processes of the filters 15AR and 27AR, of denoised static samples (Quinchia, 5.3 and table 2).

Table 2 can be made again in one way only: db4 with the levels of table 7, and a SURE threshold of details that are not scaled by
their noise. In SI units all details of a static record lie below it, and all are removed. Then such a process shows how the low-pass
filter acts at the sampling rate, and not how the sensor's error decays: its poles are those of the filter, and its beta0² is
proportional to the white noise that the filter lets through. It is valid at its own step only.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pywt

from imuwb.arrays import Floats, alone
from imuwb.axes import Axis, axes_of, for_each
from imuwb.conditioning import denoise
from imuwb.identification import burg
from imuwb.log import AXES, ImuStream
from imuwb.stochastic import Autoregressive, ImuErrorModel, RateRamp, Sum

ORDERS = (1, 3)  #: of 15AR and 27AR
WAVELET = "db4"
LEVELS = {"gyro_x": 7, "gyro_y": 7, "gyro_z": 7, "accel_x": 7, "accel_y": 6, "accel_z": 6}  #: Quinchia, table 7
SAMPLES = 1 << 18  #: of the grid of frequencies
RECORD = 2_520_000  #: samples of the record whose expectation is taken: 7 h at 100 Hz, as the paper's
SLOW = 80  #: frequencies below the grid
OWN_STEP = 0.01  #: two clocks of one rate differ by less than this share


def fitted(samples: Floats, axis: str, interval: float) -> tuple[Autoregressive, ...]:
    """Return the processes of both orders of an axis, by Burg's method from denoised samples.

    Args:
        samples: (n,) static samples without gaps.
        axis: ``gyro_x`` ... ``accel_z``; it chooses the level of denoising.
        interval: s.

    Raises:
        ValueError: too few samples for the level, a constant channel, or a process that is not stable.
    """
    fit = burg(denoise(samples, LEVELS[axis], WAVELET, scale="none").values, max(ORDERS))
    return tuple(Autoregressive(tuple(fit.alpha[p]), float(fit.variance[p]) ** 0.5, interval) for p in ORDERS)


def of_static(imu: ImuStream) -> tuple[dict[str, tuple[Autoregressive, ...]], dict[str, str]]:
    """Return the processes of each axis of a static record, and the axes that allow none with the reason."""

    def one(axis: Axis) -> tuple[Autoregressive, ...] | str:
        try:
            with alone(axis.values.size):
                return fitted(axis.longest, axis.name, axis.clock.interval)
        except ValueError as error:
            return str(error)

    own = for_each(axes_of(imu), one)
    return {a: p for a, p in own.items() if not isinstance(p, str)}, {
        a: p for a, p in own.items() if isinstance(p, str)
    }


def with_autoregressive(model: ImuErrorModel, found: Mapping[str, tuple[Autoregressive, ...]]) -> ImuErrorModel:
    """Return an error model that keeps these processes for 15AR and 27AR, in place of its own ones."""
    axes = {
        name: replace(axis, autoregressive=found[name]) if name in found else axis for name, axis in model.axes.items()
    }
    return replace(model, axes=axes)


@lru_cache(maxsize=64)
def expected(processes: Sum, level: int, interval: float) -> tuple[Autoregressive, ...]:
    """Return the processes of both orders that a long record of a sum of processes has in expectation, without drawing one.

    Denoising that removes all details of a level is a projection. The mean autocovariance of its output follows from the
    spectrum of the samples and the wavelet's scaling filter, and Levinson's recursion gives the processes. They agree with those of
    records that are drawn; a record of 7 h has a beta0² that scatters by 1 to 2 %.

    Args:
        processes: of an axis.
        level: of decomposition.
        interval: s.

    Raises:
        ValueError: the sum has no noise.
    """
    c0, drop = _autocovariance(processes, level, interval)
    if c0 <= 0:
        raise ValueError("the error model has no noise from which an AR process follows")
    made: list[Autoregressive] = []
    alpha, variance = np.zeros(0), c0
    for order in range(1, max(ORDERS) + 1):
        # c(k) + sum alpha_j c(k - j), with c = c0 - drop
        rest = (1 + alpha.sum()) * c0 - drop[order] - alpha @ drop[order - 1 : 0 : -1]
        reflection = -rest / variance
        alpha = np.append(alpha, 0.0) + reflection * np.append(alpha[::-1], 1.0)
        variance *= 1 - reflection**2
        if order in ORDERS:
            made.append(Autoregressive(tuple(alpha), float(variance) ** 0.5, interval))
    return tuple(made)


def _autocovariance(processes: Sum, level: int, interval: float) -> tuple[float, Floats]:
    """Return the variance after denoising, without the mean, and by how much lower the autocovariance is at the first lags."""
    n, shifts = SAMPLES, 2**level
    f = np.arange(1, n // 2 + 1) / n  # cycles per sample
    density = np.zeros(n)
    noise = Sum(tuple(term for term in processes.terms if not isinstance(term, RateRamp)))
    density[1 : n // 2 + 1] = noise.power_spectral_density(f / interval, interval)
    density[n // 2 + 1 :] = density[n // 2 - 1 : 0 : -1]
    passed = _scaling_filter(level, n)
    # The spectrum of the coefficients repeats after 1/shifts; each of its copies passes the filter again.
    coefficients = (passed * density).reshape(shifts, -1).sum(axis=0)
    power = (passed.reshape(shifts, -1) * coefficients).ravel() / shifts**2 / (n * interval)
    at = np.arange(n) / n
    # Below the grid the filter passes all, and the autocovariance does not drop within a few samples.
    slow = np.geomspace(0.5 / RECORD, 0.5 / n, SLOW) / interval
    below = 2 * float(np.trapezoid(noise.power_spectral_density(slow, interval), slow))
    drop = np.array([float(power @ (2 * np.sin(np.pi * at * k) ** 2)) for k in range(max(ORDERS) + 1)])
    return float(power.sum()) + below, drop


def _scaling_filter(level: int, n: int) -> Floats:
    """Return the squared response of the scaling filter of a level at n frequencies around the circle."""
    taps = np.zeros(n)
    low = np.asarray(pywt.Wavelet(WAVELET).dec_lo)
    taps[: low.size] = low
    one = np.abs(np.fft.fft(taps)) ** 2
    whole, at = np.ones(n), np.arange(n)
    for k in range(level):
        whole *= one[(at << k) % n]
    return whole


def at_interval(process: Autoregressive, interval: float) -> Autoregressive:
    """Return a process for another clock of the same rate: its step becomes that of the log; at another rate, the process itself."""
    same = abs(process.dt / interval - 1) < OWN_STEP
    return replace(process, dt=interval) if same else process


def levels() -> tuple[int, ...]:
    """Return the levels of table 7 in the order of the axes."""
    return tuple(LEVELS[axis] for axis in AXES)

"""The temperature of a sensor over a log, from a thermometer that lags it or leads it.

A thermometer of first order with the time constant L reads T with L dT/dt + T = that of the sensor, so the sensor's temperature is
T + L dT/dt. Where the sensor lags the thermometer, L is negative and the sensor's temperature is the reading through a low-pass of
first order with the time constant -L. A derivative amplifies the thermometer's noise, so the temperature is smoothed by a Gaussian
window; who compares it with a bias smooths the bias by the same window, so that a turn of the temperature stays where it is.
"""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from imuwb.arrays import Floats
from imuwb.identification.temperature.cosine_window import smoothed

NOISE = 0.02  #: °C; the window is so wide that the smoothed temperature has at most this noise
WIDEST = 0.01  #: share of the log; no window has a larger sigma
MOVING = 0.7  #: share of the readings that differ from the one before, above which steps do not limit a thermometer
NARROWEST = 2.0  #: blocks, smallest sigma of a window


@dataclass(frozen=True, eq=False, slots=True)
class ThermometerCurve:
    """A thermometer's readings, averaged over even blocks of a log."""

    time: Floats  #: (n,) s, middles of the blocks
    celsius: Floats  #: (n,) means
    noise: float  #: °C √s, standard deviation of a mean over one second

    @property
    def interval(self) -> float:
        """Return the length of a block, s."""
        return float(self.time[1] - self.time[0])

    def window(self, lag: float) -> float:
        """Return the sigma of the window with which the temperature at a lag has little noise, s."""
        wanted = (max(lag, 0.0) * self.noise / (2 * np.pi**0.25 * NOISE)) ** (2 / 3)
        least = NARROWEST * self.interval
        return float(min(max(wanted, least), max(WIDEST * self.interval * self.time.size, least)))

    def of_sensor(self, lag: float, window: float) -> Floats:
        """Return the sensor's temperature, (n,) °C, if the thermometer lags it by ``lag`` s, smoothed by a window (s)."""
        if lag < 0:
            # The exact low-pass of straight lines between the means; at rest where the first block begins, half a block before its mean.
            keep, early = _first_order(self.interval, -lag)
            taps = [1 - early, early - keep]
            half = (self.celsius[1] - self.celsius[0]) / 2
            first = self.celsius[0] - half * _first_order(self.interval / 2, -lag)[1]
            state = [first - taps[0] * self.celsius[0]]
            late = np.asarray(signal.lfilter(taps, [1, -keep], self.celsius, zi=state)[0], dtype=np.float64)
            return smoothed(late, self.interval, window)
        here = self.celsius + lag * np.gradient(self.celsius, self.interval)
        return smoothed(here, self.interval, window)


def _first_order(step: float, constant: float) -> tuple[float, float]:
    """Return what a low-pass of first order keeps of its state over a step (s), and what it still lacks of a straight rise by 1."""
    keep = float(np.exp(-step / constant))
    return keep, (1 - keep) * constant / step


def thermometer_curve(time: Floats, celsius: Floats, at: Floats) -> ThermometerCurve:
    """Return a thermometer's readings as means of even blocks.

    Args:
        time: (m,) s of the readings, rising.
        celsius: (m,) °C.
        at: (n,) s, middles of the blocks, even.
    """
    step = float(at[1] - at[0])
    number = np.floor((time - at[0]) / step + 0.5).astype(np.int64)
    inside = (number >= 0) & (number < at.size)
    count = np.bincount(number[inside], minlength=at.size)
    full = count > 0
    if not full.any():
        return ThermometerCurve(at, np.interp(at, time, celsius), _noise(time, celsius))
    mean = np.bincount(number[inside], celsius[inside], minlength=at.size)[full] / count[full]
    when = np.bincount(number[inside], time[inside], minlength=at.size)[full] / count[full]
    return ThermometerCurve(at, np.interp(at, when, mean), _noise(time, celsius))


def _noise(time: Floats, celsius: Floats) -> float:
    """Return the standard deviation of a mean over one second by the scatter of the readings and by their steps, °C √s."""
    if time.size < 3:  # noqa: PLR2004 - a second difference needs three readings
        return 0.0
    bends = np.abs(np.diff(celsius, 2))
    between = float(time[-1] - time[0]) / (time.size - 1)
    scatter = float(np.median(bends)) / 0.6745 / 6**0.5 * between**0.5
    every = np.abs(np.diff(celsius))
    changes = every[every > 1e-6]  # noqa: PLR2004 - °C, rounding of a conversion
    if not changes.size or changes.size > MOVING * every.size:
        return scatter
    held = float(time[-1] - time[0]) / changes.size
    return max(scatter, float(changes.min()) / 12**0.5 * held**0.5)

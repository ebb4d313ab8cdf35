"""From a log to its vibration."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from imuwb.arrays import Floats, Integers
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.sampling import sampling
from imuwb.statistics import Estimate
from scipy.stats import t as student

from imuwb_vibration.parameters import Parameters
from imuwb_vibration.result import Axis, Band, Result

FEWEST = 3  #: segments, for an interval
NEAR = 1  #: bins on each side of a line that the Hann window spreads it to


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the vibration of each axis of the first IMU.

    Raises:
        MissingDataError: no IMU, or fewer than three segments without gaps.
    """
    log = logs[0]
    imu = log.imu()
    axes: dict[str, Axis] = {}
    seconds = 0.0
    for name, (time, values) in imu.axes().items():
        rate = sampling(time).rate or 0.0
        size = round(parameters.segment * rate)
        segments = np.array(list(_segments(time, values, size)))
        if len(segments) < FEWEST:
            raise MissingDataError(
                f"{log.provenance.path}: {name} has {len(segments)} segments of {parameters.segment:g} s without gaps; {FEWEST} are needed: "
                "give a shorter --segment, or a longer log"
            )
        edges = [edge for edge in parameters.edges if edge < rate / 2]
        if not edges:
            raise MissingDataError(f"{log.provenance.path}: {name} has {rate:g} Hz; all bands begin above half of it")
        unit = "rad/s" if name.startswith("gyro") else "m/s²"
        axes[name] = _axis(segments, rate, [*edges, rate / 2], parameters.level, unit)
        seconds = max(seconds, len(segments) * size / rate)
    return Result(imu.name, parameters.level, seconds, axes)


def _segments(time: Integers, values: Floats, size: int) -> Iterator[Floats]:
    """Yield parts of ``size`` samples without a gap inside."""
    for begin, end in pairwise([0, *sampling(time).breaks, time.size]):
        for start in range(begin, end - size + 1, max(size, 1)):
            yield values[start : start + size]


def _axis(segments: Floats, rate: float, edges: list[float], level: float, unit: str) -> Axis:
    """Return the vibration of one axis from its segments, (m, n)."""
    size = segments.shape[1]
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    spectrum = np.fft.rfft((segments - segments.mean(axis=1, keepdims=True)) * window, axis=1)
    density = 2 * np.abs(spectrum) ** 2 / (rate * np.sum(window**2))
    frequency = np.arange(size // 2 + 1) * (rate / size)
    mean = density.mean(axis=0)
    bands = tuple(_band(frequency, density, mean, low, high, level, unit) for low, high in pairwise(edges))
    inside = (frequency >= edges[0]) & (frequency < edges[-1])
    total = _rms(density[:, inside].sum(axis=1) * frequency[1], level, unit)
    return Axis(bands, total, frequency, mean, len(segments))


def _band(frequency: Floats, density: Floats, mean: Floats, low: float, high: float, level: float, unit: str) -> Band:
    """Return the vibration between two frequencies; the lower edge belongs to the band."""
    inside = np.flatnonzero((frequency >= low) & (frequency < high))
    power = density[:, inside].sum(axis=1) * frequency[1]
    peak = int(inside[np.argmax(mean[inside])]) if inside.size else 0
    near = inside[np.abs(inside - peak) <= NEAR]
    whole = float(mean[inside].sum())
    share = float(mean[near].sum()) / whole if whole > 0 else 0.0
    at_edge = not inside.size or peak in (inside[0], inside[-1])
    return Band(low, high, _rms(power, level, unit), None if at_edge else float(frequency[peak]), share)


def _rms(power: Floats, level: float, unit: str) -> Estimate:
    """Return the root of a mean power with its interval, from how much the segments differ."""
    mean = float(power.mean())
    half = float(student.ppf(0.5 + level / 2, power.size - 1)) * float(power.std(ddof=1)) / power.size**0.5
    return Estimate(mean**0.5, max(mean - half, 0.0) ** 0.5, (mean + half) ** 0.5, unit=unit)

"""White noise that grows with vibration: what a sensor rectifies, and what its sampling folds down.

The vibration at a sample is the rms change of the specific force from sample to sample over the last two seconds, divided by
√2: for white vibration, its rms. It is known in an outage too, and needs no later sample. The error of a MEMS by vibration is
quadratic (vibration rectification), so its amplitude grows with the square of the level. Levels form classes of equal ratio,
and each class is a regime of the filter's tables.
"""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.navigation.filter_model import Vibration
from imuwb.navigation.measurement import Measurement

WINDOW = 2.0  #: s
RATIO = np.sqrt(2.0)  #: of the levels of two neighbouring classes
LOWEST, HIGHEST = -4, 4  #: classes below and above the reference; what lies outside counts as the last class


def vibration_levels(measurement: Measurement) -> Floats:
    """Return the level of vibration at each sample, (n,) m/s²."""
    samples = measurement.samples
    force = samples.velocity / samples.interval[:, None]
    power = (np.diff(force, axis=0, prepend=force[:1]) ** 2).sum(axis=1) / 2
    count = min(max(round(WINDOW / measurement.interval), 2), power.size)
    total = np.cumsum(power)
    total[count:] -= total[:-count].copy()
    return np.sqrt(np.maximum(total, 0.0) / np.minimum(np.arange(1, power.size + 1), count))


def usual_vibration(measurement: Measurement) -> float:
    """Return the level at which noise that grows with vibration has its mean density over the record, m/s²."""
    return float((vibration_levels(measurement) ** 4).mean() ** 0.25)


def with_classes(measurement: Measurement, vibration: Vibration) -> Measurement:
    """Return a measurement whose regimes are divided into classes of vibration."""
    level = vibration_levels(measurement) / vibration.reference
    with np.errstate(divide="ignore"):
        place = np.log(level) / np.log(RATIO)
    own = np.clip(np.rint(place), LOWEST, HIGHEST).astype(np.int64) - LOWEST
    factors = RATIO ** np.arange(LOWEST, HIGHEST + 1)
    regime, celsius = measurement.samples.regime, measurement.celsius
    # The regime of bridged gaps, the last one, stays as it is.
    classes, plain = factors.size, len(celsius) - (measurement.gap_noise is not None)
    divided = np.where(regime < plain, regime * classes + own, plain * classes)
    temperatures = (*(t for t in celsius[:plain] for _ in range(classes)), *celsius[plain:])
    levels = (*np.tile(factors, plain).tolist(), *(1.0 for _ in celsius[plain:]))
    return replace(
        measurement, samples=measurement.samples._replace(regime=divided), celsius=temperatures, vibration=levels
    )

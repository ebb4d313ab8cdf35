"""Whether sensors differ with heavier tails than normal ones: sensors that are far from the mean then belong to the family."""

from collections.abc import Sequence

import numpy as np

from imuwb.identification.family.members import Members
from imuwb.identification.family.random_effects import RandomEffects
from imuwb.statistics.distributions import scipy

FEWEST = 20  #: sensors
LEAST = 1e-300  #: probability
SHARE = 0.5  #: of the spread between sensors in the variance of their means, below which the errors of the logs hide its tails


def heavy_tails(sensors: Members, family: RandomEffects) -> float | None:
    """Return the probability that normal sensors have so large a kurtosis; None: too few sensors, or too uncertain ones.

    The kurtosis, less that of the errors of the logs, is compared with its distribution in normal samples (Anscombe and Glynn,
    Biometrika 70, 1983).

    Args:
        sensors: k sensors of the family, without those outside.
        family: mean and spread of these.
    """
    n, variance = sensors.mean.size, family.between + sensors.variance
    if n < FEWEST or family.between < SHARE * float(np.mean(variance)):
        return None
    away = (sensors.mean - family.coefficients[0]) / np.sqrt(variance)
    square = (away - away.mean()) ** 2
    errors = sensors.errors
    fourth = np.bincount(errors.owner, errors.weight**4 * scipy.special.polygamma(3, errors.half) / 16, n)
    kurtosis = float(np.mean(square**2) / np.mean(square) ** 2 - np.mean(fourth / variance**2))
    middle = 3 * (n - 1) / (n + 1)
    sigma = (24 * n * (n - 2) * (n - 3) / ((n + 1) ** 2 * (n + 3) * (n + 5))) ** 0.5
    skew = 6 * (n**2 - 5 * n + 2) / ((n + 7) * (n + 9)) * (6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3))) ** 0.5
    a = 6 + 8 / skew * (2 / skew + (1 + 4 / skew**2) ** 0.5)
    ratio = (1 - 2 / a) / (1 + (kurtosis - middle) / sigma * (2 / (a - 4)) ** 0.5)
    return float(scipy.special.ndtr((np.cbrt(ratio) - 1 + 2 / (9 * a)) / (2 / (9 * a)) ** 0.5))


def tails_together(chances: Sequence[float]) -> float | None:
    """Return the probability that chance makes the tails of any of several families so heavy, or of all together; None: of none told.

    One family shows by Bonferroni's bound, a little of each by the sum of the normal values (Stouffer); each has half of the error.
    """
    if not chances:
        return None
    scores = -scipy.special.ndtri(np.maximum(chances, LEAST))
    whole = float(scipy.special.ndtr(-scores.sum() / len(chances) ** 0.5))
    return min(1.0, 2 * min(whole, len(chances) * min(chances)))

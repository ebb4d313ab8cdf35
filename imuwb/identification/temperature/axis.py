"""One sensor axis over temperature: its set-points, what depends on temperature, and as which function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.temperature.bias import Biases, biases
from imuwb.identification.temperature.choice import Choice, choose_function
from imuwb.identification.temperature.dependence import Dependence, by_chi_square, depends, heterogeneity
from imuwb.identification.temperature.functions import TemperatureFunction
from imuwb.identification.temperature.pooled import pooled
from imuwb.identification.temperature.quantization import settled
from imuwb.identification.temperature.set_point import LETTERS, SetPoint, log_sigma
from imuwb.identification.temperature.slow import SLOW, size_of, slow_processes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from imuwb.identification.temperature.functions import Kind
    from imuwb.statistics import Coefficient

    Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Law:
    """What becomes of a coefficient in a model: a function of temperature, or a limit."""

    choice: Choice | None  #: None: it was not found
    limit: float | None  #: then its upper limit at all temperatures
    how: str  #: decided

    @property
    def function(self) -> TemperatureFunction | None:
        """Return the function, if there is one."""
        return None if self.choice is None else self.choice.function


@dataclass(frozen=True, eq=False, slots=True)
class AxisTemperatures:
    """One axis. SI."""

    level: float
    points: tuple[SetPoint, ...]  #: rising in temperature
    dependence: dict[str, Dependence | None]  #: N, B, K, Q, alpha, bias; None: it cannot be told
    laws: dict[str, Law]  #: N, B, K, Q, alpha, bias
    biases: Biases


def over_temperature(
    points: Sequence[SetPoint], *, level: float = 0.95, size: float = 0.05, wanted: Kind | None = None
) -> AxisTemperatures:
    """Return what depends on temperature, and how.

    Args:
        points: of one axis, rising in temperature.
        level: of intervals and limits.
        size: of the tests.
        wanted: a kind of function to take instead of choosing; a positive coefficient's law, such as Arrhenius's, is
            chosen for what has a sign.

    Raises:
        ValueError: fewer than two set-points, or too few for the function that is wanted.
    """
    if len(points) < 2:  # noqa: PLR2004 - nothing to compare
        message = f"{len(points)} set-points; what depends on temperature takes two at least"
        raise ValueError(message)
    points, together = settled(points, level)
    found = _tests(points, together, size)
    varying = [letter for letter in SLOW if _varies(found[letter])]
    if varying:
        together |= pooled(points, level, varying)
    coefficients = [p.coefficients for p in points]
    white = [size_of(c["N"], None) for c in coefficients]
    levels = biases([p.means for p in points], white, slow_processes(coefficients, together), level)
    celsius = np.array([p.celsius for p in points])
    alpha = np.array([p.first.alpha for p in points]), np.array([p.first.sigma for p in points])
    bias = np.array([b.value for b in levels.at]), np.array([b.sigma for b in levels.at])
    signed = None if wanted == "arrhenius" else wanted
    laws = {letter: _law(points, letter, found[letter], together.get(letter), level, wanted) for letter in LETTERS}
    found["alpha"] = heterogeneity(*alpha, size)
    statistic = levels.heterogeneity()
    found["bias"] = None if statistic is None else by_chi_square(len(points), statistic, size)
    for name, (values, sigmas) in (("alpha", alpha), ("bias", bias)):
        if found[name] is not None:
            choice = choose_function(
                celsius, values, sigmas, logarithmic=False, varies=_varies(found[name]), wanted=signed
            )
            laws[name] = Law(choice, None, "at all set-points")
    return AxisTemperatures(level, tuple(points), found, laws, levels)


def _tests(
    points: Sequence[SetPoint], together: Mapping[str, Coefficient], size: float
) -> dict[str, Dependence | None]:
    return {letter: depends(points, letter, together.get(letter), size=size) for letter in LETTERS}


def _law(
    points: Sequence[SetPoint],
    letter: str,
    dependence: Dependence | None,
    common: Coefficient | None,
    level: float,
    wanted: Kind | None,
) -> Law:
    """Return a coefficient's function of temperature.

    Where it is not found at every set-point, those at which it is stand out by chance as well: its common value, to which all
    contribute, is taken, unless the test says that it depends on temperature.
    """
    sure = [p for p in points if _is_sure(p.coefficients[letter])]
    if len(sure) == len(points):
        return Law(_choice(sure, letter, level, _varies(dependence), wanted), None, "identified at all set-points")
    if dependence is not None and dependence.depends and sure:
        some = [p for p in points if p.coefficients[letter].value is not None]
        how = f"it depends on temperature, and is identified at {len(sure)} of {len(points)} set-points: of those with a value"
        return Law(_choice(some, letter, level, _varies(dependence), wanted), None, how)
    if common is not None and _is_sure(common):
        how = f"identified at {len(sure)} of {len(points)} set-points: the value common to all"
        return Law(_constant(points, common, level), None, how)
    limit = None if common is None else common.upper
    return Law(None, limit, "not identified at all set-points together: an upper limit")


def _is_sure(coefficient: Coefficient) -> bool:
    return coefficient.value is not None and bool(coefficient.lower)


def _varies(dependence: Dependence | None) -> bool:
    return dependence is not None and dependence.depends is True


def _choice(
    points: Sequence[SetPoint],
    letter: str,
    level: float,
    varies: bool,  # noqa: FBT001 - data
    wanted: Kind | None,
) -> Choice:
    found = [p.coefficients[letter] for p in points]
    values = np.log([c.value or 0.0 for c in found])
    sigmas = np.array([log_sigma(c, level) or 0.0 for c in found])
    celsius = np.array([p.celsius for p in points])
    return choose_function(celsius, values, sigmas, logarithmic=True, varies=varies, wanted=wanted)


def _constant(points: Sequence[SetPoint], common: Coefficient, level: float) -> Choice:
    ends = np.array([points[0].celsius, points[-1].celsius])
    sigma = (log_sigma(common, level) or 0.0) * 2**0.5  # each of two
    values = np.full(2, np.log(common.value or 0.0))
    function = TemperatureFunction("constant", ends, values, np.full(2, sigma), logarithmic=True, excess=0.0)
    return Choice(function, (), "")

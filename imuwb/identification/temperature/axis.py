"""One sensor axis over temperature: its set-points, the tests of dependence, and the functions of temperature."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.identification.temperature.bias import SLOW, Biases, biases, size_of, slow_processes
from imuwb.identification.temperature.dependence import Dependence, by_chi_square, depends, heterogeneity
from imuwb.identification.temperature.function_choice import FunctionChoice, choose_function
from imuwb.identification.temperature.functions import FunctionKind, TemperatureFunction
from imuwb.identification.temperature.pooled import pooled, settled
from imuwb.identification.temperature.set_point import LETTERS, SetPoint, log_sigma
from imuwb.statistics import Coefficient


@dataclass(frozen=True, eq=False, slots=True)
class Law:
    """A coefficient in the error model: a function of temperature, or a limit."""

    choice: FunctionChoice | None  #: None: the coefficient is not identified
    limit: float | None  #: upper limit at all temperatures if it is not identified
    reason: str

    @property
    def function(self) -> TemperatureFunction | None:
        """Return the function; None if there is none."""
        return None if self.choice is None else self.choice.function

    def __repr__(self) -> str:
        """Return the function or the limit, in one line."""
        if self.choice is not None:
            return str(self.choice.function)
        return "not identified" if self.limit is None else f"< {self.limit:.4g}"


@dataclass(frozen=True, eq=False, slots=True)
class AxisTemperatures:
    """One axis over temperature, in SI."""

    level: float
    points: tuple[SetPoint, ...]  #: set-points in rising temperature
    dependence: dict[str, Dependence | None]  #: tests of N, B, K, Q, alpha, bias; None: there is no test
    laws: dict[str, Law]  #: laws of N, B, K, Q, alpha, bias
    biases: Biases

    def __repr__(self) -> str:
        """Return one line for each set-point and each law."""
        laws = (f"{name}: {law}" for name, law in self.laws.items())
        return "\n".join([*map(str, self.points), *laws])


def over_temperature(
    points: Sequence[SetPoint], *, level: float = 0.95, size: float = 0.05, kind: FunctionKind | None = None
) -> AxisTemperatures:
    """Return the tests of dependence on temperature, and the functions of temperature.

    Args:
        points: set-points of one axis, in rising temperature.
        level: confidence level of intervals and limits.
        size: probability of a false alarm of each test.
        kind: kind of all functions; None: each is chosen. A law of positive coefficients, such as Arrhenius's, is not used for
            quantities with a sign: their functions are chosen.

    Raises:
        ValueError: fewer than two set-points, or too few for the given kind.
    """
    if len(points) < 2:  # noqa: PLR2004 - a dependence needs two temperatures
        raise ValueError(f"{len(points)} set-points; a dependence on temperature needs at least two")
    points, common = settled(points, level)
    tests = {letter: depends(points, letter, common.get(letter), size=size) for letter in LETTERS}
    varying = [letter for letter in SLOW if _varies(tests[letter])]
    if varying:
        common |= pooled(points, level, varying)
    coefficients = [p.coefficients for p in points]
    white = [size_of(c["N"], None) for c in coefficients]
    levels = biases([p.means for p in points], white, slow_processes(coefficients, common), level)
    laws = {letter: _law(points, letter, tests[letter], common.get(letter), level, kind) for letter in LETTERS}
    alpha = np.array([p.ar1.alpha for p in points]), np.array([p.ar1.sigma for p in points])
    bias = np.array([b.estimate.value for b in levels.at]), np.array([b.estimate.sigma for b in levels.at])
    tests["alpha"] = heterogeneity(*alpha, size)
    statistic = levels.heterogeneity()
    tests["bias"] = None if statistic is None else by_chi_square(len(points), statistic, size)
    signed = None if kind == "arrhenius" else kind
    celsius = np.array([p.celsius for p in points])
    for name, (values, sigmas) in (("alpha", alpha), ("bias", bias)):
        if tests[name] is not None:
            varies = _varies(tests[name])
            choice = choose_function(celsius, values, sigmas, logarithmic=False, varies=varies, kind=signed)
            laws[name] = Law(choice, None, "known at all set-points")
    return AxisTemperatures(level, tuple(points), tests, laws, levels)


def _law(
    points: Sequence[SetPoint],
    letter: str,
    dependence: Dependence | None,
    common: Coefficient | None,
    level: float,
    kind: FunctionKind | None,
) -> Law:
    """Return the law of a coefficient.

    If a coefficient is identified at some set-points only, its values there are partly large by chance. Its common value, to
    which all set-points contribute, is then taken, unless the test finds a dependence on temperature.
    """
    sure = [p for p in points if _is_sure(p.coefficients[letter])]
    varies = _varies(dependence)
    if len(sure) == len(points):
        return Law(_choice(sure, letter, level, kind, varies=varies), None, "identified at all set-points")
    where = f"identified at {len(sure)} of {len(points)} set-points"
    some = [p for p in points if p.coefficients[letter].value is not None]
    if varies and sure and len(some) > 1:
        reason = f"{where}, and it depends on temperature; the function is fitted to all set-points with a value"
        return Law(_choice(some, letter, level, kind, varies=varies), None, reason)
    if common is not None and _is_sure(common):
        return Law(_constant(points, common, level), None, f"{where}: the value common to all set-points")
    limit = None if common is None else common.upper
    return Law(None, limit, "not identified at all set-points together: an upper limit")


def _is_sure(coefficient: Coefficient) -> bool:
    return coefficient.value is not None and bool(coefficient.lower)


def _varies(dependence: Dependence | None) -> bool:
    return dependence is not None and dependence.depends is True


def _choice(
    points: Sequence[SetPoint], letter: str, level: float, kind: FunctionKind | None, *, varies: bool
) -> FunctionChoice:
    coefficients = [p.coefficients[letter] for p in points]
    values = np.log([c.value or 0.0 for c in coefficients])
    sigmas = np.array([log_sigma(c, level) or 0.0 for c in coefficients])
    celsius = np.array([p.celsius for p in points])
    return choose_function(celsius, values, sigmas, logarithmic=True, varies=varies, kind=kind)


def _constant(points: Sequence[SetPoint], common: Coefficient, level: float) -> FunctionChoice:
    ends = np.array([points[0].celsius, points[-1].celsius])
    sigma = (log_sigma(common, level) or 0.0) * 2**0.5  # of each of two estimates
    values = np.full(2, np.log(common.value or 0.0))
    function = TemperatureFunction("constant", ends, values, np.full(2, sigma), logarithmic=True, excess=0.0)
    return FunctionChoice(function, (), "")

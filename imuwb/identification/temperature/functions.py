"""Functions of temperature fitted to estimates with errors; each value is a linear combination of the estimates.

Positive coefficients are fitted in their logarithm. A value between the set-points is weights times estimates, so its variance
follows from the variances of the estimates. The error of the function itself between set-points is added, estimated by leaving
one set-point out.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from imuwb.arrays import Floats
from imuwb.statistics.distributions import normal_limit

FunctionKind = Literal["constant", "linear", "arrhenius", "quadratic", "cubic", "piecewise", "spline"]
KELVIN = 273.15
REFERENCE = 25.0  #: °C, centre of the polynomials
SCALE = 50.0  #: °C, unit of the polynomials
DEGREES: dict[FunctionKind, int] = {"constant": 0, "linear": 1, "quadratic": 2, "cubic": 3}
#: the simplest first
KINDS: tuple[FunctionKind, ...] = ("constant", "linear", "arrhenius", "quadratic", "cubic", "piecewise", "spline")


def parameters_of(kind: FunctionKind, points: int) -> int:
    """Return the number of parameters of a function that is fitted to this many points."""
    if kind in ("piecewise", "spline"):
        return points
    return 2 if kind == "arrhenius" else DEGREES[kind] + 1


def weights(kind: FunctionKind, at: Floats, celsius: Floats, sigma: Floats) -> Floats:
    """Return the weights of the estimates in the values of a function, (m, k).

    Args:
        kind: kind of the function.
        at: (m,) °C.
        celsius: (k,) °C of the estimates, rising.
        sigma: (k,) standard errors of the estimates.
    """
    identity = np.eye(celsius.size)
    if kind == "piecewise":
        return np.stack([np.interp(at, celsius, row) for row in identity], axis=1)
    if kind == "spline":
        return np.asarray(CubicSpline(celsius, identity, bc_type="natural")(at), dtype=np.float64)
    here = _basis(kind, celsius) / sigma[:, None]
    return _basis(kind, at) @ np.linalg.lstsq(here, identity / sigma[:, None], rcond=1e-13)[0]


def _basis(kind: FunctionKind, celsius: Floats) -> Floats:
    if kind == "arrhenius":
        return np.stack([np.ones_like(celsius), 1000 / (celsius + KELVIN) - 1000 / (REFERENCE + KELVIN)], axis=1)
    return ((celsius - REFERENCE) / SCALE)[:, None] ** np.arange(DEGREES[kind] + 1)


@dataclass(frozen=True, eq=False, slots=True)
class TemperatureFunction:
    """A coefficient as a function of temperature; outside the set-points it is constant."""

    kind: FunctionKind
    celsius: Floats  #: (k,) °C of the estimates, rising
    estimate: Floats  #: (k,) the estimates, or their logarithms
    sigma: Floats  #: (k,) standard errors of those
    logarithmic: bool
    excess: float  #: variance of the function's own error between set-points

    def __repr__(self) -> str:
        """Return the formula."""
        return f"{self.kind}: {self.text}"

    def at(self, celsius: Floats, level: float = 0.95) -> tuple[Floats, Floats, Floats]:
        """Return values, and lower and upper ends of intervals that contain the sensor's value, (m,) each."""
        inside = np.clip(celsius, self.celsius[0], self.celsius[-1])
        map_to = weights(self.kind, inside, self.celsius, self.sigma)
        middle = map_to @ self.estimate
        half = normal_limit(level) * np.sqrt(map_to**2 @ self.sigma**2 + self.excess * self._missing(inside))
        ends = middle, middle - half, middle + half
        return tuple(np.exp(end) for end in ends) if self.logarithmic else ends  # type: ignore[return-value]

    def _missing(self, at: Floats) -> Floats:
        """Return the share of the excess variance that counts, (m,).

        It is 1 for a smooth function. For a function through the set-points it is that of a Brownian bridge between two
        set-points; ``left_out`` shows the error of a bridge twice as long.
        """
        if self.kind not in ("piecewise", "spline"):
            return np.ones(at.size)
        place = np.clip(np.searchsorted(self.celsius, at) - 1, 0, self.celsius.size - 2)
        share = (at - self.celsius[place]) / (self.celsius[place + 1] - self.celsius[place])
        return 2 * share * (1 - share)

    @property
    def text(self) -> str:
        """Return the formula, with T in °C."""
        name = "ln value" if self.logarithmic else "value"
        if self.kind in ("piecewise", "spline"):
            how = "straight lines between" if self.kind == "piecewise" else "a natural cubic spline through"
            return f"{how} {self.celsius.size} set-points"
        basis = _basis(self.kind, self.celsius) / self.sigma[:, None]
        factors = np.linalg.lstsq(basis, self.estimate / self.sigma, rcond=1e-13)[0]
        if self.kind == "arrhenius":
            return f"{name} = {factors[0]:.4g} {1000 * factors[1]:+.4g} K (1/(T + 273.15) - 1/298.15)"
        terms = [f"{c / SCALE**k:+.4g} (T - 25)^{k}" for k, c in enumerate(factors)][1:]
        return " ".join([f"{name} = {factors[0]:.4g}", *terms]).replace("^1", "")


def fitted(
    kind: FunctionKind, celsius: Floats, estimate: Floats, sigma: Floats, *, logarithmic: bool
) -> TemperatureFunction:
    """Return a function of one kind fitted to the estimates."""
    missed, expected = left_out(kind, celsius, estimate, sigma)
    excess = float(np.mean(missed**2 - expected)) if missed.size else 0.0
    return TemperatureFunction(kind, celsius, estimate, sigma, logarithmic, max(excess, 0.0))


def left_out(kind: FunctionKind, celsius: Floats, estimate: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return each inner estimate minus the function of the others, and the variance of this error due to the estimates' errors."""
    missed, expected = [], []
    for i in range(1, celsius.size - 1):
        others = np.arange(celsius.size) != i
        if parameters_of(kind, int(others.sum())) > others.sum():
            continue
        row = weights(kind, celsius[i : i + 1], celsius[others], sigma[others])[0]
        missed.append(float(estimate[i] - row @ estimate[others]))
        expected.append(float(sigma[i] ** 2 + row**2 @ sigma[others] ** 2))
    return np.array(missed), np.array(expected)

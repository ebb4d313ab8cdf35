"""The bias of an axis as a polynomial of temperature about a reference, of third order at most, as autopilots take it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.temperature.cosine_window import CosineWindow, smoothed
from imuwb.identification.temperature.drift_fit import DriftFit, Weights, fit_drift
from imuwb.identification.temperature.thermal_lag import ThermalLag
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

ORDER = 3  #: largest order
NEEDED = 2.58  #: standard errors by which the highest factor differs from 0, or the order is smaller
ROUNDED = 1e-6  #: °C by which a temperature may lie outside


@dataclass(frozen=True, eq=False, slots=True)
class BiasPolynomial:
    """A bias b(T) = X0 + X1 d + X2 d² + X3 d³ with d = T - reference."""

    reference: float  #: °C
    factors: tuple[Estimate, ...]  #: X0 ... X3, SI per °C^k; a fit without errors has no intervals
    covariance: Floats  #: (p, p)
    lowest: float  #: °C, from which
    highest: float  #: °C, and up to which the bias was measured
    level: float  #: of the intervals

    def __repr__(self) -> str:
        """Return the factors and the range."""
        terms = ", ".join(f"X{k} {f}" for k, f in enumerate(self.factors))
        return f"{terms}, d = T - {self.reference:g} °C, {self.lowest:.4g} to {self.highest:.4g} °C"

    def at(self, celsius: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the bias and the ends of its intervals, (n,) each.

        Raises:
            ValueError: a temperature at which the bias was not measured: a polynomial does not extrapolate.
        """
        outside = (celsius < self.lowest - ROUNDED) | (celsius > self.highest + ROUNDED)
        if outside.any():
            raise ValueError(
                f"{celsius[outside][0]:g} °C is outside of {self.lowest:.4g} to {self.highest:.4g} °C, where the bias was measured; "
                "a polynomial does not extrapolate"
            )
        powers = (celsius - self.reference)[:, None] ** np.arange(len(self.factors))
        value = powers @ [f.value for f in self.factors]
        spread = np.einsum("ni,ij,nj->n", powers, self.covariance, powers).clip(0) ** 0.5
        half = normal_limit(self.level) * spread
        return value, value - half, value + half


def polynomial_through(celsius: Floats, bias: Floats, reference: float) -> BiasPolynomial:
    """Return the polynomial of third order, or less for fewer points, through points without errors (least squares).

    Args:
        celsius: (k,) °C, rising.
        bias: (k,) SI.
        reference: °C.
    """
    order = min(ORDER, celsius.size - 1)
    fit = np.pad(np.polynomial.polynomial.polyfit(celsius - reference, bias, order), (0, ORDER - order))
    factors = tuple(Estimate(float(c), float("nan"), float("nan")) for c in fit)
    return BiasPolynomial(reference, factors, np.zeros((ORDER + 1,) * 2), float(celsius[0]), float(celsius[-1]), 0.0)


def bias_polynomial(thermal: ThermalLag, axis: str, reference: float, *, level: float = 0.95) -> BiasPolynomial:
    """Return the polynomial of an axis of one record, fitted to its samples; a hysteresis is estimated beside it.

    The slow noise of the record and the error of the lag widen the intervals. X0 is the level of this record: the bias of another
    turn-on differs.

    Args:
        thermal: temperature of the sensor over the record, and the means of its axes.
        axis: name of the axis.
        reference: °C.
        level: confidence level of the intervals.
    """
    window = thermal.window
    weights = Weights.of(window.length, window.interval, window.factor.size)
    series = smoothed(thermal.axes[axis], window.interval, window.width)
    through = window.cosines(series)

    def fitted(warm: Floats, order: int) -> tuple[Floats, DriftFit]:
        columns = _columns(thermal, warm - reference, order)
        return columns, fit_drift(through, window.cosines(columns), weights)

    order = ORDER
    columns, fit = fitted(thermal.celsius, order)
    while order > 1 and abs(fit.factors[order - 1]) < NEEDED * fit.covariance[order - 1, order - 1] ** 0.5:
        order -= 1
        columns, fit = fitted(thermal.celsius, order)
    count = order + 1
    values, covariance = _with_level(series, columns, fit, window)
    off = _with_level(series, *fitted(thermal.later, order), window)[0] - values
    values, covariance = values[:count], (covariance + np.outer(off, off))[:count, :count]
    z = normal_limit(level)
    sigmas = covariance.diagonal() ** 0.5
    factors = tuple(
        Estimate(v, v - z * s, v + z * s, float(s)) for v, s in zip(values.tolist(), sigmas.tolist(), strict=True)
    )
    warm = thermal.celsius[window.inside]
    return BiasPolynomial(reference, factors, covariance, float(warm.min()), float(warm.max()), level)


def _columns(thermal: ThermalLag, away: Floats, order: int) -> Floats:
    """Return the powers of a difference from the reference, and the direction of the temperature where it turns."""
    powers = away[:, None] ** np.arange(1, order + 1)
    return np.column_stack([powers, thermal.direction]) if thermal.direction.size else powers


def _with_level(series: Floats, columns: Floats, fit: DriftFit, window: CosineWindow) -> tuple[Floats, Floats]:
    """Return the constant and the factors of the columns, and their covariance; the record's mean is independent of the factors."""
    means = columns[window.inside].mean(axis=0)
    values = np.concatenate([[series[window.inside].mean() - means @ fit.factors], fit.factors])
    change = np.vstack([-means, np.eye(means.size)])
    covariance = change @ fit.covariance @ change.T
    covariance[0, 0] += fit.white / window.length
    return values, covariance

"""Sensors of a family by random effects: a variance between sensors, one from log to log of a sensor, and known sampling variances.

Row j of sensor i is y_ij = x_ij β + b_i + e_ij + ε_ij, with variances τ² of b, ω² of e, and v_ij of ε, which is known. τ² and ω² maximise
the restricted likelihood (REML, Patterson and Thompson, Biometrika 58, 1971) by Fisher scoring. The covariance of a sensor is a diagonal
matrix and a constant, so that each step costs a few sums (Searle, Casella and McCulloch, Variance Components, 6.6).
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.family.observations import Observations

ROUNDS, CLOSE = 100, 1e-8  #: of the scoring; the gain of the likelihood at which it ends
SHORTEST = 1e-6  #: share of a step
LEAST = 1e-12  #: share of the variance of y at which a variance component counts as 0


@dataclass(frozen=True, eq=False, slots=True)
class RandomEffects:
    """A fitted family, on the scale of its observations."""

    coefficients: Floats  #: (p,) β; the first is the mean
    covariance: Floats  #: (p, p)
    between: float  #: τ²
    within: float  #: ω²; 0 if no sensor has several logs
    information: Floats  #: (2, 2) expected information of τ² and ω²
    free: tuple[bool, bool]  #: whether τ² and ω² are estimated; without ω², ``between`` is the sum of both

    @property
    def errors(self) -> tuple[float, float]:
        """Return the sampling variances of τ² and ω²; 0 for one that is not estimated."""
        places = [k for k in (0, 1) if self.free[k]]
        found = np.diag(np.linalg.pinv(self.information[np.ix_(places, places)])) if places else []
        known = dict(zip(places, map(float, found), strict=True))
        return known.get(0, 0.0), known.get(1, 0.0)


class _Covariance:
    """The covariance of the rows: its inverse times columns, and its traces, with the columns of the design eliminated."""

    def __init__(self, rows: Observations, design: Floats, between: float, within: float) -> None:
        self.rows = rows
        self.a: Floats = 1 / (rows.variance + within)
        self.s, self.q, self.c3 = (rows.sums(self.a**k) for k in (1, 2, 3))
        self.shrunk: Floats = 1 / (1 + between * self.s)
        self.c: Floats = between * self.shrunk
        self.w = self.inverse(design)
        self.inner: Floats = np.asarray(np.linalg.inv(design.T @ self.w), dtype=np.float64)
        self.logdet = -float(np.log(self.a).sum() + np.log(self.shrunk).sum() + np.linalg.slogdet(self.inner)[1])

    def inverse(self, columns: Floats) -> Floats:
        """Return V⁻¹ times columns, (n, k)."""
        scaled = self.a[:, None] * columns
        return scaled - self.a[:, None] * (self.c[:, None] * self.grouped(scaled))[self.rows.sensor]

    def grouped(self, columns: Floats) -> Floats:
        """Return the sums of columns of each sensor."""
        if columns.shape[1] == 1:
            return self.rows.sums(columns[:, 0])[:, None]
        return np.stack([self.rows.sums(column) for column in columns.T], axis=1)

    def projected(self, column: Floats) -> Floats:
        """Return P times a column: V⁻¹ of its residual."""
        plain = self.inverse(column[:, None])[:, 0]
        return plain - self.w @ (self.inner @ (self.w.T @ column))

    def spread(self, columns: Floats, component: int) -> Floats:
        """Return the covariance that belongs to τ² (0) or ω² (1), times columns."""
        return columns if component else self.grouped(columns)[self.rows.sensor]

    def traces(self) -> tuple[Floats, Floats]:
        """Return tr(P V_k), (2,), and tr(P V_k P V_l), (2, 2)."""
        plain = np.array([(self.s * self.shrunk).sum(), self.a.sum() - (self.c * self.q).sum()])
        across = float((self.q * self.shrunk**2).sum())
        last = float((self.q - 2 * self.c * self.c3 + self.c**2 * self.q**2).sum())
        double = np.array([[float(((self.s * self.shrunk) ** 2).sum()), across], [across, last]])
        spread = [self.spread(self.w, k) for k in (0, 1)]
        outer = [self.inner @ (self.w.T @ part) for part in spread]
        first = plain - np.array([np.trace(part) for part in outer])
        middle = np.array([
            [np.trace(self.inner @ (one.T @ self.inverse(other))) for other in spread] for one in spread
        ])  # fmt: skip
        both = np.array([[np.trace(one @ other) for other in outer] for one in outer])
        return first, double - 2 * middle + both


def random_effects(
    rows: Observations, covariate: Floats | None = None, start: RandomEffects | None = None
) -> RandomEffects:
    """Return the family that maximises the restricted likelihood.

    Args:
        rows: at least two.
        covariate: (n,) on which y depends linearly besides its mean, such as a temperature; None: none.
        start: a family of nearly the same rows, from which the search begins; None: none is known.
    """
    design = np.ones((rows.y.size, 1)) if covariate is None else np.stack([np.ones_like(rows.y), covariate], axis=1)
    count = rows.sums(np.ones_like(rows.y))
    free = np.array([(count > 0).sum() > 1, count.max(initial=0) > 1])
    scale = float(np.var(rows.y)) + float(rows.variance.mean())
    theta = np.where(free, 0.3 * scale if start is None else [start.between, start.within], 0.0)
    loss, point = _loss(rows, design, theta)
    information = np.eye(2)
    for _ in range(ROUNDS):
        first, information = point.traces()
        residual = point.projected(rows.y)
        square = np.array([residual @ point.spread(residual[:, None], k)[:, 0] for k in (0, 1)])
        step = _step((square - first) / 2, information / 2, theta, free)
        share, gain = 1.0, 0.0
        while share > SHORTEST:
            trial = np.maximum(theta + share * step, 0.0)
            new, at = _loss(rows, design, trial)
            if new <= loss:
                gain, theta, loss, point = loss - new, trial, new, at
                break
            share /= 2
        if gain < CLOSE:
            break
    theta = np.where(theta > LEAST * scale, theta, 0.0)
    _, point = _loss(rows, design, theta)
    _, information = point.traces()
    coefficients = point.inner @ (point.w.T @ rows.y)
    between, within = map(float, theta)
    return RandomEffects(coefficients, point.inner, between, within, information / 2, (bool(free[0]), bool(free[1])))


def _loss(rows: Observations, design: Floats, theta: Floats) -> tuple[float, _Covariance]:
    """Return minus twice the restricted log-likelihood, without its constant."""
    point = _Covariance(rows, design, float(theta[0]), float(theta[1]))
    return point.logdet + float(rows.y @ point.projected(rows.y)), point


def _step(slope: Floats, information: Floats, theta: Floats, free: np.ndarray) -> Floats:
    """Return the step of the scoring; a variance at 0 that would fall stays there."""
    moving = free & ~((theta <= 0) & (slope <= 0))
    step = np.zeros(2)
    if moving.any():
        step[moving] = np.linalg.lstsq(information[np.ix_(moving, moving)], slope[moving], rcond=None)[0]
    return step

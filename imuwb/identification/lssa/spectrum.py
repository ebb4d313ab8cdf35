"""Least-squares spectra: how much of a series each line explains, together with the known constituents.

P. Vanicek (1969); S. D. Pagiatakis, Stochastic significance of peaks in the least-squares spectrum, J. Geodesy 73 (1999);
El-Diasty, eq. 5 to 13.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from imuwb.arrays import Complexes, Floats
from imuwb.identification.lssa.constituents import Constituents
from imuwb.identification.lssa.equations import Equations, equations, right_sides
from imuwb.identification.lssa.noise import Noise, NoiseFit, fitted_noise
from imuwb.identification.lssa.trigonometric import ROUNDED, Grid, Lattice, grid_of, lattice_of
from imuwb.sampling import sampling

FEWEST = 16  #: least number of rows minus number of constituents
RANK = 1e-6  #: share of a column's length that must remain when the columns before it are projected out
WHITE = Noise()


@dataclass(frozen=True, eq=False, slots=True)
class Adjusted:
    """A series with its estimated noise and constituents."""

    time: Floats  #: (n,) s, from the first sample
    interval: float  #: s, usual sampling interval
    lattice: Lattice | None
    noise: NoiseFit
    names: tuple[str, ...]  #: names of the k constituents
    basis: Floats  #: (rows, k) whitened constituents, orthonormal
    residual: Floats  #: (rows,) whitened series without the constituents
    coefficients: Floats  #: (k,) coefficients of the constituents
    sigma: Floats  #: (k,) standard errors of the coefficients

    def __repr__(self) -> str:
        """Return the size of the series, its noise and its constituents, in one line."""
        sizes = zip(self.names, self.coefficients, self.sigma, strict=True)
        known = "".join(f", {name} {value:.4g} ± {sigma:.1g}" for name, value, sigma in sizes)
        return f"{self.time.size} samples over {self.time[-1]:.6g} s, {self.noise.noise.kind} noise{known}"

    @property
    def rest(self) -> float:
        """Return the quadratic form of the residual."""
        return float(np.einsum("i,i", self.residual, self.residual))

    @property
    def freedom(self) -> int:
        """Return the degrees of freedom of the residual."""
        return self.noise.whitening.count - self.basis.shape[1]


@dataclass(frozen=True, eq=False, slots=True)
class Spectrum:
    """A least-squares spectrum at m frequencies."""

    adjusted: Adjusted
    grid: Grid
    equations: Equations
    oversampling: int
    reduction: Floats  #: (m,) reduction of the quadratic form of the residual by a line
    complex_amplitude: Complexes  #: (m,) a - ib of a cos(omega t) + b sin(omega t), with t from the first sample

    def __repr__(self) -> str:
        """Return the range of frequencies and the series, in one line."""
        first, last = self.grid.step, self.grid.step * self.grid.count
        return f"least-squares spectrum at {self.grid.count} frequencies, {first:.4g} to {last:.6g} Hz: {self.adjusted}"

    @property
    def frequency(self) -> Floats:
        """Return the frequencies, (m,) Hz."""
        return self.grid.frequency

    @property
    def share(self) -> Floats:
        """Return s of El-Diasty's eq. 11, (m,) from 0 to 1."""
        rest = self.adjusted.rest
        return np.minimum(self.reduction / rest, 1.0) if rest > 0 else np.zeros_like(self.reduction)

    @property
    def percent(self) -> Floats:
        """Return the share in per cent."""
        return 100 * self.share

    @property
    def decibels(self) -> Floats:
        """Return the signal-to-noise ratio of eq. 12, (m,) dB; the paper calls it a density in decibels."""
        share = np.clip(self.share, 1e-300, 1 - 1e-16)
        return 10 * np.log10(share / (1 - share))

    @property
    def printed_density(self) -> Floats:
        """Return eq. 13 as printed, (m,): quadratic form of the signal over frequency, not over a bandwidth."""
        return self.reduction / self.frequency

    @property
    def amplitude(self) -> Floats:
        """Return (m,) peak amplitudes."""
        return np.abs(self.complex_amplitude)

    @property
    def density(self) -> Floats:
        """Return A²T/2, (m,) unit²/Hz, one-sided; for evenly spaced samples it equals the Fourier periodogram."""
        return self.amplitude**2 * self.adjusted.time.size * self.adjusted.interval / 2

    def without(self, residual: Floats) -> Spectrum:
        """Return the spectrum of another residual, for example without extracted lines."""
        adjusted = replace(self.adjusted, residual=residual)
        return _spectrum(adjusted, self.grid, self.equations, self.oversampling)


def adjust(
    time: Floats,
    values: Floats,
    constituents: Constituents,
    noise: Noise = WHITE,
    *,
    interval: float | None = None,
    weights: Floats | None = None,
) -> Adjusted:
    """Return a series with its estimated noise and constituents.

    Args:
        time: (n,) s, rising; unequal spacing is allowed.
        values: (n,) in any unit.
        constituents: the known constituents.
        noise: structure of the noise; parameters that are not given are estimated.
        interval: s, usual sampling interval; None: that of ``sampling``, which leaves gaps out.
        weights: (n,) inverse variances up to a factor; with white noise only.

    Raises:
        ValueError: times that do not rise, constituents that are not separable, too few samples, a singular covariance.
    """
    values = np.asarray(values, dtype=float)
    _check_series(time, values)
    columns, names = constituents.columns(time), constituents.names
    if noise.kind == "random-walk" and names[:1] == ("constant",):
        columns, names = columns[:, 1:], names[1:]  # the level of a random walk is part of the noise
    time = time - time[0]
    usual = sampling(np.rint(time * 1e9).astype(np.int64)).interval if interval is None else interval
    lattice = lattice_of(time, usual)
    if lattice is None and noise.kind == "autoregressive":
        lattice = lattice_of(time, usual, ROUNDED)  # the time stamps of even samples may be rounded
    usual = usual if lattice is None else lattice.interval
    fit = fitted_noise(time, values, columns, lattice, noise, weights)
    return _without_constituents(time, values, columns, names, usual, lattice, fit)


def _check_series(time: Floats, values: Floats) -> None:
    if time.shape != values.shape or time.ndim != 1 or time.size < FEWEST or not np.isfinite(values).all():
        raise ValueError(
            f"times {time.shape} and values {values.shape}; they must be of one length, at least {FEWEST}, and finite"
        )
    steps = np.diff(time)
    if not steps.min() > 0:
        at = int(np.argmin(steps > 0))
        raise ValueError(f"times must rise: {time[at + 1]:.9g} s follows {time[at]:.9g} s (sample {at + 1})")


def _without_constituents(
    time: Floats,
    values: Floats,
    columns: Floats,
    names: tuple[str, ...],
    interval: float,
    lattice: Lattice | None,
    fit: NoiseFit,
) -> Adjusted:
    rows = fit.whitening.rows(np.column_stack([columns, values]))
    basis, triangle = _orthonormal(rows[:, :-1], names)
    if rows.shape[0] - basis.shape[1] < FEWEST:
        raise ValueError(
            f"{fit.whitening.count} samples and {basis.shape[1]} constituents; at least {FEWEST} samples must remain"
        )
    share = basis.T @ rows[:, -1]
    residual = rows[:, -1] - basis @ share
    residual -= basis @ (basis.T @ residual)  # a second time, for large offsets
    inverse = linalg.solve_triangular(triangle, np.eye(len(triangle)))
    level = float(np.einsum("i,i", residual, residual)) / (fit.whitening.count - basis.shape[1])
    sigma = np.sqrt(level * np.einsum("ij,ij->i", inverse, inverse))
    return Adjusted(time, interval, lattice, fit, names, basis, residual, inverse @ share, sigma)


def least_squares_spectrum(adjusted: Adjusted, *, highest: float | None = None, oversampling: int = 2) -> Spectrum:
    """Return the spectrum of a series.

    Args:
        adjusted: from ``adjust``.
        highest: Hz; None: half the usual rate.
        oversampling: frequencies for each cycle over the record; 1: the Fourier frequencies.

    Raises:
        ValueError: the record is shorter than one cycle of the highest frequency.
    """
    top = 0.5 / adjusted.interval if highest is None else highest
    if not top * float(adjusted.time[-1]) >= 1:
        raise ValueError(
            f"highest is {top:g} Hz; the record of {adjusted.time[-1]:g} s must contain at least one cycle of that frequency; use a higher frequency"
        )
    grid = grid_of(adjusted.time, adjusted.lattice, top, oversampling)
    known = equations(adjusted.time, adjusted.lattice, adjusted.noise.whitening, adjusted.basis, grid)
    return _spectrum(adjusted, grid, known, oversampling)


def _spectrum(adjusted: Adjusted, grid: Grid, known: Equations, oversampling: int) -> Spectrum:
    whitening = adjusted.noise.whitening
    right = right_sides(adjusted.time, adjusted.lattice, whitening, adjusted.residual[:, None], grid)[0]
    reduction, amplitude = known.solve(right)
    return Spectrum(adjusted, grid, known, oversampling, reduction, amplitude)


def _orthonormal(columns: Floats, names: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Return Q and R of whitened constituents."""
    if not columns.shape[1]:
        return columns, np.empty((0, 0))
    length = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    unit = np.where(length > 0, length, 1.0)
    products = columns.T @ columns / np.outer(unit, unit)
    for k in range(length.size):
        # what the columns before leave of this column, which has length 1
        share = linalg.lstsq(products[:k, :k], products[:k, k], check_finite=False)[0] if k else np.empty(0)
        if not length[k] or products[k, k] - products[:k, k] @ share < RANK**2:
            raise ValueError(
                f"the {names[k]} is not separable from {', '.join(names[:k]) or 'noise'}: "
                "leave it out (a jump must lie within the record, a line apart from other lines)"
            )
    basis, triangle = columns, np.eye(length.size)
    for _ in range(2):  # the second time for rounding errors (Yamamoto and others 2015)
        upper = linalg.cholesky(basis.T @ basis)
        basis = linalg.solve_triangular(upper, basis.T, trans="T").T
        triangle = upper @ triangle
    return np.ascontiguousarray(basis), triangle

"""The normal equations of cosine and sine at many frequencies, each together with the known constituents.

W is the whitening, E = exp(i omega t), Q the whitened constituents made orthonormal, and r the whitened series without them. The
equations of a frequency need E'W'r, E'W'Q, and the sums over rows of |row of WE|² and (row of WE)². Each of these is a sum of
strengths times exp(i omega t) at certain instants.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from imuwb.arrays import Complexes, Floats, Integers
from imuwb.identification.lssa.trigonometric import Grid, Lattice, sums
from imuwb.identification.lssa.whitening import Chain, Dense, Recursion, Whitening

#: share of a line's determinant without constituents; if the constituents leave less, they already include the line
SEPARATE = 1e-10
BLOCK = 256  #: frequencies that are evaluated together with a dense covariance


@dataclass(frozen=True, eq=False, slots=True)
class Equations:
    """The equations M x = v of each frequency; x are the coefficients of cosine and sine."""

    cosine: Floats  #: (m,) element of M
    mixed: Floats  #: (m,) element of M
    sine: Floats  #: (m,) element of M
    whole: Floats  #: (m,) trace of M without constituents
    gain: Complexes | None  #: (m,) gain of the rows at exp(i omega t); None: 1

    @property
    def determinant(self) -> Floats:
        """Return the determinants of M, 0 if the constituents already include the line."""
        determinant = self.cosine * self.sine - self.mixed**2
        return np.where(determinant > SEPARATE * self.whole**2, determinant, 0.0)

    def solve(self, right: Complexes) -> tuple[Floats, Complexes]:
        """Return by how much each line reduces the quadratic form of the residual, and a - ib of the line a cos + b sin.

        Args:
            right: (m,) v, cosine's part plus i times sine's part.
        """
        determinant = self.determinant
        safe = np.where(determinant > 0, determinant, 1.0)
        a = np.where(determinant > 0, self.sine * right.real - self.mixed * right.imag, 0.0) / safe
        b = np.where(determinant > 0, self.cosine * right.imag - self.mixed * right.real, 0.0) / safe
        # Rounding errors of the sums must not make a quadratic form negative.
        return np.maximum(a * right.real + b * right.imag, 0.0), (a - 1j * b) / (
            1.0 if self.gain is None else self.gain
        )


def equations(time: Floats, lattice: Lattice | None, whitening: Whitening, basis: Floats, grid: Grid) -> Equations:
    """Return M at all frequencies.

    Args:
        time: (n,) s, from 0.
        lattice: lattice of the time stamps.
        whitening: whitening of the noise.
        basis: (rows, k) Q.
        grid: the frequencies.
    """
    gain = whitening.gain(grid.frequency) if isinstance(whitening, Recursion) else None
    if isinstance(whitening, Dense):
        cosine, mixed, sine, whole = _dense(time, whitening, basis, grid)
        return Equations(cosine, mixed, sine, whole, gain)
    size, twice = _squares(time, lattice, whitening, grid)
    cosine, mixed, sine = 0.5 * (size + twice.real), 0.5 * twice.imag, 0.5 * (size - twice.real)
    if basis.shape[1]:
        for known in right_sides(time, lattice, whitening, basis, grid):
            cosine -= known.real**2
            mixed -= known.real * known.imag
            sine -= known.imag**2
    return Equations(cosine, mixed, sine, size, gain)


def right_sides(time: Floats, lattice: Lattice | None, whitening: Whitening, rows: Floats, grid: Grid) -> Complexes:
    """Return E'W' times whitened rows (rows, k), as (k, m)."""
    if isinstance(whitening, Dense):
        strengths = linalg.solve_triangular(whitening.factor, rows, lower=True, trans="T", check_finite=False)
        return sums(time, lattice, np.ascontiguousarray(strengths.T), grid)
    if isinstance(whitening, Chain):
        return sums(time, lattice, np.ascontiguousarray(whitening.back(rows).T), grid)
    part = None if lattice is None else type(lattice)(lattice.interval, lattice.index[whitening.kept])
    return sums(time[whitening.kept], part, np.ascontiguousarray(rows.T), grid)


def _squares(
    time: Floats, lattice: Lattice | None, whitening: Chain | Recursion, grid: Grid
) -> tuple[Floats, Complexes]:
    """Return the sums over rows of |row of WE|² and (row of WE)²."""
    if isinstance(whitening, Recursion):
        part = None if lattice is None else type(lattice)(lattice.interval, lattice.index[whitening.kept])
        twice = sums(time[whitening.kept], part, np.ones((1, whitening.count)), grid, 2)[0]
        return np.full(grid.count, float(whitening.count)), twice
    weight = whitening.scale**2
    own = weight.copy()
    own[:-1] += weight[1:] * whitening.hold[1:] ** 2
    twice = sums(time, lattice, own[None], grid, 2)[0]
    size = np.full(grid.count, float(own.sum()))
    if not whitening.plain:
        tied = 2 * weight[1:] * whitening.hold[1:]
        between, apart = None, None
        if lattice is not None:
            between = type(lattice)(lattice.interval, lattice.index[1:] + lattice.index[:-1])
            apart = np.diff(lattice.index)
        # exp(i omega (t_i + t_(i-1))), and the cosine of omega times the step
        twice -= _between(time[1:] + time[:-1], between, tied, grid)
        size -= _steps(np.diff(time), apart, tied, grid)
    return size, twice


def _between(time: Floats, lattice: Lattice | None, strength: Floats, grid: Grid) -> Complexes:
    if lattice is None or not grid.length:
        return sums(time, None, strength[None], grid)[0]
    wrapped = np.bincount(lattice.index % grid.length, strength, grid.length)
    return np.conj(np.fft.rfft(wrapped)[1 : grid.count + 1])


def _steps(steps: Floats, whole: Integers | None, strength: Floats, grid: Grid) -> Floats:
    if whole is None:
        return sums(steps, None, strength[None], grid)[0].real
    # Few different lengths of steps occur.
    lengths, which = np.unique(whole, return_inverse=True)
    total = np.bincount(which, strength)
    unit = 2 * np.pi * float(steps[0] / whole[0]) * grid.frequency
    return np.sum([t * np.cos(unit * k) for t, k in zip(total, lengths, strict=True)], axis=0)


def _dense(time: Floats, whitening: Dense, basis: Floats, grid: Grid) -> Floats:
    elements = np.empty((4, grid.count))
    for start in range(0, grid.count, BLOCK):
        part = slice(start, min(start + BLOCK, grid.count))
        phase = 2 * np.pi * np.outer(time, grid.frequency[part])
        width = phase.shape[1]
        both = whitening.rows(np.concatenate([np.cos(phase), np.sin(phase)], axis=1))
        elements[3, part] = np.einsum("ij,ij->j", both, both).reshape(2, width).sum(axis=0)
        both -= basis @ (basis.T @ both)
        c, s = both[:, :width], both[:, width:]
        elements[:3, part] = np.einsum("ij,ij->j", c, c), np.einsum("ij,ij->j", c, s), np.einsum("ij,ij->j", s, s)
    return elements

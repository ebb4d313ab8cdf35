"""Sums of strengths times exp(2 pi i k turn) at uneven turns, for many whole k at once, in the time of a fast Fourier transform.

Each strength is spread over the nearest points of a grid by a kernel, the grid is transformed, and the result is divided by the
transform of the kernel: a non-uniform transform of type 1 with the kernel "exponential of semicircle" of Barnett, Magland and af
Klinteberg (2019), SIAM J. Sci. Comput. 41, C479.
"""

from functools import cache

import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy import fft

from imuwb.arrays import Complexes, Floats, Integers
from imuwb.compiled import compiled

WIDTH = 14  #: points of the grid that a strength is spread over
FINER = 2  #: points of the grid for each term that is wanted, k = -count ... count; at least
BEND = 2.3 * WIDTH  #: of the kernel exp(BEND (sqrt(1 - z²) - 1)), -1 < z < 1
DEGREE = 13  #: of the polynomials that are the kernel between two points of the grid
TERMS = 17  #: Chebyshev polynomials that are the kernel's transform
NODES = 64  #: of an integral over the kernel
BLOCK = 32  #: turns whose kernel is computed together


def uneven_sums(turn: Floats, strengths: Floats, count: int) -> Complexes:
    """Return sum_j strength_j exp(2 pi i k turn_j), k = 1 ... count.

    The error is below 1e-11 of the root sum of squares of all terms, and of the rounding of k turn.

    Args:
        turn: (n,) cycles, finite; rising ones are faster.
        strengths: (m, n).
        count: number of terms.

    Returns:
        (m, count).
    """
    if not np.isfinite(turn).all():
        raise ValueError("a turn is not a finite number")
    length = fft.next_fast_len(max(FINER * (2 * count + 1), 4 * WIDTH), real=True)
    grid = np.zeros((len(strengths), length + 2 * WIDTH))
    work = np.empty((WIDTH, BLOCK)), np.zeros(BLOCK), np.zeros(BLOCK, np.int64)
    _spread(np.ascontiguousarray(turn), np.ascontiguousarray(strengths), _pieces(), *work, grid)
    # The grid is a circle: what lies before its first point and after its last one belongs to the other end.
    grid[:, length : length + WIDTH] += grid[:, :WIDTH]
    grid[:, WIDTH : 2 * WIDTH] += grid[:, length + WIDTH :]
    k = np.arange(1, count + 1, dtype=np.float64)
    divided = chebyshev.chebval(8 * (FINER * k / length) ** 2 - 1, _inverse_transform())
    result = np.empty((len(strengths), count), np.complex128)
    for row, points in zip(result, grid, strict=True):
        transform = fft.rfft(points[WIDTH : length + WIDTH])[1 : count + 1]
        np.conjugate(transform, out=transform)  # the sign of scipy's exponent is the other one
        np.multiply(transform, divided, out=row)
    return result


@compiled(arrays=False)
def _spread(
    turn: Floats, strengths: Floats, pieces: Floats, values: Floats, place: Floats, first: Integers, grid: Floats
) -> None:
    """Spread strengths over a grid; its first WIDTH points, and its last ones, are beyond the circle.

    Args:
        turn: (n,) cycles.
        strengths: (m, n).
        pieces: (WIDTH, DEGREE + 1), of ``_pieces``.
        values: (WIDTH, BLOCK), for the kernel.
        place: (BLOCK,), for the places between two points.
        first: (BLOCK,), for the first points.
        grid: (m, points + 2 WIDTH), to which the strengths are added.
    """
    points = grid.shape[1] - 2 * WIDTH
    for start in range(0, turn.size, BLOCK):
        count = min(BLOCK, turn.size - start)
        for j in range(count):
            begin = (turn[start + j] - np.floor(turn[start + j])) * points - WIDTH / 2
            above = np.ceil(begin)
            first[j] = int(above) + WIDTH
            place[j] = 2 * (above - begin) - 1
        for i in range(WIDTH):
            for j in range(BLOCK):  # of all, so that the processor computes several at a time
                value = pieces[i, 0]
                for power in range(1, DEGREE + 1):
                    value = value * place[j] + pieces[i, power]
                values[i, j] = value
        for row in range(strengths.shape[0]):
            for j in range(count):
                for i in range(WIDTH):
                    grid[row, first[j] + i] += strengths[row, start + j] * values[i, j]


def _kernel(z: Floats) -> Floats:
    return np.exp(BEND * (np.sqrt(1 - z * z) - 1))


@cache
def _pieces() -> Floats:
    """Return the kernel at the WIDTH points as polynomials of the place between two points, -1 ... 1, (WIDTH, DEGREE + 1), highest powers first."""
    place = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    series = chebyshev.chebfit(
        place, np.stack([_kernel((2 * i + place + 1) / WIDTH - 1) for i in range(WIDTH)], axis=1), DEGREE
    )
    return np.stack([chebyshev.cheb2poly(one)[::-1] for one in series.T])


@cache
def _inverse_transform() -> Floats:
    """Return the Chebyshev series of one over the kernel's transform, of 8 (FINER k / length)² - 1; k is at most a quarter of the length."""
    z, weight = legendre.leggauss(NODES)

    x = chebyshev.chebpts1(TERMS)
    cycles = np.sqrt((x + 1) / 8) / FINER  # for each point of the grid
    transform = WIDTH / 2 * np.cos(np.pi * WIDTH * np.multiply.outer(cycles, z)) @ (weight * _kernel(z))
    return np.asarray(chebyshev.chebfit(x, 1 / transform, TERMS - 1), np.float64)

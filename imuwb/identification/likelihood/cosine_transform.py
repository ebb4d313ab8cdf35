"""The discrete cosine transform of a record, whose memory is the result itself.

A Fourier transform of a library needs the record, its spectrum, a table of sines and a second buffer: 32 bytes a sample. The
transform of a long record is done here in place. The series is that of Makhoul (1980), "A fast cosine transform in one and two
dimensions": the even samples, then the odd ones in reverse order. Its neighbours are taken as complex numbers z_j, j < m, and these
as a matrix of p rows and q columns, j = q j1 + j2. Transforms of the columns, factors exp(-2 pi i j2 k1/m), and transforms of the rows
leave the transform of all at k = k1 + p k2 (Bailey 1990, "FFTs in external or hierarchical memory", the four-step method).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft

from imuwb.arrays import LARGE, Complexes, Floats, Integers
from imuwb.compiled import compiled

PIECE = 1 << 18  #: complex numbers that are transformed at once


@dataclass(frozen=True, eq=False, slots=True)
class CosineCoefficients:
    """The n coefficients of a transform, in the order in which it leaves them."""

    values: Floats  #: (n,)
    rows: int = 0  #: of the matrix of a long record; 0: the coefficients are in their own order

    def at(self, index: Integers) -> Floats:
        """Return some coefficients by their numbers, in half periods of the record."""
        return np.array([self.values[_place(int(i), self.values.size, self.rows)] for i in index])

    def sums_of_squares(self, edges: Integers, first: Integers, last: Integers) -> tuple[Floats, Integers]:
        """Return the sums of squares between edges, (k - 1,) each, and their counts, without those from ``first`` to ``last``."""
        return _binned(self.values, self.rows, edges, first, last)


def transform_length(n: int) -> int:
    """Return the largest length up to n that a transform is fast for: of a long record, an even one without large prime factors."""
    if n <= LARGE:
        return n
    while n % 2 or fft.next_fast_len(n, real=True) != n:
        n -= 1
    return n


def cosine_transform(values: Floats, level: float, slope: float) -> CosineCoefficients:
    """Return the orthonormal discrete cosine transform (type II) of values less a straight line.

    Args:
        values: (n,), a long record of ``transform_length(n)``.
        level: mean of the line.
        slope: of the line, per sample.
    """
    out = np.empty(values.size)
    _interleaved(values, level, slope, out)
    if values.size <= LARGE:
        # numpy frees the tables of a transform, while scipy keeps them.
        _turned(np.fft.rfft(out), out)
        return CosineCoefficients(out)
    half = out.size // 2
    rows = max(p for p in range(1, math.isqrt(half) + 1) if half % p == 0)
    _transform(out.view(np.complex128).reshape(rows, -1))
    _untangled(out.view(np.complex128), rows)
    return CosineCoefficients(out, rows)


def _transform(matrix: Complexes) -> None:
    """Transform in place: of the number q j1 + j2 at (j1, j2) to the number k1 + p k2 at (k1, k2)."""
    p, q = matrix.shape
    width, height = max(PIECE // p, 1), max(PIECE // q, 1)
    for first in range(0, q, width):
        matrix[:, first : first + width] = fft.fft(matrix[:, first : first + width], axis=0)
    # The factors are products of two from tables: of the number of a turn's part, and of the parts that are left.
    parts = math.isqrt(p * q) + 1
    near, far = (np.exp(-2j * np.pi / (p * q) * step * np.arange(parts)) for step in (1, parts))
    for first in range(0, p, height):
        rows = matrix[first : first + height]
        _twiddled(rows, first, near, far)
        rows[:] = fft.fft(rows, axis=1)


@compiled()
def _twiddled(rows: Complexes, first: int, near: Complexes, far: Complexes) -> None:  # pragma: no cover - compiled
    parts = near.size
    for row in range(rows.shape[0]):
        for column in range(rows.shape[1]):
            turn = (first + row) * column
            rows[row, column] *= far[turn // parts] * near[turn % parts]


@compiled()
def _interleaved(values: Floats, level: float, slope: float, out: Floats) -> None:  # pragma: no cover - compiled
    middle = (values.size - 1) / 2.0
    for k in range(values.size):
        place = k // 2 if k % 2 == 0 else values.size - 1 - k // 2
        out[place] = values[k] - level - slope * (k - middle)


@compiled()
def _turned(transform: Complexes, out: Floats) -> None:  # pragma: no cover - compiled
    n = out.size
    scale = math.sqrt(2.0 / n)
    for k in range(transform.size):
        angle = math.pi * k / (2.0 * n)
        cosine, sine = math.cos(angle), math.sin(angle)
        real, imaginary = transform[k].real, transform[k].imag
        out[k] = scale * (real * cosine + imaginary * sine)
        if k > 0:
            out[n - k] = scale * (real * sine - imaginary * cosine)
    out[0] /= math.sqrt(2.0)


@compiled()
def _untangled(z: Complexes, rows: int) -> None:  # pragma: no cover - compiled
    """Put the coefficients k and n - k in the place of number k of a transform of neighbours; 0 and n/2 in that of number 0."""
    m = z.size
    scale = math.sqrt(1.0 / m)
    even, odd = z[0].real, z[0].imag
    z[0] = scale * math.sqrt(0.5) * complex(even + odd, even - odd)
    columns = m // rows
    for k in range(1, m // 2 + 1):
        here, there = (k % rows) * columns + k // rows, ((m - k) % rows) * columns + (m - k) // rows
        a, b = z[here], z[there].conjugate()
        turn = complex(math.cos(math.pi * k / m), -math.sin(math.pi * k / m))
        even_part, odd_part = (a + b) / 2.0, turn * (a - b) / 2.0j
        for place, number, whole in (
            (here, k, even_part + odd_part),
            (there, m - k, (even_part - odd_part).conjugate()),
        ):
            angle = math.pi * number / (4.0 * m)
            cosine, sine = math.cos(angle), math.sin(angle)
            z[place] = scale * complex(whole.real * cosine + whole.imag * sine, whole.real * sine - whole.imag * cosine)


@compiled()
def _place(index: int, n: int, rows: int) -> int:  # pragma: no cover - compiled
    """Return the place of a coefficient."""
    if not rows:
        return index
    if index == n // 2:
        return 1
    imaginary = index > n // 2
    number = n - index if imaginary else index
    return 2 * ((number % rows) * (n // 2 // rows) + number // rows) + (1 if imaginary else 0)


@compiled()
def _binned(
    values: Floats, rows: int, edges: Integers, first: Integers, last: Integers
) -> tuple[Floats, Integers]:  # pragma: no cover - compiled
    """Return the sums of squares between edges and their counts, without the lines at first ... last."""
    sums, counts = np.zeros(edges.size - 1), np.zeros(edges.size - 1, np.int64)
    for i in range(edges.size - 1):
        total, count = 0.0, 0
        for j in range(edges[i], edges[i + 1]):
            inside = False
            for line in range(first.size):
                if first[line] <= j <= last[line]:
                    inside = True
            if not inside:
                total += values[_place(j, values.size, rows)] ** 2
                count += 1
        sums[i], counts[i] = total, count
    return sums, counts

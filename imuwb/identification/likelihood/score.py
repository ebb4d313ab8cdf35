"""Deviance, Fisher information and scoring target of a sum of processes; compiled, because a search takes thousands."""

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.compiled import compiled

LEAST_SHARE = 1e-14  #: floor of a density, as a share of the largest density


@compiled()
def add_bins(
    squared: Floats, power: Floats, count: Floats, design: Floats, information: Floats, target: Floats
) -> float:  # pragma: no cover - compiled
    """Add the information of the bins, which have one density each; return their part of the deviance.

    Args:
        squared: (t,) sizes².
        power: (k,) mean squares.
        count: (k,) coefficients in each bin.
        design: (k, t) densities of processes of size 1.
        information: (t, t) to add to.
        target: (t,) to add to.
    """
    bins, terms = design.shape
    density = np.empty(bins)
    largest = 1e-300
    for k in range(bins):
        density[k] = 0.0
        for t in range(terms):
            density[k] += design[k, t] * squared[t]
        largest = max(largest, density[k])
    deviance = 0.0
    for k in range(bins):
        s = max(density[k], largest * LEAST_SHARE)
        deviance += count[k] * (np.log(s) + power[k] / s)
        for t in range(terms):
            share = count[k] * design[k, t] / (2.0 * s * s)
            target[t] += share * power[k]
            for u in range(t + 1):
                information[t, u] += share * design[k, u]
    for t in range(terms):
        for u in range(t):
            information[u, t] = information[t, u]
    return deviance


@compiled()
def add_low(
    squared: Floats,
    low: Floats,
    trend: Floats,
    parts: Floats,
    edges: Integers,
    removed: float,
    ramp: bool,  # noqa: FBT001 - compiled code takes positional arguments
    information: Floats,
    target: Floats,
) -> tuple[float, float, float]:  # pragma: no cover - compiled
    """Add the information of the lowest coefficients with all their covariances; return deviance, ramp and its sigma.

    Records of one sensor are independent: each has its own matrix, so the cost grows as their number. By the symmetry of a
    record, coefficients of odd and of even half periods are not correlated either, and a ramp is in the odd ones only. So there
    are two matrices of half the size for each record.

    Args:
        squared: (t,) sizes².
        low: (l,) coefficients.
        trend: (l,) lowest coefficients of a ramp of 1 unit/s; 0 at even half periods.
        parts: (t, l, w) covariances of processes of size 1, of each coefficient with those of its own record.
        edges: (r + 1,) first coefficients of the records, and their number.
        removed: ramp that was taken off the samples; it is put back if ``ramp`` is false.
        ramp: whether a ramp is estimated (restricted likelihood).
        information: (t, t) to add to.
        target: (t,) to add to.
    """
    deviance, slope, sigma = 0.0, 0.0, 0.0
    for half in range(2 * (edges.size - 1)):
        first, last, odd = edges[half // 2], edges[half // 2 + 1], half % 2 == 0
        chosen = first + np.flatnonzero((trend[first:last] != 0.0) == odd)
        white, log_determinant = _whitener(squared, parts, chosen, first)
        if log_determinant == np.inf:
            return np.inf, 0.0, 0.0
        data, along = _product(white, low[chosen]), _product(white, trend[chosen])
        if not ramp:
            data += removed * along
            along[:] = 0.0
        strength = np.sum(along * along)
        if strength > 0.0:
            slope, sigma = np.sum(data * along) / strength, 1.0 / np.sqrt(strength)
            data -= slope * along
            along /= np.sqrt(strength)
            deviance += np.log(strength)
        deviance += log_determinant + np.sum(data * data)
        _add_shapes(white, parts, chosen, first, data, along, information, target)
    return deviance, slope, sigma


@compiled()
def _whitener(
    squared: Floats, parts: Floats, chosen: Integers, first: int
) -> tuple[Floats, float]:  # pragma: no cover - compiled
    """Return a lower triangular W with W C W' = 1, and log |C|, which is infinite where C is not positive definite."""
    n = chosen.size
    lower, scale = np.zeros((n, n)), np.empty(n)
    for i in range(n):
        for j in range(i + 1):
            for t in range(squared.size):
                lower[i, j] += squared[t] * parts[t, chosen[i], chosen[j] - first]
        scale[i] = max(np.sqrt(lower[i, i]), 1e-150)
    for i in range(n):
        for j in range(i + 1):
            lower[i, j] /= scale[i] * scale[j]
        lower[i, i] += LEAST_SHARE
    if not _factored(lower):
        return lower, np.inf
    white, log_determinant = _inverse(lower), 0.0
    for i in range(n):
        log_determinant += 2.0 * np.log(lower[i, i] * scale[i])
        for j in range(i + 1):
            white[i, j] /= scale[j]
    return white, log_determinant


@compiled()
def _product(lower: Floats, vector: Floats) -> Floats:  # pragma: no cover - compiled
    product = np.zeros(vector.size)
    for i in range(vector.size):
        for j in range(i + 1):
            product[i] += lower[i, j] * vector[j]
    return product


@compiled()
def _add_shapes(
    white: Floats,
    parts: Floats,
    chosen: Integers,
    first: int,
    data: Floats,
    along: Floats,
    information: Floats,
    target: Floats,
) -> None:  # pragma: no cover - compiled
    """Add half the products of the terms' whitened covariances with each other, and with the data."""
    n, terms = chosen.size, parts.shape[0]
    shapes = np.empty((terms, n, n))
    for t in range(terms):
        _whitened(white, parts[t], chosen, first, shapes[t])
        _without(along, shapes[t])
        for i in range(n):
            for j in range(n):
                target[t] += data[i] * shapes[t, i, j] * data[j] / 2.0
        for u in range(t + 1):
            both = np.sum(shapes[t] * shapes[u]) / 2.0
            information[t, u] += both
            if u < t:
                information[u, t] += both


@compiled()
def _factored(a: Floats) -> bool:  # pragma: no cover - compiled
    """Replace the lower half of a matrix by its Cholesky factor; return False where it is not positive definite."""
    for j in range(a.shape[0]):
        for k in range(j):
            a[j, j] -= a[j, k] ** 2
        if not a[j, j] > 0.0:
            return False
        a[j, j] = np.sqrt(a[j, j])
        for i in range(j + 1, a.shape[0]):
            for k in range(j):
                a[i, j] -= a[i, k] * a[j, k]
            a[i, j] /= a[j, j]
    return True


@compiled()
def _inverse(lower: Floats) -> Floats:  # pragma: no cover - compiled
    """Return the inverse of a lower triangular matrix."""
    n = lower.shape[0]
    inverse = np.zeros((n, n))
    for j in range(n):
        inverse[j, j] = 1.0 / lower[j, j]
        for i in range(j + 1, n):
            for k in range(j, i):
                inverse[i, j] -= lower[i, k] * inverse[k, j]
            inverse[i, j] /= lower[i, i]
    return inverse


@compiled(reorder=True)
def _whitened(
    white: Floats, part: Floats, chosen: Integers, first: int, out: Floats
) -> None:  # pragma: no cover - compiled
    """Write W part W' of the chosen rows; W is lower triangular."""
    n = chosen.size
    half = np.zeros((n, n))  # part W'
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(j + 1):
                total += part[chosen[i], chosen[k] - first] * white[j, k]
            half[i, j] = total
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(i + 1):
                total += white[i, k] * half[k, j]
            out[i, j] = out[j, i] = total


@compiled()
def _without(along: Floats, a: Floats) -> None:  # pragma: no cover - compiled
    """Project a direction of length 1, or of length 0 for none, out of a symmetric matrix."""
    n = along.size
    image = np.zeros(n)
    for i in range(n):
        for j in range(n):
            image[i] += a[i, j] * along[j]
    both = np.sum(image * along)
    for i in range(n):
        for j in range(n):
            a[i, j] += along[i] * along[j] * both - along[i] * image[j] - image[i] * along[j]

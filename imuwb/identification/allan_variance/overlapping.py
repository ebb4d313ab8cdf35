"""Overlapping Allan deviation (IEEE 952 annex C; El-Diasty, 2.1; Quinchia, eq. 12 to 15; Hassaballa, 4.2)."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from imuwb.compiled import compiled
from imuwb.identification.allan_variance import noise_type
from imuwb.identification.allan_variance.averaging import averaging_factors
from imuwb.identification.allan_variance.gapped import bridged
from imuwb.identification.allan_variance.moments import equivalent_degrees_of_freedom
from imuwb.statistics.distributions import chi_square_limits, normal_limit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Uncertainty = Literal["edf", "printed"]
BLOCK = 2048  #: samples of the sum that stay in the fastest cache while all factors use them
ROUNDED = 1e-8  #: of a sum of squares: the largest mean square of rounding errors that the fast mode allows
BRIDGE = 0.5  #: share of the second differences; where gaps leave less, block means bridge them
LEAST_CLEAR = (
    0.1  #: share of the degrees of freedom left; with less, a bridged variance is what its correction makes of it
)
ROUGHLY = 61  #: every so many samples are averaged to what is taken off before they are summed up
THINNEST = 16  #: points of the sum in an averaging time that the fast mode keeps at least


@dataclass(frozen=True, eq=False, slots=True)
class AllanDeviation:
    """An Allan curve with its intervals. Units are those of the samples."""

    n: int  #: samples
    dt: float  #: s
    level: float  #: of the intervals
    factor: NDArray[np.int64]  #: (k,) averaging factors m
    averaging_time: Floats  #: (k,) s
    deviation: Floats  #: (k,)
    lower: Floats  #: (k,)
    upper: Floats  #: (k,)
    degrees_of_freedom: Floats  #: (k,)
    noise_type: NDArray[np.int64]  #: (k,) exponent of the power law: 2, 1, 0, -1, -2
    terms: NDArray[np.int64]  #: (k,) second differences that were averaged


def allan(
    values: Floats,
    dt: float,
    averaging_times: str | Sequence[float] = "octave",
    *,
    level: float = 0.95,
    uncertainty: Uncertainty = "edf",
    breaks: Sequence[int] = (),
    time: NDArray[np.int64] | None = None,
    fast: bool = False,
) -> AllanDeviation:
    """Return the overlapping Allan deviation of a rate (or specific force) series.

    sigma²(tau) = sum (theta(k+2m) - 2 theta(k+m) + theta(k))² / (2 tau² (n + 1 - 2m)), theta the sum of
    the samples times dt, their mean taken off.

    Args:
        values: (n,) samples, evenly spaced.
        dt: s.
        averaging_times: ``"octave"``, ``"log:N"``, ``"all"``, or times in s.
        level: of the intervals.
        uncertainty: ``"edf"``: chi-square with Greenhall-Riley degrees of freedom of the noise type
            found at each averaging time; ``"printed"``: +-z/√(2(n/m - 1)), the papers' formula
            (Quinchia, eq. 15; Hassaballa, eq. 10).
        breaks: indices at which samples are missing before; no second difference spans one.
        time: (n,) ns; where gaps leave too few second differences, averaging times are bridged by the
            block means of the samples there are (``gapped.bridged``). Without it, they end with the longest part.
        fast: thin the sum out at long averaging times, to 16 to 32 points in one; the averaging times are rounded to
            that, and the intervals are those of the thinned sums.

    Raises:
        ValueError: fewer than 2 samples, or no averaging time within the record.
    """
    values = np.ascontiguousarray(values, dtype=np.float64)
    # What is taken off leaves the second differences alone; it keeps the sum's digits. So a rough mean will do.
    center = float(values[0] + (values[::ROUGHLY] - values[0]).mean()) if values.size else 0.0
    edges = [0, *sorted(breaks), values.size]
    phases = [_phase(values[a:b], center) for a, b in pairwise(edges) if b > a]
    # A sum of samples is finite only if all of them are.
    if not (dt > 0 and np.isfinite(dt) and all(np.isfinite(phase[-1]) for phase in phases)):
        message = f"dt is {dt} and {np.count_nonzero(~np.isfinite(values))} samples are not finite; dt must be positive, all samples finite"
        raise ValueError(message)
    phases = [phase for phase in phases if phase.size > 2]  # noqa: PLR2004 - two samples
    if not phases:
        message = f"{values.size} samples hold no two that follow each other; the Allan variance needs them"
        raise ValueError(message)
    place = _places(time, dt) if time is not None and breaks else None
    factor = averaging_factors(averaging_times, max(map(len, phases)) - 1 if place is None else int(place[-1]) + 1, dt)
    if fast:
        factor = np.unique(factor // _strides(factor) * _strides(factor))
    longest = max(phases, key=len)
    exponents = {int(m): noise_type.exponent(longest[::m]) for m in factor}
    counted = _thinned_terms(phases, factor) if fast else None
    squares, terms = np.zeros(factor.size), np.zeros(factor.size, dtype=np.int64)
    for phase in phases:
        squares += thinned_sums_of_squares(phase, factor) if fast else sums_of_squares(phase, factor)
        terms += np.maximum(phase.size - 2 * factor, 0)
    counted = terms if counted is None else counted
    variance = np.divide(squares, 2.0 * counted * factor**2.0, out=np.zeros(factor.size), where=counted > 0)
    loss = np.ones(factor.size)
    if place is not None:
        factor, variance, terms, loss = _with_bridges(values, place, factor, variance, terms)
    deviation = np.sqrt(variance)
    kinds = _noise_types([exponents[int(m)] for m in factor])
    # Gaps leave fewer terms; as if from a record that has that many. Thinned sums are those of a thinned record.
    n_effective = terms + 2 * factor - 1
    thin = _strides(factor) if fast else np.ones_like(factor)
    edf = loss * np.array(
        [
            equivalent_degrees_of_freedom(int(m // s), int(n // s), int(a))
            for m, n, a, s in zip(factor, n_effective, kinds, thin, strict=True)
        ]
    )
    lower, upper = _interval(deviation, edf, values.size / factor, level, uncertainty)
    return AllanDeviation(
        values.size, dt, level, factor, factor.astype(np.float64) * dt, deviation, lower, upper, edf, kinds, terms
    )


def _interval(
    deviation: Floats, edf: Floats, clusters: Floats, level: float, uncertainty: Uncertainty
) -> tuple[Floats, Floats]:
    if uncertainty == "edf":
        low, high = chi_square_limits(level, edf)
        return deviation * np.sqrt(low), deviation * np.sqrt(high)
    half = normal_limit(level) / np.sqrt(2 * np.maximum(clusters - 1, 0.5))
    return np.maximum(deviation * (1 - half), 0.0), deviation * (1 + half)


def _places(time: NDArray[np.int64], dt: float) -> NDArray[np.int64]:
    """Return each sample's place on an even grid; stamps that scatter never swap two or put two in one."""
    steps = np.maximum(np.rint(np.diff(time) / (dt * 1e9)), 1).astype(np.int64)
    return np.concatenate([[0], np.cumsum(steps)])


def _with_bridges(
    values: Floats, place: NDArray[np.int64], factor: NDArray[np.int64], variance: Floats, terms: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Floats, NDArray[np.int64], Floats]:
    """Return factors, variances, terms and the loss of degrees of freedom, bridged where gaps leave less than half."""
    whole = int(place[-1]) + 2 - 2 * factor
    thin = terms < BRIDGE * whole
    loss = np.ones(factor.size)
    if thin.any():
        variance, terms = variance.copy(), terms.copy()
        variance[thin], terms[thin], clear = bridged(values, place, factor[thin])
        loss[thin] = np.nan_to_num(clear) ** 2
    known = np.isfinite(variance) & (variance > 0) & (terms > 0) & (loss > LEAST_CLEAR)
    if not known.any():  # a constant channel
        known = terms > 0
    return factor[known], np.nan_to_num(variance[known]), terms[known], loss[known]


@compiled()
def _integrate(values: Floats, center: float, out: Floats) -> None:  # pragma: no cover - compiled
    total = 0.0
    out[0] = 0.0
    for k in range(values.size):
        total += values[k] - center
        out[k + 1] = total


def _phase(values: Floats, center: float) -> Floats:
    """Return the running sum of the samples less ``center``, from 0 on: theta/dt."""
    phase = np.empty(values.size + 1)
    _integrate(values, center, phase)
    return phase


def integrated(values: Floats) -> Floats:
    """Return the running sum of the samples less their mean, from 0 on."""
    return _phase(np.ascontiguousarray(values, dtype=np.float64), float(values.mean()))


@compiled(reorder=True)
def _sum_of_squares(
    early: NDArray[Any], middle: NDArray[Any], late: NDArray[Any]
) -> float:  # pragma: no cover - compiled
    """Return the sum of (late - 2 middle + early)²; slices of one array, so the loop vectorises."""
    total = early.dtype.type(0.0)
    for k in range(late.size):
        z = late[k] - middle[k] - middle[k] + early[k]
        total += z * z
    return total


@compiled()
def _sums(phase: Floats, factors: NDArray[np.int64], block: int, out: Floats) -> None:  # pragma: no cover - compiled
    """Add the squares of all factors block by block, so that a block is fetched from memory once."""
    n = phase.size
    for begin in range(0, n, block):
        for i in range(factors.size):
            m = factors[i]
            end = min(begin + block, n - 2 * m)
            if end > begin:
                out[i] += _sum_of_squares(
                    phase[begin:end], phase[begin + m : end + m], phase[begin + 2 * m : end + 2 * m]
                )


def sums_of_squares(phase: Floats, factors: NDArray[np.int64]) -> Floats:
    """Return sum (phase(k+2m) - 2 phase(k+m) + phase(k))² for every factor m; 0 where none fits."""
    out = np.zeros(factors.size)
    _sums(phase, np.ascontiguousarray(factors, dtype=np.int64), BLOCK, out)
    return out


@compiled(reorder=True)
def _bends(piece: Floats, ramp: Floats, out: NDArray[np.float32]) -> float:  # pragma: no cover - compiled
    """Write a piece less the straight line through its ends; return the mean square."""
    total, first = 0.0, piece[0]
    slope = (piece[-1] - first) / max(piece.size - 1, 1)
    for k in range(piece.size):
        bend = piece[k] - first - slope * ramp[k]
        out[k] = bend
        total += bend * bend
    return total / piece.size


@compiled()
def _single_sums(
    phase: Floats, factors: NDArray[np.int64], block: int, out: Floats
) -> None:  # pragma: no cover - compiled
    """Add the squares as ``_sums`` does, in numbers of half the length, of which twice as many go at a time.

    A block's straight line, which no second difference sees, is taken off, so that only what bends counts. Where
    rounding errors could show all the same, the sum is done in full.
    """
    n, longest = phase.size, 2 * factors.max()
    local, ramp = np.empty(block + longest, np.float32), np.arange(float(block + longest))
    for begin in range(0, n, block):
        size = min(block + longest, n - begin)
        rounding = 6.0 * _bends(phase[begin : begin + size], ramp, local) * 2.0**-48
        for i in range(factors.size):
            m = factors[i]
            count = min(block, size - 2 * m)
            if count <= 0:
                continue
            total = _sum_of_squares(local[:count], local[m : m + count], local[2 * m : 2 * m + count])
            if np.isfinite(total) and total * ROUNDED > count * rounding:
                out[i] += total
            else:
                end = begin + count
                out[i] += _sum_of_squares(
                    phase[begin:end], phase[begin + m : end + m], phase[begin + 2 * m : end + 2 * m]
                )


def _strides(factors: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return powers of two by which the phase may be thinned out and leave 16 to 32 points in an averaging time."""
    return 2 ** np.maximum(np.log2(factors / THINNEST).astype(np.int64), 0)


def _thinned_terms(phases: Sequence[Floats], factors: NDArray[np.int64]) -> NDArray[np.int64]:
    strides = _strides(factors)
    return sum(
        (np.maximum((phase.size - 1 - 2 * factors) // strides + 1, 0) for phase in phases),
        np.zeros(factors.size, np.int64),
    )


def thinned_sums_of_squares(phase: Floats, factors: NDArray[np.int64]) -> Floats:
    """Return ``sums_of_squares`` of every ``_strides``-th second difference; ``phase`` is used up."""
    out = np.zeros(factors.size)
    strides = _strides(factors)
    stride = 1
    while stride <= strides.max(initial=1):
        chosen = strides == stride
        if chosen.any():
            sums = np.zeros(int(chosen.sum()))
            _single_sums(phase, factors[chosen] // stride, BLOCK, sums)
            out[chosen] = sums
        phase = _halved(phase)
        stride *= 2
    return out


@compiled()
def _halved(phase: Floats) -> Floats:  # pragma: no cover - compiled
    """Return every second value, moved to the front: new memory would cost more than the sums."""
    for k in range((phase.size + 1) // 2):
        phase[k] = phase[2 * k]
    return phase[: (phase.size + 1) // 2]


def _noise_types(exponents: Sequence[int | None]) -> NDArray[np.int64]:
    """Return the exponent at each factor; where too few points are left to tell (None), the last that was sure.

    In a sum, ever redder processes rule as averaging times grow: a bluer type is chance.
    """
    kinds = np.zeros(len(exponents), dtype=np.int64)
    last = next((found for found in exponents if found is not None), 0)
    for i, found in enumerate(exponents):
        last = last if found is None else min(found, last)
        kinds[i] = last
    return kinds


def allan_of_axes(
    series: dict[str, tuple[Floats, float, Sequence[int]]],
    averaging_times: str | Sequence[float] = "octave",
    *,
    level: float = 0.95,
    uncertainty: Uncertainty = "edf",
    fast: bool = False,
) -> dict[str, AllanDeviation]:
    """Return ``allan`` of several axes, {name: (values, dt, breaks)}, on two threads."""
    with ThreadPoolExecutor(2) as pool:
        futures = {
            name: pool.submit(
                allan, values, dt, averaging_times, level=level, uncertainty=uncertainty, breaks=breaks, fast=fast
            )
            for name, (values, dt, breaks) in series.items()
        }
        return {name: future.result() for name, future in futures.items()}

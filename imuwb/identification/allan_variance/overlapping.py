"""Overlapping Allan deviation (IEEE 952 annex C; El-Diasty, 2.1; Quinchia, eq. 12 to 15; Hassaballa, 4.2)."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers, alone
from imuwb.compiled import compiled
from imuwb.identification.allan_variance import noise_type
from imuwb.identification.allan_variance.averaging import averaging_factors
from imuwb.identification.allan_variance.gapped import bridged
from imuwb.identification.allan_variance.moments import equivalent_degrees_of_freedom
from imuwb.identification.coefficient import printed_half_width
from imuwb.statistics.distributions import chi_square_limits
from imuwb.texts import number_text

Uncertainty = Literal["edf", "printed"]
BLOCK = 2048  #: points; a block of the sum stays in the fastest cache while all factors use it
ROUNDED = 1e-8  #: largest mean square of rounding errors in the fast mode, as a share of a sum of squares
BRIDGE = 0.5  #: where gaps leave a smaller share of the second differences, block means bridge the gaps
LEAST_CLEAR = 0.1  #: least share of the degrees of freedom; with less, a bridged variance is mostly its correction
ROUGHLY = 61  #: the mean of every 61st sample is subtracted from all samples before they are summed
THINNEST = 16  #: least number of points of the sum in an averaging time, in the fast mode


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class AllanDeviation:
    """An Allan curve with its intervals, in the unit of the samples."""

    n: int  #: samples
    dt: float  #: s
    level: float  #: confidence level of the intervals
    factor: Integers  #: (k,) averaging factors m
    averaging_time: Floats  #: (k,) s
    deviation: Floats  #: (k,)
    lower: Floats  #: (k,)
    upper: Floats  #: (k,)
    degrees_of_freedom: Floats  #: (k,)
    noise_type: Integers  #: (k,) exponent of the power law: 2, 1, 0, -1, -2
    terms: Integers  #: (k,) second differences in the mean

    def __repr__(self) -> str:
        """Return the range of averaging times and the least deviation."""
        least = int(np.argmin(self.deviation))
        return (
            f"Allan deviation of {self.n} samples at {1 / self.dt:.6g} Hz: {self.factor.size} averaging times from "
            f"{number_text(float(self.averaging_time[0]))} to {number_text(float(self.averaging_time[-1]))} s, least "
            f"{self.deviation[least]:.4g} [{self.lower[least]:.4g}, {self.upper[least]:.4g}] at "
            f"{number_text(float(self.averaging_time[least]))} s, {100 * self.level:g} % intervals"
        )


def allan(
    values: Floats,
    dt: float,
    averaging_times: str | Sequence[float] = "octave",
    *,
    level: float = 0.95,
    uncertainty: Uncertainty = "edf",
    breaks: Sequence[int] = (),
    time: Integers | None = None,
    fast: bool = False,
) -> AllanDeviation:
    """Return the overlapping Allan deviation of a rate (or specific force) series.

    sigma²(tau) = sum (theta(k+2m) - 2 theta(k+m) + theta(k))² / (2 tau² (n + 1 - 2m)), where theta is the sum of the samples
    times dt, without their mean.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        averaging_times: ``"octave"``, ``"log:N"``, ``"all"``, or times in s.
        level: confidence level of the intervals.
        uncertainty: ``"edf"``: chi-square with Greenhall-Riley degrees of freedom of the noise type at each averaging time;
            ``"printed"``: +-z/√(2(n/m - 1)), the papers' formula (Quinchia, eq. 15; Hassaballa, eq. 10).
        breaks: indices before which samples are missing; no second difference spans a break.
        time: (n,) ns. Where gaps leave too few second differences, block means bridge them (``gapped.bridged``). Without
            ``time``, the longest averaging time is half the longest part.
        fast: whether the sum is thinned at long averaging times: 16 to 32 points in each are left. The averaging times are
            rounded to the steps of these points, and the intervals are those of the thinned sums.

    Raises:
        ValueError: fewer than 2 samples, samples that are not finite, or no averaging time within the record.
    """
    values = np.asarray(values, dtype=np.float64)
    place = _places(time, dt) if time is not None and breaks else None
    with alone(values.size):
        factor, exponents, variance, terms = _summed(values, dt, averaging_times, breaks, place, fast=fast)
    loss = np.ones(factor.size)
    if place is not None:
        factor, variance, terms, loss = _with_bridges(values, place, factor, variance, terms)
    thin = _strides(factor) if fast else np.ones_like(factor)
    deviation = np.sqrt(variance)
    kinds = _noise_types([exponents[int(m)] for m in factor])
    edf = loss * _degrees_of_freedom(factor, terms, kinds, thin)
    lower, upper = _interval(deviation, edf, values.size / factor, level, uncertainty)
    return AllanDeviation(
        values.size, dt, level, factor, factor.astype(np.float64) * dt, deviation, lower, upper, edf, kinds, terms
    )


def _summed(
    values: Floats,
    dt: float,
    averaging_times: str | Sequence[float],
    breaks: Sequence[int],
    place: Integers | None,
    *,
    fast: bool,
) -> tuple[Integers, dict[int, int | None], Floats, Integers]:
    """Return the factors, the exponent of the noise at each, the variances and their terms; the running sums are freed."""
    phases = _phases(values, dt, breaks)
    factor = averaging_factors(averaging_times, max(map(len, phases)) - 1 if place is None else int(place[-1]) + 1, dt)
    if fast:
        factor = np.unique(factor // _strides(factor) * _strides(factor))
    longest = max(phases, key=len)
    exponents = {int(m): noise_type.exponent(longest[::m]) for m in factor}
    return factor, exponents, *_variances(phases, factor, fast=fast)


def _phases(values: Floats, dt: float, breaks: Sequence[int]) -> list[Floats]:
    """Return the running sums of the parts between breaks that have at least two samples."""
    # An offset does not change second differences, but it costs digits of the sum. A rough mean is enough to remove it.
    center = float(values[0] + (values[::ROUGHLY] - values[0]).mean()) if values.size else 0.0
    edges = [0, *sorted(breaks), values.size]
    phases = [_phase(values[a:b], center) for a, b in pairwise(edges) if b > a]
    # A sum of samples is finite only if all of them are.
    if not (dt > 0 and np.isfinite(dt) and all(np.isfinite(phase[-1]) for phase in phases)):
        raise ValueError(
            f"dt is {dt} and {np.count_nonzero(~np.isfinite(values))} samples are not finite; dt must be positive, all samples finite"
        )
    phases = [phase for phase in phases if phase.size > 2]  # noqa: PLR2004 - two samples
    if not phases:
        raise ValueError(
            f"{values.size} samples, of which no two follow each other without a gap; the Allan variance needs at least 2 samples without a gap"
        )
    return phases


def _variances(phases: Sequence[Floats], factor: Integers, *, fast: bool) -> tuple[Floats, Integers]:
    """Return the Allan variance at each factor, 0 where there is none, and the number of its second differences."""
    sums = thinned_sums_of_squares if fast else sums_of_squares
    # The fast mode overwrites the phases, so their terms are counted first.
    terms = np.sum([np.maximum(phase.size - 2 * factor, 0) for phase in phases], axis=0)
    counted = _thinned_terms(phases, factor) if fast else terms
    squares = np.zeros(factor.size)
    for phase in phases:
        squares += sums(phase, factor)
    variance = np.divide(squares, 2.0 * counted * factor**2.0, out=np.zeros(factor.size), where=counted > 0)
    return variance, terms


def _degrees_of_freedom(factor: Integers, terms: Integers, kinds: Integers, thin: Integers) -> Floats:
    """Return the degrees of freedom of each variance: those of a thinned record without gaps that has as many terms."""
    n = terms + 2 * factor - 1
    return np.array(
        [
            equivalent_degrees_of_freedom(int(m // s), int(k // s), int(a))
            for m, k, a, s in zip(factor, n, kinds, thin, strict=True)
        ]
    )


def _interval(
    deviation: Floats, edf: Floats, clusters: Floats, level: float, uncertainty: Uncertainty
) -> tuple[Floats, Floats]:
    if uncertainty == "edf":
        low, high = chi_square_limits(level, edf)
        return deviation * np.sqrt(low), deviation * np.sqrt(high)
    half = printed_half_width(clusters, level)
    return np.maximum(deviation * (1 - half), 0.0), deviation * (1 + half)


def _places(time: Integers, dt: float) -> Integers:
    """Return the index of each sample on an even grid; scattered stamps never exchange two samples or merge them."""
    steps = np.maximum(np.rint(np.diff(time) / (dt * 1e9)), 1).astype(np.int64)
    return np.concatenate([[0], np.cumsum(steps)])


def _with_bridges(
    values: Floats, place: Integers, factor: Integers, variance: Floats, terms: Integers
) -> tuple[Integers, Floats, Integers, Floats]:
    """Return factors, variances, terms and loss of degrees of freedom, bridged where gaps leave less than half the terms."""
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
    """Return theta/dt: the running sum of the samples less ``center``, which begins with 0."""
    phase = np.empty(values.size + 1)
    _integrate(values, center, phase)
    return phase


def integrated(values: Floats) -> Floats:
    """Return the running sum of the samples less their mean, which begins with 0."""
    return _phase(np.ascontiguousarray(values, dtype=np.float64), float(values.mean()))


@compiled(reorder=True)
def _sum_of_squares(
    early: NDArray[Any], middle: NDArray[Any], late: NDArray[Any]
) -> float:  # pragma: no cover - compiled
    """Return the sum of (late - 2 middle + early)²; the arguments are slices of one array, so the loop vectorises."""
    total = early.dtype.type(0.0)
    for k in range(late.size):
        z = late[k] - middle[k] - middle[k] + early[k]
        total += z * z
    return total


@compiled()
def _sums(phase: Floats, factors: Integers, block: int, out: Floats) -> None:  # pragma: no cover - compiled
    """Add the squares of all factors block by block, so that each block is read from memory once."""
    n = phase.size
    for begin in range(0, n, block):
        for i in range(factors.size):
            m = factors[i]
            end = min(begin + block, n - 2 * m)
            if end > begin:
                out[i] += _sum_of_squares(
                    phase[begin:end], phase[begin + m : end + m], phase[begin + 2 * m : end + 2 * m]
                )


def sums_of_squares(phase: Floats, factors: Integers) -> Floats:
    """Return sum (phase(k+2m) - 2 phase(k+m) + phase(k))² for every factor m; 0 where m is too long."""
    out = np.zeros(factors.size)
    _sums(phase, np.ascontiguousarray(factors, dtype=np.int64), BLOCK, out)
    return out


@compiled(reorder=True)
def _bends(piece: Floats, ramp: Floats, out: NDArray[np.float32]) -> float:  # pragma: no cover - compiled
    """Write a piece less the straight line through its ends, and return its mean square."""
    total, first = 0.0, piece[0]
    slope = (piece[-1] - first) / max(piece.size - 1, 1)
    for k in range(piece.size):
        bend = piece[k] - first - slope * ramp[k]
        out[k] = bend
        total += bend * bend
    return total / piece.size


@compiled()
def _single_sums(phase: Floats, factors: Integers, block: int, out: Floats) -> None:  # pragma: no cover - compiled
    """Add the squares as ``_sums`` does, in single precision, which is twice as fast.

    A straight line does not change second differences, so the line of each block is taken off to keep digits. Where rounding
    errors could still show, the sum is in double precision.
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


def _strides(factors: Integers) -> Integers:
    """Return the powers of two that thin the phase to 16 to 32 points in each averaging time."""
    return 2 ** np.maximum(np.log2(factors / THINNEST).astype(np.int64), 0)


def _thinned_terms(phases: Sequence[Floats], factors: Integers) -> Integers:
    strides = _strides(factors)
    return sum(
        (np.maximum((phase.size - 1 - 2 * factors) // strides + 1, 0) for phase in phases),
        np.zeros(factors.size, np.int64),
    )


def thinned_sums_of_squares(phase: Floats, factors: Integers) -> Floats:
    """Return ``sums_of_squares`` of every ``_strides``-th second difference; ``phase`` is overwritten."""
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
    """Return every second value, moved to the front, because new memory would cost more than the sums."""
    for k in range((phase.size + 1) // 2):
        phase[k] = phase[2 * k]
    return phase[: (phase.size + 1) // 2]


def _noise_types(exponents: Sequence[int | None]) -> Integers:
    """Return the exponent at each factor; where too few points are left (None), the last exponent.

    In a sum of processes, the exponent falls as the averaging time grows, so a higher exponent comes from chance.
    """
    kinds = np.zeros(len(exponents), dtype=np.int64)
    last = next((exponent for exponent in exponents if exponent is not None), 0)
    for i, exponent in enumerate(exponents):
        last = last if exponent is None else min(exponent, last)
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

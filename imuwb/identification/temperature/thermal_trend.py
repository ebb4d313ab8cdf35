"""The trend that a temperature-dependent bias makes in a record; it is removed when the noise is identified.

Within a stretch the bias is modelled by a parabola of the temperature and a straight line in time. These columns are projected out
of the lowest cosine coefficients (restricted likelihood). So a thermal drift does not look like flicker or a random walk, and
the lost coefficients do not count as evidence against them.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import linalg

from imuwb.arrays import Floats
from imuwb.identification.likelihood.cosine_spectrum import LOW, CosineSpectrum, cosine_spectrum
from imuwb.identification.likelihood.problem import LikelihoodProblem

MOVED = 0.2  #: °C; a stretch whose smoothed temperature spans less has no thermal trend
KNOTS = 40  #: means of a stretch, between which the smoothed thermometer is linear
SAME = 1e-6  #: share of a column's size; a smaller remainder next to the other columns is a rounding error


def smooth_temperature(time: Floats, celsius: Floats, at: Floats) -> Floats:
    """Return a thermometer's readings, smoothed and interpolated at other times, (m,) °C.

    Args:
        time: (n,) s of the readings.
        celsius: (n,) °C.
        at: (m,) s, rising, within a stretch.
    """
    inside = (time >= at[0]) & (time <= at[-1])
    if np.count_nonzero(inside) < 2:  # noqa: PLR2004 - a straight line between the readings around
        return np.interp(at, time, celsius)
    t, c = time[inside], celsius[inside]
    parts = min(KNOTS, t.size)
    edges = np.linspace(0, t.size, parts + 1).astype(np.int64)[:-1]
    count = np.diff(np.append(edges, t.size))
    knots, means = np.add.reduceat(t, edges) / count, np.add.reduceat(c, edges) / count
    smooth = np.interp(at, knots, means)
    for ends, side in ((slice(0, 2), at < knots[0]), (slice(-2, None), at > knots[-1])):
        (t0, t1), (c0, c1) = knots[ends], means[ends]
        smooth[side] = c0 + (c1 - c0) / (t1 - t0) * (at[side] - t0)
    return smooth


def trend_of(n: int, celsius: Floats | None) -> Floats:
    """Return the columns of a drift, (n, p): a line in time and, if the temperature changes, a parabola of the temperature."""
    line = np.linspace(-1, 1, n)
    if celsius is None or np.ptp(celsius) < MOVED:
        return line[:, None]
    warm = (celsius - celsius.mean()) / np.ptp(celsius)
    return np.stack([line, warm, warm**2], axis=1)


def without_trend(values: Floats, trend: Floats) -> Floats:
    """Return values minus their mean and the least-squares fit of the trend's columns, (n,)."""
    columns = trend - trend.mean(axis=0)
    rest = values - values.mean()
    squares, products = np.einsum("ip,iq->pq", columns, columns), np.einsum("ip,i->p", columns, rest)
    return rest - np.einsum("ip,p->i", columns, np.linalg.lstsq(squares, products, rcond=1e-12)[0])


def lowest(trend: Floats, dt: float) -> Floats:
    """Return the lowest cosine coefficients of a trend's columns, (32, p)."""
    spectra = [cosine_spectrum(np.ascontiguousarray(column), dt) for column in trend.T[1:]]
    line = cosine_spectrum(np.zeros(len(trend)), dt).trend()  # a spectrum has its line already removed
    return np.stack([line, *(spectrum.low for spectrum in spectra)], axis=1).reshape(LOW, -1)


def restricted(problem: LikelihoodProblem, spectrum: CosineSpectrum, trend: Floats) -> LikelihoodProblem:
    """Return the problem without a trend, (32, p), in the lowest coefficients."""
    columns = trend[spectrum.index - 1]
    size = np.linalg.norm(columns, axis=0)
    own = size > SAME * (spectrum.n * spectrum.dt) ** 0.5
    own[0] = True  # the line, whose coefficients have another scale
    kept = columns[:, own] / size[own].clip(1e-300)
    left = np.asarray(linalg.null_space(kept.T, rcond=SAME), dtype=np.float64)
    parts = left.T @ problem.parts @ left
    return replace(
        problem,
        low=left.T @ problem.low,
        trend=np.zeros(left.shape[1]),
        parts=parts,
        ramp=0.0,
        edges=np.array([0, left.shape[1]]),
    )


def joined(problems: Sequence[LikelihoodProblem]) -> LikelihoodProblem:
    """Return the problem of several records of one sensor, each without its trend: their coefficients together."""
    if len(problems) == 1:
        return problems[0]
    order = np.argsort(np.concatenate([p.frequency for p in problems]), kind="stable")

    def together(name: str) -> Floats:
        return np.concatenate([getattr(p, name) for p in problems])

    widest = max(p.parts.shape[2] for p in problems)
    parts = np.concatenate(
        [np.pad(p.parts, ((0, 0), (0, 0), (0, widest - p.parts.shape[2]))) for p in problems], axis=1
    )
    edges = np.cumsum([0, *(p.low.size for p in problems)])
    return replace(
        problems[0], low=together("low"), trend=together("trend"), parts=parts, edges=edges, frequency=together("frequency")[order],
        power=together("power")[order], count=together("count")[order], design=together("design")[order],
    )  # fmt: skip

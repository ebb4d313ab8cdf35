"""Test the upper limits of terms that were not identified.

A record is 30 min at 100 Hz of white noise and flicker (N and B of gyro x of the preset 3dm-gx3-25) and a random walk whose K
is 0, 0.3, 1 or 3 times the detection size. The detection size is the K whose expected estimate just passes the test of the
fit: K² = z sigma, where z = 1.96 belongs to the test, and sigma is the standard error of K² by generalised least squares
beside N² and B² when K is 0, calculated here from the exact moments. Goals: the limit of an absent term is always above 0; an
absent term is seldom identified; the upper end, of an interval or of a limit at 95 %, is below a K that is present in at most
7 % of records.

Command: ``python tests/studies/limits.py`` (800 records of each size: 4 to 10 minutes).
Seeds: record r of size s (0 to 3) uses ``SeedSequence([s, r])``.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy import stats
from study_report import Share, Table, main, over_records, pooled, verdict

from imuwb.identification import allan, averaging_factors, fit_allan
from imuwb.identification.allan_variance.moments import moments
from imuwb.simulation import preset
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

QUESTION = "Upper limits of terms that were not identified"
RATE, MINUTES, LEVEL = 100.0, 30.0, 0.95
SIZES = (0.0, 0.3, 1.0, 3.0)
BLOCK = 10  #: records of one job
UNIT = 3600 * 60 * 180 / np.pi  #: rad/s/√s in deg/h^1.5


def static_noise():
    """Return the white noise and flicker of the preset's gyro x."""
    return preset("3dm-gx3-25").axes["gyro_x"].processes


@cache
def detection_size(minutes):
    """Return the K whose expected estimate just passes the test, for records of this length (min)."""
    n, dt = round(minutes * 60 * RATE), 1 / RATE
    factor = averaging_factors("octave", n, dt)
    terms = static_noise().terms
    white, flicker = (next(t for t in terms if isinstance(t, kind)) for kind in (WhiteNoise, FlickerNoise))
    squared = np.array([0.0, white.N**2, flicker.B**2, 0.0])
    covariance = moments(tuple(int(m) for m in factor), n).covariance(squared, 0.0, dt)
    columns = [term.allan_variance(factor * dt, dt) for term in (WhiteNoise(1), FlickerNoise(1), RandomWalk(1))]
    size = np.sqrt(np.diag(covariance))
    design = np.stack(columns, axis=1) / size[:, None]
    unit = np.linalg.norm(design, axis=0)
    information = (design / unit).T @ np.linalg.solve(covariance / np.outer(size, size), design / unit)
    sigma = np.sqrt(np.linalg.inv(information)[2, 2]) / unit[2]
    return float(np.sqrt(stats.norm.ppf((1 + LEVEL) / 2) * sigma))


def records_of(number, first, count, minutes):
    """Return the fitted coefficients of ``count`` records of one size."""
    n = round(minutes * 60 * RATE)
    walk = RandomWalk(SIZES[number] * detection_size(minutes))
    processes = Sum((*static_noise().terms, walk))
    fits = []
    for r in range(first, first + count):
        x = processes.sample(n, 1 / RATE, np.random.default_rng(np.random.SeedSequence([number, r])))
        fits.append(fit_allan(allan(x, 1 / RATE)).coefficients)
    return fits


def study(records=800, minutes=MINUTES, workers=2):
    """Return the tables: a summary, K of every size, and the terms that are always absent."""
    size = detection_size(minutes)
    sizes, others = [], []
    for number, multiple in enumerate(SIZES):
        jobs = [(number, a, min(BLOCK, records - a), minutes) for a in range(0, records, BLOCK)]
        fits = [fit for block in over_records(records_of, jobs, workers) for fit in block]
        sizes.append(_row(multiple, multiple * size, fits))
        for letter in ("Q", "R"):
            nulls = [fit[letter] for fit in fits if fit[letter].value is None]
            above = sum(bool(c.upper > 0) for c in nulls)
            others.append((f"{multiple:g}", letter, Share(len(fits) - len(nulls), len(fits)), Share(above, len(nulls))))
    headings = (
        "K / detection size", "K, deg/h^1.5", "identified", "upper end at or above K", "limit at or above K, where not identified",
        "interval contains K, where identified", "R taken for K", "median limit, deg/h^1.5",
    )  # fmt: skip
    note = (
        f"The detection size is {size * UNIT:.4g} deg/h^1.5. The upper end is that of the interval where K was identified, and the "
        "limit elsewhere. Where K was not identified, its estimate was low by chance, so the limit is above K in fewer "
        'than 95 % of these records; where a small K was identified, its estimate was high by chance. "R taken for K": a ramp was '
        "identified and K was not."
    )
    of_absent = ("K / detection size", "term", "identified", "limit above 0")
    absent = "The true value is 0; a limit above 0 contains it."
    return (
        _summary(sizes, others),
        Table("K, absent or present", headings, tuple(sizes), note),
        Table("Q and R, always absent", of_absent, tuple(others), absent),
    )


def _summary(sizes, others):
    """Return the goals and the results."""
    limits = [sizes[0][4], *(row[3] for row in others)]
    above = pooled(limits)
    most, term = max(((row[2], row[1]) for row in others[:2]), key=lambda pair: pair[0].value)
    worst = min(sizes[1:], key=lambda row: row[3].value)
    rows = (
        ("limit above 0, term absent", "always", above, verdict(above.count == above.of)),
        ("K identified although absent", "2.5 %", sizes[0][2], verdict(_contains(sizes[0][2], 0.025))),
        (f"{term} identified although absent", "2.5 %", most, verdict(_contains(most, 0.025))),
        (
            f"upper end at or above K, worst size ({worst[0]})",
            "at least 93 %",
            worst[3],
            verdict(worst[3].value >= 0.93),
        ),
    )
    return Table("Goals", ("figure", "goal", "result (95 % interval)", "verdict"), rows)


def _contains(share, probability):
    low, high = share.interval
    return low <= probability <= high


def _row(multiple, true, fits):
    walks = [fit["K"] for fit in fits]
    mistaken = sum(fit["R"].value is not None and fit["K"].value is None for fit in fits)
    nulls, values = [c for c in walks if c.value is None], [c for c in walks if c.value is not None]
    below = [sum(bool(true <= c.upper) and c.upper > 0 for c in part) for part in (walks, nulls)]
    inside = sum(bool(c.lower <= true <= c.upper) for c in values)
    median = f"{float(np.median([c.upper for c in nulls])) * UNIT:.4g}" if nulls else "–"
    return (
        f"{multiple:g}", f"{true * UNIT:.4g}", Share(len(values), len(walks)), Share(below[0], len(walks)),
        Share(below[1], len(nulls)), Share(inside, len(values)), Share(mistaken, len(walks)), median,
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 800,
        lambda n: f"seeds (s, 0..{n - 1}) for sizes s = 0..3; n = {n} records of {MINUTES:g} min at {RATE:g} Hz each",
    )  # fmt: skip

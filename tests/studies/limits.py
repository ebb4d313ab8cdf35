"""What is the upper limit of a term worth that was not identified?

30 min at 100 Hz of white noise and flicker (N and B of the 3dm-gx3-25's gyro x) and a random walk of
size K in 0, 0.3, 1 and 3 times the detection size. That is the K whose expected estimate just passes
the fit's test: K² = z sigma, z = 1.96 the test's, sigma the generalised least squares error of K²
beside N² and B² when there is no K, worked out here from the exact moments. Wanted: a term that is
not there never has a value above its limit (its limit is above 0), and is seldom identified; the
upper end, be it of an interval or a limit at 95 %, is below a K that is there in at most 7 % of records.

Command: ``python tests/studies/limits.py`` (800 records of each size: 4 to 10 minutes).
Seeds: record r of size number s (0 to 3) uses ``SeedSequence([s, r])``.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy import stats
from study_report import Share, Table, main, over_records

from imuwb.identification import allan, averaging_factors, fit_allan
from imuwb.identification.allan_variance.moments import moments
from imuwb.simulation import preset
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

QUESTION = "Upper limits of terms that were not identified"
RATE, MINUTES, LEVEL = 100.0, 30.0, 0.95
SIZES = (0.0, 0.3, 1.0, 3.0)
BLOCK = 10  #: records in a job
UNIT = 3600 * 60 * 180 / np.pi  #: rad/s/√s in deg/h^1.5


def still():
    """Return white noise and flicker of the preset's gyro x."""
    return preset("3dm-gx3-25").axes["gyro_x"].processes


@cache
def detection_size(minutes):
    """Return the K that is as large as what the test at this length asks for."""
    n, dt = round(minutes * 60 * RATE), 1 / RATE
    factor = averaging_factors("octave", n, dt)
    white, flicker = (next(t for t in still().terms if isinstance(t, kind)) for kind in (WhiteNoise, FlickerNoise))
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
    processes = Sum((*still().terms, walk))
    found = []
    for r in range(first, first + count):
        x = processes.sample(n, 1 / RATE, np.random.default_rng(np.random.SeedSequence([number, r])))
        found.append(fit_allan(allan(x, 1 / RATE)).coefficients)
    return found


def study(records=800, minutes=MINUTES, workers=2):
    """Return the tables: a summary, K of every size, and the terms that are never there."""
    size = detection_size(minutes)
    sizes, others = [], []
    for number, multiple in enumerate(SIZES):
        jobs = [(number, a, min(BLOCK, records - a), minutes) for a in range(0, records, BLOCK)]
        fits = [one for part in over_records(records_of, jobs, workers) for one in part]
        sizes.append(_row(multiple, multiple * size, fits))
        for letter in ("Q", "R"):
            nulls = [one[letter] for one in fits if one[letter].value is None]
            above = sum(bool(c.upper > 0) for c in nulls)
            others.append((f"{multiple:g}", letter, Share(len(fits) - len(nulls), len(fits)), Share(above, len(nulls))))
    headings = (
        "K / detection size", "K, deg/h^1.5", "identified", "upper end not below K", "limit not below K, where not identified",
        "interval holds K, where identified", "R taken for K", "median limit, deg/h^1.5",
    )  # fmt: skip
    note = (
        f"Detection size {size * UNIT:.4g} deg/h^1.5. The upper end is that of the interval where K was identified, and the "
        "limit elsewhere. Given that K was not identified its estimate came out low, so there the limit holds less often "
        'than 95 %, and given that a small K was identified its estimate came out high. "R taken for K": a ramp was '
        "identified and no K."
    )
    absent = "A true value of 0 exceeds no limit above 0."
    return (
        _summary(sizes, others),
        Table("K, there or not", headings, tuple(sizes), note),
        Table(
            "Q and R, never there", ("K / detection size", "term", "identified", "limit above 0"), tuple(others), absent
        ),
    )


def _summary(sizes, others):
    """Return what was wanted and what was reached."""
    limits = [sizes[0][4], *(row[3] for row in others)]
    above = Share(sum(share.count for share in limits), sum(share.of for share in limits))
    most, term = max(((row[2], row[1]) for row in others[:2]), key=lambda pair: pair[0].value)
    worst = min(sizes[1:], key=lambda row: row[3].value)
    rows = (
        ("limit above 0, term not there", "always", above, _verdict(above.count == above.of)),
        ("K identified that is not there", "2.5 %", sizes[0][2], _verdict(_holds(sizes[0][2], 0.025))),
        (f"{term} identified that is not there", "2.5 %", most, _verdict(_holds(most, 0.025))),
        (
            f"upper end not below K, worst size ({worst[0]})",
            "at least 93 %",
            worst[3],
            _verdict(worst[3].value >= 0.93),
        ),
    )
    return Table("What was wanted", ("figure", "wanted", "reached (95 % interval)", "verdict"), rows)


def _holds(share, probability):
    low, high = share.interval
    return low <= probability <= high


def _verdict(reached):
    return "reached" if reached else "NOT reached"


def _row(multiple, true, fits):
    found = [one["K"] for one in fits]
    mistaken = sum(one["R"].value is not None and one["K"].value is None for one in fits)
    nulls, values = [c for c in found if c.value is None], [c for c in found if c.value is not None]
    below = [sum(bool(true <= c.upper) and c.upper > 0 for c in part) for part in (found, nulls)]
    held = sum(bool(c.lower <= true <= c.upper) for c in values)
    median = f"{float(np.median([c.upper for c in nulls])) * UNIT:.4g}" if nulls else "–"
    return (
        f"{multiple:g}", f"{true * UNIT:.4g}", Share(len(values), len(found)), Share(below[0], len(found)),
        Share(below[1], len(nulls)), Share(held, len(values)), Share(mistaken, len(found)), median,
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 800,
        lambda n: f"seeds (s, 0..{n - 1}) for sizes s = 0..3; n = {n} records of {MINUTES:g} min at {RATE:g} Hz each",
    )  # fmt: skip

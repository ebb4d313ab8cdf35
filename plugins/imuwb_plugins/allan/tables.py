"""Tables of the Allan analysis."""

import math
from collections.abc import Iterator, Mapping

from imuwb.analysis import Table
from imuwb.identification import ModelCandidate
from imuwb.noise_results import line_table, slope_table
from imuwb.statistics import Coefficient
from imuwb.stochastic import GaussMarkov, Sum
from imuwb.texts import coefficient_text, interval_text, number_text
from imuwb.units import coefficient_units
from imuwb_plugins.allan.result import AllanAxis, EstimatorComparison, Result

LETTERS = "QNBKR"
CANDIDATES = 4  #: sums in the table
_HEADINGS = ("Q quantization", "N random walk", "B bias instability", "K rate random walk", "R rate ramp")
_ESTIMATORS = {
    "allan": "Allan variances",
    "likelihood": "likelihood of the spectrum",
    "wavelet": "wavelet variances (D4)",
}


def fits(result: Result) -> Iterator[Table]:
    """Yield the coefficients, the slopes, and the lines if there are any."""
    yield _coefficients(result)
    level = f"{100 * result.level:g} % interval"
    yield slope_table(
        "Slopes by region",
        {axis: r.regions for axis, r in result.axes.items()},
        "s",
        "The slope of a free line over the averaging times where one term makes more than 60 % of the Allan variance, without "
        f"periodic lines, with its {level}.",
    )
    lines = {axis: r.lines for axis, r in result.axes.items() if r.lines}
    if lines:
        yield line_table(lines, f"Sinusoids in the spectrum, which are terms of the fit; amplitude [{level}].")


def comparisons(result: Result) -> Iterator[Table]:
    """Yield the estimators side by side, the tests of stationarity, and the sums that were compared."""
    estimates = {axis: r.estimates for axis, r in result.axes.items() if r.estimates is not None}
    yield _estimators(estimates)
    yield _stationarity(estimates)
    if any(e.choice for e in estimates.values()):
        yield _sums(estimates)


def _cells(axis: str, coefficients: Mapping[str, Coefficient]) -> tuple[str, ...]:
    return tuple(
        coefficient_text(coefficients[x], coefficient_units(axis, x)[1]) if x in coefficients else "—" for x in LETTERS
    )


def _coefficients(result: Result) -> Table:
    rows = tuple((axis, *_cells(axis, r.coefficients), *_correlation(r)) for axis, r in result.axes.items())
    level = f"{100 * result.level:g} %"
    caption = (
        f"Value [{level} interval]; < is the {level} upper limit of a term that is not identified. Each coefficient is read on its "
        "own line: Q at √3 s, N at 1 s, K at 3 s, R at √2 s; B is the flat level / 0.664. Tc is the middle [begin, end] of the flat part, "
        "as Quinchia reads table 5; > is a bound, where it may last beyond the curve. Matched: Tc of the Gauss-Markov process that peaks there."
    )
    moving = " (the IMU moves: see the notes)" if result.moving else ""
    return Table(
        f"Noise coefficients of {result.imu}{moving}", ("axis", *_HEADINGS, "Tc of B", "Tc, matched"), rows, caption
    )


def _correlation(r: AllanAxis) -> tuple[str, str]:
    """Return the correlation time as the paper reads it, and that of the Gauss-Markov process that peaks there."""
    if r.correlation_time is None or r.gauss_markov_time is None:
        return "—", "—"
    read, matched = r.correlation_time, f"{number_text(r.gauss_markov_time)} s"
    if math.isinf(read.upper):
        return f"> {number_text(read.value)} s, flat from {number_text(read.lower)} s on", f"> {matched}"
    return interval_text(read), matched


def _estimators(estimates: Mapping[str, EstimatorComparison]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, e in estimates.items():
        for name, coefficients in e.by.items():
            headline = name == e.headline
            agreement = ("agree" if e.agree else f"DIFFER in {'; '.join(e.disagreements)}") if headline else ""
            rows.append(
                (axis, _ESTIMATORS[name] + (" (headline)" if headline else ""), *_cells(axis, coefficients), agreement)
            )
    caption = (
        "Three estimators of one sum. The headline has the least error; its value is the likeliest size, and a term whose interval begins "
        "at 0 may be absent. The Allan fit gives a value only to a term that chance does not explain. Estimators agree if their "
        "intervals overlap in all coefficients."
    )
    return Table("Estimators side by side", ("axis", "estimator", *_HEADINGS, "agreement"), tuple(rows), caption)


def _stationarity(estimates: Mapping[str, EstimatorComparison]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, e in estimates.items():
        s = e.stationarity
        if s is None:
            rows.append((axis, "not tested", "—", "—"))
            continue
        part = (
            f"part {s.worst_part + 1} of {s.start.size}, from {s.start[s.worst_part]:.0f} s: {s.worst_ratio:.3g} times the usual Allan "
            f"deviation at {number_text(s.worst_time)} s"
        )
        rows.append((axis, "yes" if s.stationary else "NO", f"{s.smallest:.2g}", "—" if s.stationary else part))
    caption = (
        "A record is not stationary if the Allan deviations of its parts differ more than chance makes them (1 % over all averaging "
        "times)."
    )
    return Table(
        "Stationarity", ("axis", "stationary", "probability [1]", "part that differs most"), tuple(rows), caption
    )


def _sums(estimates: Mapping[str, EstimatorComparison]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, e in estimates.items():
        for c in e.choice.candidates[:CANDIDATES] if e.choice else ():
            best = e.choice is not None and c is e.choice.best
            name = c.name + (" (clearly best)" if best and e.choice and e.choice.clear else "")
            rows.append((axis, name, _gauss_markov(axis, c.processes) if best else "", *_excess(c)))
    headings = (
        "axis",
        "sum",
        "Gauss-Markov terms",
        "BIC over the best [1]",
        "AIC over the best [1]",
        "out of sample over the best [1]",
    )
    caption = (
        "Sums of processes, in the order of BIC. Out of sample: each half of the record is tested with the fit to the other half "
        "(deviance). A difference of 10 is called clear."
    )
    return Table("Sums of processes that explain the record", headings, tuple(rows), caption)


def _excess(c: ModelCandidate) -> tuple[str, str, str]:
    out = "—" if c.out_of_sample_excess is None else f"{c.out_of_sample_excess:+.1f}"
    return f"{c.bic_excess:+.1f}", f"{c.aic_excess:+.1f}", out


def _gauss_markov(axis: str, processes: Sum) -> str:
    unit = coefficient_units(axis, "rate")[1]
    return "; ".join(
        f"sigma {unit.from_si(term.sigma):.3g} {unit.name}, Tc {number_text(term.Tc)} s"
        for term in processes.terms
        if isinstance(term, GaussMarkov)
    )

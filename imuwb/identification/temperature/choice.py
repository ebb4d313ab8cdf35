"""Which function of temperature? The simplest that agrees with the set-points and predicts one left out not surely worse than the best."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.identification.temperature.functions import (
    KINDS,
    TemperatureFunction,
    fitted,
    left_out,
    parameters_of,
    weights,
)
from imuwb.statistics.distributions import chi_square_tail

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from imuwb.identification.temperature.functions import Kind

    Floats = NDArray[np.float64]

FEWEST = 4  #: set-points for a cross-validation
CONTRADICTED = 1e-3  #: probability of a fit as bad, below which a function is none


@dataclass(frozen=True, slots=True)
class Candidate:
    """How well one kind of function predicts a set-point from the others."""

    kind: Kind
    parameters: int
    error: float  #: mean square of the prediction errors over the estimates' own standard errors; 1 is the least there can be
    behind: float  #: of the best: mean difference of these squares
    behind_sigma: float  #: its standard error
    fit_probability: float | None  #: of a chi-square of the fit as large; None: nothing is left to tell


@dataclass(frozen=True, eq=False, slots=True)
class Choice:
    """The function that is taken, and those it was chosen from."""

    function: TemperatureFunction
    candidates: tuple[Candidate, ...]
    why: str


def choose_function(
    celsius: Floats,
    estimate: Floats,
    sigma: Floats,
    *,
    logarithmic: bool,
    varies: bool = True,
    wanted: Kind | None = None,
) -> Choice:
    """Return a function of temperature through estimates.

    Args:
        celsius: (k,) °C, rising.
        estimate: (k,) estimates, or their logarithms.
        sigma: (k,) standard errors of those.
        logarithmic: whether they are logarithms; an Arrhenius law is tried only then.
        varies: whether a test found that they depend on temperature; if not, they are a constant.
        wanted: a kind to take instead of choosing.

    Raises:
        ValueError: no estimate, or too few for the kind that is wanted.
    """
    if wanted is not None:
        return _wanted(wanted, celsius, estimate, sigma, logarithmic=logarithmic)
    if not varies:
        why = "the test does not find that it depends on temperature"
        return Choice(fitted("constant", celsius, estimate, sigma, logarithmic=logarithmic), (), why)
    if celsius.size < FEWEST:
        why = f"too few set-points for a cross-validation, which takes {FEWEST}"
        return Choice(fitted("piecewise", celsius, estimate, sigma, logarithmic=logarithmic), (), why)
    squares: dict[Kind, Floats] = {
        kind: (left_out(kind, celsius, estimate, sigma)[0] / sigma[1:-1]) ** 2
        for kind in KINDS
        if parameters_of(kind, celsius.size - 1) < celsius.size and (logarithmic or kind != "arrhenius")
    }
    candidates = _candidates(squares, celsius, estimate, sigma)
    # Few set-points scatter much: one far off must not excuse a function that the others contradict.
    tenable = [c for c in candidates if c.fit_probability is None or c.fit_probability > CONTRADICTED]
    taken = next((c for c in tenable if c.behind <= c.behind_sigma), None)
    if taken is None:
        why = "no smooth function agrees with the set-points: straight lines between them"
        return Choice(fitted("piecewise", celsius, estimate, sigma, logarithmic=logarithmic), candidates, why)
    if taken.kind in ("linear", "arrhenius"):  # as simple as each other
        taken = min((c for c in tenable if c.kind in ("linear", "arrhenius")), key=lambda c: c.error)
    why = "cross-validation"
    return Choice(fitted(taken.kind, celsius, estimate, sigma, logarithmic=logarithmic), candidates, why)


def _wanted(kind: Kind, celsius: Floats, estimate: Floats, sigma: Floats, *, logarithmic: bool) -> Choice:
    least = 2 if kind in ("piecewise", "spline") else parameters_of(kind, celsius.size)
    if celsius.size < least or (kind == "arrhenius" and not logarithmic):
        why = (
            "takes a positive coefficient"
            if celsius.size >= least
            else f"takes {least} set-points; there are {celsius.size}"
        )
        message = f"a function of kind {kind} {why}"
        raise ValueError(message)
    return Choice(fitted(kind, celsius, estimate, sigma, logarithmic=logarithmic), (), "asked for")


def _candidates(squares: dict[Kind, Floats], celsius: Floats, estimate: Floats, sigma: Floats) -> tuple[Candidate, ...]:
    best = min(squares, key=lambda kind: float(squares[kind].mean()))
    found: Sequence[Candidate] = [
        Candidate(
            kind, parameters_of(kind, celsius.size), float(square.mean()), float((square - squares[best]).mean()),
            float((square - squares[best]).std(ddof=1)) / square.size**0.5, _fit_probability(kind, celsius, estimate, sigma),
        )
        for kind, square in squares.items()
    ]  # fmt: skip
    return tuple(found)


def _fit_probability(kind: Kind, celsius: Floats, estimate: Floats, sigma: Floats) -> float | None:
    freedom = celsius.size - parameters_of(kind, celsius.size)
    if freedom < 1:
        return None
    rest = (estimate - weights(kind, celsius, celsius, sigma) @ estimate) / sigma
    return float(chi_square_tail(float(rest @ rest), freedom))

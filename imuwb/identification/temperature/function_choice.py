"""The choice of a function of temperature.

The choice is the simplest function that agrees with the set-points and predicts a left-out set-point about as well as the best
function does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from imuwb.arrays import Floats
from imuwb.identification.temperature.functions import (
    KINDS,
    FunctionKind,
    TemperatureFunction,
    fitted,
    left_out,
    parameters_of,
    weights,
)
from imuwb.statistics.distributions import chi_square_tail

FEWEST = 4  #: set-points for a cross-validation
CONTRADICTED = 1e-3  #: probability of the fit's chi-square, below which the set-points contradict a function


@dataclass(frozen=True, slots=True)
class FunctionCandidate:
    """How well one kind of function predicts a set-point from the others."""

    kind: FunctionKind
    parameters: int
    error: float  #: mean square of the prediction errors over the estimates' standard errors; about 1 is the least
    excess: float  #: mean difference of these squares from those of the best kind
    excess_sigma: float  #: standard error of that difference
    fit_probability: float | None  #: probability of so large a chi-square of the fit; None: no degree of freedom


@dataclass(frozen=True, eq=False, slots=True)
class FunctionChoice:
    """The chosen function, and its candidates."""

    function: TemperatureFunction
    candidates: tuple[FunctionCandidate, ...]
    reason: str

    def __repr__(self) -> str:
        """Return the function and the reason, in one line."""
        return f"{self.function} ({self.reason})"


def choose_function(
    celsius: Floats,
    estimate: Floats,
    sigma: Floats,
    *,
    logarithmic: bool,
    varies: bool = True,
    kind: FunctionKind | None = None,
) -> FunctionChoice:
    """Return a function of temperature through estimates.

    Args:
        celsius: (k,) °C, rising.
        estimate: (k,) estimates, or their logarithms.
        sigma: (k,) standard errors of those.
        logarithmic: whether they are logarithms; an Arrhenius law needs them.
        varies: whether a test found a dependence on temperature; if not, the function is a constant.
        kind: the kind to take; None: it is chosen.

    Raises:
        ValueError: no estimate, or too few for the given kind.
    """
    if kind is not None:
        return _given(kind, celsius, estimate, sigma, logarithmic=logarithmic)

    def taken(name: FunctionKind, reason: str, candidates: tuple[FunctionCandidate, ...] = ()) -> FunctionChoice:
        return FunctionChoice(fitted(name, celsius, estimate, sigma, logarithmic=logarithmic), candidates, reason)

    if not varies:
        return taken("constant", "the test finds no dependence on temperature")
    if celsius.size < FEWEST:
        return taken("piecewise", f"fewer than {FEWEST} set-points, too few for a cross-validation")
    squares: dict[FunctionKind, Floats] = {
        name: (left_out(name, celsius, estimate, sigma)[0] / sigma[1:-1]) ** 2
        for name in KINDS
        if parameters_of(name, celsius.size - 1) < celsius.size and (logarithmic or name != "arrhenius")
    }
    candidates = _candidates(squares, celsius, estimate, sigma)
    # The errors of few set-points scatter much. One outlier must not justify a function that the others contradict.
    tenable = [c for c in candidates if c.fit_probability is None or c.fit_probability > CONTRADICTED]
    best = next((c for c in tenable if c.excess <= c.excess_sigma), None)
    if best is None:
        reason = "no smooth function agrees with the set-points; straight lines between them are used"
        return taken("piecewise", reason, candidates)
    if best.kind in ("linear", "arrhenius"):  # both have two parameters
        best = min((c for c in tenable if c.kind in ("linear", "arrhenius")), key=lambda c: c.error)
    return taken(best.kind, "cross-validation", candidates)


def _given(
    kind: FunctionKind, celsius: Floats, estimate: Floats, sigma: Floats, *, logarithmic: bool
) -> FunctionChoice:
    least = 2 if kind in ("piecewise", "spline") else parameters_of(kind, celsius.size)
    if celsius.size < least:
        raise ValueError(f"a function of kind {kind} needs {least} set-points; there are {celsius.size}")
    if kind == "arrhenius" and not logarithmic:
        raise ValueError(f"a function of kind {kind} needs a positive coefficient")
    return FunctionChoice(fitted(kind, celsius, estimate, sigma, logarithmic=logarithmic), (), "given")


def _candidates(
    squares: dict[FunctionKind, Floats], celsius: Floats, estimate: Floats, sigma: Floats
) -> tuple[FunctionCandidate, ...]:
    best = min(squares, key=lambda kind: float(squares[kind].mean()))
    candidates: Sequence[FunctionCandidate] = [
        FunctionCandidate(
            kind, parameters_of(kind, celsius.size), float(square.mean()), float((square - squares[best]).mean()),
            float((square - squares[best]).std(ddof=1)) / square.size**0.5, _fit_probability(kind, celsius, estimate, sigma),
        )
        for kind, square in squares.items()
    ]  # fmt: skip
    return tuple(candidates)


def _fit_probability(kind: FunctionKind, celsius: Floats, estimate: Floats, sigma: Floats) -> float | None:
    freedom = celsius.size - parameters_of(kind, celsius.size)
    if freedom < 1:
        return None
    rest = (estimate - weights(kind, celsius, celsius, sigma) @ estimate) / sigma
    return float(chi_square_tail(float(rest @ rest), freedom))

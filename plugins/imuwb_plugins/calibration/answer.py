"""The answer of a calibration: bias, scale factor and the largest coupling of each axis, and whether the fit is noise alone."""

import math
from collections.abc import Iterator

from imuwb.analysis import Answer, Step
from imuwb.statistics import Estimate
from imuwb.texts import counted, decimals, number_text
from imuwb_plugins.calibration.parameter_table import DISPLAY, display
from imuwb_plugins.calibration.result import PositionResult, TableResult

COUPLINGS = "cross_coupling_"
SAID = ("misplaced",)  #: ids of notes that a sentence says already
DOUBTED = 1e-3  #: probability of residuals as large by noise alone; below it, something else is in them
USE = Step("imuwb noise LOG --through correction:model={model}", "a log of this sensor without these errors")


def answer(result: PositionResult | TableResult) -> Answer:
    """Return the parameters of each axis."""
    rows = [(axis.replace("_", " "), *_cells(terms)) for axis, terms in result.parameters.items()]
    about = (
        counted(len(result.positions), "position")
        if isinstance(result, PositionResult)
        else f"{counted(len(result.runs), 'run')} of a rate table"
    )
    return Answer(
        about, ("", "bias", "scale factor", "largest coupling"), tuple(rows), tuple(_sentences(result)), (USE,),
        f"{100 * result.level:g} % intervals",
    )  # fmt: skip


def _cells(terms: dict[str, Estimate]) -> Iterator[str]:
    scale = terms.get("scale_factor") or terms.get("sensitivity") or terms.get("value_of_one")
    couplings = {name: x for name, x in terms.items() if name.startswith(COUPLINGS)}
    largest = max(couplings, key=lambda name: abs(couplings[name].value), default=None)
    yield _text(terms.get("bias"))
    yield _text(scale)
    yield "—" if largest is None else f"{_text(couplings[largest])} of {largest.removeprefix(COUPLINGS)}"


def _text(x: Estimate | None) -> str:
    if x is None:
        return "—"
    factor, name = display(x.unit)
    own = x.scaled(1 / factor, name)
    half = (own.upper - own.lower) / 2
    if not math.isfinite(half):
        return f"{number_text(own.value)} {name}"
    places = decimals(2 * half)
    return f"{own.value:.{places}f} ± {half:.{places}f} {name}"


def _sentences(result: PositionResult | TableResult) -> Iterator[str]:
    if isinstance(result, PositionResult):
        worst = max(
            (abs(v) for p in result.positions for axis, v in p.residual.items() if axis.startswith("accel")),
            default=0.0,
        )
        size = (
            f"{number_text(worst / DISPLAY['m/s²'][0])} mg"
            if not result.unit
            else f"{number_text(worst)} {result.unit}"
        )
        if result.probability < DOUBTED:
            yield f"Accept it with care: residuals of up to {size} are no noise."
        else:
            yield f"Accept it: noise alone explains the residuals (up to {size})."
        if result.misplacement is not None:
            yield f"The faces stood {number_text(math.degrees(result.misplacement))} deg off square, which the couplings' intervals contain."
    more = [note for note in result.notes if getattr(note, "id", "") not in SAID]
    yield from (f"{note[:1].upper()}{note[1:]}." for note in more[:2])

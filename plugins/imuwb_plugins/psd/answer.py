"""The answer of the power spectral density: the white level of each axis, its noises, and its lines."""

from imuwb.analysis import Answer, Step
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN
from imuwb.texts import coefficient_cell, number_text
from imuwb.units import coefficient_units
from imuwb_plugins.psd.result import Result, SpectrumAxis

LETTERS = "NB"
NOISE = Step("imuwb noise {log}", "the same numbers by the best estimator, and a model")
LSSA = Step("imuwb lssa {log}", "whether the lines are surely there")


def answer(result: Result) -> Answer:
    """Return N and B of each axis, up to where the spectrum is white, its strongest line, and its broad peaks."""
    rows: list[tuple[str, ...]] = []
    for axes in by_sensor(result.axes).values():
        first = next(iter(axes))
        units = [coefficient_units(first, x)[1] for x in LETTERS]
        for axis, r in axes.items():
            cells = (
                coefficient_cell(r.coefficients.get(x, UNKNOWN), unit) for x, unit in zip(LETTERS, units, strict=True)
            )
            rows.append((axis.replace("_", " "), *cells, _white(r), _line(r)))
        rows.append(("", *(unit.name for unit in units)))
    rates = " and ".join(dict.fromkeys(f"{number_text(rate)} Hz" for rate in result.rate_hz.values()))
    lines = any(r.lines for r in result.axes.values())
    sentences = tuple(f"{axis.replace('_', ' ')}: {r.why_none}." for axis, r in result.axes.items() if r.why_none)
    if broad := [f"{axis.replace('_', ' ')} {_resonances(r)}" for axis, r in result.axes.items() if r.resonances]:
        sentences += (f"Resonances, broad peaks that are no lines: {', '.join(broad)}.",)
    return Answer(
        f"to {number_text(max(result.rate_hz.values()) / 2)} Hz, sampled at {rates}", ("", *LETTERS, "white to", "strongest line"),
        tuple(rows), sentences, (LSSA, NOISE) if lines else (NOISE,), f"{100 * result.level:g} % intervals",
    )  # fmt: skip


def _white(r: SpectrumAxis) -> str:
    return (
        "its end" if r.white_to is None and "N" in r.coefficients and r.coefficients["N"].value else _hertz(r.white_to)
    )


def _line(r: SpectrumAxis) -> str:
    line = max(r.lines, key=lambda line: line.amplitude.value, default=None)
    return "none" if line is None else f"{line.frequency:.4g} Hz"


def _resonances(r: SpectrumAxis) -> str:
    return f"{' and '.join(number_text(f) for f in r.resonances)} Hz"


def _hertz(frequency: float | None) -> str:
    return "—" if frequency is None else f"{number_text(frequency)} Hz"

"""Error models in words, in the units of data sheets."""

from dataclasses import fields
from typing import Any, cast

from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.sums import Process
from imuwb.units import UNITS, Unit, coefficient_units

#: parameter of a process -> its unit; those that are not here are letters of coefficients, or have the unit of the samples
PLAIN = {"Tc": "s", "dt": "s", "frequency": "Hz"}
LETTERS = ("Q", "N", "B", "K", "R")


def axis_text(axis: str, model: AxisModel) -> str:
    """Return all terms of an axis such as ``gyro_x`` in one line."""
    terms = [process_text(axis, term) for term in model.processes.terms]
    return "; ".join([*terms, *deterministic_texts(axis, model), *_apart(model)]) or "no term"


def _apart(model: AxisModel) -> tuple[str, ...]:
    if not model.autoregressive:
        return ()
    return (
        f"{' and '.join(f'AR({len(p.alpha)})' for p in model.autoregressive)} of denoised samples, for 15AR and 27AR",
    )


def process_text(axis: str, process: Process) -> str:
    """Return a process with its parameters: white noise N 2.42 deg/√h."""
    values = {f.name: getattr(process, f.name) for f in fields(cast("Any", process))}
    name = cast("Any", process).name.replace("_", " ").replace("gauss markov", "Gauss-Markov")
    return f"{name} {', '.join(_parameter(axis, *item) for item in values.items())}"


def _parameter(axis: str, name: str, value: Any) -> str:  # noqa: ANN401 - a number, or the numbers of an AR set
    if name == "alpha":
        return f"alpha {', '.join(f'{a:.10g}' for a in value)}"
    if name in PLAIN:
        return f"{name} {value:.6g} {PLAIN[name]}"
    return f"{name} {_shown(value, coefficient_units(axis, name if name in LETTERS else 'rate')[1])}"


def deterministic_texts(axis: str, model: AxisModel) -> tuple[str, ...]:
    """Return the deterministic terms that an axis states, one text each: scale factor 1.2 %."""
    sensor, percent = coefficient_units(axis, "rate")[1], UNITS["%"]
    units = {
        "bias": sensor, "scale_factor": percent, "scale_factor_nonlinear": percent, "bandwidth": UNITS["Hz"],
        "group_delay": UNITS["s"], "lsb": sensor, "range": sensor,
    }  # fmt: skip
    texts = [f"{_words(name)} {_shown(value, unit)}" for name, unit in units.items() if (value := getattr(model, name))]
    if any(model.cross_coupling):
        texts.append(f"cross-coupling {', '.join(f'{1e3 * c:.4g}' for c in model.cross_coupling)} mrad")
    if any(model.g_sensitivity):
        texts.append(f"g-sensitivity {', '.join(f'{g:.4g}' for g in model.g_sensitivity)} rad/s per m/s²")
    curves = {"bias": model.thermal_bias, "scale factor": model.thermal_scale_factor, "processes": model.thermal}
    texts += [
        f"{name} by temperature, {len(points)} set-points from {points[0][0]:g} to {points[-1][0]:g} °C"
        for name, points in curves.items()
        if points
    ]
    return tuple(texts)


def _shown(value: float, unit: Unit) -> str:
    return f"{unit.from_si(value):.4g} {unit.name}"


def _words(name: str) -> str:
    return {"lsb": "LSB", "scale_factor_nonlinear": "non-linear scale factor"}.get(name, name.replace("_", " "))

"""Error models drawn and laid beside each other."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.errors import ImuwbError
from imuwb.log import AXES
from imuwb.stochastic.model_check import LETTERS, coefficient
from imuwb.texts import coefficient_text
from imuwb.units import UNITS, coefficient_units

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from imuwb.analysis import Review
    from imuwb.log import Floats
    from imuwb.stochastic import AxisModel, ImuErrorModel, Sum
    from imuwb.stochastic.model_check import Verdict

PALETTE = ((76, 120, 168), (242, 142, 43), (84, 162, 75), (228, 87, 86), (176, 122, 161), (118, 183, 178))
_SENSORS = {
    "gyro": ("Gyroscopes", "deg/h", "(deg/s)²/Hz", (np.pi / 180) ** 2),
    "accel": ("Accelerometers", "m/s²", "(m/s²)²/Hz", 1.0),
}


def draw_models(models: Mapping[str, ImuErrorModel], rate: float, duration: float, review: Review) -> None:
    """Show the Allan deviation and the spectrum of each axis, and the figures."""
    for sensor in _SENSORS:
        axes = [axis for axis in AXES if axis.startswith(sensor) and any(axis in m.axes for m in models.values())]
        if axes:
            review.figure(_allan(models, axes, sensor, rate, duration))
            review.figure(_spectrum(models, axes, sensor, rate, duration))
    review.table(_figures(models))
    others = _others(models)
    if others.rows:
        review.table(others)


def _color(axis: str, place: int, count: int) -> tuple[int, int, int]:
    return AXIS_COLORS[axis[-1]] if count == 1 else PALETTE[place % len(PALETTE)]


def _allan(
    models: Mapping[str, ImuErrorModel], axes: Sequence[str], sensor: str, rate: float, duration: float
) -> Figure:
    name, unit, _, _ = _SENSORS[sensor]
    tau = np.geomspace(1 / rate, duration / 2, 200)
    tau = np.unique(np.rint(tau * rate)) / rate  # an autoregressive process knows multiples of its step only
    curves: list[Curve] = []
    for place, (model, axis) in enumerate(_shown(models, axes)):
        processes = models[model].axes[axis].processes
        variance = _curve(processes, axis, tau, 1 / rate, "allan_variance")
        label = axis.replace("_", " ") if len(models) == 1 else f"{model.removesuffix('.toml')} {axis[-1]}"
        curves.append(
            Curve(label, tau, np.sqrt(variance) / UNITS[unit].factor, _color(axis, place, len(models)), style="curve")
        )
    return Figure(
        f"{name}: Allan deviation of the model", "averaging time [s]", f"Allan deviation [{unit}]", tuple(curves)
    )


def _spectrum(
    models: Mapping[str, ImuErrorModel], axes: Sequence[str], sensor: str, rate: float, duration: float
) -> Figure:
    name, _, unit, factor = _SENSORS[sensor]
    f = np.geomspace(1 / duration, rate / 2, 200)
    curves: list[Curve] = []
    for place, (model, axis) in enumerate(_shown(models, axes)):
        density = 2 * _curve(models[model].axes[axis].processes, axis, f, 1 / rate, "power_spectral_density")
        label = axis.replace("_", " ") if len(models) == 1 else f"{model.removesuffix('.toml')} {axis[-1]}"
        curves.append(Curve(label, f, density / factor, _color(axis, place, len(models)), style="curve"))
    return Figure(f"{name}: spectrum of the model", "frequency [Hz]", f"one-sided density [{unit}]", tuple(curves))


def _shown(models: Mapping[str, ImuErrorModel], axes: Sequence[str]) -> list[tuple[str, str]]:
    """Return (model, axis) of one model's three axes, or of several models' z axes, which are enough in a figure."""
    chosen = axes if len(models) == 1 else axes[-1:]
    return [(name, axis) for name, model in models.items() for axis in chosen if axis in model.axes]


def _curve(processes: Sum, axis: str, at: Floats, dt: float, what: str) -> Floats:
    try:
        return getattr(processes, what)(at, dt)
    except ValueError as error:  # an autoregressive process of another step
        message = f"{axis}: {error}; give its rate with --rate"
        raise ImuwbError(message) from error


def _figures(models: Mapping[str, ImuErrorModel]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis in AXES:
        for name, model in models.items():
            if axis in model.axes:
                cells = (
                    coefficient_text(coefficient(model.axes[axis], x), coefficient_units(axis, x)[1]) for x in LETTERS
                )
                rows.append((axis, name, *cells))
    headings = (
        "axis",
        "model",
        "Q quantization",
        "N random walk",
        "B bias instability",
        "K rate random walk",
        "R rate ramp",
    )
    source = "; ".join(
        f"{name}: {key} {text}" for name, model in models.items() for key, text in model.provenance.items()
    )
    return Table(
        "Coefficients",
        headings,
        tuple(rows),
        f"Value [interval]; < is the limit of a term that was looked for. {source}",
    )


def _others(models: Mapping[str, ImuErrorModel]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis in AXES:
        for name, model in models.items():
            if axis in model.axes:
                rows += [(axis, name, text) for text in _other_terms(axis, model.axes[axis])]
    return Table("Other terms", ("axis", "model", "term"), tuple(rows), "SI, but for what names its unit.")


def _other_terms(axis: str, model: AxisModel) -> list[str]:
    rate = coefficient_units(axis, "rate")[1]
    said: list[str] = []
    for term in cast("tuple[Any, ...]", model.processes.terms):
        if any(hasattr(term, x) for x in LETTERS):
            continue
        parts: list[str] = []
        for field in (f.name for f in fields(term)):
            value = getattr(term, field)
            if field in ("sigma", "beta0", "amplitude"):
                parts.append(f"{field} {rate.from_si(value):.4g} {rate.name}")
            elif field == "alpha":
                parts.append(f"alpha {', '.join(f'{a:.10g}' for a in value)}")
            else:
                parts.append(f"{field} {value:.6g} {'Hz' if field == 'frequency' else 's'}")
        said.append(f"{term.name.replace('_', ' ')}: {', '.join(parts)}")
    return said + _deterministic_terms(model)


def _deterministic_terms(model: AxisModel) -> list[str]:
    said: list[str] = []
    for field in ("bias", "scale_factor", "bandwidth", "group_delay", "lsb", "range"):
        value = getattr(model, field)
        if value:
            said.append(f"{field.replace('_', ' ')} {value:.6g}")
    for name, points in (("bias", model.thermal_bias), ("scale factor", model.thermal_scale_factor)):
        if points:
            said.append(
                f"{name} by temperature, {len(points)} set-points from {points[0][0]:g} to {points[-1][0]:g} °C"
            )
    if model.thermal:
        said.append(
            f"by temperature, {len(model.thermal)} set-points from {model.thermal[0][0]:g} to {model.thermal[-1][0]:g} °C"
        )
    return said


def verdicts_table(verdicts: Sequence[Verdict], model: str, against: str) -> Table:
    """Return limits and what the model says of each."""
    rows: list[tuple[str, ...]] = []
    for v in verdicts:
        unit = coefficient_units(v.limit.axis, v.limit.letter)[1]
        value = coefficient_text(v.coefficient, unit)
        rows.append(
            (v.limit.axis, v.limit.letter, f"{unit.from_si(v.limit.at_most):.4g} {unit.name}", value, v.outcome)
        )
    caption = "within: the whole interval is; beyond: the whole interval is not; not sure: the limit lies inside; not known: the model has no such figure."
    return Table(f"{model} against {against}", ("axis", "term", "at most", "found", "verdict"), tuple(rows), caption)

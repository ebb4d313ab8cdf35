"""Figures and tables of error models."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.arrays import Floats
from imuwb.colors import AXIS_COLORS, Color, color_at
from imuwb.errors import ImuwbError
from imuwb.log import AXES
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb.stochastic.description import LETTERS, deterministic_texts, process_text
from imuwb.stochastic.model_check import Verdict, coefficient
from imuwb.texts import coefficient_text
from imuwb.units import UNITS, coefficient_units

POINTS = 200  #: number of points of each curve
#: sensor -> title, unit of the Allan deviation, unit of the density and its factor to SI
_SENSORS = {
    "gyro": ("Gyroscopes", "deg/h", "(deg/s)²/Hz", (np.pi / 180) ** 2),
    "accel": ("Accelerometers", "m/s²", "(m/s²)²/Hz", 1.0),
}


def tables_of(models: Mapping[str, ImuErrorModel]) -> list[Table]:
    """Return the terms of the models as tables."""
    return [table for table in (_doubts(models), _coefficients(models), _others(models)) if table.rows]


def draw_models(models: Mapping[str, ImuErrorModel], rate: float, duration: float, review: Review) -> None:
    """Show the Allan deviation and the spectrum of each axis, and the terms."""
    for sensor in _SENSORS:
        axes = [axis for axis in AXES if axis.startswith(sensor) and any(axis in m.axes for m in models.values())]
        if axes:
            review.figure(_allan(models, axes, sensor, rate, duration))
            review.figure(_spectrum(models, axes, sensor, rate, duration))
    for table in tables_of(models):
        review.table(table)


def _allan(
    models: Mapping[str, ImuErrorModel], axes: Sequence[str], sensor: str, rate: float, duration: float
) -> Figure:
    name, unit, _, _ = _SENSORS[sensor]
    tau = np.geomspace(1 / rate, duration / 2, POINTS)
    tau = np.unique(np.rint(tau * rate)) / rate  # an autoregressive process is defined only at multiples of its step
    curves = tuple(
        Curve(label, tau, np.sqrt(variance) / UNITS[unit].factor, color, style="curve")
        for label, color, variance in _shown(models, axes, tau, 1 / rate, "allan_variance")
    )
    return Figure(f"{name}: Allan deviation of the model", "averaging time [s]", f"Allan deviation [{unit}]", curves)


def _spectrum(
    models: Mapping[str, ImuErrorModel], axes: Sequence[str], sensor: str, rate: float, duration: float
) -> Figure:
    name, _, unit, factor = _SENSORS[sensor]
    f = np.geomspace(1 / duration, rate / 2, POINTS)
    curves = tuple(
        Curve(label, f, 2 * density / factor, color, style="curve")
        for label, color, density in _shown(models, axes, f, 1 / rate, "power_spectral_density")
    )
    return Figure(f"{name}: spectrum of the model", "frequency [Hz]", f"one-sided density [{unit}]", curves)


def _shown(
    models: Mapping[str, ImuErrorModel], axes: Sequence[str], at: Floats, dt: float, curve: str
) -> Iterator[tuple[str, Color, Floats]]:
    """Yield label, colour and values of each curve: three axes of one model, or the z axis of each of several models."""
    last = axes[-1]
    if len(models) == 1:
        (model,) = models.values()
        shown = [(axis.replace("_", " "), AXIS_COLORS[axis[-1]], model, axis) for axis in axes if axis in model.axes]
    else:
        known = [
            (f"{name.removesuffix('.toml')} {last[-1]}", model) for name, model in models.items() if last in model.axes
        ]
        shown = [(label, color_at(place), model, last) for place, (label, model) in enumerate(known)]
    for label, color, model, axis in shown:
        try:
            yield label, color, getattr(model.axes[axis].processes, curve)(at, dt)
        except ValueError as error:  # an autoregressive process of another step
            raise ImuwbError(f"{axis}: {error}; give the rate of the model with --rate") from error


def _rows(models: Mapping[str, ImuErrorModel]) -> Iterator[tuple[str, str, AxisModel]]:
    """Yield axis, name of the model and model of the axis, axis by axis."""
    for axis in AXES:
        yield from ((axis, name, model.axes[axis]) for name, model in models.items() if axis in model.axes)


def _doubts(models: Mapping[str, ImuErrorModel]) -> Table:
    rows = tuple((name, doubt) for name, model in models.items() for doubt in model.doubts)
    return Table(
        "What puts the model in doubt", ("model", "doubt"), rows, "The command that made the model wrote these."
    )


def _coefficients(models: Mapping[str, ImuErrorModel]) -> Table:
    rows = tuple(
        (axis, name, *(coefficient_text(coefficient(model, x), coefficient_units(axis, x)[1]) for x in LETTERS))
        for axis, name, model in _rows(models)
    )
    headings = ("axis", "model", "Q quantization", "N random walk", "B bias instability", "K rate random walk", "R rate ramp")  # fmt: skip
    source = "; ".join(f"{name}: {key} {text}" for name, m in models.items() for key, text in m.provenance.items())
    caption = f"Value [interval]; < stands before the upper limit of a term that the record does not show. {source}"
    return Table("Coefficients", headings, rows, caption)


def _others(models: Mapping[str, ImuErrorModel]) -> Table:
    """Return the processes that have no coefficient of their own, and the deterministic terms."""
    rows: list[tuple[str, ...]] = []
    for axis, name, model in _rows(models):
        processes = [t for t in model.processes.terms if not any(hasattr(t, letter) for letter in LETTERS)]
        texts = (*(process_text(axis, term) for term in processes), *deterministic_texts(axis, model))
        rows += [(axis, name, text) for text in texts]
    return Table("Other terms", ("axis", "model", "term"), tuple(rows))


def verdicts_table(verdicts: Sequence[Verdict], model: str, against: str) -> Table:
    """Return the limits, the model's coefficients, and a verdict for each limit."""
    rows: list[tuple[str, ...]] = []
    for v in verdicts:
        unit = coefficient_units(v.limit.axis, v.limit.letter)[1]
        value, limit = coefficient_text(v.coefficient, unit), f"{unit.from_si(v.limit.at_most):.4g} {unit.name}"
        rows.append((v.limit.axis, v.limit.letter, limit, value, v.outcome))
    caption = "within: the whole interval is below the limit; beyond: the whole interval is above it; not sure: the interval contains the limit; not known: the model does not state the term."
    return Table(f"{model} against {against}", ("axis", "term", "limit", "model", "verdict"), tuple(rows), caption)

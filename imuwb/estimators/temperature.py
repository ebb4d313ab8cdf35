"""A model that depends on temperature, for a tool that has no place for that."""

import math
from dataclasses import replace

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.stochastic import AxisModel, ImuErrorModel, WhiteNoise

MOST_ROWS = 12  #: temperatures in the comments of a file
_UNITS = {"gyro": ("rad/s", "rad/s/√Hz"), "accel": ("m/s²", "m/s²/√Hz")}


def constant(model: ImuErrorModel, celsius: float | None) -> tuple[ImuErrorModel, tuple[str, ...]]:
    """Return the model at one temperature, and notes: what was taken, and a table by temperature.

    Args:
        model: returned as it is where it does not depend on temperature.
        celsius: °C; None: the processes and constants that the model states beside its curves.

    Raises:
        UsageError: not a number.
        MissingDataError: outside of the model's temperatures, or a model that has none.
    """
    points = sorted({t for axis in model.axes.values() for t in _set_points(axis)})
    if celsius is None and not points:
        return model, ()
    if celsius is not None and not math.isfinite(celsius):
        raise UsageError(f"--celsius is {celsius}; it must be a number")
    if not points:
        raise MissingDataError(f"model {model.name} does not depend on temperature, so --celsius has no meaning for it")
    if celsius is not None and not points[0] <= celsius <= points[-1]:
        raise MissingDataError(
            f"--celsius {celsius:g}: model {model.name} is known from {points[0]:g} to {points[-1]:g} °C"
        )
    rows = points if len(points) <= MOST_ROWS else np.linspace(points[0], points[-1], MOST_ROWS).tolist()
    table = tuple(_row(model, t) for t in rows)
    if celsius is None:
        plain = "the tool has no place for temperature: the terms that the model states without it are written; --celsius T takes those at T"
        return model, (plain, *table)
    axes = {name: _at(axis, celsius) for name, axis in model.axes.items()}
    taken = f"the tool has no place for temperature: the model at {celsius:g} °C is written"
    stated = {**model.provenance, "at": f"{celsius:g} °C"}
    return replace(model, axes=axes, provenance=stated), (taken, *table)


def _set_points(axis: AxisModel) -> list[float]:
    return [point[0] for curve in (axis.thermal, axis.thermal_bias, axis.thermal_scale_factor) for point in curve]


def _at(axis: AxisModel, celsius: float) -> AxisModel:
    """Return an axis without curves; intervals of processes are those of another temperature, so they are left out."""
    return replace(
        axis,
        processes=axis.at(celsius),
        intervals={} if axis.thermal else axis.intervals,
        thermal=(),
        bias=_value(axis.thermal_bias, axis.bias, celsius),
        scale_factor=_value(axis.thermal_scale_factor, axis.scale_factor, celsius),
        thermal_bias=(),
        thermal_scale_factor=(),
    )


def _value(curve: tuple[tuple[float, float], ...], otherwise: float, celsius: float) -> float:
    if not curve:
        return otherwise
    return float(np.interp(celsius, [t for t, _ in curve], [value for _, value in curve]))


def _row(model: ImuErrorModel, celsius: float) -> str:
    """Return the biases and the white noise of the axes at a temperature, in words."""
    parts: list[str] = []
    for sensor, units in _UNITS.items():
        own = [_at(axis, celsius) for name, axis in model.axes.items() if name.startswith(sensor)]
        curved = any(axis.thermal_bias for name, axis in model.axes.items() if name.startswith(sensor))
        scaled = any(axis.thermal_scale_factor for name, axis in model.axes.items() if name.startswith(sensor))
        noisy = any(axis.thermal for name, axis in model.axes.items() if name.startswith(sensor))
        white = [term.N for axis in own for term in axis.processes.terms if isinstance(term, WhiteNoise)]
        parts += [f"{sensor} bias {_texts([axis.bias for axis in own])} {units[0]}"] if curved else []
        parts += [f"{sensor} scale factor {_texts([axis.scale_factor for axis in own])}"] if scaled else []
        parts += [f"{sensor} N {_texts(white)} {units[1]}"] if noisy and white else []
    return f"at {celsius:g} °C: {'; '.join(parts)}"


def _texts(values: list[float]) -> str:
    return ", ".join(f"{value:.4g}" for value in values)

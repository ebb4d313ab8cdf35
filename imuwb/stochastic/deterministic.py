"""The deterministic terms of an error model, added to a motion and subtracted from a measurement.

With s the scale factor, s2 its non-linear part, c the cross-couplings and G the g-sensitivity (Hassaballa, eq. 1 and 2):

    measured = (1 + s + s2 |true|/range) true + c . others + G . force + b
"""

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import AXES
from imuwb.stochastic.axis_model import AxisModel, Thermal
from imuwb.stochastic.error_model import ImuErrorModel

RAW = "calibration_unit"  #: key in a model's provenance: unit of the samples that were calibrated, if it is not SI
GYROS = 3  #: axes before the first accelerometer
CLOSE = 1e-14  #: share of the largest value, measured or true; a smaller change ends the iteration
MOST_TURNS = 200  #: largest number of iterations
NOTHING = AxisModel()
#: field of an axis model -> its term; a curve counts where the temperature is known
PLAIN = {
    "bias": "bias", "scale_factor": "scale factor", "scale_factor_nonlinear": "non-linear scale factor",
    "cross_coupling": "cross-coupling", "g_sensitivity": "g-sensitivity",
}  # fmt: skip
THERMAL = {"thermal_bias": "bias", "thermal_scale_factor": "scale factor"}


def is_ideal(model: ImuErrorModel) -> bool:
    """Return whether a model has no deterministic term."""
    return not any(states(model, name) for name in (*PLAIN, *THERMAL))


def states(model: ImuErrorModel, name: str) -> bool:
    """Return whether a model states a term, a field of an axis model, on any axis."""
    return any(np.any(getattr(axis, name)) for axis in model.axes.values())


def unscaled(model: ImuErrorModel) -> tuple[str, ...]:
    """Return the axes whose samples stay in counts or volts after a correction by a model of a calibration of such samples."""
    if RAW not in model.provenance:
        return ()
    return tuple(axis for axis in AXES if not model.axes.get(axis, NOTHING).scale_factor)


def is_thermal(model: ImuErrorModel) -> bool:
    """Return whether a model has deterministic terms that depend on temperature."""
    return any(states(model, name) for name in THERMAL)


def shown(model: ImuErrorModel, motion: tuple[Floats, Floats], celsius: Floats | None) -> tuple[Floats, Floats]:
    """Return what sensors without noise measure of a motion.

    Args:
        model: its deterministic terms.
        motion: (n, 3) rad/s and (n, 3) m/s², true.
        celsius: (n,) or () °C; None: unknown; constant values count in place of the model's curves.
    """
    rate, force = motion
    gyro = np.stack([_axis(model, i, rate, celsius) + _leaked(model, i, force) for i in range(GYROS)], axis=1)
    return gyro, np.stack([_axis(model, GYROS + i, force, celsius) for i in range(GYROS)], axis=1)


def corrected(model: ImuErrorModel, measured: tuple[Floats, Floats], celsius: Floats | None) -> tuple[Floats, Floats]:
    """Return the motion for which sensors without noise measure these values: the inverse of ``shown``.

    Args:
        model: its deterministic terms.
        measured: (n, 3) rad/s and (n, 3) m/s².
        celsius: as in ``shown``.

    Raises:
        ValueError: terms so large that no motion fits the measurement.
    """
    rate, force = measured
    force = np.stack(_solved(model, GYROS, force, celsius), axis=1)
    leaked = np.stack([np.broadcast_to(_leaked(model, i, force), len(rate)) for i in range(GYROS)], axis=1)
    return np.stack(_solved(model, 0, rate - leaked, celsius), axis=1), force


def _axis(model: ImuErrorModel, place: int, triad: Floats, celsius: Floats | None) -> Floats:
    """Return what axis ``place`` measures of its triad's (n, 3) motion."""
    axis = model.axes.get(AXES[place], NOTHING)
    true = triad[:, place % 3]
    return _gain(axis, true, celsius) * true + _crossed(axis, place, triad) + _at(axis.thermal_bias, axis.bias, celsius)


def _gain(axis: AxisModel, true: Floats, celsius: Floats | None) -> Floats:
    bent = axis.scale_factor_nonlinear * np.abs(true) / axis.range if axis.range else 0.0
    return np.asarray(1 + _at(axis.thermal_scale_factor, axis.scale_factor, celsius) + bent)


def _crossed(axis: AxisModel, place: int, triad: Floats) -> Floats:
    others = [k for k in range(3) if k != place % 3]
    return axis.cross_coupling[0] * triad[:, others[0]] + axis.cross_coupling[1] * triad[:, others[1]]


def _leaked(model: ImuErrorModel, place: int, force: Floats) -> Floats:
    return force @ np.array(model.axes.get(AXES[place], NOTHING).g_sensitivity)


def _at(points: Thermal, plain: float, celsius: Floats | None) -> Floats | float:
    if not points or celsius is None:
        return plain
    return np.interp(celsius, [t for t, _ in points], [value for _, value in points])


def _solved(model: ImuErrorModel, first: int, measured: Floats, celsius: Floats | None) -> list[Floats]:
    """Return the triad's motion by iteration over the axes: the measurement less bias and cross-couplings, over the gain."""
    axes = [model.axes.get(AXES[first + i], NOTHING) for i in range(3)]
    true = np.array(measured)
    largest = float(np.abs(measured).max(initial=0.0))
    for _ in range(MOST_TURNS):
        before = true.copy()
        for i, axis in enumerate(axes):
            bias = _at(axis.thermal_bias, axis.bias, celsius)
            true[:, i] = (measured[:, i] - bias - _crossed(axis, i, true)) / _gain(axis, true[:, i], celsius)
        # The size of the motion counts too: a measurement of 0 may be a motion that cancels a bias.
        close = CLOSE * max(largest, float(np.abs(true).max(initial=0.0)))
        if not np.abs(true - before).max(initial=0.0) > close:
            return [true[:, i] for i in range(3)]
    raise ValueError(
        f"{model.name}: its scale factors and cross-couplings are so large that no motion fits the measurement; check the model"
    )

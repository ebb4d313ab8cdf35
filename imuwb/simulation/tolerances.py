"""One specimen of a sensor: its turn-on biases and its errors within the tolerances of a data sheet, drawn once."""

import math
from dataclasses import dataclass, replace

import numpy as np

from imuwb.log import AXES
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Sum

_DRAWS = 0x7201E  #: keeps these draws apart from those of noise with the same seed


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Largest errors, each drawn from a uniform distribution; defaults: the data sheet of InvenSense's MPU-6050."""

    scale_factor: float = 0.03
    cross_axis: float = 0.02  #: rad
    nonlinearity_gyro: float = 0.002  #: of full range
    nonlinearity_accel: float = 0.005
    g_sensitivity: float = math.radians(0.1) / 9.80665  #: rad/s per m/s²


def specimen(model: ImuErrorModel, seed: int, tolerances: Tolerances | None) -> ImuErrorModel:
    """Return one sensor of a kind; its turn-on biases and its errors within the tolerances are drawn at random.

    Args:
        model: the kind. A ``Constant`` process becomes a bias, normally distributed.
        seed: the same seed draws the same sensor.
        tolerances: None: the model's own deterministic terms are the truth.
    """
    axes = {
        name: _axis(name, axis, tolerances, np.random.default_rng([seed, _DRAWS, AXES.index(name)]))
        for name, axis in model.axes.items()
    }
    drawn = "turn-on biases" + ("" if tolerances is None else ", scale factors, cross-couplings and g-sensitivity")
    truth = {**model.provenance, "truth": f"{drawn} drawn with seed {seed}"}
    return replace(model, axes=axes, provenance=truth)


def _axis(name: str, axis: AxisModel, tolerances: Tolerances | None, rng: np.random.Generator) -> AxisModel:
    constants = [term for term in axis.processes.terms if isinstance(term, Constant)]
    others = tuple(term for term in axis.processes.terms if not isinstance(term, Constant))
    bias = sum(float(rng.normal(0.0, term.sigma)) for term in constants)
    fixed = replace(axis, processes=Sum(others), intervals={}, bias=axis.bias + bias)
    if tolerances is None:
        return fixed

    def within(most: float) -> float:
        return float(rng.uniform(-most, most))

    gyro = name.startswith("gyro")
    bent = tolerances.nonlinearity_gyro if gyro else tolerances.nonlinearity_accel
    return replace(
        fixed,
        scale_factor=within(tolerances.scale_factor),
        scale_factor_nonlinear=within(bent) if axis.range else 0.0,
        cross_coupling=(within(tolerances.cross_axis), within(tolerances.cross_axis)),
        g_sensitivity=(
            (within(tolerances.g_sensitivity), within(tolerances.g_sensitivity), within(tolerances.g_sensitivity))
            if gyro
            else (0.0, 0.0, 0.0)
        ),
    )

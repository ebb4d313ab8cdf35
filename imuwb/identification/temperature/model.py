"""The error model of one axis over temperature."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.likelihood.fit import TERMS
from imuwb.identification.temperature.axis import AxisTemperatures
from imuwb.identification.temperature.functions import TemperatureFunction
from imuwb.stochastic import AxisModel, Sum

STEP = 5.0  #: °C, largest distance between set-points of a model, which is linear between them


def axis_model(axis: AxisTemperatures, reference: float = 25.0, *, gravity: bool = False) -> AxisModel:
    """Return the error model of an axis: processes and bias by temperature, each by its function.

    Args:
        axis: its set-points and laws.
        reference: °C, for use without a known temperature.
        gravity: whether the means include gravity, as an accelerometer's do. Since one attitude does not separate the bias from
            gravity, biases are then changes from the reference temperature.
    """
    laws = {letter: law.function for letter in TERMS if (law := axis.laws[letter]).function is not None}
    lowest, highest = axis.points[0].celsius, axis.points[-1].celsius
    at_reference = float(np.clip(reference, lowest, highest))
    inside = [p.celsius for p in axis.points]
    steps = np.linspace(lowest, highest, int(np.ceil((highest - lowest) / STEP)) + 1)
    celsius: Floats = np.unique(np.concatenate([steps, inside, [at_reference]]).round(2))
    varies = any(law.kind != "constant" for law in laws.values())
    thermal = tuple((float(t), _sum(laws, float(t))) for t in celsius) if varies else ()
    bias, thermal_bias = _bias(axis, celsius, at_reference, gravity=gravity)
    return AxisModel(
        _sum(laws, at_reference),
        _intervals(laws, at_reference, axis.level),
        {letter: law.limit for letter, law in axis.laws.items() if law.limit is not None},
        thermal=thermal,
        bias=bias,
        thermal_bias=thermal_bias,
    )


def _value(law: TemperatureFunction, celsius: float) -> float:
    return float(law.at(np.array([celsius]))[0][0])


def _sum(laws: dict[str, TemperatureFunction], celsius: float) -> Sum:
    return Sum(tuple(TERMS[letter](_value(law, celsius)) for letter, law in laws.items()))


def _intervals(laws: dict[str, TemperatureFunction], celsius: float, level: float) -> dict[str, tuple[float, float]]:
    intervals: dict[str, tuple[float, float]] = {}
    for i, (letter, law) in enumerate(laws.items()):
        _, lower, upper = law.at(np.array([celsius]), level)
        intervals[f"{i}.{letter}"] = float(lower[0]), float(upper[0])
    return intervals


def _bias(
    axis: AxisTemperatures, celsius: Floats, reference: float, *, gravity: bool
) -> tuple[float, tuple[tuple[float, float], ...]]:
    law = axis.laws["bias"].function if "bias" in axis.laws else None
    if law is None:
        return 0.0, ()
    at_reference = _value(law, reference)
    if law.kind == "constant":
        return (0.0 if gravity else at_reference), ()
    values = law.at(celsius)[0] - (at_reference if gravity else 0.0)
    bias = 0.0 if gravity else at_reference
    return bias, tuple((float(t), float(v)) for t, v in zip(celsius, values, strict=True))

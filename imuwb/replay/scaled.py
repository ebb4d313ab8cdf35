"""An error model with its noise multiplied: what a still record tells is less than what shows in a vehicle."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Quantization, Sum, WhiteNoise

if TYPE_CHECKING:
    from imuwb.stochastic import Process

AMPLITUDES = ("N", "B", "K", "R", "sigma", "beta0", "amplitude")  #: parameters in the unit of the axis


def scaled(model: ImuErrorModel, white: tuple[float, float], slow: tuple[float, float] = (1.0, 1.0)) -> ImuErrorModel:
    """Return a model whose white noise, and whose slower processes, are multiplied; turn-on biases stay.

    Args:
        model: of an IMU.
        white: factors of gyros and accelerometers.
        slow: of all but white noise and turn-on bias, likewise.
    """

    def of(process: Process, sensor: int) -> Process:
        if isinstance(process, Constant | Quantization):
            return process
        factor = (white if isinstance(process, WhiteNoise) else slow)[sensor]
        own: Any = process
        return replace(own, **{f.name: getattr(own, f.name) * factor for f in fields(own) if f.name in AMPLITUDES})

    def axis(name: str, one: AxisModel) -> AxisModel:
        sensor = int(name.startswith("accel"))

        def total(s: Sum) -> Sum:
            return Sum(tuple(of(term, sensor) for term in s.terms))

        points = tuple((t, total(s)) for t, s in one.thermal)
        return replace(one, processes=total(one.processes), thermal=points, intervals={}, limits={})

    return replace(model, axes={name: axis(name, one) for name, one in model.axes.items()})

"""An error model with its noise scaled: the noise in a vehicle is larger than that of a static record."""

from dataclasses import fields, replace
from typing import Any

from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Process, Quantization, Sum, WhiteNoise

AMPLITUDES = (
    "N",
    "B",
    "K",
    "R",
    "sigma",
    "beta0",
    "amplitude",
)  #: parameters that are proportional to the unit of the axis


def scaled(model: ImuErrorModel, white: tuple[float, float], slow: tuple[float, float] = (1.0, 1.0)) -> ImuErrorModel:
    """Return a model with scaled white noise and scaled slower processes; turn-on biases and quantization stay.

    Args:
        model: error model of an IMU.
        white: factors of the white noise of gyros and accelerometers.
        slow: factors of the slower processes of gyros and accelerometers.
    """

    def of(process: Process, sensor: int) -> Process:
        if isinstance(process, Constant | Quantization):
            return process
        factor = (white if isinstance(process, WhiteNoise) else slow)[sensor]
        term: Any = process
        return replace(term, **{f.name: getattr(term, f.name) * factor for f in fields(term) if f.name in AMPLITUDES})

    def axis(name: str, own: AxisModel) -> AxisModel:
        sensor = int(name.startswith("accel"))

        def total(s: Sum) -> Sum:
            return Sum(tuple(of(term, sensor) for term in s.terms))

        points = tuple((t, total(s)) for t, s in own.thermal)
        return replace(own, processes=total(own.processes), thermal=points, intervals={}, limits={})

    return replace(model, axes={name: axis(name, own) for name, own in model.axes.items()})

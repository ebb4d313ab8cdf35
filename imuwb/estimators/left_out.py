"""What an estimator has no place for, and what that does to a drift."""

import math
from typing import Any, cast

import numpy as np

from imuwb.estimators.growth import TO_POSITION, averaged, constant_variance
from imuwb.estimators.tool import Tool
from imuwb.navigation.lines import line_drift
from imuwb.stochastic import (
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Sum,
    WhiteNoise,
)
from imuwb.units import STANDARD_GRAVITY

_SLOW = (FlickerNoise, GaussMarkov, RandomWalk)


def cost_texts(tool: Tool, model: ImuErrorModel, horizon: float) -> list[str]:
    """Return a sentence for each kind of process that the tool has no place for.

    Args:
        tool: the estimator.
        model: the sensor.
        horizon: s without aids, after which the drift is stated.
    """
    terms = tool.terms
    held: tuple[type, ...] = (WhiteNoise,)
    held += _SLOW if terms & {"K", "sigma", "drive"} else ()
    held += (FlickerNoise,) if "B" in terms else ()
    held += (RandomWalk,) if "own_K" in terms else ()
    held += (Constant,) if "turn_on" in terms else ()
    drifts: dict[tuple[str, str], list[float]] = {}
    for axis, content in model.axes.items():
        sensor = axis.partition("_")[0]
        for term in cast("tuple[Any, ...]", content.processes.terms):
            if not isinstance(term, held):
                name = (
                    term.name.replace("_", " ")
                    .replace("gauss markov", "Gauss-Markov bias")
                    .replace("constant", "bias at turn-on")
                )
                drifts.setdefault((sensor, name), []).append(_drift(term, sensor, horizon))
    return [_text(sensor, name, sizes, horizon) for (sensor, name), sizes in drifts.items()]


def _text(sensor: str, name: str, sizes: list[float], horizon: float) -> str:
    known = [size for size in sizes if not math.isnan(size)]
    cost = f"; alone it moves the position by {max(known):.2g} m in {horizon:g} s" if known else ""
    return f"{sensor}: the tool has no place for {name}, so it is left out{cost}"


def _drift(term: object, sensor: str, horizon: float) -> float:
    """Return the position drift (m, 1 sigma) that one process makes when it is the only error; nan where it is not known."""
    times = TO_POSITION[sensor]
    gain = STANDARD_GRAVITY if sensor == "gyro" else 1.0
    if isinstance(term, Constant):
        return gain * math.sqrt(constant_variance(term.sigma, horizon, times))
    if isinstance(term, RateRamp):
        return gain * abs(term.R) * horizon ** (times + 1) / math.factorial(times + 1)
    if isinstance(term, Sinusoid):
        return math.sqrt(float(line_drift(term.amplitude, term.frequency, np.array(horizon), gyro=sensor == "gyro")))
    if isinstance(term, FlickerNoise | GaussMarkov | RandomWalk):
        return gain * math.sqrt(averaged(horizon, times, horizon).variance(Sum((term,))))
    return math.nan

"""The error model of several logs of one sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from imuwb.stochastic import AxisModel, Constant, FlickerNoise, ImuErrorModel, Quantization, RandomWalk, Sum, WhiteNoise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.stochastic import Process
    from imuwb_plugins.noise.repeatability import Repeatability

_TERMS = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}


def combined(models: Sequence[ImuErrorModel], together: Repeatability | None) -> ImuErrorModel:
    """Return one log's model; of several logs the coefficients that all together show, and the turn-on bias.

    They are those of one sum Q, N, B, K: logs may prefer different sums, of which the terms mean different things. What all
    logs together do not show has a limit. Lines are left to the single logs.
    """
    if together is None:
        return models[0]
    axes = {axis: _axis(axis, together) for axis in together.coefficients}
    source = "; ".join(f"{key} {i + 1}: {text}" for i, m in enumerate(models) for key, text in m.provenance.items())
    return ImuErrorModel(models[0].name, axes, {"logs": source})


def _axis(axis: str, together: Repeatability) -> AxisModel:
    terms: list[Process] = []
    intervals: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    for letter, compared in together.coefficients[axis].items():
        mean = compared.mean
        if mean.value is not None and mean.lower:
            intervals[f"{len(terms)}.{letter}"] = mean.lower, mean.upper
            terms.append(_TERMS[letter](mean.value))
        elif math.isfinite(mean.upper):
            limits[letter] = mean.upper
    turn_on = together.turn_on[axis].sigma
    if turn_on.value is not None and turn_on.lower is not None:
        intervals[f"{len(terms)}.sigma"] = (turn_on.lower, turn_on.upper)
        terms.append(Constant(turn_on.value))
    return AxisModel(Sum(tuple(terms)), intervals, limits)

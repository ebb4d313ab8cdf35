"""The error model of one log, or of several logs of one sensor."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from imuwb.health import model_doubts
from imuwb.notes import Note
from imuwb.replay import with_autoregressive
from imuwb.stochastic import (
    AxisModel,
    Constant,
    FlickerNoise,
    ImuErrorModel,
    Process,
    Quantization,
    RandomWalk,
    Sum,
    WhiteNoise,
)
from imuwb_plugins import allan
from imuwb_plugins.noise.repeatability import Repeatability
from imuwb_plugins.noise.result import Result

_TERMS = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}
_ALLAN: Any = allan


def error_model(result: Result) -> ImuErrorModel:
    """Return the headline's sums; of several logs their means, with the turn-on bias; and all doubts."""
    models = [_ALLAN.error_model(part["allan"]) for part in result.parts]
    model = combined(models, result.repeatability)
    if result.repeatability is None:
        return with_autoregressive(model, result.autoregressive)
    doubts = (
        f"{log}: {doubt}" for log, m in zip(result.repeatability.names, models, strict=True) for doubt in m.doubts
    )
    return replace(model, doubts=(*doubts, *model_doubts(model).all))


def objections(result: Result) -> tuple[Note, ...]:
    """Return why no error model should be made of these records."""
    own = [_ALLAN.objections(part["allan"]) for part in result.parts]
    if result.repeatability is None:
        return own[0]
    named = zip(result.repeatability.names, own, strict=True)
    return tuple(Note(note.id, f"{log}: {note}") for log, notes in named for note in notes)


def combined(models: Sequence[ImuErrorModel], repeatability: Repeatability | None) -> ImuErrorModel:
    """Return one log's model; of several logs the coefficients that they show together, and the turn-on bias.

    All logs together have one sum Q, N, B, K, because single logs may prefer different sums, whose terms mean different things.
    A coefficient that the logs together do not show has a limit. Periodic lines belong to a single log and are left out.
    """
    if repeatability is None:
        return models[0]
    axes = {axis: _axis(axis, repeatability) for axis in repeatability.coefficients}
    source = "; ".join(f"{key} {i + 1}: {text}" for i, m in enumerate(models) for key, text in m.provenance.items())
    return ImuErrorModel(models[0].name, axes, {"logs": source})


def _axis(axis: str, repeatability: Repeatability) -> AxisModel:
    terms: list[Process] = []
    intervals: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    for letter, compared in repeatability.coefficients[axis].items():
        mean = compared.mean
        if mean.value is not None and mean.lower:
            intervals[f"{len(terms)}.{letter}"] = mean.lower, mean.upper
            terms.append(_TERMS[letter](mean.value))
        elif 0 < mean.upper < math.inf:
            limits[letter] = mean.upper
    turn_on = repeatability.turn_on[axis].sigma
    if turn_on.value is not None and turn_on.lower is not None:
        intervals[f"{len(terms)}.sigma"] = (turn_on.lower, turn_on.upper)
        terms.append(Constant(turn_on.value))
    return AxisModel(Sum(tuple(terms)), intervals, limits)

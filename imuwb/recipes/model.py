"""The error model of several logs of one sensor."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, cast

from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Sinusoid, Sum

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.recipes.repeatability import Repeatability


def combined(models: Sequence[ImuErrorModel], together: Repeatability | None) -> ImuErrorModel:
    """Return one log's model, or several logs' as one: their terms, and the turn-on bias as a constant.

    A term is in it where half of the logs show it; its parameters are root mean squares. Lines are left to the single logs.
    """
    if together is None:
        return models[0]
    axes = {axis: _axis(axis, [m.axes[axis] for m in models if axis in m.axes], together) for axis in models[0].axes}
    source = "; ".join(f"{key} {i + 1}: {text}" for i, m in enumerate(models) for key, text in m.provenance.items())
    return ImuErrorModel(models[0].name, axes, {"logs": source})


def _axis(axis: str, models: Sequence[AxisModel], together: Repeatability) -> AxisModel:
    found: dict[type, list[Any]] = {}
    for model in models:
        for term in model.processes.terms:
            if not isinstance(term, Sinusoid):
                found.setdefault(type(term), []).append(term)
    terms: list[Any] = [_mean(same) for same in found.values() if 2 * len(same) >= len(models)]
    intervals: dict[str, tuple[float, float]] = {}
    for i, term in enumerate(terms):
        for f in fields(term):
            compared = together.coefficients.get(axis, {}).get(f.name)
            if compared is not None and compared.mean is not None and compared.mean_interval is not None:
                terms[i] = replace(term, **{f.name: compared.mean})
                intervals[f"{i}.{f.name}"] = compared.mean_interval
    if axis in together.turn_on:
        turn_on = together.turn_on[axis]
        intervals[f"{len(terms)}.sigma"] = (turn_on.lower, turn_on.upper)
        terms.append(Constant(turn_on.sigma))
    return AxisModel(Sum(tuple(terms)), intervals)


def _mean(terms: list[Any]) -> Any:  # noqa: ANN401 - whatever process it is given
    def rms(name: str) -> float:
        values = [cast("float", getattr(term, name)) for term in terms]
        return (sum(v * v for v in values) / len(values)) ** 0.5

    return replace(
        terms[0], **{f.name: rms(f.name) for f in fields(terms[0]) if isinstance(getattr(terms[0], f.name), float)}
    )

"""What a bench record leaves open, carried by a filter: a process that is not identified is not zero.

A record of an hour that shows white noise alone still allows bias instability and a random walk below its limits. A filter
without them holds its biases for constants, and after some minutes it refuses fixes.
"""

from dataclasses import replace

from imuwb.stochastic import FLICKER_LEVEL, AxisModel, FlickerNoise, GaussMarkov, ImuErrorModel, RandomWalk, Sum

HORIZON = 60.0  #: s, of an outage: the random walk has the deviation of the limits after this time
SLOW = (FlickerNoise, GaussMarkov, RandomWalk)


def with_unidentified(model: ImuErrorModel, source: ImuErrorModel) -> tuple[ImuErrorModel, tuple[str, ...]]:
    """Return a model with a random walk at the upper limit of what its record does not identify, and the axes that get one.

    An axis with a slow process of its own, or whose record states no limits, stays as it is. The walk is the larger of the
    limit of K and of a walk whose Allan deviation after ``HORIZON`` is that of bias instability at the limit of B.

    Args:
        model: the filter's error model.
        source: the error model of the record, with its limits.
    """
    axes: dict[str, AxisModel] = {}
    carried: list[str] = []
    for name, own in model.axes.items():
        limit = _walk(source.axes[name])
        slow = any(isinstance(term, SLOW) for term in source.axes[name].processes.terms)
        if limit and not slow:
            more = RandomWalk(limit)
            thermal = tuple((t, Sum((*s.terms, more))) for t, s in own.thermal)
            own = replace(own, processes=Sum((*own.processes.terms, more)), thermal=thermal)  # noqa: PLW2901
            carried.append(name)
        axes[name] = own
    return replace(model, axes=axes), tuple(carried)


def _walk(axis: AxisModel) -> float:
    """Return K, unit/√s, of the random walk that the limits of a record allow; 0: no limits."""
    k, b = axis.limits.get("K", 0.0), axis.limits.get("B", 0.0)
    return max(k, FLICKER_LEVEL * b / (HORIZON / 3) ** 0.5)

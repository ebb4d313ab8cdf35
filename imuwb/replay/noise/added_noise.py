"""An error model with noise added to it: what a sensor does in motion and not at rest."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from imuwb.stochastic import AxisModel, ImuErrorModel, Process, RandomWalk, Sum, WhiteNoise


def with_added(model: ImuErrorModel, white: tuple[float, float], walk: tuple[float, float]) -> ImuErrorModel:
    """Return a model with independent white noise and random walks added on every axis, at all temperatures.

    Densities of independent noise add: an axis with white noise of density N² has N² + white² after the addition.

    Args:
        model: error model of an IMU.
        white: N of gyros, rad/s/√Hz, and accelerometers, m/s²/√Hz.
        walk: K of gyros, rad/s/√s, and accelerometers, m/s²/√s.
    """

    def axis(name: str, own: AxisModel) -> AxisModel:
        sensor = int(name.startswith("accel"))

        def total(s: Sum) -> Sum:
            return Sum(tuple(_added(s.terms, white[sensor], walk[sensor])))

        points = tuple((t, total(s)) for t, s in own.thermal)
        return replace(own, processes=total(own.processes), thermal=points, intervals={}, limits={})

    return replace(model, axes={name: axis(name, own) for name, own in model.axes.items()})


def _added(terms: Iterable[Process], white: float, walk: float) -> list[Process]:
    """Return the terms with white noise and a random walk added; terms of the same kind become one."""
    kept = [term for term in terms if not isinstance(term, WhiteNoise | RandomWalk)]
    n = [term.N for term in terms if isinstance(term, WhiteNoise)]
    k = [term.K for term in terms if isinstance(term, RandomWalk)]
    noise: list[Process] = []
    if total := float(np.sqrt(np.square([*n, white]).sum())):
        noise.append(WhiteNoise(total))
    if total := float(np.sqrt(np.square([*k, walk]).sum())):
        kept.append(RandomWalk(total))
    return [*noise, *kept]

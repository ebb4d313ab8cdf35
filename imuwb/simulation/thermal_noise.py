"""The noise of a sensor whose temperature changes.

An amplitude multiplies a process of unit amplitude, sample by sample. The steps of a random walk and of a ramp are scaled
before they are added up. A correlation time, a frequency or the coefficients of an AR set change within the recursion. Its
state continues, so the output never jumps. The variance at any time is that of the temperature at that time.
"""

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    WhiteNoise,
)

Parameters = Mapping[str, Floats]  #: parameter of a process -> (n,) its value at each sample

PIECE = 0.25  #: °C, over which an AR set is constant
SMALL = 1e-3  #: dt/Tc, below which a difference of tanh cancels


def thermal_noise(model: AxisModel, celsius: Floats, dt: float, rng: np.random.Generator) -> Floats:
    """Return an axis's noise, one sample for each temperature.

    Args:
        model: its processes at set-points.
        celsius: (n,) °C.
        dt: s.
        rng: for all draws; the terms are drawn one after another.

    Returns:
        (n,) in the axis's unit.

    Raises:
        ValueError: an AR set for another sampling interval, or one that is not stable between two set-points; a process that
            has no rule for a changing temperature.
    """
    if not model.thermal:
        return model.processes.sample(celsius.size, dt, rng)
    total = np.zeros(celsius.size)
    for place, term in enumerate(model.thermal[0][1].terms):
        if isinstance(term, Autoregressive):
            total += _autoregressive(model, place, celsius, dt, rng)
            continue
        if type(term) not in RULES:
            raise ValueError(f"{term} has no rule for a changing temperature")
        total += RULES[type(term)](_parameters(model, place, celsius), dt, rng)
    return total


def _parameters(model: AxisModel, place: int, celsius: Floats) -> Parameters:
    """Return a term's parameters at each sample, as ``AxisModel.at`` computes them."""
    terms: list[Any] = [sums.terms[place] for _, sums in model.thermal]
    points = [t for t, _ in model.thermal]
    return {f.name: np.interp(celsius, points, [getattr(term, f.name) for term in terms]) for f in fields(terms[0])}


def _times(unit: Any, name: str) -> Callable[[Parameters, float, np.random.Generator], Floats]:  # noqa: ANN401 - any process
    """Return the rule of a process that has an amplitude only."""

    def rule(p: Parameters, dt: float, rng: np.random.Generator) -> Floats:
        return p[name] * unit.sample(p[name].size, dt, rng)

    return rule


def _random_walk(p: Parameters, dt: float, rng: np.random.Generator) -> Floats:
    steps = rng.standard_normal((2, p["K"].size)) * (p["K"] * np.sqrt(dt))
    # As for a walk at one temperature: the mean of both ends of a step, plus the mean of a Brownian bridge, variance 1/12.
    return np.cumsum(steps[0]) - steps[0] / 2 + steps[1] / np.sqrt(12)


def _rate_ramp(p: Parameters, dt: float, rng: np.random.Generator) -> Floats:
    return dt * (np.cumsum(p["R"]) - p["R"] / 2)


def _sinusoid(p: Parameters, dt: float, rng: np.random.Generator) -> Floats:
    turns = p["frequency"] * dt
    middle = 2 * np.pi * (np.cumsum(turns) - turns / 2) + rng.uniform(0, 2 * np.pi)
    return p["amplitude"] * np.sinc(turns) * np.sin(middle)


def _gauss_markov(p: Parameters, dt: float, rng: np.random.Generator) -> Floats:
    """Return averages over dt: given both ends of a step, they are normal with mean (a + b) tanh(x/2)/x, x = dt/Tc."""
    from imuwb.simulation.recursion import carried  # noqa: PLC0415 - numba is slow to import

    x = dt / p["Tc"]
    start = rng.standard_normal()
    noise = rng.standard_normal((2, x.size))
    ends = carried(start, np.exp(-x), np.sqrt(-np.expm1(-2 * x)) * noise[0])
    share = np.tanh(x / 2) / x
    apart = np.where(x < SMALL, x / 6, 2 * (1 - 2 * share) / x)  # variance about the mean; 2 (x - 2 tanh(x/2))/x²
    return p["sigma"] * ((ends[:-1] + ends[1:]) * share + np.sqrt(apart) * noise[1])


def _autoregressive(model: AxisModel, place: int, celsius: Floats, dt: float, rng: np.random.Generator) -> Floats:
    """Return a series whose AR set changes every quarter of a degree, while its past values stay."""
    from scipy import signal  # noqa: PLC0415 - scipy.signal is slow to import

    edges = np.flatnonzero(np.diff(np.floor(celsius / PIECE))) + 1
    series: list[Floats] = []
    past = np.empty(0)  # the newest first
    for piece in np.split(celsius, edges):
        term: Any = model.at(float(piece.mean())).terms[place]
        if not series:
            order = len(term.alpha)
            past = term.sample(order, dt, rng)[::-1] if order else past
        driving = term.beta0 * rng.standard_normal(piece.size)
        taps = [1.0, *term.alpha]
        state = signal.lfiltic([1.0], taps, past)
        values = signal.lfilter([1.0], taps, driving, zi=state)[0] if past.size else driving
        past = np.concatenate([values[::-1][: past.size], past])[: past.size]
        series.append(values)
    return np.concatenate(series)


#: process -> its rule; an AR set has none, as its recursion changes
RULES: dict[type, Callable[[Parameters, float, np.random.Generator], Floats]] = {
    WhiteNoise: _times(WhiteNoise(1.0), "N"),
    Quantization: _times(Quantization(1.0), "Q"),
    FlickerNoise: _times(FlickerNoise(1.0), "B"),
    Constant: _times(Constant(1.0), "sigma"),
    RandomWalk: _random_walk,
    RateRamp: _rate_ramp,
    GaussMarkov: _gauss_markov,
    Sinusoid: _sinusoid,
}

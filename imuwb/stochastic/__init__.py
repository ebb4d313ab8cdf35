"""A small algebra of stochastic processes, and the error model of an IMU that is made of them.

``WhiteNoise(N) + GaussMarkov(sigma, T) + RandomWalk(K)`` is a value: it has an Allan variance and a
spectrum, it can be sampled, and it can be given to a filter.
"""

from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.deterministic import corrected, is_ideal, is_thermal, shown
from imuwb.stochastic.error_model import AxisModel, ImuErrorModel
from imuwb.stochastic.processes import (
    Constant,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    WhiteNoise,
)
from imuwb.stochastic.state_space import FlickerApproximation, StateSpace
from imuwb.stochastic.sums import FiniteOrder, Process, Stationary, Sum

__all__ = [
    "Autoregressive",
    "AxisModel",
    "Constant",
    "FiniteOrder",
    "FlickerApproximation",
    "FlickerNoise",
    "GaussMarkov",
    "ImuErrorModel",
    "Process",
    "Quantization",
    "RandomWalk",
    "RateRamp",
    "Sinusoid",
    "StateSpace",
    "Stationary",
    "Sum",
    "WhiteNoise",
    "corrected",
    "is_ideal",
    "is_thermal",
    "shown",
]

"""All kinds of processes by the names that they have in documents."""

from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.flicker import FlickerNoise
from imuwb.stochastic.gauss_markov import GaussMarkov
from imuwb.stochastic.processes import Constant, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise

PROCESSES = {
    kind.name: kind
    for kind in (
        WhiteNoise, Quantization, FlickerNoise, RandomWalk, RateRamp, GaussMarkov, Autoregressive, Sinusoid, Constant,
    )
}  # fmt: skip

import numpy as np
import pytest

from imuwb.identification import allan
from imuwb.identification.temperature.white_slope import white_slope
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import Sum, WhiteNoise

N, DT = 0.005, 0.01
WHITE = {"Q": UNKNOWN, "N": Coefficient(N, 0.99 * N, 1.01 * N), "B": UNKNOWN, "K": UNKNOWN}


def test_white_noise_has_its_slope_and_an_interval_as_wide_as_the_slopes_scatter():
    rng = np.random.default_rng(1)
    process = Sum((WhiteNoise(N),))
    found = [
        white_slope(allan(process.sample(20_000, DT, rng), DT, "octave", fast=True), process, WHITE) for _ in range(60)
    ]
    slopes = np.array([region.slope.value for region in found])
    assert slopes.mean() == pytest.approx(-0.5, abs=0.005)
    halves = np.mean([(region.slope.upper - region.slope.lower) / 2 for region in found])
    assert halves == pytest.approx(1.96 * slopes.std(), rel=0.4)
    assert all(region.end / region.start == 2**9 for region in found)  # ten octaves


def test_without_white_noise_there_is_no_slope():
    curve = allan(np.random.default_rng(2).standard_normal(2000), DT, "octave")
    assert white_slope(curve, Sum((WhiteNoise(N),)), WHITE | {"N": UNKNOWN}) is None

import numpy as np
import pytest

from imuwb.identification.allan_variance.noise_type import exponent
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, WhiteNoise


@pytest.mark.parametrize(
    ("process", "alpha"), [(Quantization(1.0), 2), (WhiteNoise(1.0), 0), (FlickerNoise(1.0), -1), (RandomWalk(1.0), -2)]
)
def test_pure_noise_is_recognised(process, alpha):
    rng = np.random.default_rng(0)
    found = [exponent(np.cumsum(process.sample(2000, 1.0, rng))) for _ in range(50)]
    assert found.count(alpha) >= 40  # flicker lies between its neighbours, and 2000 points do not always tell


def test_too_few_points_or_none_that_vary_have_no_type():
    assert exponent(np.arange(29.0) % 3) is None
    assert exponent(np.zeros(100)) is None

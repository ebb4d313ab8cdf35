"""The papers' intervals of coefficients."""

import numpy as np
import pytest

from imuwb.identification import allan, fit_allan, printed_intervals
from imuwb.identification.coefficient import printed_half_width
from imuwb.stochastic import RandomWalk, WhiteNoise


@pytest.mark.parametrize(
    ("time", "value", "sigma"), [(654.01, 44.533, 5.14), (5.7, 0.047, 0.00050), (2.59, 5.1581, 0.0370)]
)
def test_one_sigma_of_table_4_is_eq_15_at_some_time(time, value, sigma):
    """B of gyro x at the end of its flat part; N of accelerometer z at 6 s, B of accelerometer x at 2.6 s."""
    assert value * printed_half_width(np.array(7 * 3600 / time), 0.6827) == pytest.approx(sigma, rel=0.02)


def test_coefficients_have_the_interval_of_their_part():
    true = WhiteNoise(0.01) + RandomWalk(1e-3)
    n, dt = 60_000, 0.01
    fit = fit_allan(allan(true.sample(n, dt, np.random.default_rng(2)), dt), ())
    found = printed_intervals(fit, n * dt)
    regions = {r.letter: r for r in fit.regions}
    for letter, time in (("N", regions["N"].end), ("K", regions["K"].start)):
        c = found[letter]
        half = 1.96 / np.sqrt(2 * (n * dt / time - 1))
        assert (c.lower, c.upper) == pytest.approx((c.value * (1 - half), c.value * (1 + half)), rel=1e-3)
    assert found["B"].value is None
    assert found["B"] == fit.coefficients["B"]

import numpy as np
import pytest
from scipy import linalg

from imuwb.stochastic import Autoregressive

DT = 0.1
AR3 = Autoregressive((-1.5, 0.9, -0.2), 0.7, DT)
MODELS = [AR3, Autoregressive((-0.95,), 2.0, DT), Autoregressive((0.4, 0.5), 1.0, DT), Autoregressive((), 3.0, DT)]


@pytest.mark.parametrize("model", MODELS, ids=repr)
@pytest.mark.parametrize("factor", [1, 2, 7])
def test_every_has_the_autocovariance_of_the_samples_that_are_left(model, factor):
    space = model.every(factor)
    for lag in range(6):
        found = space.c @ np.linalg.matrix_power(space.A, lag) @ space.P0 @ space.c + space.R * (lag == 0)
        assert found == pytest.approx(model.autocovariance(np.array([lag * factor * DT]))[0], rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("factor", [2, 3, 7])
def test_every_adds_up_the_noise_of_the_steps_between(factor):
    one, many = AR3.discretize(DT), AR3.every(factor)
    powers = [np.linalg.matrix_power(one.A, k) for k in range(factor)]
    np.testing.assert_allclose(many.A, powers[-1] @ one.A, atol=1e-12)
    np.testing.assert_allclose(many.Q, sum(p @ one.Q @ p.T for p in powers), atol=1e-9)
    np.testing.assert_allclose(many.A @ many.P0 @ many.A.T + many.Q, many.P0, rtol=1e-9)


def test_every_single_step_is_the_process_itself():
    one, same = AR3.discretize(DT), AR3.every(1)
    for a, b in ((one.A, same.A), (one.Q, same.Q), (one.P0, same.P0)):
        np.testing.assert_allclose(a, b, atol=1e-10)


@pytest.mark.parametrize("model", MODELS, ids=repr)
@pytest.mark.parametrize("factor", [1, 2, 7])
def test_resampled_agrees_up_to_its_order(model, factor):
    found = model.resampled(factor)
    assert found.dt == pytest.approx(factor * DT)
    assert len(found.alpha) == len(model.alpha)
    lags = np.arange(len(model.alpha) + 1.0) * factor * DT
    np.testing.assert_allclose(found.autocovariance(lags), model.autocovariance(lags), rtol=1e-8)


def test_resampled_solves_the_equations_of_yule_and_walker():
    r = AR3.autocovariance(np.arange(4.0) * 5 * DT)
    phi = np.linalg.solve(linalg.toeplitz(r[:3]), r[1:])
    found = AR3.resampled(5)
    np.testing.assert_allclose(found.alpha, -phi, rtol=1e-9)
    assert found.beta0**2 == pytest.approx(r[0] - phi @ r[1:], rel=1e-9)


def test_resampling_order_1_is_exact():
    found = Autoregressive((-0.9,), 2.0, DT).resampled(3)
    assert found.alpha == pytest.approx((-(0.9**3),))
    assert found.beta0**2 == pytest.approx(4.0 * (1 + 0.9**2 + 0.9**4))


def test_resampled_order_3_is_not_the_samples_that_are_left():
    lag = np.array([4 * 2 * DT])
    assert AR3.resampled(2).autocovariance(lag)[0] != pytest.approx(AR3.autocovariance(lag)[0], rel=1e-4)


def test_samples_left_out_of_a_record_follow_it():
    factor, lags = 4, np.arange(4)
    values = AR3.sample(400_000, DT, np.random.default_rng(0))[::factor]
    found = [np.mean(values[k:] * values[: values.size - k]) for k in lags]
    space = AR3.every(factor)
    expected = [space.c @ np.linalg.matrix_power(space.A, k) @ space.P0 @ space.c for k in lags]
    np.testing.assert_allclose(found, expected, atol=0.02 * expected[0])


def test_a_pole_closer_to_the_circle_than_a_billionth_is_refused():
    with pytest.raises(ValueError, match="pole of magnitude 1"):
        Autoregressive((-(1 - 0.7e-9),), 1.0, DT)
    assert Autoregressive((-(1 - 1.4e-9),), 1.0, DT).beta0 == 1.0

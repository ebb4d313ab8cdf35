import numpy as np
import pytest
from scipy import linalg, signal

from imuwb.identification import burg, fit_autoregressive
from imuwb.stochastic import Autoregressive, RandomWalk, WhiteNoise

pytestmark = pytest.mark.slow

DT = 0.1
AR3 = Autoregressive((-1.2, 0.7, -0.2), 0.3, DT)


def record(n=2**13, seed=0, model=AR3):
    return model.sample(n, DT, np.random.default_rng(seed))


def low_passed(n, seed):
    noise = np.random.default_rng(seed).standard_normal(n + 200)
    return signal.lfilter(*signal.butter(3, 0.3), noise)[200:]


def test_the_true_order_is_chosen_and_its_values_found():
    fits = [fit_autoregressive(record(seed=seed), DT, 10) for seed in range(20)]
    assert sum(fit.chosen == 3 for fit in fits) >= 18
    process = fits[0].process(3)
    np.testing.assert_allclose(process.alpha, AR3.alpha, atol=0.05)
    assert process.beta0 == pytest.approx(0.3, rel=0.03)
    assert process.dt == DT


def test_models_are_burgs():
    values = record()
    fit, models = fit_autoregressive(values, DT, 6), burg(values, 6)
    assert [order.order for order in fit.orders] == [1, 2, 3, 4, 5, 6]
    for order in fit.orders:
        np.testing.assert_array_equal(order.alpha, models.alpha[order.order])
        assert order.beta0**2 == pytest.approx(models.variance[order.order])
        assert order.largest_pole == pytest.approx(np.abs(np.roots([1, *order.alpha])).max())
        assert order.stable


def test_criteria_are_those_of_the_books():
    fit = fit_autoregressive(record(), DT, 6)
    n = fit.n
    for order in fit.orders:
        k, deviance = order.order + 1, n * np.log(order.beta0**2)
        assert order.bic == pytest.approx(deviance + k * np.log(n))
        assert order.aicc == pytest.approx(deviance + 2 * k + 2 * k * (k + 1) / (n - k - 1))
        assert order.fpe == pytest.approx(order.beta0**2 * (n + k) / (n - k))


@pytest.fixture(scope="module")
def many():
    """Fits of many records of a true AR(3), and of as many filtered records."""
    return {
        make: [fit_autoregressive(make(2**12, seed), DT, 12, test=()).orders for seed in range(150)]
        for make in (record, low_passed)
    }


@pytest.mark.parametrize("order", [1, 3, 5])
@pytest.mark.parametrize("make", [record, low_passed])
def test_bartletts_errors_are_those_of_the_scatter(many, make, order):
    fits = [orders[order - 1] for orders in many[make]]
    scatter = np.std([fit.alpha for fit in fits], axis=0)
    np.testing.assert_allclose(np.mean([fit.alpha_sigma for fit in fits], axis=0), scatter, rtol=0.2)


def test_the_ideal_errors_are_those_of_the_scatter_for_a_true_model_only(many):
    for make, order, true in ((record, 3, True), (record, 5, True), (low_passed, 1, False), (low_passed, 3, False)):
        fits = [orders[order - 1] for orders in many[make]]
        ratio = np.mean([fit.alpha_sigma_if_ar for fit in fits], axis=0) / np.std([fit.alpha for fit in fits], axis=0)
        assert (np.abs(np.log(ratio)) < 0.2).all() == true
        assert (np.abs(np.log(ratio)) > 0.3).any() != true


def test_the_ideal_error_of_order_1_is_its_formula_and_of_others_that_of_the_inverse_covariance():
    fit = fit_autoregressive(record(), DT, 6)
    alpha = fit.orders[0].alpha[0]
    assert fit.orders[0].alpha_sigma_if_ar[0] == pytest.approx(np.sqrt((1 - alpha**2) / fit.n), rel=1e-9)
    for p in (2, 5):
        model = fit.process(p)
        r = model.autocovariance(np.arange(float(p)) * DT)
        expected = np.sqrt(np.diag(np.linalg.inv(linalg.toeplitz(r))) * model.beta0**2 / fit.n)
        np.testing.assert_allclose(fit.orders[p - 1].alpha_sigma_if_ar, expected, rtol=1e-6)


def test_coefficients_beyond_the_true_order_are_seldom_significant():
    fits = [fit_autoregressive(record(2**12, seed), DT, 6, test=(), level=0.95) for seed in range(60)]
    assert all(fit.orders[2].significant.all() for fit in fits)
    beyond = np.mean([fit.orders[5].significant[3:] for fit in fits])
    assert beyond == pytest.approx(0.05, abs=0.05)


def test_innovations_of_the_true_order_are_white_and_of_a_lower_one_not():
    probabilities = []
    for seed in range(40):
        fit = fit_autoregressive(record(2**12, seed), DT, 6, test=(1, 3))
        one, three = (next(w for w in fit.whiteness if w.order == p) for p in (1, 3))
        probabilities.append(three.probability)
        assert one.probability < 1e-6
        assert one.largest > 5 / 2**6 > three.largest
    assert np.mean(probabilities) == pytest.approx(0.5, abs=4 * np.sqrt(1 / 12 / 40))
    assert np.mean(np.array(probabilities) < 0.05) < 0.2


def test_the_statistic_is_ljungs_and_boxs():
    diagnostic = pytest.importorskip("statsmodels.stats.diagnostic")
    values = record()
    fit = fit_autoregressive(values, DT, 6, test=(2,))
    two = next(w for w in fit.whiteness if w.order == 2)
    errors = signal.lfilter([1, *fit.orders[1].alpha], [1], values - values.mean())[2:]
    # statsmodels takes the mean off the errors, 0 but for chance
    table = diagnostic.acorr_ljungbox(errors, lags=[22], model_df=2)
    assert two.statistic == pytest.approx(float(table["lb_stat"].iloc[0]), rel=1e-3)


def test_orders_asked_for_and_the_chosen_one_are_tested():
    fit = fit_autoregressive(record(), DT, 6, test=(1, 5, 9))
    assert [w.order for w in fit.whiteness] == sorted({1, 5, fit.chosen})


@pytest.mark.parametrize(
    ("process", "meaning"),
    [
        (RandomWalk(1.0), "random-walk"),
        (WhiteNoise(1.0), "white-noise"),
        (Autoregressive((-0.6,), 1.0, DT), "alike"),
        (Autoregressive((-0.06,), 1.0, DT), "alike"),
        (Autoregressive((-0.97,), 1.0, DT), "alike"),
        (Autoregressive((0.6,), 1.0, DT), "opposite"),
    ],
    ids=repr,
)
def test_order_1_is_interpreted(process, meaning):
    assert fit_autoregressive(record(2**14, model=process), DT, 3).reading.id == meaning


def test_a_bias_and_the_unit_change_nothing_but_the_size():
    values = record()
    plain, other = fit_autoregressive(values, DT, 4), fit_autoregressive(values * 1e-6 + 9.81, DT, 4)
    for a, b in zip(plain.orders, other.orders, strict=True):
        np.testing.assert_allclose(a.alpha, b.alpha, rtol=1e-5)
        np.testing.assert_allclose(a.alpha_sigma, b.alpha_sigma, rtol=1e-4)
        assert b.beta0 == pytest.approx(a.beta0 * 1e-6, rel=1e-6)
    assert other.mean == pytest.approx(9.81, abs=1e-5)


def test_parts_of_one_process_give_its_model():
    parts = [record(1000, seed) for seed in range(20)]
    fit = fit_autoregressive(np.concatenate(parts), DT, 6, breaks=range(1000, 20_000, 1000))
    np.testing.assert_allclose(fit.orders[2].alpha, AR3.alpha, atol=0.03)
    assert fit.chosen == 3


def test_what_has_no_model_is_refused_with_the_reason():
    with pytest.raises(ValueError, match="20 samples; order 20 needs at least 21"):
        fit_autoregressive(np.arange(20.0), DT, 20)
    with pytest.raises(ValueError, match="constant"):
        fit_autoregressive(np.ones(100), DT, 3)


def test_innovations_are_called_white_down_to_one_in_a_hundred():
    tests = [fit_autoregressive(record(2**9, seed), DT, 3).whiteness for seed in range(12)]
    probabilities = np.array([[w.probability, w.white] for of_record in tests for w in of_record])
    np.testing.assert_array_equal(probabilities[:, 1] == 1, probabilities[:, 0] > 0.01)
    assert ((probabilities[:, 0] > 0.01) & (probabilities[:, 0] < 0.5)).any()

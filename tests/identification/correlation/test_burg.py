import re

import numpy as np
import pytest
from scipy import signal

from imuwb.identification import burg
from imuwb.stochastic import Autoregressive


def lattice(parts, orders):
    """Burg's recursion as textbooks print it, the sums of several parts added up."""
    parts = [np.asarray(part) for part in parts]
    f, b = [part[1:] for part in parts], [part[:-1] for part in parts]
    a, models = np.ones(1), []
    power = sum(part @ part for part in parts) / sum(part.size for part in parts)
    powers = [power]
    for _ in range(orders):
        k = -2 * sum(x @ y for x, y in zip(f, b, strict=True)) / sum(x @ x + y @ y for x, y in zip(f, b, strict=True))
        a = np.append(a, 0) + k * np.append(a, 0)[::-1]
        f, b = (
            [(x + k * y)[1:] for x, y in zip(f, b, strict=True)],
            [(y + k * x)[:-1] for x, y in zip(f, b, strict=True)],
        )
        models.append(a[1:])
        powers.append(powers[-1] * (1 - k**2))
    return models, powers


def record(n, seed, alpha=(-1.5, 0.9, -0.2)):
    return Autoregressive(alpha, 1.0, 0.1).sample(n, 0.1, np.random.default_rng(seed)) + 3


@pytest.mark.parametrize("n", [25, 1024, 1025, 1045, 5000])
def test_equals_the_textbook_lattice_at_all_orders(n):
    values = record(n, n)
    found = burg(values, 20)
    models, powers = lattice([values - values.mean()], 20)
    for mine, expected in zip(found.alpha[1:], models, strict=True):
        np.testing.assert_allclose(mine, expected, atol=1e-10)
    np.testing.assert_allclose(found.variance, powers, rtol=1e-10)
    assert found.alpha[0].size == 0
    assert found.mean == pytest.approx(values.mean())
    assert found.n == n


@pytest.mark.parametrize("seed", range(5))
def test_equals_statsmodels(seed):
    linear_model = pytest.importorskip("statsmodels.regression.linear_model")
    values = record(700, seed)
    np.testing.assert_allclose(burg(values, 3).alpha[3], -linear_model.burg(values, order=3)[0], atol=1e-10)


def figures(text, heading):
    """The numbers that R printed after a heading, up to the next heading."""
    block = re.split(r"\n(?=[a-z])", text[text.index(heading) + len(heading) :], maxsplit=1)[0]
    return [
        [float(x) for x in run.split()]
        for run in re.sub(r"\[\d+\]", lambda m: "|" * (m[0] == "[1]"), block).split("|")[1:]
    ]


@pytest.mark.parametrize(("name", "column", "order"), [("lh", 0, 3), ("sunspot.year", 1, 9)])
def test_equals_r_on_its_own_data(shared, name, column, order):
    folder = shared / "vectors/burg"
    file = folder / f"{name.replace('.', '_')}.csv"
    values = np.loadtxt(file, delimiter=",", skiprows=1, usecols=column)
    blocks = figures((folder / "R_ar_burg_outputs.txt").read_text(), f"{name} order {order} var.method 1")
    found = burg(values, order)
    np.testing.assert_allclose(found.alpha[order], -np.array(blocks[0]), atol=1e-12)
    assert found.variance[order] == pytest.approx(blocks[1][0], rel=1e-12)
    if len(blocks) > 2:
        np.testing.assert_allclose([alpha[-1] for alpha in found.alpha[1:]], -np.array(blocks[2]), atol=1e-12)


@pytest.mark.parametrize(("name", "column", "orders", "chosen"), [("lh", 0, 16, 3), ("sunspot_year", 1, 24, 9)])
def test_variances_of_all_orders_make_rs_table_of_aic(shared, name, column, orders, chosen):
    folder = shared / "vectors/burg"
    text = (folder / "R_ar_burg_outputs.txt").read_text()
    heading = f"{name.replace('_', '.')} aic-selected order {chosen}"
    block = re.split(r"\n(?=[a-z])", text[text.index(heading) + len(heading) :], maxsplit=1)[0]
    expected = [float(x) for x in block.split() if "." in x]
    found = burg(np.loadtxt(folder / f"{name}.csv", delimiter=",", skiprows=1, usecols=column), orders)
    aic = found.n * np.log(found.variance) + 2 * np.arange(orders + 1)
    np.testing.assert_allclose(aic - aic.min(), expected, atol=1e-8)


@pytest.mark.parametrize("breaks", [[400], [30, 1100, 1107], [5, 9, 1500]])
def test_parts_between_gaps_add_their_sums(breaks):
    values = record(2500, 7)
    found = burg(values, 6, breaks)
    models, powers = lattice(np.split(values - values.mean(), breaks), 4)
    for mine, expected in zip(found.alpha[1:5], models, strict=True):
        np.testing.assert_allclose(mine, expected, atol=1e-10)
    np.testing.assert_allclose(found.variance[:5], powers, rtol=1e-10)


def test_a_gap_between_records_of_one_process_does_no_harm():
    values = np.concatenate([record(2000, seed) for seed in range(20)])
    np.testing.assert_allclose(burg(values, 3, range(2000, 40_000, 2000)).alpha[3], (-1.5, 0.9, -0.2), atol=0.02)


def test_every_model_is_stable_even_of_a_sine_and_a_walk():
    t = np.arange(3000.0)
    walk = np.random.default_rng(0).standard_normal(3000).cumsum()
    for values in (np.sin(0.3 * t) + 1e-3 * np.cos(t), walk):
        for alpha in burg(values, 8).alpha[1:]:
            assert np.abs(np.roots([1, *alpha])).max() < 1 + 1e-9


def test_the_variance_is_that_of_the_prediction_errors():
    values = record(50_000, 3)
    found = burg(values, 3)
    errors = signal.lfilter([1, *found.alpha[3]], [1], values - found.mean)[3:]
    assert found.variance[3] == pytest.approx(errors.var(), rel=1e-3)


def test_does_not_write_into_the_record():
    values = record(200, 0)
    before = values.copy()
    burg(values, 4)
    np.testing.assert_array_equal(values, before)


def test_what_has_no_model_is_refused_with_the_reason():
    with pytest.raises(ValueError, match="10 samples; order 10 needs at least 11"):
        burg(np.arange(20.0), 10, [10])
    with pytest.raises(ValueError, match="constant"):
        burg(np.full(100, 2.0), 3)

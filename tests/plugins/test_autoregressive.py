import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Conditioning
from imuwb.review.answers.document import plain
from imuwb_plugins import autoregressive

ALPHA = (-1.2, 0.5)


@pytest.fixture(scope="module")
def log(make_log):
    """Return an AR(2) process on x, white noise on y, a random walk on z."""
    w = np.random.default_rng(51).standard_normal((20_000, 3))
    x = signal.lfilter([0.3], [1, *ALPHA], w[:, 0])
    return make_log(np.stack([x, w[:, 1], w[:, 2].cumsum()], axis=1))


@pytest.fixture(scope="module")
def result(log):
    return autoregressive.run([log], autoregressive.Parameters(orders=6))


def test_the_process_that_was_made_is_found(result):
    found = result.axes["gyro_x"]
    assert found.chosen == 2
    second = found.orders[1]
    assert second.alpha == pytest.approx(ALPHA, abs=4 * max(second.alpha_sigma))
    assert second.alpha_sigma == pytest.approx([((1 - 0.5**2) / 20_000) ** 0.5] * 2, rel=0.1)
    assert second.beta0 == pytest.approx(0.3, rel=0.02)
    assert found.model.alpha == tuple(second.alpha)
    assert sorted(np.abs(found.poles)) == pytest.approx([0.5**0.5] * 2, rel=0.02)
    probability = {w.order: w.probability for w in found.whiteness}
    assert probability[2] > 0.01
    assert probability[1] < 1e-6


def test_criteria_are_those_of_the_books(result):
    n = 20_000
    for order in result.axes["gyro_x"].orders:
        k = order.order + 1
        deviance = n * np.log(order.beta0**2)
        assert order.bic == pytest.approx(deviance + k * np.log(n))
        assert order.aicc == pytest.approx(deviance + 2 * k + 2 * k * (k + 1) / (n - k - 1))


def test_first_order_shows_what_the_series_is_like(result):
    readings = {axis: found.reading for axis, found in result.axes.items()}
    assert readings["gyro_y"].id == "white-noise"
    assert readings["gyro_z"].id == "random-walk"
    remarks = {f.axis: f.remarks for f in autoregressive.findings(result)}
    assert remarks["gyro_y"][1] == "AR(1) is tenable"
    assert remarks["gyro_x"][1] == "AR(2) is tenable"


def test_the_order_that_is_asked_for_is_saved(log):
    found = autoregressive.run([log], autoregressive.Parameters(orders=6, order=4))
    model = autoregressive.error_model(found)
    (term,) = model.axes["gyro_x"].processes.terms
    assert (len(term.alpha), term.dt) == (4, pytest.approx(0.01))
    assert model.provenance["log"] == "made.csv sha256:0"


def test_the_saved_model_at_another_rate_has_the_same_variance(log):
    found = autoregressive.run([log], autoregressive.Parameters(orders=6, order=2, resample=50.0))
    model = found.axes["gyro_x"].model
    assert model.dt == pytest.approx(0.02)
    responses = [
        signal.lfilter([m.beta0], [1, *m.alpha], np.eye(1, 500)[0])
        for m in (
            autoregressive.run([log], autoregressive.Parameters(orders=2, order=2)).axes["gyro_x"].model,
            model,
        )
    ]
    variances = [float(r @ r) for r in responses]
    assert variances[0] == pytest.approx(0.09 * 1.5 / ((1 - 0.5) * (1.5**2 - 1.2**2)), rel=0.05)  # of an AR(2) process
    assert variances[1] == pytest.approx(variances[0], rel=1e-3)
    following = float(responses[0][2:] @ responses[0][:-2]), float(responses[1][1:] @ responses[1][:-1])
    assert following[1] == pytest.approx(following[0], rel=1e-3)


@pytest.mark.parametrize("resample", [30.0, 200.0])
def test_a_rate_that_is_no_whole_fraction_is_wrong_usage(log, resample):
    with pytest.raises(UsageError, match=r"100 Hz, divided by a whole number"):
        autoregressive.run([log], autoregressive.Parameters(orders=3, resample=resample))


def test_gaps_are_not_bridged(make_log, gap):
    values = np.random.default_rng(52).standard_normal(4000).cumsum()
    values[2000:] += 1e6
    found = autoregressive.run(
        [
            make_log(
                np.r_[values[:2000] - values[:2000].mean(), values[2000:] - values[2000:].mean()],
                keep=gap(4000, 1990, 2000),
            )
        ],
        autoregressive.Parameters(orders=3),
    )
    assert found.axes["gyro_x"].orders[0].beta0 == pytest.approx(1, rel=0.05)


def test_json_is_as_promised_and_has_no_nan(result):
    document = json.loads(json.dumps(plain(result), allow_nan=False))
    for axis in document["axes"].values():
        assert [o["order"] for o in axis["orders"]] == [1, 2, 3, 4, 5, 6]
        for order in axis["orders"]:
            assert {"order", "alpha", "alpha_sigma", "beta0", "aicc", "bic", "stable"} <= set(order)
            assert len(order["alpha"]) == len(order["alpha_sigma"]) == order["order"]
    assert document["conditioned"] is False
    assert "-sum alpha_k" in document["convention"]


def test_a_conditioned_log_is_marked(log):
    made = replace(log, conditioning=(Conditioning("kaiser", "fc=16", causal=False, delay=0.0),))
    found = autoregressive.run([made], autoregressive.Parameters(orders=2))
    assert found.conditioned
    assert found.source.endswith("through kaiser:fc=16")


@pytest.mark.parametrize(("values", "named"), [(np.ones(1000), "constant"), (np.arange(30.0) % 7, "30 samples")])
def test_nothing_to_analyse_is_missing_data(make_log, values, named):
    with pytest.raises(MissingDataError, match=named):
        autoregressive.run([make_log(values)], autoregressive.Parameters())


@pytest.mark.parametrize(
    "wrong",
    [{"orders": 0}, {"orders": 201}, {"order": 0}, {"orders": 3, "order": 4}, {"resample": 0.0}, {"level": 1.0}],
)
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match="must be"):
        autoregressive.Parameters(**wrong)


def test_all_is_drawn(result, shown):
    autoregressive.draw(result, shown)
    assert shown.figures
    assert shown.tables

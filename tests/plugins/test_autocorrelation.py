import json

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.notes import ids
from imuwb.review.answers.document import plain
from imuwb.stochastic import GaussMarkov, WhiteNoise
from imuwb_plugins import autocorrelation


@pytest.fixture(scope="module")
def log(make_log):
    """Return a Gauss-Markov process on x, white noise on y, their sum on z."""
    rng = np.random.default_rng(41)
    n, dt = 20_000, 0.05
    markov = GaussMarkov(0.5, 2.0).sample(n, dt, rng)
    white = WhiteNoise(0.1).sample(n, dt, rng)
    return make_log(np.stack([markov, white, markov + 3 * white], axis=1), rate=20.0)


@pytest.fixture(scope="module")
def result(log):
    return autocorrelation.run([log], autocorrelation.Parameters(denoise=3))


def test_the_value_is_the_textbooks(log, result):
    found = result.axes["gyro_x"]
    x = log.imu().angular_rate.value[:, 0]
    x = x - x.mean()
    for lag in (0, 1, 7, 100, 2000):
        at = int(np.argmin(np.abs(found.lag - lag * 0.05)))
        k = round(found.lag[at] / 0.05)
        assert found.value[at] == pytest.approx(float(x[: x.size - k] @ x[k:]) / float(x @ x), abs=1e-9)
    assert found.lag[-1] == pytest.approx(100, abs=0.06)
    assert found.deviation == pytest.approx(x.std(), rel=1e-9)


def test_a_gauss_markov_process_is_found_and_tenable(result):
    found = result.axes["gyro_x"].gauss_markov
    assert found.tenable
    assert found.sigma.lower < 0.5 < found.sigma.upper
    assert found.Tc.lower < 2 < found.Tc.upper
    assert found.Tc.value == pytest.approx(2, rel=0.2)
    assert result.axes["gyro_x"].falls_to == pytest.approx(2, rel=0.2)


def test_white_noise_stays_in_the_band(result):
    found = result.axes["gyro_y"]
    assert found.band == pytest.approx(1.96 / 20_000**0.5, rel=0.01)
    assert np.mean(np.abs(found.value[1:]) < found.band) > 0.9


def test_a_sum_is_no_first_order_process(result):
    assert not result.axes["gyro_z"].gauss_markov.tenable


def test_findings_say_which(result):
    remarks = {f.axis: f.remarks[0] for f in autocorrelation.findings(result)}
    assert {axis: r.id for axis, r in remarks.items()} == {
        "gyro_x": "tenable",
        "gyro_y": "white",
        "gyro_z": "untenable",
    }
    assert {axis: r.verdict for axis, r in result.axes.items()} == remarks


def test_a_second_curve_is_of_the_denoised_series(log, result):
    from imuwb.conditioning import denoise
    from imuwb.identification import autocorrelation as reference

    quiet = denoise(np.ascontiguousarray(log.imu().angular_rate.value[:, 1]), 3).values
    np.testing.assert_array_equal(result.axes["gyro_y"].denoised.value, reference(quiet, 0.05).value)
    assert result.axes["gyro_y"].denoised.value[1] > 0.5
    none = autocorrelation.run([log], autocorrelation.Parameters(denoise=0))
    assert none.axes["gyro_y"].denoised is None


def test_the_longest_lag_is_what_was_asked_for(log):
    found = autocorrelation.run([log], autocorrelation.Parameters(longest=3.0, denoise=0))
    assert found.axes["gyro_x"].lag[-1] == pytest.approx(3)


def test_json_is_as_promised_and_has_no_nan(result):
    document = json.loads(json.dumps(plain(result), allow_nan=False))
    for axis in document["axes"].values():
        assert len(axis["lag"]) == len(axis["value"])
        assert isinstance(axis["band"], float)
        assert {"sigma", "Tc", "tenable"} <= set(axis["gauss_markov"])


def test_of_a_log_with_gaps_the_longest_part_counts(make_log, gap):
    values = np.random.default_rng(43).standard_normal(2000)
    parameters = autocorrelation.Parameters(denoise=0)
    found = autocorrelation.run([make_log(values, keep=gap(2000, 500, 700))], parameters)
    alone = autocorrelation.run([make_log(values[700:])], parameters)
    np.testing.assert_allclose(found.axes["gyro_x"].value, alone.axes["gyro_x"].value, rtol=0, atol=1e-12)
    assert ids(found.notes) == ("gaps",)


@pytest.mark.parametrize(("values", "named"), [(np.ones(1000), "constant"), (np.arange(100.0) % 7, "100 samples")])
def test_nothing_to_analyse_is_missing_data(make_log, values, named):
    with pytest.raises(MissingDataError, match=named):
        autocorrelation.run([make_log(values)], autocorrelation.Parameters())


@pytest.mark.parametrize(
    "wrong", [{"longest": 0.0}, {"longest": float("nan")}, {"denoise": -1}, {"denoise": 21}, {"level": 0.2}]
)
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match="must be"):
        autocorrelation.Parameters(**wrong)


def test_all_is_drawn(result, shown):
    autocorrelation.draw(result, shown)
    assert shown.figures
    assert shown.tables

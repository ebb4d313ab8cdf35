import numpy as np
import pytest

from imuwb.identification import fit_likelihood
from imuwb.identification.temperature import Record, first_order, over_temperature, set_point_of
from imuwb.stochastic import Autoregressive, FlickerNoise, RandomWalk, Sum, WhiteNoise

DT = 0.01
SENSOR = Sum((WhiteNoise(0.005), FlickerNoise(0.002)))
WALK = Sum((WhiteNoise(0.005), RandomWalk(0.002)))


@pytest.mark.parametrize("sensor", [SENSOR, WALK])
def test_one_record_has_the_coefficients_that_the_likelihood_gives_it(sensor):
    x = sensor.sample(60_000, DT, np.random.default_rng(1)) + 3.0
    point = set_point_of([Record(x, 0.0, 20.0)], DT)
    plain = fit_likelihood(x - x.mean(), DT)
    for letter in "QNBK":
        a, b = point.coefficients[letter], plain.coefficients[letter]
        assert (a.value or 0) == pytest.approx(b.value or 0, rel=1e-3, abs=1e-7)
    assert (point.samples, point.duration) == (60_000, pytest.approx(600))
    assert point.means[0].value == pytest.approx(float(x.mean()))
    assert point.means[0].middle == pytest.approx(300)
    if sensor is SENSOR:
        assert point.deviation.value == pytest.approx(x.std(), rel=0.02)
    assert point.region is not None
    assert point.region.slope.lower < -0.5 + 0.02
    assert point.region.nominal == -0.5


@pytest.mark.slow
def test_more_records_of_a_temperature_tell_more():
    rng = np.random.default_rng(2)
    parts = [Record(SENSOR.sample(40_000, DT, rng) + k, 1000.0 * k, 20.0 + 0.1 * k, log=k) for k in range(3)]
    one, three = set_point_of(parts[:1], DT), set_point_of(parts, DT)
    width = [p.coefficients["B"].upper - p.coefficients["B"].lower for p in (one, three)]
    assert width[1] < 0.75 * width[0]
    assert three.coefficients["N"].lower < 0.005 < three.coefficients["N"].upper
    assert three.celsius == pytest.approx(20.1)
    assert len(three.means) == 3


def test_first_order_has_the_papers_sign_and_its_own_error():
    rng = np.random.default_rng(3)
    n, c = 200_000, -0.3
    parts = [Record(Autoregressive((c,), 1.0, DT).sample(n, DT, rng) + k, 0.0, 0.0) for k in (0.0, 50.0)]
    found = first_order(parts, DT)
    assert abs(found.alpha - c) < 4 * found.sigma
    assert found.sigma == pytest.approx(((1 - c**2) / (2 * n)) ** 0.5, rel=0.05)
    assert found.sigma_if_ar == pytest.approx(found.sigma, rel=0.05)


@pytest.mark.slow
def test_the_samples_deviation_has_an_interval_that_knows_their_correlation():
    rng = np.random.default_rng(4)
    process = Autoregressive((-0.95,), 1.0, DT)
    sigma = (1 / (1 - 0.95**2)) ** 0.5
    inside = widths = 0
    for _ in range(30):
        found = set_point_of([Record(process.sample(20_000, DT, rng), 0.0, 0.0)], DT).deviation
        inside += found.lower <= sigma <= found.upper
        widths += (found.upper - found.lower) / sigma
    assert inside >= 23  # of 30 at 95 %: fewer in 1 of 1e4
    assert widths / 30 > 4 * 1.96 / (2 * 20_000) ** 0.5  # four times as wide as white noise's would be


@pytest.mark.parametrize(
    ("values", "why"),
    [(np.ones(2000), "constant"), (np.random.default_rng(0).standard_normal(1000), "1000 samples.*1024")],
)
def test_what_has_no_noise_is_refused(values, why):
    with pytest.raises(ValueError, match=why):
        set_point_of([Record(values, 0.0, 20.0)], DT)


def test_quantization_that_no_temperature_shows_is_left_out_and_n_is_surer():
    rng = np.random.default_rng(5)
    points = [set_point_of([Record(WhiteNoise(0.005).sample(30_000, DT, rng), 0.0, t)], DT) for t in range(0, 60, 10)]
    free = [p for p in points if p.coefficients["Q"].value]
    assert free  # else there is nothing to settle
    settled = over_temperature(points).points
    for before, after in zip(points, settled, strict=True):
        assert after.coefficients["Q"].value is None
        assert after.coefficients["Q"].upper == before.coefficients["Q"].upper
        width = after.coefficients["N"].upper / after.coefficients["N"].lower - 1
        assert width < 1.2 * 2 * 1.96 / (2 * 30_000) ** 0.5


def test_a_random_walk_is_found_in_a_ramps_bin_and_not_made_by_its_drift():
    rng = np.random.default_rng(6)
    n = 60_000
    warm = 20 + 5 * np.linspace(0, 1, n)
    still, walking = WhiteNoise(0.005), Sum((WhiteNoise(0.005), RandomWalk(0.003)))
    drift = 0.3 * (warm - 20)
    quiet = set_point_of([Record(still.sample(n, DT, rng) + drift, 0.0, 22.5, warm)], DT)
    walks = set_point_of([Record(walking.sample(n, DT, rng) + drift, 0.0, 22.5, warm)], DT)
    assert quiet.coefficients["K"].upper < 0.001
    assert walks.coefficients["K"].lower < 0.003 < walks.coefficients["K"].upper
    assert walks.coefficients["K"].lower > 0.001

import csv
import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.identification import allan, allan_of_axes, averaging_factors, equivalent_degrees_of_freedom
from imuwb.identification.allan_variance.overlapping import _strides, sums_of_squares
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise


def slow_allan_variance(values, dt, m):
    """The textbook's double sum over averages, no running sum."""
    n = values.size
    means = np.array([values[k : k + m].mean() for k in range(n - m + 1)])
    return np.mean((means[m:] - means[: means.size - m]) ** 2) / 2


@pytest.mark.slow
@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1), st.integers(2, 150))
def test_equals_the_textbook_sum(seed, n):
    values = np.random.default_rng(seed).standard_normal(n) + 5
    curve = allan(values, 0.1, "all")
    expected = [np.sqrt(slow_allan_variance(values, 0.1, m)) for m in curve.factor]
    np.testing.assert_allclose(curve.deviation, expected, rtol=1e-9)


@settings(deadline=None)
@given(st.floats(-1e3, 1e3), st.floats(0.01, 100))
def test_is_blind_to_a_constant_and_scales_with_the_unit(offset, scale):
    values = np.random.default_rng(1).standard_normal(200)
    plain, other = allan(values, 1.0), allan(values * scale + offset, 1.0)
    np.testing.assert_allclose(other.deviation, plain.deviation * scale, rtol=1e-6)


def test_kernel_adds_nothing_where_no_difference_fits():
    phase = np.arange(10.0) ** 2
    assert sums_of_squares(phase, np.array([4, 5, 6])).tolist() == [2 * 32.0**2, 0.0, 0.0]


def test_no_difference_spans_a_gap():
    rng = np.random.default_rng(3)
    first, second = rng.standard_normal(500), rng.standard_normal(300) + 1000
    curve = allan(np.concatenate([first, second]), 1.0, [1, 4], breaks=[500])
    a, b = (allan(part, 1.0, [1, 4]) for part in (first, second))
    pooled = (a.deviation**2 * a.terms + b.deviation**2 * b.terms) / (a.terms + b.terms)
    np.testing.assert_allclose(curve.deviation**2, pooled, rtol=1e-6)
    assert curve.terms.tolist() == (a.terms + b.terms).tolist()


@pytest.mark.parametrize(
    ("times", "expected"),
    [("octave", [1, 2, 4, 8, 16, 32]), ([0.02, 0.031], [2, 3]), ("0.02,0.3", [2, 30]), ("log:3", [1, 7, 50])],
)
def test_averaging_factors(times, expected):
    assert averaging_factors(times, 100, 0.01).tolist() == expected


@pytest.mark.parametrize("times", ["octaves", "log:x", [1e9], "", "nan"])
def test_averaging_times_that_cannot_be_say_why(times):
    with pytest.raises(ValueError, match="averaging|lies between"):
        averaging_factors(times, 100, 0.01)


def test_too_much_work_is_refused_with_the_remedy():
    with pytest.raises(ValueError, match="log:1000"):
        averaging_factors("all", 10**7, 0.01)


def test_nbs14_to_the_printed_digits(shared):
    # NIST SP 1065, table 31: overlapping Allan deviation of the 1000-point set, frequency data.
    values = np.loadtxt(shared / "vectors/nbs14/nbs14_1000_freq.txt")
    curve = allan(values, 1.0, [1, 10, 100])
    np.testing.assert_allclose(curve.deviation, [2.922319e-01, 9.159953e-02, 3.241343e-02], atol=5e-9 * 10)


def stable32(path):
    rows = [line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    return np.array([[float(cell) for cell in row] for row in rows])


def test_phase_dat_deviation_and_intervals(shared):
    folder = shared / "vectors/stable32/phasedat"
    phase = np.loadtxt(folder / "PHASE.DAT", comments="#")
    table = stable32(folder / "phase_dat_oadev_octave.txt")
    curve = allan(np.diff(phase), 1.0, table[:, 1], level=0.683)
    np.testing.assert_allclose(curve.deviation, table[:, 5], rtol=5e-5)
    from scipy import stats

    for m, alpha, low, sigma, high in table[:, [0, 3, 4, 5, 6]]:
        edf = equivalent_degrees_of_freedom(int(m), phase.size - 1, int(alpha))
        tail = (1 - 0.683) / 2
        assert sigma * np.sqrt(edf / stats.chi2.ppf(1 - tail, edf)) == pytest.approx(low, rel=1e-2)
        assert sigma * np.sqrt(edf / stats.chi2.ppf(tail, edf)) == pytest.approx(high, rel=1e-2)


@pytest.mark.slow
def test_published_variance_of_the_adis16405(shared):
    with gzip.open(shared / "static/adis16405_imu1.csv.gz", "rt") as file:
        next(file)
        values = np.loadtxt(file, delimiter=",")
    with (shared / "expected/adis16405_imu1_avar.csv").open() as file:
        rows = list(csv.DictReader(file))
    names = ["Gyro. X", "Gyro. Y", "Gyro. Z", "Accel. X", "Accel. Y", "Accel. Z"]
    for column, name in enumerate(names):
        mine = [row for row in rows if row["axis"] == name]
        assert len(mine) == 18
        curve = allan(values[:, column], 0.01, [float(row["tau_s"]) for row in mine])
        np.testing.assert_allclose(curve.deviation**2, [float(row["avar"]) for row in mine], rtol=1e-5)


def test_two_samples_are_too_few_and_one_is_none():
    assert allan(np.array([1.0, 2.0]), 1.0).deviation == pytest.approx([np.sqrt(0.5)])
    with pytest.raises(ValueError, match="^1 samples.*at least 2"):
        allan(np.array([1.0]), 1.0)


def thinned(process, n, seed, share=0.05):
    rng = np.random.default_rng(seed)
    values = process.sample(n, 0.01, rng)
    place = np.flatnonzero(rng.random(n) >= share)
    return values[place], place * 10**7, (np.flatnonzero(np.diff(place) > 1) + 1).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("process", [WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(1.0)], ids=repr)
def test_gaps_at_random_are_bridged_without_bias(process):
    factor = 2 ** np.arange(7)
    draws = []
    for seed in range(40):
        values, time, breaks = thinned(process, 4096, seed)
        draws.append(allan(values, 0.01, list(factor * 0.01), breaks=breaks, time=time).deviation ** 2)
    error = np.std(draws, axis=0) / 40**0.5
    expected = process.allan_variance(factor * 0.01, 0.01)
    assert (np.abs(np.mean(draws, axis=0) - expected) < 4 * error).all()


def test_intervals_of_bridged_averaging_times_hold_the_truth():
    inside = []
    for seed in range(60):
        values, time, breaks = thinned(WhiteNoise(1.0), 4096, seed)
        curve = allan(values, 0.01, [0.08, 0.16, 0.32, 0.64], breaks=breaks, time=time)
        expected = np.sqrt(WhiteNoise(1.0).allan_variance(curve.averaging_time, 0.01))
        inside.append((curve.lower < expected) & (expected < curve.upper))
    assert np.mean(inside) > 0.93


def test_without_stamps_averaging_times_end_with_the_longest_part():
    values, time, breaks = thinned(WhiteNoise(1.0), 4096, 0)
    longest = np.diff([0, *breaks, values.size]).max()
    assert allan(values, 0.01, breaks=breaks).factor[-1] <= longest / 2
    assert allan(values, 0.01, breaks=breaks, time=time).factor[-1] > 5 * longest


def test_averaging_times_with_terms_enough_are_not_bridged():
    rng = np.random.default_rng(4)
    values = rng.standard_normal(6000)
    time = (np.arange(6000) + 1000 * (np.arange(6000) >= 3000)) * 10**7
    with_stamps, without = (allan(values, 0.01, breaks=[3000], time=t) for t in (time, None))
    short = without.averaging_time <= 2.0
    np.testing.assert_array_equal(with_stamps.deviation[: short.sum()], without.deviation[short])
    np.testing.assert_array_equal(with_stamps.lower[: short.sum()], without.lower[short])


def test_less_than_half_of_the_differences_is_bridged():
    """A sample in a hundred is missing: an average over 20 keeps 0.6 of the differences, one over 35 keeps 0.3."""
    place = np.flatnonzero(np.arange(4000) % 100 < 99)
    breaks = (np.flatnonzero(np.diff(place) > 1) + 1).tolist()
    curve = allan(
        np.random.default_rng(5).standard_normal(place.size), 0.01, [0.2, 0.35], breaks=breaks, time=place * 10**7
    )
    assert curve.terms[0] == 40 * (99 + 1 - 2 * 20)
    assert curve.terms[1] > 0.95 * (place.size + 1 - 2 * 35)


def test_stamps_that_scatter_move_no_sample():
    values, time, breaks = thinned(WhiteNoise(1.0), 4096, 1)
    jitter = np.random.default_rng(0).integers(-2_000_000, 2_000_000, time.size)
    plain, scattered = (allan(values, 0.01, breaks=breaks, time=t) for t in (time, time + jitter))
    np.testing.assert_array_equal(plain.deviation, scattered.deviation)


def test_a_constant_channel_with_gaps_has_a_deviation_of_0():
    time = np.delete(np.arange(200), [50, 51, 120]) * 10**7
    curve = allan(np.full(197, 9.81), 0.01, breaks=[50, 118], time=time)
    assert curve.factor.size
    assert not curve.deviation.any()


def test_fast_is_exact_as_long_as_nothing_is_thinned_out():
    values = np.random.default_rng(5).standard_normal(5000)
    whole, fast = (allan(values, 1.0, [1, 7, 16, 31], fast=fast) for fast in (False, True))
    assert fast.factor.tolist() == [1, 7, 16, 31]
    # Up to 2,048 squares are added in single precision, in an order that depends on the processor.
    np.testing.assert_allclose(fast.deviation, whole.deviation, rtol=1e-5)
    np.testing.assert_allclose(fast.upper, whole.upper, rtol=1e-5)


MOVED = {
    "motion": lambda t, noise: 3 * np.sin(t / 1000) + 1e-3 * noise,
    "a step": lambda t, noise: np.where(t > t.size / 2, 1000.0, 0.0) + 1e-3 * noise,
    "a random walk": lambda _, noise: noise.cumsum(),
    "steps of a quantizer": lambda _, noise: np.round(9.81 + 1e-3 * noise, 3),
    "tiny": lambda _, noise: 1e-25 * noise,
    "huge": lambda _, noise: 1e25 * noise,
    "stuck half of the time": lambda t, noise: np.where(t > t.size / 2, noise, 0.0),
}


@pytest.mark.parametrize("what", MOVED)
def test_fast_rounds_little_whatever_the_record(what):
    t, noise = np.arange(50_000.0), np.random.default_rng(7).standard_normal(50_000)
    values = MOVED[what](t, noise)
    whole, fast = (allan(values, 1.0, [1, 2, 3, 7, 16, 31], fast=fast) for fast in (False, True))
    np.testing.assert_allclose(fast.deviation, whole.deviation, rtol=2e-5)


def test_fast_keeps_every_second_fourth_eighth_difference():
    values = np.random.default_rng(6).standard_normal(5000)
    phase = np.concatenate([[0], np.cumsum(values - values.mean())])
    curve = allan(values, 1.0, [32, 100, 333, 1000], fast=True)
    assert np.abs(curve.factor / [32, 100, 333, 1000] - 1).max() < 0.07
    for m, deviation in zip(curve.factor, curve.deviation, strict=True):
        stride = int(_strides(np.array([m]))[0])
        assert stride > 1 or m < 128
        assert m % stride == 0
        assert m / stride >= 16
        z = (phase[2 * m :] - 2 * phase[m:-m] + phase[: -2 * m])[::stride]
        assert deviation == pytest.approx(np.sqrt(np.mean(z**2) / 2) / m, rel=1e-5)


@pytest.mark.parametrize("process", [WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(0.1)], ids=repr)
def test_fast_differs_by_little_of_what_chance_does(process):
    ratios = []
    for seed in range(30):
        values = process.sample(2**14, 1.0, np.random.default_rng(seed))
        whole, fast = allan(values, 1.0), allan(values, 1.0, fast=True)
        assert whole.factor.tolist() == fast.factor.tolist()
        assert fast.terms.tolist() == whole.terms.tolist()
        ratios.append(fast.deviation / whole.deviation - 1)
    alpha = {WhiteNoise: 0, FlickerNoise: -1, RandomWalk: -2}[type(process)]
    chance = 1 / np.sqrt([2 * equivalent_degrees_of_freedom(int(m), 2**14, alpha) for m in whole.factor])
    assert (np.sqrt(np.mean(np.square(ratios), axis=0)) < 0.25 * chance).all()
    assert (np.abs(np.mean(ratios, axis=0)) < 0.1 * chance).all()


def test_fast_spans_no_gap_either():
    rng = np.random.default_rng(3)
    first, second = rng.standard_normal(700), rng.standard_normal(300) + 1000
    curve = allan(np.concatenate([first, second]), 1.0, [4, 64], breaks=[700], fast=True)
    assert curve.deviation[1] == pytest.approx(1 / 8, rel=0.3)
    assert curve.deviation[0] == pytest.approx(1 / 2, rel=0.1)


def test_axes_are_each_what_allan_gives():
    rng = np.random.default_rng(0)
    series = {name: (rng.standard_normal(3000), 0.1, breaks) for name, breaks in (("x", ()), ("y", (1000,)), ("z", ()))}
    found = allan_of_axes(series, "octave", fast=True)
    assert list(found) == ["x", "y", "z"]
    for name, (values, dt, breaks) in series.items():
        np.testing.assert_array_equal(found[name].deviation, allan(values, dt, breaks=breaks, fast=True).deviation)

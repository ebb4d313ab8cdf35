import csv
import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.identification import allan, averaging_factors
from imuwb.identification.allan import sums_of_squares


def slow_allan_variance(values, dt, m):
    """The textbook's double sum over averages, no running sum."""
    n = values.size
    means = np.array([values[k : k + m].mean() for k in range(n - m + 1)])
    return np.mean((means[m:] - means[: means.size - m]) ** 2) / 2


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

    from imuwb.identification import equivalent_degrees_of_freedom

    for m, alpha, low, sigma, high in table[:, [0, 3, 4, 5, 6]]:
        edf = equivalent_degrees_of_freedom(int(m), phase.size - 1, int(alpha))
        tail = (1 - 0.683) / 2
        assert sigma * np.sqrt(edf / stats.chi2.ppf(1 - tail, edf)) == pytest.approx(low, rel=1e-2)
        assert sigma * np.sqrt(edf / stats.chi2.ppf(tail, edf)) == pytest.approx(high, rel=1e-2)


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
    with pytest.raises(ValueError, match="no two that follow"):
        allan(np.array([1.0]), 1.0)

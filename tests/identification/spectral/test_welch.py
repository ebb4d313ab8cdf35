import numpy as np
import pytest
from scipy import signal

from imuwb.identification.spectral import welch as welch_module
from imuwb.identification.spectral.welch import independent, welch

DT = 0.02


@pytest.mark.parametrize(
    ("n", "size"), [(5000, 512), (5000, 501), (4096, 4096), (4097, 4096), (6143, 4096), (6144, 4096)]
)
def test_equals_scipys_with_the_same_segments(n, size):
    values = np.random.default_rng(n).standard_normal(n).cumsum() + 9.81
    frequency, expected = signal.welch(values, 1 / DT, "hann", size, noverlap=size - size // 2, detrend="linear")
    if size % 2 == 0:
        expected[-1] *= 2  # scipy takes the last bin once; here it is twice the two-sided density, as all are
    expected[0] *= 2
    density, _ = welch(values, DT, size)
    assert density.size == frequency.size
    np.testing.assert_allclose(density, expected, rtol=1e-8, atol=1e-12 * expected.max())


@pytest.mark.slow
@pytest.mark.parametrize("width", [1, 2, 8])
def test_means_are_worth_what_their_scatter_shows(width):
    size, n = 64, 64 * 16
    draws = [welch(np.random.default_rng(10_000 + seed).standard_normal(n), DT, size) for seed in range(2000)]
    count = draws[0][1]
    assert count == 31
    power = np.array([density for density, _ in draws])[:, 4:28].reshape(len(draws), -1, width).mean(axis=2)
    seen = np.mean(power.mean(axis=0) ** 2 / power.var(axis=0))
    assert independent(count, width) == pytest.approx(seen, rel=0.05)


def test_one_segment_is_worth_one():
    assert welch(np.random.default_rng(0).standard_normal(100), DT, 100)[1] == 1
    assert independent(1) == 1


def test_white_noise_has_twice_its_two_sided_density():
    density, _ = welch(0.3 / DT**0.5 * np.random.default_rng(0).standard_normal(2**17), DT, 256)
    assert density[4:-4].mean() == pytest.approx(2 * 0.3**2, rel=0.02)


def test_does_not_write_into_the_record():
    values = np.arange(200.0) ** 2
    before = values.copy()
    welch(values, DT, 64)
    np.testing.assert_array_equal(values, before)


def overlap(apart, bins, size=256):
    """Return the correlation of white noise's powers: |sum w(t) w(t + apart) e^(2 pi i bins t/size)|² over (sum w²)²."""
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    shared = window[apart:] * window[: size - apart]
    turned = np.sum(shared * np.exp(2j * np.pi * bins * np.arange(shared.size) / size))
    return abs(turned) ** 2 / np.sum(window**2) ** 2


def test_powers_correlate_as_their_windows_overlap():
    assert [overlap(0, 1), overlap(0, 2)] == pytest.approx([welch_module.APART_1, welch_module.APART_2])
    assert 2 * overlap(128, 0) == pytest.approx(welch_module.NEIGHBOURS)
    assert sum(overlap(128, bins) for bins in range(1, 20)) == pytest.approx(welch_module.ASIDE, rel=1e-3)

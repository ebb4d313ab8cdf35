import numpy as np
import pytest
from scipy import fft

from imuwb.identification.likelihood import cosine_transform as transforms
from imuwb.identification.likelihood.cosine_transform import cosine_transform, transform_length


@pytest.fixture
def all_long(monkeypatch):
    monkeypatch.setattr(transforms, "LARGE", 0)
    monkeypatch.setattr(transforms, "PIECE", 64)  # several blocks of rows and of columns


@pytest.mark.parametrize("n", [2, 30, 486, 1000, 16_384])
def test_in_place_it_equals_the_transform_of_a_library(all_long, n):
    values = np.random.default_rng(n).normal(size=(n, 3))[:, 1] + 0.01 * np.arange(n)
    line = 3.0 + 0.01 * (np.arange(n) - (n - 1) / 2)
    found = cosine_transform(values, 3.0, 0.01)
    expected = fft.dct(values - line, type=2, norm="ortho")
    np.testing.assert_allclose(found.at(np.arange(n)), expected, atol=1e-12 * np.abs(expected).max())


def test_sums_of_squares_leave_lines_out_in_any_order_of_the_coefficients(all_long):
    values = np.random.default_rng(0).normal(size=1000)
    edges, first, last = np.array([1, 20, 600, 1000]), np.array([498]), np.array([502])
    square = fft.dct(values, type=2, norm="ortho") ** 2
    square[498:503] = 0.0
    sums, counts = cosine_transform(values, 0.0, 0.0).sums_of_squares(edges, first, last)
    np.testing.assert_allclose(sums, np.add.reduceat(square, edges[:-1]), rtol=1e-12)
    assert counts.tolist() == [19, 575, 400]


def test_a_long_record_is_shortened_to_an_even_length_without_large_factors(all_long):
    assert [transform_length(n) for n in (1000, 1001, 2 * 499, 2187)] == [1000, 1000, 972, 2160]


def test_a_record_of_usual_length_keeps_it():
    assert transform_length(1_000_003) == 1_000_003

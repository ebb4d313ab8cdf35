"""Sums of exponentials at uneven turns, against the sums as they are written."""

import numpy as np
import pytest

from imuwb.identification.lssa.uneven import BLOCK, uneven_sums


def direct(turn, strengths, count):
    return strengths @ np.exp(2j * np.pi * np.multiply.outer(turn, np.arange(1, count + 1)))


@pytest.mark.parametrize(
    ("size", "count", "rows"),
    [(1000, 800, 3), (1, 5, 1), (BLOCK, 1, 2), (BLOCK + 1, 7, 1), (50, 2000, 1), (3000, 3, 6)],
)
def test_sums_are_those_of_the_formula(size, count, rows):
    rng = np.random.default_rng(size)
    turn, strengths = np.sort(rng.uniform(0, 1, size)), rng.standard_normal((rows, size))
    wanted = direct(turn, strengths, count)
    np.testing.assert_allclose(uneven_sums(turn, strengths, count), wanted, rtol=0, atol=1e-11 * np.sqrt(size) * 3)


@pytest.mark.parametrize("shift", [-3.0, -1e-17, 0.5, 7.0])
def test_turns_may_be_in_any_order_and_more_than_one(shift):
    rng = np.random.default_rng(1)
    turn = np.concatenate([rng.uniform(0, 2, 200), np.arange(8) / 8, [np.nextafter(1, 0), 1.0]]) + shift
    strengths = rng.standard_normal((1, turn.size))
    wanted = direct(turn, strengths, 90)
    found = uneven_sums(turn, strengths, 90)
    assert np.linalg.norm(found - wanted) < 1e-11 * np.linalg.norm(wanted)


def test_sums_are_linear_and_real_strengths_of_a_grid_are_a_fourier_transform():
    rng = np.random.default_rng(2)
    strengths = rng.standard_normal((2, 256))
    found = uneven_sums(np.arange(256) / 256, strengths, 127)
    np.testing.assert_allclose(found, np.conj(np.fft.rfft(strengths)[:, 1:128]), rtol=0, atol=1e-10)
    both = uneven_sums(np.arange(256) / 256, strengths.sum(axis=0)[None], 127)
    np.testing.assert_allclose(found.sum(axis=0), both[0], rtol=0, atol=1e-11)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_turn_that_is_no_number_is_refused(wrong):
    with pytest.raises(ValueError, match="finite"):
        uneven_sums(np.array([0.1, wrong]), np.ones((1, 2)), 3)

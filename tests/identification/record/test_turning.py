"""A record without a rest: turns are found by their rate, whatever the rest of the record is like."""

import numpy as np
import pytest

from imuwb.identification import stillness

RATE, N = 50, 50 * 120


def wandering(rng, size):
    """Return a rate that wanders between 0.1 and 1 Hz all the time."""
    spectrum = np.fft.rfft(rng.standard_normal(N))
    f = np.fft.rfftfreq(N, 1 / RATE)
    spectrum[(f < 0.1) | (f > 1)] = 0
    moved = np.fft.irfft(spectrum, N)
    return size * moved / moved.std()


@pytest.mark.parametrize(
    ("axis", "size", "moving"), [("gyro_x", 0.5, True), ("gyro_x", 0.01, False), ("accel_x", 0.5, False)]
)
def test_a_record_that_turns_all_the_time_moves(axis, size, moving):
    rng = np.random.default_rng(0)
    found = stillness({axis: (np.arange(N) / RATE, wandering(rng, size) + 0.002 * rng.standard_normal(N))})
    assert found.moving == moving


@pytest.mark.parametrize("seed", range(5))
def test_the_bias_of_a_sensor_that_warms_up_is_no_turn(seed):
    time = np.arange(N) / RATE
    bias = 0.1 * (1 - np.exp(-time / 60)) + 0.01 * np.random.default_rng(seed).standard_normal(N)
    assert not stillness({"gyro_x": (time, bias)}).moving

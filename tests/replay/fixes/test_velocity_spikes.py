from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream
from imuwb.notes import ids
from imuwb.replay.fixes.velocity_spikes import without_spikes


def receiver(rate=5.0, rows=300, seed=0):
    """Return a car that turns in circles at 20 m/s."""
    rng = np.random.default_rng(seed)
    time = np.arange(rows) / rate
    velocity = 20 * np.column_stack([np.cos(0.4 * time), np.sin(0.4 * time), 0 * time]) + rng.normal(0, 0.1, (rows, 3))
    return GnssStream("gnss", np.rint(time * SECOND).astype(np.int64), np.zeros((rows, 3)), velocity,
                      velocity_sigma=np.full((rows, 3), 0.1))  # fmt: skip


@pytest.mark.parametrize("rate", [1.0, 5.0, 20.0])
@pytest.mark.parametrize("seed", range(5))
def test_no_velocity_of_a_sound_receiver_is_a_spike(rate, seed):
    own = receiver(rate, seed=seed)
    assert without_spikes(own) == (own, ())


def test_lone_spikes_and_only_these_are_left_out():
    own = receiver()
    velocity = own.velocity.copy()
    rows = [50, 51 + 40, 200]
    velocity[rows] += [[84, 0, 0], [0, -30, 0], [0, 0, 427]]
    cleaned, notes = without_spikes(replace(own, velocity=velocity))
    assert np.flatnonzero(np.isnan(cleaned.velocity).any(axis=1)).tolist() == rows
    assert ids(notes) == ("velocity-spikes",)
    kept = np.delete(np.arange(300), rows)
    np.testing.assert_array_equal(cleaned.velocity[kept], velocity[kept])


def test_a_step_is_no_spike():
    own = receiver()
    velocity = own.velocity.copy()
    velocity[150:] += 60.0
    assert without_spikes(replace(own, velocity=velocity))[1] == ()


def test_spikes_of_the_size_of_stated_sigmas_are_noise():
    own = receiver()
    velocity = own.velocity.copy()
    velocity[100] += 60.0
    doubted = own.velocity_sigma.copy()
    doubted[100] = 30.0
    assert without_spikes(replace(own, velocity=velocity, velocity_sigma=doubted))[1] == ()

import numpy as np
import pytest

from imuwb.identification.calibration import clipped, means
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise


def stretches(process, count=6, n=3000, dt=0.02, seed=0):
    rng = np.random.default_rng(seed)
    return [np.stack([process.sample(n, dt, rng) for _ in range(3)], axis=1) for _ in range(count)]


def test_the_mean_is_the_mean_and_its_variance_that_of_white_noise():
    found = means(stretches(WhiteNoise(0.01), count=200))
    assert found.value.shape == (200, 3)
    assert found.red == (False, False, False)
    np.testing.assert_allclose(found.variance, 0.01**2 / 60, rtol=0.15)  # N²/T, of 600 degrees of freedom
    np.testing.assert_array_equal(found.freedom, 600)
    np.testing.assert_allclose(found.value.var(axis=0), 0.01**2 / 60, rtol=0.35)


def test_stretches_of_other_lengths_have_variances_of_their_own():
    long, short = stretches(WhiteNoise(1.0), 20, n=6400), stretches(WhiteNoise(1.0), 20, n=1600, seed=2)
    found = means(long + short)
    assert found.red == (False, False, False)
    np.testing.assert_allclose(found.variance[20:] / found.variance[:20], 4.0)


@pytest.mark.parametrize("process", [WhiteNoise(1e-3) + FlickerNoise(1e-2), WhiteNoise(1e-3) + RandomWalk(1e-2)])
def test_slow_noise_is_seen_and_the_means_are_worth_less(process):
    parts = stretches(process, n=3200)
    found = means(parts)
    assert found.red == (True, True, True)
    slow, fast = (np.stack([s.reshape(k, -1, 3).mean(axis=1) for s in parts]) for k in (4, 16))
    quarter = slow.var(axis=1, ddof=1).mean(axis=0)
    sixteenth = fast.reshape(6, 4, 4, 3).var(axis=2, ddof=1).mean(axis=(0, 1))
    np.testing.assert_allclose(found.variance[0], quarter * np.maximum(quarter / sixteenth, 1))


def test_flicker_between_positions_is_about_what_is_claimed():
    dt, n, rng = 0.02, 3000, np.random.default_rng(3)
    claimed, seen = [], []
    for _ in range(40):
        whole = FlickerNoise(1.0).sample(6 * n, dt, rng)
        parts = [np.stack([whole[i * n : (i + 1) * n]] * 3, axis=1) for i in range(6)]
        found = means(parts)
        claimed.append(found.variance[0, 0])
        seen.append(found.value[:, 0].var(ddof=1))
    assert 0.5 < np.mean(claimed) / np.mean(seen) < 2.0


def test_rounding_counts_where_noise_does_not_reach_the_next_step():
    rng = np.random.default_rng(0)
    coarse = [np.rint(0.45 + 0.03 * rng.standard_normal((640, 3))) for _ in range(6)]
    assert all(np.unique(s).size == 2 for s in coarse)
    assert (means(coarse).variance > 1 / 12).all()


def test_too_short_a_stretch_is_refused():
    with pytest.raises(ValueError, match="63 samples; .* 64"):
        means([np.zeros((63, 3))])
    with pytest.raises(ValueError, match="0 samples"):
        means([])


def test_a_clipped_axis_is_told_from_a_coarse_and_from_a_quiet_one():
    rng = np.random.default_rng(1)
    free = [np.round(rng.standard_normal((500, 3)), 2) for _ in range(5)]
    cut = np.round(rng.standard_normal((500, 3)), 2)
    cut[:, 1] = np.minimum(cut[:, 1], -0.3)
    found = clipped([*free, cut])
    assert found[5].tolist() == [False, True, False]
    assert not found[:5].any()
    assert not clipped([np.rint(f / 2) for f in free]).any()  # few steps everywhere
    assert not clipped([np.zeros((100, 3))] * 6).any()


def test_white_noise_is_called_red_one_time_in_twenty():
    rng = np.random.default_rng(6)
    red = [means([rng.standard_normal((64, 3)) for _ in range(6)]).red for _ in range(150)]
    assert 0.02 < np.mean(red) < 0.09


def test_the_rounding_of_a_coarse_sensor_is_a_twelfth_of_a_squared_step():
    coarse = np.tile([0.0, 1.0], 320)[:, None] * np.ones(3)
    np.testing.assert_allclose(means([coarse]).variance, 1 / 12)

import numpy as np

from imuwb.identification import stillness


def still(n=60_000, seed=0):
    return np.random.default_rng(seed).standard_normal(n)


def test_a_still_record_has_no_disturbance():
    for seed in range(20):
        found = stillness({"a": still(seed=seed), "b": still(seed=seed + 100)}, 0.01)
        assert found.disturbances == ()
        assert (found.quiet_start, found.quiet_end, found.moving) == (0.0, 600.0, False)


def test_a_shock_is_found_with_its_axis_and_the_longer_quiet_part():
    values = still()
    values[20_000:20_050] += 40
    found = stillness({"a": values, "b": still(seed=1)}, 0.01)
    assert len(found.disturbances) == 1
    shock = found.disturbances[0]
    assert shock.start <= 200 < shock.end <= 202
    assert shock.axes == ("a",)
    assert found.quiet_start >= 200.5
    assert found.quiet_end == 600.0


def test_a_moving_record_is_no_static_record():
    values = still()
    values[:40_000] *= 30
    values[:40_000] += 50 * np.sin(np.arange(40_000) / 80)
    assert stillness({"a": values}, 0.01).moving


def test_slow_drift_is_no_motion():
    drift = np.cumsum(still(seed=4)) * 0.003
    assert stillness({"a": still() + drift}, 0.01).disturbances == ()

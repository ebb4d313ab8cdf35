"""Tests of the conditioner."""

import numpy as np
import pytest
from imuwb.simulation import preset, static
from imuwb.testing import check

import plugin_name


@pytest.mark.parametrize("causal", ["true", "false"])
def test_it_keeps_the_contract(causal: str) -> None:
    """All rules of ``imuwb plugins check`` pass."""
    check(plugin_name, "plugin_name", parameters={"causal": causal}).require()


def test_a_mean_is_that_of_the_neighbours() -> None:
    """Each sample is the mean of the five around it, at the time of the middle one."""
    log = static(preset("adis16465"), 10, 100, 1)
    changed, _ = plugin_name.condition(log, plugin_name.Parameters(samples=5))
    before, after = log.imu().angular_rate, changed.imu().angular_rate
    assert before is not None
    assert after is not None
    assert after.time[0] == before.time[2]
    np.testing.assert_allclose(after.value[0], before.value[:5].mean(axis=0))


def test_an_even_number_is_refused() -> None:
    """A mean of an even number has no middle."""
    with pytest.raises(ValueError, match="samples is 4"):
        plugin_name.Parameters(samples=4)

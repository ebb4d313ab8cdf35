"""Logs from the field that a replay must take: the small inputs of ``shared/cases``."""

import pytest

from imuwb.joining import joined
from imuwb.notes import ids
from imuwb.readers import read
from imuwb_plugins import outage
from tests.recordings import recording

from .made import stated


def case(name, gnss, duration, settling, **more):
    """Return the drift of the filter ``full`` in some outages of a case."""
    folder = recording("cases", name)
    log = joined(read(folder / "log.csv"), read(folder / gnss))
    options = {"error_model": folder / "model.toml", "durations": str(duration), "settling": settling, "models": "full"}
    return outage.run([log], stated(**options, random=12, **more))


def median_end(result):
    return next(iter(result.summary[0].models.values())).median_end


@pytest.mark.parametrize("reference", ["best", "own"])
def test_an_imu_slower_than_its_receiver(reference):
    found = case("04-outage-slow-imu", "log.gnss.csv", 10, 40.0, reference=reference, spacing=0.0)
    assert "slow-imu" in ids(found.notes)
    assert 0.1 < median_end(found) < 4.0


def test_positions_of_ten_a_second_without_velocity_or_sigma():
    found = case("05-position-only-10hz", "gnss.csv", 5, 15.0)
    assert {"no-velocities", "default-position-sigmas", "alignment"} <= set(ids(found.notes))
    assert "slow-imu" not in ids(found.notes)
    assert median_end(found) < 1.0


def test_lone_spikes_of_the_velocity_do_not_change_the_drift():
    found = case("12-gated-spikes", "gnss.csv", 10, 40.0, spacing=0.0)
    assert "velocity-spikes" in ids(found.notes)
    assert found.filters[0].refused == 0
    assert median_end(found) < 1.5

"""An IMU that is held by hand: its truth, its holds and its motions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb import simulation
from imuwb.errors import UsageError
from imuwb.stochastic import AxisModel, ImuErrorModel

IDEAL = ImuErrorModel("ideal", {f"{s}_{k}": AxisModel() for s in ("gyro", "accel") for k in "xyz"})


def samples(**options):
    imu = simulation.hand_held(IDEAL, 3, positions=9, table=4.0, rate=50, **options).log.imu()
    return imu.angular_rate.value, imu.specific_force.value


def test_on_a_support_gyros_integrate_to_what_the_accelerometers_show():
    rate, force = samples(tremor=0.0)
    attitude, worst = Rotation.identity(), 0.0
    for w, f in zip(rate, force, strict=True):
        attitude = attitude * Rotation.from_rotvec(w.copy() / 100)
        if np.linalg.norm(w) < 1e-9:  # still
            worst = max(worst, np.linalg.norm(attitude.apply(f.copy()) / 9.80665 - [0, 0, -1]))
        attitude = attitude * Rotation.from_rotvec(w.copy() / 100)
    assert worst < 1e-3  # the coning within a sample is left out here
    assert force[0] == pytest.approx([0, 0, -9.80665])


def test_each_position_is_held_and_all_directions_appear():
    rate, force = samples(tremor=0.0, seconds=4.0)
    still = np.linalg.norm(rate, axis=1) < 1e-9
    edges = np.flatnonzero(np.diff(still.astype(int)))
    holds = np.diff(edges)[1::2] / 50
    assert len(holds) + 1 == 9
    assert holds.min() > 0.85 * 4 - 0.1
    assert holds.max() < 1.35 * 4 + 0.1
    assert (force[still].max(axis=0) > 5).all()
    assert (force[still].min(axis=0) < -5).all()


def test_a_hand_sways_about_the_position_and_not_on_the_table():
    rate, force = samples(tremor=np.radians(0.2))
    quiet, _ = samples(tremor=0.0)
    on_table = np.arange(len(rate)) < 4 * 50
    assert np.abs(rate[on_table][:-1]).max() < 1e-12
    assert force[on_table][:-1] == pytest.approx(np.tile([0, 0, -9.80665], (on_table.sum() - 1, 1)))
    held = np.linalg.norm(quiet[: len(rate)], axis=1) < 1e-9
    swaying = np.degrees(rate[held & ~on_table].std())
    assert 0.1 < swaying < 1.5


def test_the_earth_turns_it():
    site = simulation.Site(9.81, np.radians(50))
    rate, _ = samples(tremor=0.0, site=site)
    assert np.linalg.norm(rate[0]) == pytest.approx(7.292e-5, rel=1e-3)
    assert rate[0, 2] == pytest.approx(-7.292e-5 * np.sin(np.radians(50)), rel=1e-3)


def test_the_same_seed_gives_the_same_log():
    first, again = (samples()[0] for _ in range(2))
    assert (first == again).all()
    assert simulation.hand_held(IDEAL, 4, positions=9, rate=50).truth.axes == IDEAL.axes


@pytest.mark.parametrize(
    ("options", "message"),
    [({"positions": 8}, "8 positions"), ({"positions": 101}, "9 to 100"), ({"tremor": 0.2}, "tremor"), ({"seconds": 0.1}, "16 or more")],
)  # fmt: skip
def test_settings_that_cannot_be(options, message):
    with pytest.raises(UsageError, match=message):
        simulation.hand_held(IDEAL, 1, **options)

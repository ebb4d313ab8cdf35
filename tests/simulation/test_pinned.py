"""The same seed gives the same log, in every release: values of each part of the simulator, which hold its constants too."""

import numpy as np
import pytest

from imuwb.simulation import Tolerances, mixed_route, planned_route, preset, rate_table, six_position, specimen
from imuwb.simulation.vibration import vibration
from imuwb.stochastic import ImuErrorModel

IDEAL = ImuErrorModel("ideal", {})


def same(values, pinned):
    np.testing.assert_allclose(np.ravel(values), pinned, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(
    ("route", "times", "speed", "attitude", "force"),
    [
        (
            lambda: planned_route("turin-2", 3), (200, 480, 640, 880),
            (9.40188101421, 12.6772847959, 29.0710602049, 8.71921643635),
            (-0.0150579600746, -0.0193687050711, -0.969133463958, 0.00310775974571, 0.0155713341389, -0.828530706447,
             0.0146912300926, -0.0150838513877, 0.514410683994, -0.0164807531936, -0.00010957384838, 0.296095725363),
            (-0.141886876367, 0.146690835025, -9.779613248, -0.814402353323, -0.0326954872001, -9.82389098452,
             -0.326041897987, -0.148324054229, -9.83895480017, -1.67620861157, 0.160301932893, -9.80271833342),
        ),
        (
            lambda: mixed_route(600, 5), (100, 300, 500),
            (7.17071189309, 16.8271887499, 22.9455663634),
            (0.00605716132948, 0.00462907199954, -0.791109177393, -0.00430177970783, -0.0141015559692, -2.60136609728,
             -0.00764156137124, 0.00783311237763, -2.71041503495),
            (1.44661899195, -0.0579473892061, -9.81163306914, -0.128624646317, 0.0405149062564, -9.7785866715,
             -0.0791128011779, 0.105322907125, -9.82120192894),
        ),
    ],
    ids=["planned", "mixed"],
)  # fmt: skip
def test_routes(route, times, speed, attitude, force):
    drive, t = route(), np.array(times, float)
    same(drive.speed(t), speed)
    same(drive.state(t).attitude, attitude)
    same(drive.inertial(t)[1], force)


@pytest.mark.parametrize(
    ("route", "pinned"),
    [
        (lambda: planned_route("turin-1", 1), (8.21510060818, 30.7945620699, 0.0172073054901)),
        (lambda: planned_route("turin-2", 3), (15.6557921582, 9.52028384221, 0.0168273628385)),
        (lambda: mixed_route(600, 5), (16.2335235744, 8.50297273298, 0.0165856098748)),
        (lambda: mixed_route(2400, 2), (18.5528627213, 39.305520913, 0.0168425067636)),
    ],
)
def test_the_whole_of_a_route(route, pinned):
    """Mean speed, all turns, and the scatter of the road."""
    profile = route().profile
    speed, heading = profile.manoeuvres.c.T
    same((speed.mean(), np.abs(np.diff(heading)).sum(), profile.road.c.std()), pinned)


def test_vibration():
    rates, forces = vibration(400, 200.0, 2.0, np.random.default_rng(1))
    same(rates[303], (0.0223042743075, -0.00092247231908, -0.0428654132782))
    same(forces[303], (-1.37418888154, 0.354799088846, 4.36133033627))


def test_a_specimen():
    axes = specimen(preset("mpu-6050"), 4, Tolerances()).axes
    gyro, accel = axes["gyro_x"], axes["accel_z"]
    same(
        (gyro.bias, gyro.scale_factor, gyro.scale_factor_nonlinear),
        (-0.582552970127, -0.0189247715702, 0.00188997878219),
    )
    same(gyro.cross_coupling, (-0.0107879698226, -0.00786526145529))
    np.testing.assert_allclose(
        gyro.g_sensitivity, (3.05514533014e-05, -0.000124375043985, -6.63021235422e-05), rtol=1e-8
    )
    same((accel.bias, accel.scale_factor_nonlinear), (0.438201810324, 0.00483733401093))


def test_positions():
    made = six_position(IDEAL, 2, positions=9, seconds=1.0, rate=20, misplacement=0.01, one_log=True)
    imu = made.logs["positions"].imus[0]
    assert len(imu.angular_rate) == 660  # turns of 3 s
    same(imu.specific_force.value[25], (4.34628402521, 0.150268213833, 8.78963132666))
    same(imu.angular_rate.value[25], (0.0891846547737, 0.152035696629, -0.0466991114477))


def test_a_rate_table():
    rate = rate_table(IDEAL, 2, [0.5, 1.0], axes="z", seconds=1.0, rate=50, misplacement=0.01).logs["rate_z"]
    value = rate.imus[0].angular_rate.value
    assert len(value) == 464
    same(
        value[[51, 199]],
        (-0.00107115025091, -0.000105994754219, 0.0535606139008, -0.00517107017679, -0.000511698813469, 0.258568480901),
    )

"""Constraints on a vehicle's motion hold for a point of the vehicle, not for the IMU."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import ImuStream, Triad
from imuwb.navigation import Aids, FilterModel, Installation, Settings
from imuwb.navigation.tables import SPEED, STRAIGHT
from imuwb.replay import prepare, replay, run, sweep
from imuwb.simulation import Odometer, Receiver, drive, mixed_route

from . import made

ARM = np.array([1.5, 0.4, -0.6])  #: m, from the middle of the rear axle to the IMU
RATE = 50.0


@pytest.fixture(scope="module")
def log():
    """Return a drive whose IMU and antenna sit off the point that the car's path is that of."""
    route = mixed_route(300, 2)
    log = drive(made.error_model(), route, 4, rate=RATE, receiver=Receiver(lever_arm=tuple(ARM)), odometer=Odometer())
    imu = log.imus[0]
    rate, _ = route.averages(len(imu.angular_rate), RATE)
    force = imu.specific_force.value + np.cross(np.gradient(rate, 1 / RATE, axis=0), ARM)
    force += np.cross(rate, np.cross(rate, ARM))
    return replace(log, imus=(ImuStream(imu.name, imu.angular_rate, Triad(imu.specific_force.time, force)),))


def model(arm):
    return FilterModel(
        "aided", made.error_model(), installation=Installation(vehicle_arm=tuple(arm)), settings=Settings(settling=30.0),
        aids=Aids(straight=0.03, speed=0.05),
    )  # fmt: skip


def innovations(log, arm, kind, component):
    """Return the innovations of an aid over their sigma, after the filter has settled."""
    prepared = prepare(log, model(arm))
    track, events = run(model(arm), prepared).track, prepared.corrections
    rows = (events.events.kind == kind) & (events.time > prepared.start_time + 30)
    return track.innovation[rows, component] / track.deviation[rows, component]


def test_the_constraint_holds_at_its_point(log):
    """The rear axle does not slip; the IMU, 1.5 m ahead of it, moves sideways in each turn."""
    right, wrong = (np.mean(innovations(log, arm, STRAIGHT, 0) ** 2) for arm in (-ARM, np.zeros(3)))
    assert right < 1.3
    assert wrong > 2 * right
    speed = [np.mean(innovations(log, arm, SPEED, 0) ** 2) for arm in (-ARM, np.zeros(3))]
    assert speed[0] < 1.3
    assert speed[1] > speed[0]


def test_outages_are_better_with_the_right_point(log):
    def drift(arm):
        prepared = prepare(log, model(arm))
        found = replay(prepared, [model(arm)], sweep(prepared, model(arm), 20.0), reference="smoothed")
        return np.nanmedian(found.runs["aided"].outages[20.0].scores.horizontal[:, -1])

    assert drift(-ARM) < 0.9 * drift(np.zeros(3))

"""Test whether a spread of starts finds the heading of a slow vehicle, and whether its sigma is true.

A robot stands for 12 s, and then drives at up to 1.6 m/s for two and a half minutes, with stops and turns. The IMU (an MPU-6050 at
25 Hz) is turned about the vertical by an angle of its own in each record, as that of a walker: the course says nothing. Three
receivers: RTK; RTK with sensors that shake; and a receiver of metres, with sensors that shake less.

Command: ``python tests/studies/heading_start.py`` (three minutes on two cores).
Seeds: seed r makes the sensor, the route and the angle of record r.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation
from study_report import Share, Table, main, over_records

from imuwb.log import ImuStream, Triad
from imuwb.navigation import FilterModel
from imuwb.navigation.measurement import measurement_of
from imuwb.navigation.standstill import standstills
from imuwb.replay.starts.heading_search import search_heading
from imuwb.simulation import MotionNoise, Receiver, drive, preset
from imuwb.simulation.legs import Leg
from imuwb.simulation.profile import profile
from imuwb.simulation.route import Route

QUESTION = "Headings by a spread of starts"
SECONDS, SPEED, STANDS, RATE = 150.0, 1.3, 12.0, 25.0
PRECISE = Receiver(rate=4.0, position_sigma=(0.02, 0.02, 0.03), velocity_sigma=(0.05, 0.05, 0.05))
COARSE = Receiver(rate=1.0, position_sigma=(1.5, 1.5, 3.0), velocity_sigma=(0.1, 0.1, 0.15))
KINDS = {
    "RTK": (PRECISE, None), "RTK, shaking": (PRECISE, MotionNoise((3e-3, 5e-2))), "metres, shaking": (COARSE, MotionNoise((1e-3, 2e-2))),
}  # fmt: skip
LIMIT = 1.96  #: sigmas


def route_of(seed):
    """Return a slow route with stops and turns."""
    rng = np.random.default_rng(seed)
    legs = [Leg(STANDS, 0.0, 0.0)]
    while sum(leg.duration for leg in legs) < SECONDS:
        speed = float(rng.choice([0.0, 0.7, 1.0, 1.2], p=[0.15, 0.25, 0.4, 0.2])) * SPEED
        turn = float(rng.choice([0.0, rng.normal(0.0, 1.0)])) if speed else 0.0
        legs.append(Leg(float(rng.uniform(3.0, 10.0)), speed, turn))
    return Route("slow", SECONDS, profile(legs, [], rng))


def turned(log, yaw):
    """Return a log whose IMU is turned about the vertical, rad."""
    turn, imu = Rotation.from_euler("Z", -yaw), log.imus[0]
    triads = [Triad(t.time, turn.apply(np.array(t.value))) for t in (imu.angular_rate, imu.specific_force)]
    return replace(log, imus=(ImuStream(imu.name, *triads, imu.temperature, imu.origin),))


def record(kind, seed):
    """Return error and sigma of a heading, deg; None if none is found."""
    receiver, noise = KINDS[kind]
    yaw = float(np.random.default_rng([seed, 1]).uniform(-np.pi, np.pi))
    route, sensor = route_of(seed), preset("mpu-6050")
    log = turned(drive(sensor, route, seed, rate=RATE, receiver=receiver, motion_noise=noise), yaw)
    model = FilterModel("any", sensor)
    measurement = measurement_of(log, log.imu(), model.installation)
    found = search_heading(log, log.gnss[0], measurement, standstills(measurement, log, log.gnss[0]), model)
    if found is None:
        return None
    true = np.degrees(route.state(np.array([found.time])).attitude[0, 2] + yaw)
    return (found.heading - true + 180) % 360 - 180, found.sigma


def study(records, workers=2):
    """Return the table of errors."""
    rows = []
    for kind in KINDS:
        found = [x for x in over_records(record, [(kind, seed) for seed in range(records)], workers) if x is not None]
        error, sigma = np.array(found).reshape(-1, 2).T
        inside = Share(int((np.abs(error) < LIMIT * sigma).sum()), error.size)
        rows.append(
            (kind, Share(error.size, records), float(np.sqrt((error**2).mean())), float(np.median(sigma)),
             float(np.sqrt(((error / sigma) ** 2).mean())), inside, float(np.abs(error).max()))
        )  # fmt: skip
    return (
        Table(
            "Headings at the start",
            (
                "receiver and sensors",
                "found",
                "rms error, deg",
                "median sigma, deg",
                "rms error/sigma",
                "within 1.96 sigma",
                "largest error, deg",
            ),
            tuple(rows),
            "Innovations count by half, because those of neighbouring seconds are not independent on real logs; in simulation they "
            "are, and the sigma is then too large by about the square root of two, and by the steps between the starts.",
        ),
    )


if __name__ == "__main__":
    main(
        __file__,
        QUESTION,
        study,
        40,
        lambda n: f"seeds 0..{n - 1}; {n} records of {SECONDS:g} s at {RATE:g} Hz for each row",
    )

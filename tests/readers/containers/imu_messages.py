"""Messages of an IMU for tests of MCAP."""

import json

import numpy as np

T = 1_714_564_800 * 10**9
RATE, FORCE = (0.1, 0.2, 0.3), (0.5, 0.25, 9.75)
FRD = np.array([1, -1, -1])


def assert_imu(imu, count=3):
    assert imu.angular_rate.time.tolist() == [T + i for i in range(count)]
    np.testing.assert_array_equal(imu.angular_rate.value, [np.array(RATE) * FRD] * count)
    np.testing.assert_array_equal(imu.specific_force.value, [np.array(FORCE) * FRD] * count)


def own(i, x=1.0, stamp=None, **fields):
    """Return a JSON IMU of second ``i``."""
    return json.dumps(
        {
            "stamp": {"sec": T // 10**9 + i, "nanosec": 0, **(stamp or {})},
            "angular_velocity": {"x": x, "y": 2.0, "z": 3.0},
            "linear_acceleration": dict(zip("xyz", FORCE, strict=True)),
            **fields,
        },
    ).encode()

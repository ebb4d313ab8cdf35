"""Text logs of an IMU for tests."""

import numpy as np

DEG = np.pi / 180
G = 9.80665
NAMES = ("gx", "gy", "gz", "ax", "ay", "az")
UNITS = {"gyro": "deg/s", "accel": "g"}
HEADER = "gx_dps,gy_dps,gz_dps,ax [g],ay [g],az [g]"
ROW = "1,2,3,0.5,0.25,-1"
RATE = np.array([1, 2, 3]) * DEG
FORCE = np.array([0.5, 0.25, -1]) * G


def timed(name, *times):
    return f"{name},{HEADER}\n" + "".join(f"{time},{ROW}\n" for time in times)


def assert_one_row(imu, row=0):
    np.testing.assert_allclose(imu.angular_rate.value[row], RATE, rtol=1e-15)
    np.testing.assert_allclose(imu.specific_force.value[row], FORCE, rtol=1e-15)

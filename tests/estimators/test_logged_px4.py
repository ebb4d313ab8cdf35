"""What PX4 takes off before it logs, against its own order of corrections, written out here, and against a real log."""

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.estimators.calibration import calibration_text, sensor_identity, thermal_text
from imuwb.estimators.calibration.logged import as_measured, taken_off
from imuwb.readers import read
from imuwb.stochastic import AxisModel, ImuErrorModel
from tests.readers.flight import ulog_writer as ulog

REAL = Path("../shared/data/ulog/pyulog_sample_log_small.ulg")
GYRO_ID, ACCEL_ID = 2424842, 3670050
CELSIUS = np.linspace(-5.0, 60.0, 80)
GYRO = np.array([[0.01 * i, -0.02 + 0.001 * i, 0.03] for i in range(80)])
ACCEL = np.array([[0.1 * i, 1.0, -9.8] for i in range(80)])
STATED = {
    "CAL_ACC0_ID": 77, "CAL_ACC0_XOFF": 9.0, "CAL_ACC1_ID": ACCEL_ID, "CAL_ACC1_XOFF": 0.25, "CAL_ACC1_XSCALE": 1.02, "CAL_ACC1_YSCALE": 1.0,
    "CAL_GYRO0_ID": GYRO_ID, "CAL_GYRO0_YOFF": -0.015, "CAL_GYRO1_ID": 78, "CAL_GYRO0_ROT": -1, "TC_A_ENABLE": 1, "TC_G_ENABLE": 1,
    "TC_A2_ID": ACCEL_ID, "TC_A2_TMIN": 0.0, "TC_A2_TMAX": 50.0, "TC_A2_TREF": 20.0, "TC_A2_X0_2": 0.05, "TC_A2_X1_2": 1e-3, "TC_A2_X3_2": 2e-6,
    "TC_G0_ID": GYRO_ID, "TC_G0_X1_0": 1e-4, "TC_G1_ID": 78, "TC_G1_X1_0": 5.0, "SENS_BOARD_ROT": 2, "SENS_BOARD_Y_OFF": 3.0,
}  # fmt: skip


def parameter(name, value):
    key = f"{'int32_t' if isinstance(value, int) else 'float'} {name}".encode()
    return ulog.message("P", bytes([len(key)]) + key + struct.pack("<i" if isinstance(value, int) else "<f", value))


def as_logged():
    """Return gyro and accelerometer as PX4 logs them: temperature, offset, scale, YAW_90, then pitch by 3 degrees."""
    d = np.clip(CELSIUS, 0.0, 50.0) - 20.0
    accel = ACCEL.copy()
    accel[:, 2] -= 0.05 + 1e-3 * d + 2e-6 * d**3
    accel[:, 0] = (accel[:, 0] - 0.25) * 1.02
    gyro = GYRO - np.column_stack([1e-4 * (np.clip(CELSIUS, 0.0, 100.0) - 25.0), np.full(80, -0.015), np.zeros(80)])
    s, c = np.sin(np.radians(3.0)), np.cos(np.radians(3.0))
    pitch = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return [np.column_stack([-v[:, 1], v[:, 0], v[:, 2]]) @ pitch.T for v in (gyro, accel)]


SELECTION = "uint64_t timestamp;uint32_t accel_device_id;uint32_t gyro_device_id;"


def flight(tmp_path, stated=STATED, selected=(ACCEL_ID,), devices=(GYRO_ID, ACCEL_ID)):
    gyro, accel = as_logged()
    times = [ulog.START + 20_000 * i for i in range(80)]
    rows = [
        {"timestamp": t, "gyro_rad": g, "accelerometer_m_s2": a} for t, g, a in zip(times, gyro, accel, strict=True)
    ]
    warm = [
        {"timestamp": t, "device_id": devices[1], "temperature": c}
        for t, c in list(zip(times, CELSIUS, strict=True))[::79]
    ]
    chosen = [
        {"timestamp": times[i], "accel_device_id": own, "gyro_device_id": devices[0]} for i, own in enumerate(selected)
    ]
    parts = [
        ulog.HEADER,
        *(parameter(*one) for one in stated.items()),
        ulog.topic("sensor_combined", 1, ulog.COMBINED, rows),
        ulog.topic("sensor_selection", 2, SELECTION, chosen),
        ulog.topic("sensor_accel", 3, ulog.ACCEL, warm),
    ]
    path = tmp_path / "flight.ulg"
    path.write_bytes(b"".join(parts))
    return read(path)


def test_the_values_of_the_sensor_come_back_from_a_log_of_px4(tmp_path):
    log = flight(tmp_path)
    names = taken_off(log, log.imu())
    assert {"CAL_ACC1_XSCALE", "TC_A2_X3_2", "TC_G0_X1_0", "SENS_BOARD_Y_OFF"} <= set(names)
    others = {"CAL_ACC0_XOFF", "TC_G1_X1_0", "CAL_ACC1_YSCALE", "CAL_GYRO0_ROT"}  # of other devices, or neutral
    assert not others & set(names)
    bare = as_measured(log)
    np.testing.assert_allclose(bare.imu().angular_rate.value, GYRO, atol=1e-6)
    np.testing.assert_allclose(bare.imu().specific_force.value, ACCEL, atol=3e-6)
    assert sensor_identity(log) == {"gyro device": str(GYRO_ID), "accel device": str(ACCEL_ID)}


def test_samples_of_an_unknown_device_are_not_brought_back(tmp_path):
    changing = flight(tmp_path, selected=(ACCEL_ID, 77))
    with pytest.raises(MissingDataError, match="from which accel"):
        as_measured(changing)
    alone = {n: v for n, v in STATED.items() if n not in ("CAL_ACC0_ID", "CAL_ACC0_XOFF")} | {
        "TC_A_ENABLE": 0,
        "TC_G_ENABLE": 0,
    }
    only = as_measured(flight(tmp_path, alone, selected=(ACCEL_ID, 77)))  # the only one with parameters
    np.testing.assert_allclose(
        only.imu().specific_force.value[:, :2], ACCEL[:, :2], atol=3e-6
    )  # z lacks its polynomial


@pytest.mark.parametrize("driver", [False, True])
def test_single_sensors_of_px4_lack_offset_and_scale_only_where_drivers_took_them_off(tmp_path, driver):
    stated = STATED | ({"CAL_GYRO0_XSCALE": 1.0} if driver else {})
    log = flight(tmp_path, stated)
    single = next(imu for imu in log.imus if imu.name == "sensor_accel")
    bare = as_measured(replace(log, imus=(single,))).imu()
    expected = [0.25, 0.0, 0.0] if driver else [0.0, 0.0, 0.0]  # the file's values are 0
    np.testing.assert_allclose(bare.specific_force.value, np.tile(expected, (2, 1)), atol=1e-9)


@pytest.mark.skipif(not REAL.exists(), reason="no recordings beside the repository")
def test_a_real_log_of_px4_agrees_with_its_own_bare_sensors():
    log = read(REAL)
    for place in range(3):
        mean = {
            kind: as_measured(replace(log, imus=tuple(i for i in log.imus if i.name.startswith(f"{kind}.{place}"))))
            for kind in ("vehicle_imu", "sensor_accel")
        }
        a, b = (log.imu().specific_force.value.mean(axis=0) for log in mean.values())
        np.testing.assert_allclose(a, b, atol=0.03)  # 12 and 6 rows of noise with 0.05 m/s²; without the level 0.5 m/s²


def test_exported_parameters_carry_device_and_instance():
    axes = {a: AxisModel(thermal_bias=((0.0, 0.0), (40.0, 0.1)), bias=0.1) for a in ("gyro_x", "accel_x")}
    own = ImuErrorModel("m", axes, {"gyro device": "2424842", "accel device of part": "3670050", "imu instance": "1"})
    text = thermal_text(own, "px4-tc", 2)[0]
    assert "TC_G2_ID\t2424842" in text
    assert "TC_A2_ID\t3670050" in text
    assert "INS_TCAL2_ENABLE 1" in thermal_text(own, "ardupilot-tcal")[0]
    assert "CAL_GYRO3_ID\t2424842" in calibration_text(own, "px4-cal", 3)[0]
    assert "INS_ACC2OFFS_X 0.1" in calibration_text(own, "ardupilot-ins")[0]
    assert "# set TC_G0_ID" in thermal_text(replace(own, provenance={}), "px4-tc")[0]

"""What autopilots take off before they log, against their own order of corrections, written out here."""

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.estimators.calibration.logged import as_measured, before_logging, taken_off
from imuwb.readers import read
from tests.readers.flight import dataflash_writer as log

PARM = log.Format(143, "PARM", "QNf", "TimeUS,Name,Value")
GYRO = np.array([[0.01 * i, -0.02 + 0.001 * i, 0.03] for i in range(60)])
ACCEL = np.array([[0.1 * i, 1.0, -9.8] for i in range(60)])
CELSIUS = np.linspace(5.0, 65.0, 60)
SETTINGS = {
    "INS_TCAL2_ENABLE": 1, "INS_TCAL2_TMIN": 10, "INS_TCAL2_TMAX": 60, "INS_TCAL2_ACC1_X": 1500.0, "INS_TCAL2_ACC2_X": -20.0,
    "INS_TCAL2_GYR1_Y": 300.0, "INS_TCAL2_GYR3_Y": 0.5, "INS_ACC2OFFS_X": 0.25, "INS_ACC2SCAL_X": 1.02, "INS_ACC2SCAL_Y": 1.0,
    "INS_GYR2OFFS_Y": -0.015, "INS_ACC2_CALTEMP": 40.0, "INS_GYR2_CALTEMP": 38.0, "AHRS_ORIENTATION": 2, "INS_ACCOFFS_Z": 3.0, "SCHED_LOOP_RATE": 400,
}  # fmt: skip


def polynomial(kind, axis, celsius):
    d = np.clip(celsius, SETTINGS["INS_TCAL2_TMIN"], SETTINGS["INS_TCAL2_TMAX"]) - 35.0
    return 1e-6 * sum(SETTINGS.get(f"INS_TCAL2_{kind}{k}_{axis}", 0.0) * d**k for k in (1, 2, 3))


def as_logged():
    """Return gyro and accelerometer as the second IMU of ArduPilot logs them: temperature, offset, scale, YAW_90."""
    gyro, accel = GYRO.copy(), ACCEL.copy()
    for values, kind in ((accel, "ACC"), (gyro, "GYR")):
        for column, axis in enumerate("XYZ"):
            at = SETTINGS[f"INS_{kind}2_CALTEMP"]
            values[:, column] -= polynomial(kind, axis, CELSIUS) - polynomial(kind, axis, at)
            values[:, column] -= SETTINGS.get(f"INS_{kind}2OFFS_{axis}", 0.0)
            if kind == "ACC":
                values[:, column] *= SETTINGS.get(f"INS_ACC2SCAL_{axis}", 1.0)
    return (np.column_stack([-v[:, 1], v[:, 0], v[:, 2]]) for v in (gyro, accel))


def rows(settings, more=()):
    gyro, accel = as_logged()
    yield from log.declared(*log.ALL, PARM)
    yield from ((PARM, (log.START, name, float(value))) for name, value in settings.items())
    for i, (g, a, t) in enumerate(zip(gyro, accel, CELSIUS, strict=True)):
        yield log.IMU, (log.START + 20_000 * i, 1, *g.tolist(), *a.tolist(), float(t))
    yield from ((PARM, (log.START + 10_000, name, value)) for name, value in more)


@pytest.mark.parametrize("form", [log.binary, log.text])
def test_the_values_of_the_sensor_come_back_from_a_log_of_ardupilot(tmp_path, form):
    path = tmp_path / "flight.bin"
    path.write_bytes(form(rows(SETTINGS)))
    flight = read(path)
    assert set(flight.settings) == set(SETTINGS) - {"SCHED_LOOP_RATE"}
    names = taken_off(flight, flight.imu())
    assert "INS_ACC2SCAL_X" in names
    assert not {"INS_ACC2SCAL_Y", "INS_ACCOFFS_Z", "INS_TCAL2_TMIN"} & set(
        names
    )  # neutral, of another IMU, no correction
    bare = as_measured(flight)
    np.testing.assert_allclose(bare.imu().angular_rate.value, GYRO, atol=2e-7)
    np.testing.assert_allclose(bare.imu().specific_force.value, ACCEL, atol=2e-6)
    assert bare.conditioning[-1].name == "as measured"
    (note,) = before_logging([flight, flight], undo=False)[1]
    assert note.id == "corrected-before"
    assert "by INS_TCAL2, INS_ACC2OFFS, INS_ACC2SCAL, INS_GYR2OFFS, AHRS_ORIENTATION:" in note


def test_parameters_that_changed_or_are_not_stated_are_refused(tmp_path):
    path = tmp_path / "flight.bin"
    path.write_bytes(log.binary(rows(SETTINGS, [("INS_GYR2OFFS_Y", 0.5)])))
    with pytest.raises(MissingDataError, match="INS_GYR2OFFS_Y changed while the log was written"):
        as_measured(read(path))
    path.write_bytes(log.binary(rows({"AHRS_ORIENTATION": 101.0, "INS_GYR2OFFS_X": 0.1})))
    with pytest.raises(MissingDataError, match="AHRS_ORIENTATION 101 is a rotation"):
        as_measured(read(path))
    path.write_bytes(log.binary(rows({})))
    with pytest.raises(MissingDataError, match="with its parameters"):
        as_measured(read(path))
    assert before_logging([read(path)], undo=False)[1] == ()

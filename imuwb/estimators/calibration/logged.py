"""What an autopilot took off inertial samples before it logged them, by the parameters in its log, and the samples without that.

ArduPilot (libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp) logs R (((v - t) - o) s): v is the sensor's value, t the
polynomial of temperature, o the offset, s the scale factor of an accelerometer, and R the rotation of the board. PX4
(src/lib/sensor_calibration) logs R ((v - t - o) s) in ``sensor_combined`` and ``vehicle_imu``, and v in ``sensor_accel`` and ``sensor_gyro``.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.estimators.calibration.thermal import subtracted
from imuwb.geodesy import rotation_of_euler
from imuwb.log import Conditioning, ImuStream, Log, Nanoseconds, Triad
from imuwb.notes import Note

_STREAM = re.compile(r"(?:IMU|ACC)([123]?)(?:\.(\d))?(?:\+GYR.*)?")
_PX4 = re.compile(r"(sensor_combined|vehicle_imu)\b.*")
_GROUP = re.compile(r"INS_TCAL\d|INS_\w+(?=_[XYZ]$)|CAL_[A-Z]+\d|TC_[AG]\d|\w+")  #: of a parameter's name, for a note
#: number of AHRS_ORIENTATION -> roll, pitch, yaw (deg). Source: MAV_SENSOR_ORIENTATION
_TURNS: Mapping[int, tuple[int, int, int]] = {
    **{i: (0, 0, 45 * i) for i in range(8)}, **{8 + i: (180, 0, 45 * i) for i in range(8)}, 12: (0, 180, 0),
    **{16 + i: (90, 0, 45 * i) for i in range(4)}, **{20 + i: (270, 0, 45 * i) for i in range(4)}, 24: (0, 90, 0), 25: (0, 270, 0),
    26: (0, 180, 90), 27: (0, 180, 270), 28: (90, 90, 0), 29: (180, 90, 0), 30: (270, 90, 0), 31: (90, 180, 0), 32: (270, 180, 0),
    33: (90, 270, 0), 34: (180, 270, 0), 35: (270, 270, 0), 36: (90, 180, 90), 37: (90, 0, 270),
}  # fmt: skip


def taken_off(log: Log, imu: ImuStream) -> tuple[str, ...]:
    """Return the names of the log's parameters that changed an IMU's samples before they were logged; none is neutral."""
    settings, place = log.settings, _instance(imu.name)
    if _PX4.fullmatch(imu.name):
        form = "|".join(
            (r"CAL_.*(OFF|SCALE)|SENS_BOARD_ROT", *(rf"TC_{s}\d_X.*" for s in "AG" if settings.get(f"TC_{s}_ENABLE")))
        )
    elif place is not None:
        number, thermal = "" if place == 0 else str(place + 1), f"INS_TCAL{place + 1}_"
        form = rf"INS_(ACC{number}(OFFS|SCAL)|GYR{number}OFFS)_[XYZ]|AHRS_ORIENTATION"
        form += rf"|{thermal}(ACC|GYR).*" if settings.get(f"{thermal}ENABLE") == 1.0 else ""
    else:
        return ()
    return tuple(n for n, value in settings.items() if re.fullmatch(form, n) and value != (1.0 if "SCAL" in n else 0.0))


def taken_off_note(log: Log) -> tuple[Note, ...]:
    """Return a note if the samples of the log's first IMU were corrected before they were logged."""
    names = taken_off(log, log.imu()) if log.settings else ()
    groups = dict.fromkeys(match[0] for name in names if (match := _GROUP.match(name)))
    text = (
        f"the autopilot corrected the samples of {log.imu().name} before it logged them, by {', '.join(groups)}: the results are "
        "what this left, not those of the bare sensor"
    )
    return (Note("corrected-before", text),) if names else ()


def before_logging(logs: Sequence[Log], *, undo: bool) -> tuple[list[Log], tuple[Note, ...]]:
    """Return logs as measured, if that is asked for; else the logs, and notes on what was taken off."""
    if undo:
        return [as_measured(log) for log in logs], ()
    return list(logs), tuple(dict.fromkeys(note for log in logs for note in taken_off_note(log)))


def as_measured(log: Log) -> Log:
    """Return a log whose first IMU has the samples that its sensor measured, in the axes of the sensor.

    Raises:
        MissingDataError: the log does not state the parameters, or they changed while it was logged; no temperature, where
            the correction depends on it; samples of which no formula is known.
    """
    imu, where = log.imu(), log.provenance.path
    place = _instance(imu.name)
    if place is None or not any(name.startswith("INS_") for name in log.settings):
        raise MissingDataError(
            f"{where}: {imu.name}: what was taken off before logging is known only of the records IMU, ACC and GYR of a log of "
            "ArduPilot with its parameters (PARM); of a PX4 log, sensor_accel and sensor_gyro are as the sensor measured"
        )
    names = taken_off(log, imu)
    changed = [name for name in names if np.isnan(log.settings[name])]
    if changed:
        raise MissingDataError(
            f"{where}: {', '.join(changed)} changed while the log was written; give a part of the log"
        )
    if not names:
        return log
    turn = int(log.settings.get("AHRS_ORIENTATION", 0))
    if turn not in _TURNS:
        raise MissingDataError(f"{where}: AHRS_ORIENTATION {turn} is a rotation of which no angles are known")
    rotation = rotation_of_euler(np.radians(np.array([_TURNS[turn]], float)))[0]
    rate = _measured(log, imu, imu.angular_rate, rotation, place, accel=False)
    force = _measured(log, imu, imu.specific_force, rotation, place, accel=True)
    note = "by the parameters of the log, in the axes of the sensor"
    step = Conditioning("as measured", ",".join(names), causal=True, delay=0.0, note=note)
    first = replace(imu, angular_rate=rate, specific_force=force)
    imus = tuple(first if other is imu else other for other in log.imus)
    return replace(log, imus=imus, conditioning=(*log.conditioning, step))


def _instance(name: str) -> int | None:
    """Return the number of an IMU of ArduPilot, from 0; None for another stream."""
    match = _STREAM.fullmatch(name)
    if match is None:
        return None
    return int(match[2]) if match[2] else max(int(match[1] or 1) - 1, 0)


def _measured(
    log: Log, imu: ImuStream, triad: Triad | None, rotation: Floats, place: int, *, accel: bool
) -> Triad | None:
    if triad is None:
        return None
    settings, number, prefix = log.settings, "" if place == 0 else str(place + 1), f"INS_TCAL{place + 1}"
    warm = settings.get(f"{prefix}_ENABLE", 0.0) == 1.0
    neutral = {f"{prefix}_TMIN": 0.0, f"{prefix}_TMAX": 70.0}
    neutral |= {f"INS_{kind}{place + 1}_CALTEMP": -300.0 for kind in ("ACC", "GYR")}
    values = neutral | {n: v for n, v in settings.items() if warm or not n.startswith("INS_TCAL")}
    off = subtracted("ardupilot-tcal", values, _celsius(log, imu, triad.time, needed=warm), place)[int(accel)]
    scale = [settings.get(f"INS_ACC{number}SCAL_{axis}", 1.0) for axis in "XYZ"] if accel else [1.0] * 3
    return Triad(triad.time, triad.value @ rotation / np.where(np.array(scale) == 0, 1.0, scale) + off)


def _celsius(log: Log, imu: ImuStream, time: Nanoseconds, *, needed: bool) -> Floats:
    if imu.temperature is None or not len(imu.temperature):
        if needed:
            raise MissingDataError(
                f"{log.provenance.path}: {imu.name} has no temperature, on which its correction depended"
            )
        return np.full(time.size, 25.0)
    return np.interp(time.astype(float), imu.temperature.time.astype(float), imu.temperature.value)

"""What an autopilot took off inertial samples before it logged them, by the parameters in its log, and the samples without that."""

import re
from collections.abc import Sequence
from dataclasses import replace
from types import ModuleType

import numpy as np

from imuwb.errors import MissingDataError
from imuwb.estimators.calibration import logged_ardupilot, logged_px4
from imuwb.log import Conditioning, ImuStream, Log
from imuwb.notes import Note

_AUTOPILOTS: tuple[ModuleType, ...] = (logged_ardupilot, logged_px4)
_GROUP = re.compile(r"INS_TCAL\d|INS_\w+(?=_[XYZ]$)|CAL_[A-Z]+\d|TC_[AG]\d|\w+")  #: of a parameter's name, for a note


def taken_off(log: Log, imu: ImuStream) -> tuple[str, ...]:
    """Return the names of the log's parameters that changed an IMU's samples before they were logged; none is neutral."""
    maker = _maker(log, imu)
    return () if maker is None else maker.taken_off(log, imu)


def taken_off_note(log: Log) -> tuple[Note, ...]:
    """Return a note if the samples of the log's first IMU were corrected before they were logged."""
    names = taken_off(log, log.imu()) if log.settings else ()
    groups = dict.fromkeys(match[0] for name in names if (match := _GROUP.match(name)))
    text = (
        f"the autopilot corrected the samples of {log.imu().name} before it logged them, by {', '.join(groups)}: the results are "
        "what this left, not those of the bare sensor; --as-measured puts it back"
    )
    return (Note("corrected-before", text),) if names else ()


def before_logging(logs: Sequence[Log], *, undo: bool) -> tuple[list[Log], tuple[Note, ...]]:
    """Return logs as measured, if that is asked for; else the logs, and notes on what was taken off."""
    if undo:
        return [as_measured(log) for log in logs], ()
    return list(logs), tuple(dict.fromkeys(note for log in logs for note in taken_off_note(log)))


def sensor_identity(log: Log) -> dict[str, str]:
    """Return which sensor of an autopilot a log's first IMU is, as a model's provenance states it; empty if unknown."""
    imu = log.imu()
    devices = {f"{sensor} device": str(number) for sensor, number in log.devices.get(imu.name, {}).items() if number}
    place = logged_ardupilot.instance(imu.name) if any(name.startswith("INS_") for name in log.settings) else None
    return devices | ({} if place is None else {"imu instance": str(place)})


def as_measured(log: Log) -> Log:
    """Return a log whose first IMU has the samples that its sensor measured, in the axes of the sensor.

    Raises:
        MissingDataError: the log does not state the parameters or the device, or they changed while it was logged; no
            temperature, where the correction depends on it; samples of which no formula is known.
    """
    imu, where = log.imu(), log.provenance.path
    maker = _maker(log, imu)
    if maker is None:
        raise MissingDataError(
            f"{where}: {imu.name}: what was taken off before logging is known only of the records IMU, ACC and GYR of a log of "
            "ArduPilot with its parameters (PARM), and of sensor_combined and vehicle_imu of a log of PX4 with its own"
        )
    names = maker.taken_off(log, imu)
    changed = [name for name in names if np.isnan(log.settings[name])]
    if changed:
        raise MissingDataError(
            f"{where}: {', '.join(changed)} changed while the log was written; give a part of the log"
        )
    if not names:
        return log
    note = "by the parameters of the log, in the axes of the sensor"
    step = Conditioning("as measured", ",".join(names), causal=True, delay=0.0, note=note)
    first = maker.measured(log, imu)
    imus = tuple(first if other is imu else other for other in log.imus)
    return replace(log, imus=imus, conditioning=(*log.conditioning, step))


def _maker(log: Log, imu: ImuStream) -> ModuleType | None:
    """Return the module of the autopilot whose parameters tell what became of an IMU's samples; None if they are not stated."""
    return next((maker for maker in _AUTOPILOTS if maker.tells(log, imu)), None)

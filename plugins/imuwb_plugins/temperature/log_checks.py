"""Whether logs suit an analysis over temperature: rates, duplicates, names and thermometers."""

from collections.abc import Sequence
from dataclasses import replace

from imuwb.axes import axes_of
from imuwb.errors import MissingDataError, UsageError
from imuwb.health import sound_thermometer
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.selection import select
from imuwb_plugins.temperature.parameters import Parameters

SAME_RATE = 0.01  #: largest relative difference of sampling rates between logs


def imu_of(log: Log, parameters: Parameters) -> str:
    """Return the name of the IMU that is analysed: the first that has a temperature, unless the temperatures are given."""
    warm = [imu.name for imu in log.imus if imu.axes() and imu.temperature is not None and len(imu.temperature)]
    return log.imu().name if parameters.celsius or not warm else warm[0]


def check_together(logs: Sequence[Log], parameters: Parameters) -> list[Note]:
    """Return notes on logs that are analysed together.

    Raises:
        UsageError: a log is given twice, rates differ, or --celsius does not have one temperature for each log.
    """
    given = parameters.celsius
    if given and len(given) != len(logs):
        raise UsageError(
            f"--celsius has {len(given)} temperatures for {len(logs)} logs; give one for each, in their order"
        )
    paths = {log.provenance.hash: log.provenance.path for log in logs}
    if len(paths) < len(logs):
        twice = [log.provenance.path for log in logs if paths[log.provenance.hash] != log.provenance.path]
        same = twice[0] if twice else logs[0].provenance.path
        raise UsageError(
            f"{same} is the same as another of the logs; the same noise twice gives no more information: give it once"
        )
    _check_rates(logs)
    names = sorted({log.imu().name for log in logs})
    if len(names) > 1:
        text = f"the IMUs of the logs have different names ({', '.join(names)}); they are taken for one sensor"
        return [Note("different-names", text)]
    return []


def _check_rates(logs: Sequence[Log]) -> None:
    first: dict[str, tuple[float, str]] = {}
    for log in logs:
        for axis in axes_of(log.imu()).values():
            rate, path = 1 / axis.clock.interval, log.provenance.path
            known, first_path = first.setdefault(axis.sensor, (rate, path))
            if abs(rate / known - 1) > SAME_RATE:
                raise UsageError(
                    f"{axis.sensor}: {known:.6g} Hz in {first_path}, {rate:.6g} Hz in {path}; AR(1) and sigma are valid at one rate "
                    f"only: bring the logs to one rate with --through decimate:rate={min(rate, known):.4g}"
                )


#: kinds of faults of a thermometer with which temperatures are wrong
WRONG = ("temperature unit", "stuck thermometer")
LEAST = 600.0  #: s; the part of a log beside a stuck thermometer is taken if it is longer


def with_sound_thermometers(logs: Sequence[Log], parameters: Parameters) -> tuple[list[Log], list[Note]]:
    """Return the logs without the spikes of their thermometers and without the time in which they are stuck, and notes.

    Raises:
        MissingDataError: readings of another unit than °C, or a thermometer that is stuck for nearly all of its log.
    """
    if parameters.celsius:
        return list(logs), []
    sound: list[Log] = []
    notes: list[Note] = []
    for whole in logs:
        log, stuck_notes = _without_stuck(whole)
        notes += stuck_notes
        thermometer, faults = sound_thermometer(log)
        path = log.provenance.path
        for fault in faults:
            if fault.kind in WRONG and fault.severity == "fault":
                span = "" if fault.start is None else f" from {fault.start:.0f} s on"
                raise MissingDataError(f"{path}: {fault.what}{span}; {fault.consequence}; or state --celsius")
            if fault.kind == "temperature spikes":
                text = f"{path}: {fault.what}, at {fault.count} of its readings, the first at {fault.start:.2f} s; they are left out"
                notes.append(Note("thermometer-spikes", text))
            elif fault.severity != "note" or fault.kind in WRONG:
                notes.append(Note("thermometer", f"{path}: {fault.what}: {fault.consequence}"))
        imu = replace(log.imu(), temperature=thermometer)
        sound.append(log if thermometer is None else replace(log, imus=(imu, *log.imus[1:])))
    return sound, notes


def _without_stuck(log: Log) -> tuple[Log, list[Note]]:
    """Return the longer part of a log beside the time in which its thermometer is stuck, and a note; without such a time the log."""
    stuck = [f for f in sound_thermometer(log)[1] if f.kind == WRONG[1] and f.severity == "fault"]
    thermometer = log.imu().temperature
    if not stuck or stuck[0].start is None or thermometer is None:
        return log, []
    start, end = stuck[0].start, stuck[0].start + (stuck[0].length or 0.0)
    last = float(log.seconds(thermometer.time[-1:])[0])
    if max(start, last - end) < LEAST:
        return log, []
    before = start > last - end
    kept = select(log, end=f"{start:.3f}") if before else select(log, start=f"{end:.3f}")
    part = f"{'after' if before else 'before'} {start if before else end:.0f} s"
    text = f"{log.provenance.path}: {stuck[0].what} from {start:.0f} s on: the log {part} is left out"
    return kept, [Note("thermometer-stuck", text)]


def check_thermometers(logs: Sequence[Log], parameters: Parameters) -> list[Note]:
    """Return notes on thermometers that read 0 throughout.

    Raises:
        MissingDataError: all thermometers read 0 throughout, as a disconnected one does.
    """
    if parameters.celsius:
        return []
    readings = [(log, t) for log in logs if (t := log.imu().temperature) is not None and len(t)]
    dead = [log for log, t in readings if not t.value.any()]
    if readings and len(dead) == len(readings):
        raise MissingDataError(
            f"{logs[0].provenance.path}: its temperature is 0 °C throughout{', as in all logs' if len(logs) > 1 else ''}, as of a "
            "disconnected thermometer; give the temperatures: --celsius with one number for each log"
        )
    return [
        Note(
            "thermometer-zero",
            f"{log.provenance.path}: its temperature is exactly 0 °C throughout: a set-point at 0 °C, or a disconnected thermometer",
        )
        for log in dead
    ]

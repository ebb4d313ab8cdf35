"""All faults of a log, and a verdict for each stream."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.health.apart import apart
from imuwb.health.channel import Channel, channels
from imuwb.health.clocks import SHORT, clock_faults
from imuwb.health.fault import LOST, RANK, Fault, repair_faults
from imuwb.health.held import held_rows
from imuwb.health.lone import lone_samples
from imuwb.health.motion import Segment
from imuwb.health.plausibility import felt_gravity, implausible
from imuwb.health.receivers import receiver_faults
from imuwb.health.thermometer import thermometer_faults, thermometer_name
from imuwb.log import ImuStream, Log, Nanoseconds, Repair

WINDOWS = 400  #: number of windows of a log in which the rate of a stream is counted
FEWEST = 20  #: least number of rows in a window
FEWEST_READINGS = 10  #: rows; no stream can be judged by fewer
#: the verdict for each severity of the worst fault, from a note to a fault
VERDICTS = ("good", "usable, with warnings", "not usable as it is")
TOO_SHORT = "too short to judge"  #: the verdict on a stream of so few rows that the checks see no fault


@dataclass(frozen=True, eq=False, slots=True)
class StreamHealth:
    """One stream: its verdict, and its rate over time."""

    name: str
    verdict: str
    faults: int  #: number of faults of the stream and its axes, including notes
    usual_rate: float  #: Hz, the median over time
    time: Floats  #: (w,) s from the log's start
    rate: Floats  #: (w,) Hz


@dataclass(frozen=True, eq=False, slots=True)
class Health:
    """A log's streams and their faults, the worst first."""

    streams: tuple[StreamHealth, ...]
    faults: tuple[Fault, ...]
    segments: tuple[Segment, ...]  #: when one IMU is still and when it moves; empty where the record does not show it
    #: name of that IMU: the first whose record shows it, else the first; None: no IMU was examined
    segments_of: str | None
    still: float  #: s; total time during which that IMU is still
    moving: float  #: s; total time during which that IMU moves
    even: float  #: s; the part of ``moving`` that only a receiver or an odometer shows

    def __repr__(self) -> str:
        """Return the verdict of each stream, and the faults; one line for each."""
        return "\n".join([*(f"{s.name}: {s.verdict}" for s in self.streams), *map(str, self.faults)])


def check(log: Log, *, lines: bool = True, samples: bool = True) -> Health:
    """Return what is wrong with a log.

    Args:
        log: the log.
        lines: look for periodic lines in still records too.
        samples: examine the samples of the IMUs too; this takes most of the time. Clocks, receivers, and the usual size of the
            specific force are always examined.
    """
    faults: list[Fault] = []
    clocks = list(_clocks(log))
    for name, time, repairs, inertial in clocks:
        faults += repair_faults(name, repairs, time.size)
        faults += clock_faults(name, log.seconds(time), inertial=inertial)
    by_imu: dict[str, tuple[Segment, ...]] = {}
    travelled = _travelled(log) if samples else np.empty((0, 2))
    for imu in log.imus:
        axes = channels(log, imu) if samples else {}
        faults += thermometer_faults(log, imu, axes)
        if imu.temperature is not None:
            faults += repair_faults(thermometer_name(imu), imu.temperature.repairs, len(imu.temperature))
        if not samples:
            faults += felt_gravity(log, imu)
        else:
            by_imu[imu.name], own = _examined(log, imu, axes, travelled, lines=lines)
            faults += own
    for gnss in log.gnss:
        faults += receiver_faults(log, gnss)
    faults += apart(log)
    faults.sort(key=lambda fault: (-RANK[fault.severity], fault.kind != LOST))
    thermometers = (
        (thermometer_name(imu), t.time) for imu in log.imus if (t := imu.temperature) is not None and len(t)
    )
    timed = (*((name, time) for name, time, _, _ in clocks), *thermometers)
    streams = tuple(_stream(log, name, time, faults) for name, time in timed)
    return _health(streams, faults, by_imu)


def _health(
    streams: tuple[StreamHealth, ...], faults: Sequence[Fault], by_imu: Mapping[str, tuple[Segment, ...]]
) -> Health:
    """Return the health of a log; the motion is that of the first IMU whose record shows it."""
    shown = next((name for name, own in by_imu.items() if own), next(iter(by_imu), None))
    spans = () if shown is None else by_imu[shown]
    still, moving = (sum(s.length for s in spans if s.moving == moves) for moves in (False, True))
    even = sum(s.length for s in spans if s.even)
    return Health(streams, tuple(faults), spans, shown, still, moving, even)


def _travelled(log: Log) -> Floats:
    """Return when the vehicle travels, (k, 2) s."""
    from imuwb.navigation.travel import travels  # noqa: PLC0415 - clocks and receivers need no scipy

    return travels(log) if log.imus else np.empty((0, 2))


def _examined(
    log: Log, imu: ImuStream, axes: Mapping[str, Channel], travelled: Floats, *, lines: bool
) -> tuple[tuple[Segment, ...], list[Fault]]:
    """Return when an IMU is still and when it moves, and what is wrong with its samples."""
    from imuwb.health.inertial import inertial_faults  # noqa: PLC0415 - clocks and receivers need no compiler
    from imuwb.health.motion import segments  # noqa: PLC0415
    from imuwb.health.turning import turning_faults  # noqa: PLC0415

    if imu.origin.counts:
        sensors = " and ".join(imu.origin.counts)
        unknown = Fault(imu.name, "counts", f"{sensors} are in counts: their values are not judged", "note",
                        consequence="give the scale of the data sheet, or calibrate")  # fmt: skip
        return (), [unknown, *held_rows(imu.name, axes)]
    lone = {axis: lone_samples(channel) for axis, channel in axes.items()}
    spans = segments(axes, lone, travelled)
    own = (
        held_rows(imu.name, axes),
        inertial_faults(imu, axes, lone, spans, lines=lines),
        implausible(log, imu, spans),
        turning_faults(log, imu, spans),
    )
    return spans, [fault for faults in own for fault in faults]


def _clocks(log: Log) -> Iterator[tuple[str, Nanoseconds, tuple[Repair, ...], bool]]:
    """Yield for each stream its name, times, repairs, and whether it is inertial; an IMU with two clocks counts as two streams."""
    for imu in log.imus:
        triads = [t for t in (imu.angular_rate, imu.specific_force) if t is not None]
        same = len(triads) < 2 or np.array_equal(triads[0].time, triads[1].time)  # noqa: PLR2004 - gyro and accelerometer
        for i, triad in enumerate(triads[:1] if same else triads):
            name = imu.name if same else f"{imu.name} {('gyros', 'accelerometers')[i]}"
            yield name, triad.time, imu.origin.repairs if not i else (), True
    for stream in (*log.gnss, *log.references):
        yield stream.name, stream.time, stream.origin.repairs, False
    for speed in log.speeds:
        yield speed.name, speed.time, speed.repairs, False


def is_of(fault: Fault, stream: str) -> bool:
    """Return whether a fault belongs to a stream or to one of its axes."""
    imu, _, sensor = stream.rpartition(" ")
    of_sensor = {"gyros": (f"{imu} gyro_",), "accelerometers": (f"{imu} accel_",), "thermometer": ()}
    return fault.stream == stream or fault.stream.startswith(
        of_sensor.get(sensor, (f"{stream} gyro", f"{stream} accel"))
    )


def _stream(log: Log, name: str, time: Nanoseconds, faults: Sequence[Fault]) -> StreamHealth:
    own = [fault for fault in faults if is_of(fault, name)]
    worst = max((RANK[fault.severity] for fault in own), default=0)
    verdict = VERDICTS[worst]
    if worst < RANK["fault"] and (time.size < FEWEST_READINGS or any(fault.kind == SHORT for fault in own)):
        verdict = TOO_SHORT
    at = log.seconds(time)
    count = int(min(WINDOWS, max(time.size // FEWEST, 1)))
    edges = np.linspace(float(at[0]), float(at[-1]), count + 1)
    width = (edges[-1] - edges[0]) / count
    rows = np.diff(np.searchsorted(at, edges)).astype(float)
    rate = rows / width if width > 0 else np.zeros(count)
    middle = (edges[:-1] + edges[1:]) / 2
    return StreamHealth(name, verdict, len(own), float(np.median(rate)), middle, rate)

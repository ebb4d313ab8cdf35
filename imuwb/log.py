"""The values that every reader makes and every analysis takes.

Conventions of the whole of imuwb:

* SI units: rad/s, m/s², rad for latitude and longitude, m above WGS 84 for height; °C.
* Body frame forward-right-down (FRD), navigation frame north-east-down (NED).
* Time is int64 nanoseconds and strictly increases within a stream. It counts from 1970 UTC if the log states it
  (``epoch="unix"``), else from power-up (``"boot"``) or from the log's start (``"log"``).
* measured = true + bias. A level accelerometer at rest reads -9.8 m/s² on z.

All values are frozen and their arrays read-only, so no analysis changes what a reader made.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers, all_finite, blocks_of, step_range
from imuwb.errors import MissingDataError
from imuwb.geodesy.local_track import LocalTrack
from imuwb.sampling import sampling
from imuwb.texts import rows_text
from imuwb.units import COUNT, SECOND, SENSORS, Epoch

Nanoseconds: TypeAlias = Integers
#: What the rows of a stream are. Readers also yield "velocity" and "fix" rows, which assembly joins to a receiver.
Kind = Literal["imu", "gnss", "velocity", "fix", "speed", "temperature", "reference", "pose", "orientation"]
#: What a repair did to a stream: it left rows out, replaced times, changed the order of rows, or made values doubtful.
Effect = Literal["lost", "time", "order", "value"]

AXES = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
MOST_NOTES = 4  #: notes of a log that an error repeats
MEAN_SEA_LEVEL = "above mean sea level"  #: part of ``Origin.units`` if heights are not above WGS 84
BY_FILTER = "estimated by the vehicle's own filter"  #: part of ``Origin.frame`` of such a stream


def _frozen(
    values: object, dtype: type, shape: tuple[int | None, ...], name: str, *, unknown: bool = False
) -> NDArray[Any]:
    """Return values as a read-only array of a shape (None: any length); ``unknown`` allows nan."""
    array = np.ascontiguousarray(values, dtype=dtype).view()
    if array.ndim != len(shape) or any(n not in (None, m) for n, m in zip(shape, array.shape, strict=True)):
        raise ValueError(f"{name} has shape {array.shape}; it must be {shape}")
    if dtype is np.float64 and not all_finite(array):
        allowed = np.isfinite(array)
        if unknown and not allowed.all():
            allowed |= np.isnan(array)
        if missing := int(allowed.size - np.count_nonzero(allowed)):
            raise ValueError(f"{name} has {missing} values that are not finite; remove their rows")
    array.flags.writeable = False
    return array


def _frozen_time(time: object, name: str) -> Nanoseconds:
    array = _frozen(time, np.int64, (None,), f"{name} time")
    if array.size > 1 and step_range(array)[0] <= 0:
        row = int(np.argmax(np.diff(array) <= 0)) + 1
        raise ValueError(f"{name} time must increase; row {row} has {array[row]} ns after {array[row - 1]} ns")
    return array


def _store(target: object, /, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(target, name, value)


def _freeze_columns(stream: Any, names: tuple[str, ...], known: tuple[str, ...] = ()) -> None:  # noqa: ANN401 - a stream
    """Freeze the time and the (n, 3) columns of a stream; nan is allowed, except in ``known`` columns."""
    time = _frozen_time(stream.time, stream.name)
    _store(stream, time=time)
    for name in names:
        values = getattr(stream, name)
        if values is not None:
            label = f"{stream.name} {name}"
            frozen = _frozen(values, np.float64, (time.size, 3), label, unknown=name not in known)
            _store(stream, **{name: frozen})


def _line(name: str, kind: str, time: Nanoseconds, *more: str) -> str:
    """Return a stream in a line: name, kind, rows, rate, duration, gaps, and more."""
    clock = sampling(time)
    seconds = float(time[-1] - time[0]) / SECOND if time.size else 0.0
    return ", ".join((f"{name}: {kind}", rows_text(time.size, clock.rate, seconds, clock.gaps), *filter(None, more)))


class _Timed:
    """Base of streams with one clock: gives their length, and their text in one line."""

    __slots__ = ()
    time: Nanoseconds

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.time.size

    def __repr__(self) -> str:
        """Return name, kind, rows, rate, duration, gaps, units and frame in a line."""
        kind, origin = type(self).__name__.removesuffix("Stream").lower(), getattr(self, "origin", None)
        more = (origin.units, origin.frame) if origin is not None else ()
        return _line(getattr(self, "name", "sensors"), kind, self.time, *more)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Triad(_Timed):
    """Three orthogonal sensors with one clock, or one or two of them, such as a single fibre-optic gyro."""

    time: Nanoseconds  #: (n,) ns
    value: Floats  #: (n, 3) rad/s or m/s², FRD; an axis that the sensor does not have is nan throughout

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, "triad")
        value = _frozen(self.value, np.float64, (time.size, 3), "triad value", unknown=True)
        _store(self, time=time, value=value)
        if not (value.size and np.isnan(value.min())):
            return
        unknown = np.isnan(value)
        absent = unknown.all(axis=0)
        missing = int(np.count_nonzero(unknown if absent.all() else unknown[:, ~absent]))
        if missing:
            raise ValueError(f"triad value has {missing} values that are not finite; remove their rows")

    @property
    def axes(self) -> str:
        """Return the letters of the axes that the sensor has: "xyz", or fewer."""
        first = self.value[0].tolist() if len(self) else (0.0, 0.0, 0.0)
        return "".join(axis for axis, value in zip("xyz", first, strict=True) if not math.isnan(value))


@dataclass(frozen=True, slots=True)
class Repair:
    """Something that a reader repaired, and how often."""

    what: str
    count: int
    effect: Effect = "lost"


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Scalars(_Timed):
    """One quantity over time: a temperature (°C) or a speed (m/s, forward positive)."""

    name: str
    time: Nanoseconds  #: (n,) ns
    value: Floats  #: (n,)
    repairs: tuple[Repair, ...] = ()  #: of these values alone; the others are those of the stream that they belong to

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, self.name)
        _store(self, time=time, value=_frozen(self.value, np.float64, (time.size,), self.name))


@dataclass(frozen=True, slots=True)
class Origin:
    """Units, frame and clock of a stream in its file, before the conversion to SI and FRD, and its repairs."""

    units: str = "SI"
    frame: str = "FRD"
    epoch: Epoch = "log"
    repairs: tuple[Repair, ...] = ()

    @property
    def counts(self) -> tuple[str, ...]:
        """The sensors, gyro or accel, whose samples are counts of an unknown scale (``--units gyro=count``)."""
        return tuple(sensor for sensor in SENSORS if f"{sensor} {COUNT}" in self.units.split(", "))

    @property
    def above_sea(self) -> bool:
        """Whether heights are above mean sea level, because the file has none above WGS 84."""
        return MEAN_SEA_LEVEL in self.units

    @property
    def by_filter(self) -> bool:
        """Whether the stream is an estimate of the vehicle's own filter, which has used the log's own fixes."""
        return BY_FILTER in self.frame


@dataclass(frozen=True, eq=False, slots=True)
class ImuStream:
    """An inertial measurement unit. Its gyro and accelerometer triads may have different clocks."""

    name: str
    angular_rate: Triad | None  #: rad/s
    specific_force: Triad | None  #: m/s²
    temperature: Scalars | None = None  #: °C
    origin: Origin = field(default_factory=Origin)

    def axes(self) -> dict[str, tuple[Nanoseconds, Floats]]:
        """Return {axis: (time, values)}, from ``gyro_x`` to ``accel_z``, of the axes that the IMU has."""
        triads = {"gyro": self.angular_rate, "accel": self.specific_force}
        return {
            f"{sensor}_{axis}": (triad.time, triad.value[:, column])
            for sensor, triad in triads.items()
            if triad is not None
            for column, axis in enumerate("xyz")
            if axis in triad.axes
        }

    def sensors(self) -> dict[str, Triad]:
        """Return {name: triad} with one entry per clock: the IMU's name, or its name with gyro and accelerometer."""
        rate, force = self.angular_rate, self.specific_force
        if rate is not None and force is not None and not np.array_equal(rate.time, force.time):
            return {f"{self.name} (gyro)": rate, f"{self.name} (accelerometer)": force}
        triad = rate if rate is not None else force
        return {} if triad is None else {self.name: triad}

    def __repr__(self) -> str:
        """Return each clock of the IMU in a line: name, kind, rows, rate, duration, gaps, units and frame."""
        origin, axes = self.origin, self.axes()
        only = "" if len(axes) % 3 == 0 else f"only {', '.join(axes)}"
        lines = [
            _line(name, "imu", triad.time, origin.units, origin.frame, only) for name, triad in self.sensors().items()
        ]
        if self.temperature is not None:
            lines.append(_line(self.temperature.name, "temperature", self.temperature.time, "°C"))
        return "\n".join(lines) or f"{self.name}: imu without samples"


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class GnssStream(_Timed):
    """The fixes of a GNSS receiver.

    ``fix_type`` is numbered as in MAVLink: 1 no fix, 2 2D, 3 3D, 4 differential, 5 RTK float, 6 RTK fixed. A value that the
    receiver does not state, such as a vertical velocity or a sigma, is nan, never 0.
    """

    name: str
    time: Nanoseconds  #: (n,) ns
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m above WGS 84
    velocity: Floats | None = None  #: (n, 3) m/s, NED
    position_sigma: Floats | None = None  #: (n, 3) m, NED, stated by the receiver
    velocity_sigma: Floats | None = None  #: (n, 3) m/s, NED, stated by the receiver
    fix_type: Integers | None = None  #: (n,)
    origin: Origin = field(default_factory=Origin)

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        _freeze_columns(self, ("position", "velocity", "position_sigma", "velocity_sigma"), known=("position",))
        if self.fix_type is not None:
            _store(self, fix_type=_frozen(self.fix_type, np.int64, (self.time.size,), f"{self.name} fix_type"))


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Reference(_Timed):
    """A trajectory with which solutions are compared: truth, or, if its origin says so, an estimate of the vehicle's filter.

    A sigma that is not known is nan.
    """

    name: str
    time: Nanoseconds  #: (n,) ns
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m above WGS 84
    velocity: Floats | None = None  #: (n, 3) m/s, NED
    attitude: Floats | None = None  #: (n, 3) roll, pitch, heading of C_b_n, rad
    origin: Origin = field(default_factory=Origin)
    position_sigma: Floats | None = None  #: (n, 3) m, NED
    velocity_sigma: Floats | None = None  #: (n, 3) m/s, NED
    attitude_sigma: Floats | None = None  #: (n, 3) rad, about north, east and down
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: m FRD, from the IMU to the point of the trajectory

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        columns = ("position", "velocity", "attitude")
        _freeze_columns(self, (*columns, "position_sigma", "velocity_sigma", "attitude_sigma"), known=columns)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Orientation(_Timed):
    """The attitude that an IMU states itself, for example with a magnetometer; its north may be any direction."""

    name: str  #: that of the IMU
    time: Nanoseconds  #: (n,) ns
    quaternion: Floats  #: (n, 4) w, x, y, z of the IMU's FRD axes relative to NED
    sigma: Floats | None = None  #: (n, 3) rad, about north, east and down, stated by the IMU; nan: not stated
    origin: Origin = field(default_factory=Origin)

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        _freeze_columns(self, ("sigma",))
        quaternion = _frozen(self.quaternion, np.float64, (self.time.size, 4), f"{self.name} quaternion")
        _store(self, quaternion=quaternion)


@dataclass(frozen=True, slots=True)
class Provenance:
    """The file that a log was read from, and its reader's format."""

    path: str  #: or its address, without secrets
    format: str
    hash: str  #: "sha256:..." of the file's bytes; of a part of a large file, "sha256-ends:..." of its size, first and last MiB
    size: int  #: bytes
    selection: str = ""  #: the part in time that was kept, as text; empty: all


@dataclass(frozen=True, slots=True)
class Conditioning:
    """What a conditioner did to a log's samples."""

    name: str  #: the conditioner's name
    parameters: str  #: the parameters as they follow the name on the command line
    causal: bool  #: whether no sample depends on later samples, apart from the delay
    delay: float  #: s; the samples lag the motion by this time
    note: str = ""
    band: float | None = None  #: Hz; up to this frequency a spectrum changes by at most 1 %; None: at every frequency
    without_mean: tuple[str, ...] = ()  #: sensors (gyro, accel) whose mean was removed, that of gravity too


@dataclass(frozen=True, eq=False, slots=True)
class Log:
    """The streams of one file in one form, whatever the file's format."""

    provenance: Provenance
    imus: tuple[ImuStream, ...] = ()
    gnss: tuple[GnssStream, ...] = ()
    speeds: tuple[Scalars, ...] = ()
    references: tuple[Reference, ...] = ()
    notes: tuple[str, ...] = ()
    poses: tuple[LocalTrack, ...] = ()  #: trajectories in frames of their own, such as those of odometry
    orientations: tuple[Orientation, ...] = ()  #: attitudes that IMUs state themselves
    zero: int | None = None  #: ns; start of "seconds from the log's start", also for a part of the log
    conditioning: tuple[Conditioning, ...] = ()  #: in the order in which they were applied
    #: parameters that a simulator put in, apart from the sensor's error model: name -> value with its SI unit
    truth: Mapping[str, str] = field(default_factory=dict[str, str])
    #: parameters by which an autopilot corrected the samples before it logged them; nan: changed while it logged
    settings: Mapping[str, float] = field(default_factory=dict[str, float])
    #: numbers of the devices that IMUs' samples come from, as an autopilot states them: IMU -> "gyro" or "accel" -> number
    devices: Mapping[str, Mapping[str, int]] = field(default_factory=dict[str, Mapping[str, int]])

    def __post_init__(self) -> None:
        """Set ``zero`` to the start of the earliest stream unless it is given."""
        if self.zero is None:
            triads = [t for imu in self.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
            timed = (*triads, *self.gnss, *self.speeds, *self.references)
            _store(self, zero=min((int(x.time[0]) for x in timed if len(x)), default=0))

    def __repr__(self) -> str:
        """Return a line with path and format, then a line for each stream."""
        where = self.provenance
        cut = f", {where.selection}" if where.selection else ""
        streams = [str(stream) for stream in (*self.imus, *self.gnss, *self.references)]
        speeds = [_line(speed.name, "speed", speed.time, "m/s") for speed in self.speeds]
        return "\n".join((f"{where.path} ({where.format}{cut})", *(streams + speeds or ["no streams"])))

    def imu(self) -> ImuStream:
        """Return the first IMU.

        Raises:
            MissingDataError: the log has no IMU; the message lists its other streams.
        """
        for imu in self.imus:
            if imu.angular_rate is not None or imu.specific_force is not None:
                return imu
        temperatures = [imu.temperature for imu in self.imus if imu.temperature is not None]
        others = (
            ", ".join(stream.name for stream in (*temperatures, *self.gnss, *self.references))
            or "no stream that imuwb reads"
        )
        why = f"; {'; '.join(self.notes[:MOST_NOTES])}" if self.notes else ""
        raise MissingDataError(
            f"{self.provenance.path}: the log has no IMU, which the analysis needs; it has {others}{why}"
        )

    def streams(self) -> tuple[ImuStream | GnssStream | Scalars | Reference, ...]:
        """Return all streams.

        Raises:
            MissingDataError: the log has no stream; the message gives the notes of its reader.
        """
        if streams := (*self.imus, *self.gnss, *self.speeds, *self.references):
            return streams
        why = "; ".join(self.notes) or "it contains nothing that imuwb reads"
        raise MissingDataError(f"{self.provenance.path}: the log has no usable stream: {why}")

    @property
    def causal(self) -> bool:
        """Whether no sample depends on later samples."""
        return all(step.causal for step in self.conditioning)

    @property
    def band(self) -> float:
        """The frequency (Hz) up to which conditioning keeps spectra; infinite without conditioning."""
        return min((step.band for step in self.conditioning if step.band is not None), default=math.inf)

    def seconds(self, time: Nanoseconds) -> Floats:
        """Return times of a stream in seconds from the log's start."""
        seconds = np.empty(time.size)
        for rows in blocks_of(time.size):  # no second array of the size of a long stream
            seconds[rows] = (time[rows] - (self.zero or 0)) / SECOND
        return seconds


def source_of(log: Log) -> str:
    """Return path, hash and conditioning of a log: the provenance of what is computed from it."""
    steps = "".join(f" through {step.name}:{step.parameters}" for step in log.conditioning)
    return f"{log.provenance.path} {log.provenance.hash}{steps}"

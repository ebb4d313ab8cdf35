"""The values that every reader makes and every analysis takes.

Conventions, once for the whole of imuwb:

* SI inside: rad/s, m/s², rad for latitude and longitude, m above WGS 84 for height; °C.
* Body frame forward-right-down (FRD), navigation frame north-east-down (NED).
* Time is int64 nanoseconds, strictly increasing in a stream: since the Unix epoch (UTC) where the
  log knows it (``epoch="unix"``), since power-up (``"boot"``), else since the log's start (``"log"``).
* measured = true + bias. A still accelerometer, level, reads -9.8 m/s² on z.

All values are frozen and their arrays read-only: what a reader made, no analysis changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from imuwb.errors import MissingDataError

Floats: TypeAlias = NDArray[np.float64]
Nanoseconds: TypeAlias = NDArray[np.int64]
Epoch = Literal["unix", "boot", "log"]
#: What a repair did to a stream: left rows out, set times anew, put rows in another order, made up values.
Effect = Literal["lost", "time", "order", "value"]

AXES = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
SECOND = 1_000_000_000  # nanoseconds
MEAN_SEA_LEVEL = "above mean sea level"  #: in an origin's units, where heights are not above WGS 84


def _frozen(
    values: object, dtype: type, shape: tuple[int | None, ...], what: str, *, unknown: bool = False
) -> NDArray[Any]:
    """Return ``values`` as a read-only array of that shape (None: any length), all finite but for nan, if that is allowed."""
    array = np.ascontiguousarray(values, dtype=dtype).view()
    if array.ndim != len(shape) or any(n not in (None, m) for n, m in zip(shape, array.shape, strict=True)):
        message = f"{what} has shape {array.shape}; it must be {shape}"
        raise ValueError(message)
    if dtype is np.float64 and not (np.isfinite(array) | (np.isnan(array) if unknown else False)).all():
        message = f"{what} holds {np.count_nonzero(~np.isfinite(array))} values that are not finite"
        raise ValueError(message)
    array.flags.writeable = False
    return array


def _frozen_time(time: object, what: str) -> Nanoseconds:
    array = _frozen(time, np.int64, (None,), f"{what} time")
    steps = np.diff(array)
    if array.size > 1 and steps.min() <= 0:
        at = int(np.argmax(steps <= 0)) + 1
        message = f"{what} time does not increase at row {at}: {array[at - 1]} then {array[at]} ns"
        raise ValueError(message)
    return array


def _store(target: object, /, **fields: object) -> None:
    for name, content in fields.items():
        object.__setattr__(target, name, content)


@dataclass(frozen=True, eq=False, slots=True)
class Triad:
    """Three orthogonal sensors on one clock."""

    time: Nanoseconds  #: (n,) ns
    value: Floats  #: (n, 3) rad/s or m/s², FRD

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, "triad")
        _store(self, time=time, value=_frozen(self.value, np.float64, (time.size, 3), "triad value"))

    def __len__(self) -> int:
        """Return the number of samples."""
        return self.time.size


@dataclass(frozen=True, eq=False, slots=True)
class Scalars:
    """One quantity over time: a temperature (°C), a speed (m/s, forward positive)."""

    name: str
    time: Nanoseconds  #: (n,) ns
    value: Floats  #: (n,)

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, self.name)
        _store(self, time=time, value=_frozen(self.value, np.float64, (time.size,), self.name))

    def __len__(self) -> int:
        """Return the number of samples."""
        return self.time.size


@dataclass(frozen=True, slots=True)
class Repair:
    """Something a reader mended, and how often."""

    what: str
    count: int
    effect: Effect = "lost"


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a stream's numbers come from: what the file held before it became SI and FRD."""

    units: str = "SI"
    frame: str = "FRD"
    epoch: Epoch = "log"
    repairs: tuple[Repair, ...] = ()

    @property
    def above_sea(self) -> bool:
        """Whether heights are above mean sea level, for want of those above WGS 84."""
        return MEAN_SEA_LEVEL in self.units


@dataclass(frozen=True, eq=False, slots=True)
class ImuStream:
    """An inertial measurement unit. Gyro and accelerometer triads need not share a clock."""

    name: str
    angular_rate: Triad | None  #: rad/s
    specific_force: Triad | None  #: m/s²
    temperature: Scalars | None = None  #: °C
    origin: Origin = field(default_factory=Origin)

    def axes(self) -> dict[str, tuple[Nanoseconds, Floats]]:
        """Return {axis name: (time, values)} of what there is, ``gyro_x`` ... ``accel_z``."""
        triads = {"gyro": self.angular_rate, "accel": self.specific_force}
        return {
            f"{sensor}_{axis}": (triad.time, triad.value[:, column])
            for sensor, triad in triads.items()
            if triad is not None
            for column, axis in enumerate("xyz")
        }


@dataclass(frozen=True, eq=False, slots=True)
class GnssStream:
    """A GNSS receiver's fixes. ``fix_type`` counts as MAVLink does: 1 none, 3 3D, 5 float, 6 RTK fixed.

    What a receiver does not tell of a fix, such as a vertical velocity or a sigma, is nan, never 0.
    """

    name: str
    time: Nanoseconds  #: (n,) ns
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m above WGS 84
    velocity: Floats | None = None  #: (n, 3) m/s, NED
    position_sigma: Floats | None = None  #: (n, 3) m, NED, as the receiver claims
    velocity_sigma: Floats | None = None  #: (n, 3) m/s, NED, likewise
    fix_type: NDArray[np.int64] | None = None  #: (n,)
    origin: Origin = field(default_factory=Origin)

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, self.name)
        _store(self, time=time)
        for name in ("position", "velocity", "position_sigma", "velocity_sigma"):
            array, what = getattr(self, name), f"{self.name} {name}"
            if array is not None:
                unknown = name != "position"
                _store(self, **{name: _frozen(array, np.float64, (time.size, 3), what, unknown=unknown)})
        if self.fix_type is not None:
            _store(self, fix_type=_frozen(self.fix_type, np.int64, (time.size,), f"{self.name} fix type"))

    def __len__(self) -> int:
        """Return the number of fixes."""
        return self.time.size


@dataclass(frozen=True, eq=False, slots=True)
class Reference:
    """A trajectory that is better than what is judged by it."""

    name: str
    time: Nanoseconds  #: (n,) ns
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats | None = None  #: (n, 3) m/s, NED
    attitude: Floats | None = None  #: (n, 3) roll, pitch, heading of C_b_n, rad
    origin: Origin = field(default_factory=Origin)

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        time = _frozen_time(self.time, self.name)
        _store(self, time=time)
        for name in ("position", "velocity", "attitude"):
            array = getattr(self, name)
            if array is not None:
                _store(self, **{name: _frozen(array, np.float64, (time.size, 3), f"{self.name} {name}")})

    def __len__(self) -> int:
        """Return the number of epochs."""
        return self.time.size


@dataclass(frozen=True, slots=True)
class Provenance:
    """Which file a log was read from, by what."""

    path: str
    format: str
    hash: str  #: "sha256:..." of the file's bytes
    size: int  #: bytes
    selection: str = ""  #: what was read of it, as text; empty: all


@dataclass(frozen=True, slots=True)
class Conditioning:
    """What was done to a log's samples after it was read."""

    name: str  #: of the conditioner
    parameters: str  #: as one writes them behind its name
    causal: bool  #: whether no sample knows of later ones, but for the delay
    delay: float  #: s, by which what is seen in a sample is late, or a sample comes late
    note: str = ""
    band: float | None = None  #: Hz, up to which it leaves a spectrum as it was, to a hundredth; None: everywhere


@dataclass(frozen=True, eq=False, slots=True)
class Log:
    """What one file holds, in one normal form: after reading, nobody can tell the format."""

    provenance: Provenance
    imus: tuple[ImuStream, ...] = ()
    gnss: tuple[GnssStream, ...] = ()
    speeds: tuple[Scalars, ...] = ()
    references: tuple[Reference, ...] = ()
    notes: tuple[str, ...] = ()
    zero: int | None = None  #: ns; what seconds "from the log's start" count from, also in a part of it
    conditioning: tuple[Conditioning, ...] = ()  #: in order

    def __post_init__(self) -> None:
        """Begin where the earliest stream does, unless told."""
        if self.zero is None:
            triads = [t for imu in self.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
            timed = (*triads, *self.gnss, *self.speeds, *self.references)
            _store(self, zero=min((int(x.time[0]) for x in timed if len(x)), default=0))

    def imu(self) -> ImuStream:
        """Return the IMU, or the first of several.

        Raises:
            MissingDataError: there is none; the message says what there is.
        """
        if self.imus:
            return self.imus[0]
        there = ", ".join(stream.name for stream in (*self.gnss, *self.references)) or "nothing that is read"
        message = f"{self.provenance.path}: no IMU in this log (it has {there}), and the analysis needs one"
        raise MissingDataError(message)

    def streams(self) -> tuple[ImuStream | GnssStream | Scalars | Reference, ...]:
        """Return all streams.

        Raises:
            MissingDataError: there is none; the message says what was found instead.
        """
        if found := (*self.imus, *self.gnss, *self.speeds, *self.references):
            return found
        why = "; ".join(self.notes) or "nothing in it is of a kind that imuwb reads"
        message = f"{self.provenance.path}: no stream that can be used: {why}"
        raise MissingDataError(message)

    @property
    def causal(self) -> bool:
        """Whether no sample was made of later ones."""
        return all(step.causal for step in self.conditioning)

    @property
    def band(self) -> float:
        """Return the frequency, Hz, up to which conditioning has left a spectrum as it was; infinite where everywhere."""
        return min((step.band for step in self.conditioning if step.band is not None), default=math.inf)

    def seconds(self, time: Nanoseconds) -> Floats:
        """Return times of a stream in s from the log's start."""
        return (time - (self.zero or 0)) / SECOND


def source_of(log: Log) -> str:
    """Return where a log's samples come from, for the provenance of what is made of them: path, hash, conditioning."""
    steps = "".join(f" through {step.name}:{step.parameters}" for step in log.conditioning)
    return f"{log.provenance.path} {log.provenance.hash}{steps}"

"""Makes a Log from a reader's batches: joins them, repairs their times, and counts every repair."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from imuwb.arrays import Booleans, Floats, all_finite
from imuwb.geodesy import rotation_of_quaternion
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import (
    GnssStream,
    ImuStream,
    Kind,
    Log,
    Orientation,
    Provenance,
    Reference,
    Repair,
    Scalars,
    Triad,
)
from imuwb.notes import Note
from imuwb.readers.assembly.growing import GrowingRows
from imuwb.readers.assembly.interleaved import sensors_in_turn, turns
from imuwb.readers.assembly.sample_times import Clock, sample_times
from imuwb.readers.assembly.siblings import sibling, with_fix_rows, with_parts_joined
from imuwb.readers.assembly.time_order import in_order, taken
from imuwb.readers.assembly.without_fix import fix_types, without_unfixed
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.budget import Budget

Key = tuple[str, Kind, tuple[str, ...]]

TRIADS = ("angular_rate", "specific_force")
#: kind -> the columns it may have
_COLUMNS = {
    "imu": (*TRIADS, "temperature"),
    "gnss": ("position", "velocity", "position_sigma", "velocity_sigma", "fix_type"),
    "reference": ("position", "velocity", "attitude", "position_sigma", "velocity_sigma", "attitude_sigma"),
    "pose": ("position", "quaternion", "position_sigma"),
    "orientation": ("quaternion", "sigma"),
    "velocity": ("velocity", "velocity_sigma"),
    "fix": ("fix_type",),
    "speed": ("speed",),
    "temperature": ("temperature",),
}
#: kind -> its columns that may be nan
_SIGMAS = ("position_sigma", "velocity_sigma")
_MAY_BE_UNKNOWN: dict[Kind, tuple[str, ...]] = {
    "gnss": ("velocity", *_SIGMAS, "fix_type"), "velocity": ("velocity", *_SIGMAS, "fix_type"),
    "reference": (*_SIGMAS, "attitude_sigma"), "pose": _SIGMAS,
    "orientation": ("sigma",),
}  # fmt: skip
_SHOWN: tuple[Kind, ...] = ("imu", "gnss", "speed", "temperature", "pose", "orientation")
NOT_FINITE = Repair(Note("not_finite", "rows with a value that is not a number left out"), 0)


def assemble(
    parts: Iterable[Batch | Remark],
    provenance: Provenance,
    *,
    rate: float | None = None,
    even: bool = False,
    budget: Budget = Budget(),  # noqa: B008 - a frozen value
) -> Log:
    """Return the log of a reader's batches and remarks.

    Rows with a value that is not finite are left out. Rows that are out of order by less than a second are sorted. A row that
    repeats the time and all values of the row before is left out. If a clock is set back by more than a second, the time after it
    goes on by one usual step. Even samples whose stamps are not even get even times. Each repair is counted in the stream's
    ``origin``. Rows in which a receiver states that it has no fix are left out.

    Args:
        parts: what the reader yields.
        provenance: the file.
        rate: Hz, the rate of the IMUs, if the user states it; it beats their stamps.
        even: the samples of the IMUs are even, as the user states.
        budget: the memory that the rows may take.

    Raises:
        OverBudgetError: the rows take more.
    """
    truth: dict[str, str] = {}
    settings: dict[str, float] = {}
    devices: dict[str, Mapping[str, int]] = {}
    groups, repairs, notes = _grouped(_stated(parts, truth, settings, devices), provenance.size, budget)
    streams: list[Batch] = []
    for (stream, kind, _), group in groups.items():
        rows = _joined(group, repairs.pop(stream, []))
        if not rows.time.size:
            lost = sum(repair.count for repair in rows.origin.repairs)
            notes.append(Note("no_usable_row", f"{stream} ({kind}): none of its {lost} rows can be used"))
            continue
        sensors = _parted(rows)
        if len(sensors) > 1:
            text = f"{stream}: its rows are those of {len(sensors)} sensors that take turns at equal stamps"
            notes.append(Note("in_turn", f"{text}; they are read as {', '.join(rows.stream for rows in sensors)}"))
        streams.extend(_timed(sensor, rate, even=even) for sensor in sensors)
    notes.extend(_repair_notes(streams, repairs))
    return replace(_log(provenance, streams, notes), truth=truth, settings=settings, devices=devices)


def _stated(
    parts: Iterable[Batch | Remark],
    truth: dict[str, str],
    settings: dict[str, float],
    devices: dict[str, Mapping[str, int]],
) -> Iterator[Batch | Remark]:
    """Yield the parts, and collect the parameters and devices that a simulator or an autopilot stated."""
    for part in parts:
        if isinstance(part, Remark):
            truth.update(part.truth)
            settings.update(part.settings)
            devices.update(part.devices)
            if not part.text:
                continue
        yield part


def _grouped(
    parts: Iterable[Batch | Remark], size: int, budget: Budget
) -> tuple[dict[Key, GrowingRows], dict[str, list[Repair]], list[str]]:
    """Return rows by stream and columns, repairs by stream, and notes."""
    groups: dict[Key, GrowingRows] = {}
    repairs: dict[str, list[Repair]] = defaultdict(list)
    notes: dict[str, None] = {}  # in order
    held = 0
    for part in parts:
        if isinstance(part, Batch):
            held += part.time.nbytes + sum(values.nbytes for values in part.columns.values())
            budget.check(held, "its rows")
            for piece in _pieces(part):
                key = piece.stream, piece.kind, tuple(piece.columns)
                if key not in groups:
                    groups[key] = GrowingRows(piece, size, budget.most)
                groups[key].add(piece)
        elif part.stream:
            repairs[part.stream].append(Repair(part.text, part.count, part.effect))
        else:  # files that are one log may give one note
            notes.setdefault(part.text)
    return groups, repairs, list(notes)


def _pieces(batch: Batch) -> tuple[Batch, ...]:
    """Return a batch, or two for an IMU with a temperature: motion and temperature, because some rows may lack the temperature."""
    if batch.kind not in _COLUMNS or not set(batch.columns) <= set(_COLUMNS[batch.kind]):
        raise ValueError(
            f"{batch.stream}: a batch of kind {batch.kind} cannot have the columns {', '.join(batch.columns)}"
        )
    if batch.kind != "imu" or "temperature" not in batch.columns or len(batch.columns) == 1:
        return (batch,)
    motion = {name: values for name, values in batch.columns.items() if name != "temperature"}
    return replace(batch, columns=motion), replace(batch, columns={"temperature": batch.columns["temperature"]})


def _joined(group: GrowingRows, repairs: list[Repair]) -> Batch:
    """Return rows as one batch, in the order of time; its repairs are those given, then those made here."""
    first = group.first
    time, columns = group.taken()
    repairs = [*first.origin.repairs, *repairs]
    finite = finite_rows(first.kind, time.size, columns)
    if not finite.all():
        repairs.append(replace(NOT_FINITE, count=int(np.count_nonzero(~finite))))
        time, columns = taken(time, columns, finite)
    time, columns = in_order(time, columns, repairs)
    origin = replace(first.origin, repairs=tuple(repairs))
    return replace(first, time=time, columns=columns, origin=origin)


def _parted(rows: Batch) -> list[Batch]:
    """Return the rows of an IMU sensor by sensor, where several take turns."""
    sensors = sensors_in_turn(rows.time, dict(rows.columns)) if rows.kind == "imu" else 1
    if sensors == 1:
        return [rows]
    turn = turns(rows.time, sensors)
    parts: list[Batch] = []
    for sensor in range(sensors):
        time, columns = taken(rows.time, dict(rows.columns), turn == sensor)
        parts.append(replace(rows, stream=f"{rows.stream}.{sensor}", time=time, columns=columns))
    return parts


def _timed(rows: Batch, rate: float | None, *, even: bool) -> Batch:
    """Return the rows with their times, and the repairs of these."""
    repairs = list(rows.origin.repairs)
    time, columns = sample_times(rows.time, dict(rows.columns), Clock(rows.kind, rows.exact, rate, even), repairs)
    return replace(rows, time=time, columns=columns, origin=replace(rows.origin, repairs=tuple(repairs)))


def finite_rows(kind: Kind, rows: int, columns: Mapping[str, Floats]) -> Booleans:
    """Return which rows are finite in all columns, except the columns that may be unknown."""
    finite = np.ones(rows, dtype=bool)
    for name, values in columns.items():
        if name in _MAY_BE_UNKNOWN.get(kind, ()) or all_finite(values):
            continue
        known = np.isfinite(values)
        if name in TRIADS:
            there = ~np.isnan(values).all(axis=0)  # a sensor may have one axis or two
            known = known[:, there] if there.any() else known
        finite &= known if values.ndim == 1 else known.all(axis=1)
    return finite


def _axes_notes(imus: Iterable[ImuStream]) -> Iterator[Note]:
    """Yield a note for each IMU with a sensor that lacks an axis."""
    for imu in imus:
        if any(triad is not None and triad.axes != "xyz" for triad in (imu.angular_rate, imu.specific_force)):
            lacks = imu.specific_force is not None and imu.specific_force.axes != "xyz"
            more = "; without three axes of an accelerometer |f| cannot be compared with gravity" if lacks else ""
            yield Note("axes_missing", f"{imu.name}: it has only {', '.join(imu.axes())}{more}")


def _repair_notes(streams: list[Batch], unused: dict[str, list[Repair]]) -> Iterator[Note]:
    """Yield the repairs of streams whose repairs a summary does not show, and the repairs of streams without rows."""
    # The poses of an odometry are rows of its speed too, and an orientation's those of its IMU; the repairs are the same.
    shown = {(r.stream, r.kind) for r in streams if r.kind in _SHOWN}
    hidden = [(r.stream, repair) for r in streams if (r.stream, r.kind) not in shown for repair in r.origin.repairs]
    for stream, repair in (*hidden, *((stream, repair) for stream, repairs in unused.items() for repair in repairs)):
        yield Note(getattr(repair.what, "id", "repair"), f"{stream}: {repair.what} ({repair.count})")


def _log(provenance: Provenance, streams: list[Batch], notes: list[str]) -> Log:
    """Return the log of all rows; rows that belong to another stream are joined to it."""
    of: dict[str, list[Batch]] = defaultdict(list)
    for rows in streams:
        of[rows.kind].append(rows)
    imus, imu_notes = _imus(of["imu"], [_scalars(r, "temperature") for r in of["temperature"]])
    gnss, gnss_notes = tuple(map(_gnss, of["gnss"])), list[str]()
    for rows in (r for r in streams if r.kind in ("velocity", "fix")):
        gnss, note = with_fix_rows(gnss, rows.stream, rows.time, rows.columns)
        gnss_notes.append(note)
    gnss, unfixed_notes = without_unfixed(gnss)
    return Log(
        provenance,
        imus=imus,
        gnss=gnss,
        references=tuple(map(_reference, of["reference"])),
        poses=tuple(map(_pose, of["pose"])),
        orientations=tuple(Orientation(r.stream, r.time, origin=r.origin, **r.columns) for r in of["orientation"]),
        speeds=tuple(_scalars(r, "speed") for r in of["speed"]),
        notes=(*notes, *imu_notes, *gnss_notes, *unfixed_notes),
    )


def _imus(streams: list[Batch], temperatures: list[Scalars]) -> tuple[tuple[ImuStream, ...], list[str]]:
    """Return the IMUs, each with the temperature that belongs to it, and notes on what was joined."""
    imus: dict[str, ImuStream] = {}
    for rows in streams:
        imu = imus.get(rows.stream, ImuStream(rows.stream, None, None, origin=replace(rows.origin, repairs=())))
        imus[rows.stream] = _with_rows(imu, rows)
    notes: list[str] = []
    for temperature in temperatures:
        name = sibling(temperature.name, [n for n, imu in imus.items() if imu.temperature is None])
        if name is None:
            text = f"{temperature.name}: no IMU in the log has this temperature; it is left out"
            notes.append(Note("temperature_left_out", text))
            continue
        imus[name] = replace(imus[name], temperature=temperature)
        notes.append(Note("temperature_joined", f"{temperature.name}: taken as the temperature of {name}"))
    whole, part_notes = with_parts_joined(tuple(imus.values()))
    return whole, [*notes, *part_notes, *_axes_notes(whole)]


def _with_rows(imu: ImuStream, rows: Batch) -> ImuStream:
    """Return an IMU with the sensors of some rows, and their repairs."""
    own = tuple(x for x in rows.origin.repairs if x not in imu.origin.repairs)
    if set(rows.columns) == {"temperature"}:  # what befell the temperatures alone befell no sample
        return replace(imu, temperature=Scalars(rows.stream, rows.time, rows.columns["temperature"], own))
    repairs = imu.origin.repairs + own
    triads = {name: Triad(rows.time, rows.columns[name]) for name in TRIADS if name in rows.columns}
    units = ", ".join(dict.fromkeys((*imu.origin.units.split(", "), *rows.origin.units.split(", "))))
    imu = replace(imu, origin=replace(imu.origin, repairs=repairs, units=units), **triads)
    if "temperature" not in rows.columns:
        return imu
    return replace(imu, temperature=Scalars(rows.stream, rows.time, rows.columns["temperature"]))


def _gnss(rows: Batch) -> GnssStream:
    def known(name: str) -> Floats | None:
        values = rows.columns.get(name)
        if values is None or not np.isfinite(values).any():
            return None
        return np.where(np.isfinite(values), values, np.nan)

    fix = rows.columns.get("fix_type")
    fix = None if fix is None or not np.isfinite(fix).any() else fix
    return GnssStream(
        rows.stream,
        rows.time,
        position=rows.columns["position"],
        velocity=known("velocity"),
        position_sigma=known("position_sigma"),
        velocity_sigma=known("velocity_sigma"),
        fix_type=None if fix is None else fix_types(fix),
        origin=rows.origin,
    )


def _reference(rows: Batch) -> Reference:
    columns: dict[str, Any] = {name: values for name, values in rows.columns.items() if np.isfinite(values).any()}
    return Reference(rows.stream, rows.time, origin=rows.origin, **columns)


def _pose(rows: Batch) -> LocalTrack:
    columns = rows.columns
    rotation = rotation_of_quaternion(columns["quaternion"])
    return LocalTrack(
        rows.stream, rows.time, columns["position"], rotation, position_sigma=columns.get("position_sigma")
    )


def _scalars(rows: Batch, column: str) -> Scalars:
    return Scalars(rows.stream, rows.time, rows.columns[column], rows.origin.repairs)

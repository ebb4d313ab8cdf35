"""Makes a Log of a reader's batches: joins them, mends time, and counts every repair."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Repair, Scalars, Triad
from imuwb.readers.assembly.siblings import beside_fixes, sibling, with_parts_joined
from imuwb.readers.batch import Batch

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from imuwb.log import Effect, Floats, Nanoseconds
    from imuwb.readers.batch import Kind, Remark

#: kind -> the columns it may have
_COLUMNS = {
    "imu": ("angular_rate", "specific_force", "temperature"),
    "gnss": ("position", "velocity", "position_sigma", "velocity_sigma", "fix_type"),
    "reference": ("position", "velocity", "attitude"),
    "velocity": ("velocity", "velocity_sigma"),
    "fix": ("fix_type",),
    "speed": ("speed",),
    "temperature": ("temperature",),
}
_MAY_BE_UNKNOWN = ("velocity", "position_sigma", "velocity_sigma", "fix_type")  #: of a fix
SET_BACK = "clock set back: time goes on behind it by one nominal step"
LATE = "rows out of order sorted by time"
_EFFECTS: dict[str, Effect] = {SET_BACK: "time", LATE: "order"}  #: of a repair that leaves no row out
FIRST, LAST = np.iinfo(np.int64).max, np.iinfo(np.int64).min  # of no rows
MOST_STEPS = 10  # back, of a clock that is set now and then
FEW = 12  # rows; of fewer, nobody can tell which stamp is damaged
LATEST = 2**62  # ns from the epoch: the year 2116; differences of such times fit into int64
END_STEP = 86_400 * SECOND  # of a first or last row, that is then a damaged stamp
CLOCK_STEP = SECOND  # a row that is older than its predecessor by more is a clock set back, not a late row


@dataclass(frozen=True, slots=True)
class _Rows:
    """All rows of one stream that share their columns, mended."""

    stream: str
    kind: Kind
    origin: Origin
    time: Nanoseconds
    columns: dict[str, Floats]


def assemble(parts: Iterable[Batch | Remark], provenance: Provenance) -> Log:
    """Return the log that ``parts`` make up.

    Rows with a value that is not finite are left out; rows out of order by less than a second are
    sorted; of repeated times the first row is kept; behind a clock set back by more, time goes on
    by one nominal step. Each is a repair, counted in the stream's ``origin``.
    """
    groups, repairs, notes = _grouped(parts)
    rows: list[_Rows] = []
    for (stream, kind, _), batches in groups.items():
        joined = _join(batches, repairs[stream])
        batches.clear()  # the pieces go as soon as they are joined: a log is held once, not twice
        if joined.time.size:
            rows.append(joined)
        else:
            lost = sum(repair.count for repair in joined.origin.repairs)
            notes.append(f"{stream} ({kind}): none of its {lost} rows could be used")
    known = {(r.stream, r.kind) for r in rows if r.kind in ("imu", "gnss")}
    for r in rows:  # a stream without an origin tells its repairs here
        if (r.stream, r.kind) not in known:
            notes.extend(f"{r.stream}: {repair.what} ({repair.count})" for repair in r.origin.repairs)
    for stream, left in repairs.items():
        notes.extend(f"{stream}: {repair.what} ({repair.count})" for repair in left)
    temperatures = [_scalars(r, "temperature") for r in rows if r.kind == "temperature"]
    imus, joined_notes = _imus([r for r in rows if r.kind == "imu"], temperatures)
    gnss = tuple(_gnss(r) for r in rows if r.kind == "gnss")
    for r in (r for r in rows if r.kind in ("velocity", "fix")):
        gnss, note = beside_fixes(gnss, r.stream, r.time, r.columns)
        joined_notes.append(note)
    return Log(
        provenance,
        imus=imus,
        gnss=gnss,
        references=tuple(_reference(r) for r in rows if r.kind == "reference"),
        speeds=tuple(_scalars(r, "speed") for r in rows if r.kind == "speed"),
        notes=(*notes, *joined_notes),
    )


def _grouped(
    parts: Iterable[Batch | Remark],
) -> tuple[dict[tuple[str, Kind, tuple[str, ...]], list[Batch]], dict[str, list[Repair]], list[str]]:
    """Return batches by stream and columns, repairs by stream, and notes."""
    groups: dict[tuple[str, Kind, tuple[str, ...]], list[Batch]] = defaultdict(list)
    repairs: dict[str, list[Repair]] = defaultdict(list)
    notes: list[str] = []
    for part in parts:
        if isinstance(part, Batch):
            for piece in _pieces(part):
                groups[piece.stream, piece.kind, tuple(piece.columns)].append(piece)
        elif part.stream:
            repairs[part.stream].append(Repair(part.text, part.count, part.effect))
        else:
            notes.append(part.text)
    return groups, repairs, notes


def _pieces(batch: Batch) -> tuple[Batch, ...]:
    """Return a batch as it is joined: an IMU's temperature apart, which some rows may lack."""
    if batch.kind not in _COLUMNS or not set(batch.columns) <= set(_COLUMNS[batch.kind]):
        message = f"{batch.stream}: a reader made a batch of {batch.kind} with {', '.join(batch.columns)}"
        raise ValueError(message)
    if batch.kind != "imu" or "temperature" not in batch.columns or len(batch.columns) == 1:
        return (batch,)
    motion = {name: values for name, values in batch.columns.items() if name != "temperature"}
    return replace(batch, columns=motion), replace(batch, columns={"temperature": batch.columns["temperature"]})


def _join(batches: list[Batch], noted: list[Repair]) -> _Rows:
    first = batches[0]
    time = np.concatenate([batch.time for batch in batches])
    columns = {name: np.concatenate([batch.columns[name] for batch in batches]) for name in first.columns}
    counts: dict[str, int] = {}

    finite = np.ones(time.size, dtype=bool)
    for name, values in columns.items():
        whole = np.isfinite(values)
        if not whole.all() and (first.kind not in ("gnss", "velocity") or name not in _MAY_BE_UNKNOWN):
            finite &= whole if values.ndim == 1 else whole.all(axis=1)
    if not finite.all():
        counts["rows with a value that is not a number left out"] = int(np.count_nonzero(~finite))
        time, columns = _take(time, columns, finite)
    possible = np.abs(time) < LATEST
    if not possible.all():
        counts["rows whose time cannot be left out"] = int(np.count_nonzero(~possible))
        time, columns = _take(time, columns, possible)
    time, columns = _mend_time(time, columns, counts)
    repairs = (
        *first.origin.repairs,
        *noted,
        *(Repair(what, count, _EFFECTS.get(what, "lost")) for what, count in counts.items()),
    )
    noted.clear()
    return _Rows(first.stream, first.kind, replace(first.origin, repairs=repairs), time, columns)


def _mend_time(
    time: Nanoseconds, columns: dict[str, Floats], counts: dict[str, int]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return rows whose time increases, and count what was mended."""
    steps = np.diff(time)
    if steps.size and steps.min() > 0 and steps.max() <= CLOCK_STEP:
        return time, columns  # as nearly all logs are
    alone = _lone(time)
    others = time[~alone]
    # A lone row within the log's time is only late; one before or behind all others has a damaged stamp.
    alone &= (time < others.min(initial=FIRST)) | (time > others.max(initial=LAST))
    if alone.any():
        counts["rows whose time lies far from that of both neighbours left out"] = int(np.count_nonzero(alone))
        time, columns = _take(time, columns, ~alone)
    if time.size > 1:
        continued, set_back = _continue_behind_steps(time)
        if set_back <= max(MOST_STEPS, time.size // 100):
            time = continued
        else:  # no clock is set back as often as this: the rows are in no order at all
            set_back = 0
        if set_back:
            counts[SET_BACK] = set_back
        late = int(np.count_nonzero(time < np.maximum.accumulate(time)))
        if late:
            counts[LATE] = late
            time, columns = _take(time, columns, np.argsort(time, kind="stable"))
        repeated = np.diff(time, prepend=time[0] - 1) == 0
        if repeated.any():
            counts["rows that repeat the time before left out"] = int(np.count_nonzero(repeated))
            time, columns = _take(time, columns, ~repeated)
    return time, columns


def _take(
    time: Nanoseconds, columns: dict[str, Floats], rows: NDArray[np.bool_] | NDArray[np.int64]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    return time[rows], {name: values[rows] for name, values in columns.items()}


def _lone(time: Nanoseconds) -> NDArray[np.bool_]:
    """Return the rows that step far from their predecessor, and whose successor steps back to it."""
    alone = np.zeros(time.size, dtype=bool)
    if time.size > 2:  # noqa: PLR2004 - both neighbours
        far = np.abs(np.diff(time)) > CLOCK_STEP
        near = np.abs(time[2:] - time[:-2]) <= CLOCK_STEP
        alone[1:-1] = far[:-1] & far[1:] & near
        for end, step, rest in ((0, time[1] - time[0], time[1:]), (-1, time[-1] - time[-2], time[:-1])):
            far_off = abs(step) > max(END_STEP, 10 * abs(int(rest[-1] - rest[0])))
            alone[end] |= far_off and time.size >= FEW
    return alone


def _continue_behind_steps(time: Nanoseconds) -> tuple[Nanoseconds, int]:
    """Return time without the steps back that are too large for a late row, and their number."""
    steps = np.diff(time)
    back = steps < -CLOCK_STEP
    if not back.any():
        return time, 0
    nominal = int(np.median(steps[steps > 0])) if (steps > 0).any() else 1
    shift = np.where(back, nominal - steps, 0)
    late = np.flatnonzero(_lone(time))  # such a row steps back and forth again
    shift[(late - 1).clip(0)] = shift[late.clip(max=shift.size - 1)] = 0
    if float(np.abs(shift.astype(np.float64)).sum()) + float(np.abs(time).max()) >= LATEST:
        return time, time.size  # no clock is set back so far
    return time + np.concatenate([[0], np.cumsum(shift)]), int(np.count_nonzero(shift))


def _imus(rows: list[_Rows], temperatures: list[Scalars]) -> tuple[tuple[ImuStream, ...], list[str]]:
    imus: dict[str, ImuStream] = {}
    for r in rows:
        imu = imus.get(r.stream, ImuStream(r.stream, None, None, origin=replace(r.origin, repairs=())))
        repairs = imu.origin.repairs + tuple(x for x in r.origin.repairs if x not in imu.origin.repairs)
        imu = replace(imu, origin=replace(imu.origin, repairs=repairs))
        for quantity in ("angular_rate", "specific_force"):
            if quantity in r.columns:
                imu = replace(imu, **{quantity: Triad(r.time, r.columns[quantity])})
        if "temperature" in r.columns:
            imu = replace(imu, temperature=Scalars(r.stream, r.time, r.columns["temperature"]))
        imus[r.stream] = imu
    notes: list[str] = []
    for temperature in temperatures:
        name = sibling(temperature.name, [n for n, imu in imus.items() if imu.temperature is None])
        if name is None:
            notes.append(f"{temperature.name}: temperature of no IMU in the log, left out")
            continue
        imus[name] = replace(imus[name], temperature=temperature)
        notes.append(f"{temperature.name}: taken as the temperature of {name}")
    joined, joined_notes = with_parts_joined(tuple(imus.values()))
    return joined, [*notes, *joined_notes]


def _gnss(r: _Rows) -> GnssStream:
    fix = r.columns.get("fix_type")

    def known(name: str) -> Floats | None:
        values = r.columns.get(name)
        return (
            None if values is None or not np.isfinite(values).any() else np.where(np.isfinite(values), values, np.nan)
        )

    return GnssStream(
        r.stream,
        r.time,
        position=r.columns["position"],
        velocity=known("velocity"),
        position_sigma=known("position_sigma"),
        velocity_sigma=known("velocity_sigma"),
        fix_type=None if fix is None else np.nan_to_num(fix).astype(np.int64),
        origin=r.origin,
    )


def _reference(r: _Rows) -> Reference:
    parts = {name: r.columns.get(name) for name in ("velocity", "attitude")}
    return Reference(r.stream, r.time, r.columns["position"], **parts, origin=r.origin)


def _scalars(r: _Rows, column: str) -> Scalars:
    return Scalars(r.stream, r.time, r.columns[column])

"""The receiver of a file's NMEA sentences: fixes with the date of RMC or ZDA, velocity of RMC, sigmas of GST."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.log import MEAN_SEA_LEVEL, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.flight import trajectory
from imuwb.readers.receivers.nmea_sentences import POSITIONS, READ, Columns, Sentences
from imuwb.units import SECOND, UNITS

DAY = 86_400 * SECOND  #: ns
KNOT = UNITS["knot"].factor
#: quality of GGA (none, autonomous, differential, precise, RTK fixed, RTK float, dead reckoning, by hand, simulated) -> MAVLink's fix type
QUALITY = {0: 1, 1: 3, 2: 4, 3: 3, 4: 6, 5: 5, 6: 1, 7: 1, 8: 3}
#: letter of the mode of GNS -> MAVLink's fix type; the best of the letters of all systems counts
MODES = {b"N": 1, b"E": 1, b"M": 1, b"S": 3, b"A": 3, b"P": 3, b"D": 4, b"F": 5, b"R": 6}
CENTURY = 80  #: years of two digits before this one are after 2000
PREFERRED = b"GN"  #: talker of a solution of several systems


def streamed(sentences: Sentences, bytes_read: int) -> Iterator[Batch | Remark]:
    """Yield the fixes of a file's sentences, then notes on what is not used; nothing without a position."""
    kind = next((kind for kind in POSITIONS if sentences.rows(kind) is not None), None)
    if kind is None:
        return
    fixes, others = _one_talker(sentences.rows(kind) or {})
    calendar = _Calendar(sentences)
    time, timed = calendar.time(fixes)
    lost = int(np.count_nonzero(~timed))
    if lost:
        yield Remark(Note("no_time", "sentences without a usable time left out"), "gnss", lost)
    time, fixes = time[timed], {name: values[timed] for name, values in fixes.items()}
    columns, told = _columns(kind, fixes)
    above_sea = f" ({MEAN_SEA_LEVEL})" if "above_sea" in (note.id for note in told) else ""
    used = {kind, *calendar.kinds}
    for more, kinds in (_velocity(sentences, calendar, time), _sigmas(sentences, calendar, time)):
        columns |= more
        used |= kinds
    origin = Origin(f"deg, m{above_sea}, knot", "NED", "unix" if calendar.dated else "log")
    yield from trajectory.located("gnss", "gnss", time, columns, origin, bytes_read)
    yield from map(Remark, told)
    yield from _not_used(sentences, used, others)
    if not calendar.dated:
        text = "no RMC or ZDA states the date: times count from midnight UTC of the first day"
        yield Remark(Note("no_date", text))


def _one_talker(rows: Columns) -> tuple[Columns, str]:
    """Return the fixes of one talker, and the talkers that are left out because they state the same fixes."""
    talkers, counts = np.unique(rows["talker"], return_counts=True)
    best = max(zip(talkers.tolist(), counts.tolist(), strict=True), key=lambda pair: (pair[0] == PREFERRED, pair[1]))[0]
    mine = rows["talker"] == best
    # Receivers change the talker with the systems in use; only a second talker at the same time is a repeat.
    repeated = ~mine & np.isin(rows["time"], rows["time"][mine])
    others = ", ".join(sorted({talker.decode() for talker in rows["talker"][repeated].tolist()}))
    return {name: values[~repeated] for name, values in rows.items()}, others


class _Calendar:
    """The dates that sentences of RMC and ZDA state, for the sentences that state a time of day alone."""

    def __init__(self, sentences: Sentences) -> None:
        rows = {kind: rows for kind in (b"RMC", b"ZDA") if (rows := sentences.rows(kind)) is not None}
        parts = [(r["place"], *_day(r["date"]), *_of_day(r["time"])) for r in rows.values()]
        place, day, dated, clock, timed = (
            (np.concatenate(part) for part in zip(*parts, strict=True)) if parts else [np.empty(0)] * 5
        )
        known = dated.astype(bool) & timed.astype(bool)
        order = np.argsort(place[known], kind="stable")
        self._place, self._day, self._clock = (values[known][order].astype(np.int64) for values in (place, day, clock))
        self.dated = self._place.size > 0
        self.kinds = set(rows) if self.dated else set[bytes]()

    def time(self, rows: Columns) -> tuple[Nanoseconds, Booleans]:
        """Return the times of sentences (ns), and which of them have one."""
        clock, timed = _of_day(rows["time"])
        if not self.dated:
            moved = np.where(timed, clock, 0)
            moved = np.concatenate([[0], np.cumsum(np.diff(moved[timed]) < -DAY // 2)]) if timed.any() else moved
            days = np.zeros(clock.size, np.int64)
            days[timed] = moved
            return clock + days * DAY, timed
        near = np.searchsorted(self._place, rows["place"], side="right").clip(1) - 1
        day = self._day[near] + np.rint((self._clock[near] - clock) / DAY).astype(np.int64)
        return clock + day * DAY, timed


def _of_day(numbers: Floats) -> tuple[Nanoseconds, Booleans]:
    """Return times of day such as 235959.25 in ns, and which of them are possible."""
    with np.errstate(invalid="ignore"):
        possible = (numbers >= 0) & (numbers < 240_000) & (numbers % 100 < 61) & (numbers // 100 % 100 < 60)  # noqa: PLR2004 - hhmmss
    whole = np.where(possible, numbers, 0.0)
    parts = np.rint(whole * SECOND).astype(np.int64)  # a double holds such a number to 0.03 ns
    hours, rest = np.divmod(parts, 10_000 * SECOND)
    minutes, seconds = np.divmod(rest, 100 * SECOND)
    return (hours * 3600 + minutes * 60) * SECOND + seconds, possible


def _day(numbers: Floats) -> tuple[Integers, Booleans]:
    """Return dates such as 291126 (29 November 2026) in days since 1970, and which of them are possible."""
    whole = np.where((numbers >= 0) & (numbers < 320_000), numbers, 0.0).astype(np.int64)  # noqa: PLR2004 - ddmmyy
    day, month, year = whole // 10_000, whole // 100 % 100, whole % 100
    possible = (day >= 1) & (day <= 31) & (month >= 1) & (month <= 12)  # noqa: PLR2004 - a calendar
    months = (year + np.where(year < CENTURY, 30, -70)) * 12 + np.where(possible, month, 1) - 1
    return months.astype("M8[M]").astype("M8[D]").astype(np.int64) + day - 1, possible


def _columns(kind: bytes, rows: Columns) -> tuple[dict[str, Floats], list[Note]]:
    """Return positions and fix types, and notes on the heights."""
    notes: list[Note] = []
    if kind == b"RMC":
        height = np.zeros(rows["time"].size)
        fix = np.where(rows["status"] == b"A", 3.0, 1.0)
        notes.append(
            Note("no_height", "gnss: no sentence states a height (there is no GGA and no GNS); it is set to 0")
        )
    else:
        height = _heights(rows, notes)
        fix = _modes(rows["mode"]) if kind == b"GNS" else _qualities(rows["quality"])
    position = trajectory.positions(rows["latitude"], rows["longitude"], height)
    unknown = np.isnan(position).any(axis=1)
    position[np.flatnonzero(unknown)] = (
        0.0  # a receiver without a fix leaves the cells empty: such a row has no position
    )
    return {"position": position, "fix_type": fix}, notes


def _qualities(quality: Floats) -> Floats:
    return np.array([QUALITY.get(int(q), 0) for q in np.nan_to_num(quality).clip(0, 99)], dtype=np.float64)


def _modes(modes: NDArray[np.bytes_]) -> Floats:
    texts: list[bytes] = modes.tolist()
    return np.array([max((MODES.get(bytes([c]), 0) for c in text), default=0) for text in texts], dtype=np.float64)


def _heights(rows: Columns, notes: list[Note]) -> Floats:
    """Return heights above the ellipsoid if the separation is stated, else above the sea."""
    separation, sea = rows["separation"], rows["above_sea"]
    known, stated = np.isfinite(separation), np.isfinite(sea)
    if not (known & stated).any():
        if stated.any():
            notes.append(
                Note("above_sea", "gnss: heights are above mean sea level; no sentence states the geoid's separation")
            )
        return sea
    if (stated & ~known).any():
        index = np.arange(separation.size)
        separation = np.interp(index, index[known], separation[known])
        text = f"gnss: {np.count_nonzero(stated & ~known)} sentences state no separation of the geoid; that of the sentences around is taken"
        notes.append(Note("separation_interpolated", text))
    return sea + separation


def _velocity(sentences: Sentences, calendar: _Calendar, time: Nanoseconds) -> tuple[dict[str, Floats], set[bytes]]:
    """Return the velocity of RMC, or else of VTG, which belongs to the sentence with a time before it."""
    rows, kind = sentences.rows(b"RMC"), b"RMC"
    if rows is None or not np.isfinite(rows["knots"]).any():
        rows, kind = _timed_vtg(sentences), b"VTG"
    if rows is None:
        return {}, set()
    at, timed = calendar.time(rows)
    speed = rows["knots"] * KNOT
    course = np.where(speed == 0, 0.0, rows["course"])  # without motion there is no course
    values = trajectory.velocities(speed, course)
    values[:, 2] = np.nan
    return {"velocity": _at(time, at[timed], values[timed])}, {kind}


def _timed_vtg(sentences: Sentences) -> Columns | None:
    """Return the sentences of VTG, each with the time of the sentence with a time before it."""
    rows = sentences.rows(b"VTG")
    timed = [r for kind in POSITIONS if (r := sentences.rows(kind)) is not None]
    if rows is None or not timed:
        return None
    place, clock = (np.concatenate([r[name] for r in timed]) for name in ("place", "time"))
    order = np.argsort(place)
    before = np.searchsorted(place[order], rows["place"]) - 1
    return {**rows, "time": np.where(before < 0, np.nan, clock[order][before])}


def _sigmas(sentences: Sentences, calendar: _Calendar, time: Nanoseconds) -> tuple[dict[str, Floats], set[bytes]]:
    rows = sentences.rows(b"GST")
    if rows is None:
        return {}, set()
    at, timed = calendar.time(rows)
    values = trajectory.triples(rows, ("north", "east", "up"))
    return {"position_sigma": _at(time, at[timed], values[timed])}, {b"GST"}


def _at(time: Nanoseconds, at: Nanoseconds, values: Floats) -> Floats:
    """Return the rows of the same times; nan where there is none."""
    found = np.full((time.size, values.shape[1]), np.nan)
    _, mine, theirs = np.intersect1d(time, at, return_indices=True)
    found[mine] = values[theirs]
    return found


def _not_used(sentences: Sentences, used: set[bytes], talkers: str) -> Iterator[Remark]:
    """Yield which sentences are not used, and what is wrong with them."""
    names = [
        f"{kind.decode()} ({count})"
        for kind, count in sentences.counts.items()
        if kind not in used and kind not in READ
    ]
    if names:
        yield unused(names, "NMEA sentences without a value that imuwb uses")
    read = [
        f"{kind.decode()} ({count})" for kind, count in sentences.counts.items() if kind not in used and kind in READ
    ]
    if read:
        yield unused(read, "the same values are in other sentences")
    if talkers:
        yield unused([f"talker {talkers}"], "its fixes have the times of another talker's")
    if sentences.stamped:
        text = "sentences with text before them in their line, such as a host's stamp, which is not used: the sentences state UTC"
        yield Remark(Note("host_stamp", f"{sentences.stamped} {text}"))
    yield from faults(sentences)


def faults(sentences: Sentences) -> Iterator[Remark]:
    """Yield what is wrong with the sentences."""
    if sentences.failed:
        yield Remark(
            Note("nmea_checksum_failed", f"{sentences.failed} NMEA sentences whose checksum is wrong, not used")
        )
    if sentences.short:
        yield Remark(Note("nmea_short", f"{sentences.short} NMEA sentences with too few cells, not used"))

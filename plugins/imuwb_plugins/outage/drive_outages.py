"""The outages that are shown in time: a typical one, the worst and the best, and others that do not overlap with these."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.health import Fault
from imuwb.log import SECOND
from imuwb.navigation.filter import axis_errors
from imuwb.replay import FilterRun, Replay
from imuwb.scene import Belief, Caption, Episode
from imuwb.texts import number_text
from imuwb_plugins.outage.figures import color_of

BEFORE, AFTER = 15.0, 5.0  #: s, shown before and after an outage
APART = BEFORE + AFTER  #: s between the end of an outage and the begin of the next one that is shown
MOST = 12  #: outages
TYPICAL, WORST, BEST = "typical outage", "worst outage", "best outage"
ROWS = 6  #: filters in a caption
WINDS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


@dataclass(frozen=True, slots=True)
class Shown:
    """An outage that is shown."""

    name: str  #: such as "worst outage"; empty: one of many
    given: str  #: its name as the user gives it
    start: float  #: s from the log's start
    duration: float  #: s
    row: int  #: among the outages of its duration

    def apart(self, others: Iterable["Shown"]) -> bool:
        """Return whether the outage keeps its distance from others."""
        return all(
            self.start >= other.start + other.duration + APART or other.start >= self.start + self.duration + APART
            for other in others
        )


def stamps(replay: Replay, seconds: Floats) -> Integers:
    """Return times, s from the log's start, as ns on its own clock, to a microsecond: sums of seconds are then equal."""
    return np.asarray((replay.prepared.log.zero or 0) + np.rint(seconds * 1e6) * (SECOND // 10**6), dtype=np.int64)


def shown_outages(replay: Replay, best: str) -> tuple[tuple[Shown, ...], str]:
    """Return the outages that are shown, the typical one first, and a sentence on them.

    The error of the best filter at the end decides, among the longest outages: the typical one is nearest to the median.
    """
    every = every_outage(replay)
    longest = max((own.duration for own in every), default=0.0)
    ends = {own: _end(replay.runs[best], own) for own in every if own.duration == longest}
    known = [own for own in ends if np.isfinite(ends[own])]
    if not known:
        return (), "no outage is shown in time: the best filter has no error in any"
    median = float(np.median([ends[own] for own in known]))
    ranked = {
        TYPICAL: sorted(known, key=lambda own: abs(ends[own] - median)),
        WORST: sorted(known, key=lambda own: -ends[own]),
        BEST: sorted(known, key=lambda own: ends[own]),
    }
    named: dict[str, Shown] = {}
    for order in ((WORST, BEST, TYPICAL), (TYPICAL, WORST, BEST)):
        named = _named(ranked, order)
        if TYPICAL in named:
            break
    chosen = [named[name] for name in ranked if name in named]
    for own in sorted(every, key=lambda own: (-own.duration, own.start)):
        if len(chosen) < MOST and own.apart(chosen):
            chosen.append(own)
    texts = [
        f"{name} at {own.start:.0f} s ({number_text(ends[known_as(own, known)])} m)" for name, own in named.items()
    ]
    about = (
        f"drive: {len(chosen)} of {len(every)} outages are shown in time, {APART:g} s or more apart; by the error of {best} "
        f"after {longest:g} s: {', '.join(texts)}"
    )
    return tuple(chosen), about


def known_as(own: Shown, known: Sequence[Shown]) -> Shown:
    """Return the outage without the name that it got."""
    return next(one for one in known if (one.start, one.duration) == (own.start, own.duration))


def _named(ranked: dict[str, list[Shown]], order: Sequence[str]) -> dict[str, Shown]:
    """Return an outage for each name, in an order of the names, as far as they do not overlap."""
    found: dict[str, Shown] = {}
    for name in order:
        free = next((own for own in ranked[name] if own.apart(found.values())), None)
        if free is not None:
            found[name] = Shown(name, free.given, free.start, free.duration, free.row)
    return {name: found[name] for name in ranked if name in found}


def every_outage(replay: Replay) -> list[Shown]:
    """Return all outages that are scored, by duration."""
    return [own for duration in replay.scored for own in _of_duration(replay, duration)]


def _of_duration(replay: Replay, duration: float) -> list[Shown]:
    start = next(iter(replay.runs.values())).outages[duration].scores.start
    names = [outage.name for outage in replay.outages[duration]]
    rows = np.flatnonzero(replay.scored[duration]).tolist()
    return [Shown("", names[row], float(start[row]), duration, row) for row in rows]


def _end(run: FilterRun, own: Shown) -> float:
    return float(run.outages[own.duration].scores.horizontal[own.row, -1])


def episode(replay: Replay, names: Sequence[str], own: Shown, faults: Sequence[Fault]) -> Episode:
    """Return an outage as a part of the scene.

    Args:
        replay: all filters in the same outages.
        names: the filters, the best first.
        own: the outage.
        faults: of the log, at known times.
    """
    sound = [name for name in names if replay.runs[name].outages[own.duration].drift.sound[own.row]]
    beliefs = tuple(belief(replay, name, own) for name in sound)
    begin, end = stamps(replay, own.start + np.array([0.0, own.duration])).tolist()
    inside = [
        f for f in faults if f.start is not None and own.start - BEFORE <= f.start <= own.start + own.duration + AFTER
    ]
    seconds = np.concatenate([[0.0], replay.runs[names[0]].outages[own.duration].drift.elapsed])
    captions: tuple[Caption, ...] = ()
    if beliefs:
        remarks = _bias(replay.runs[sound[0]], sound[0], own), _faults(inside)
        captions = tuple(_caption(replay, sound, own, k, float(t), remarks) for k, t in enumerate(seconds))
    return Episode(own.name, begin, end, beliefs, captions, _about(replay, sound, own, inside))


def belief(replay: Replay, name: str, own: Shown) -> Belief:
    """Return what a filter believes from the last fix before an outage to its end."""
    run = replay.runs[name]
    drift, solution = run.outages[own.duration].drift, run.solution
    event = int(drift.event[own.row])
    position = np.concatenate([solution.track.state[event : event + 1, :3], drift.state[own.row, :, :3]])
    first = solution.track.covariance[event : event + 1, :2, :2]
    covariance = np.concatenate([first, drift.covariance[own.row, :, :2, :2]])
    seconds = drift.start[own.row] + np.concatenate([[0.0], drift.elapsed])
    return Belief(name, stamps(replay, seconds), position, covariance, color_of(name))


def _name_of(own: Shown) -> str:
    name = own.name or "outage"
    return f"{name[0].upper()}{name[1:]}{f' ({own.given})' if own.given else ''}"


def _about(replay: Replay, names: Sequence[str], own: Shown, faults: Sequence[Fault]) -> Caption:
    meaning = {
        TYPICAL: f"Half of the outages end farther off, half nearer (by {names[0] if names else 'the best filter'}).",
        WORST: "No other outage ends farther off.", BEST: "No other outage ends nearer.",
    }  # fmt: skip
    texts = (meaning[own.name],) if own.name in meaning else ()
    play = "Press play: at 0 s the fixes are taken away. Thin lines: where each filter will drift."
    return Caption(
        f"{_name_of(own)}: {own.duration:g} s without fixes", (*texts, play), _headings("off at the end"),
        _rows(replay, names, own, -1), (_faults(faults),),
    )  # fmt: skip


def _caption(
    replay: Replay, names: Sequence[str], own: Shown, k: int, elapsed: float, remarks: tuple[str, ...]
) -> Caption:  # fmt: skip
    """Return what holds at one time of an outage: how far the filters are off, and how the vehicle moves."""
    scores = replay.runs[names[0]].outages[own.duration].scores
    velocity = replay.reference.at(np.array([scores.start[own.row] + elapsed]))[1][0]
    text = f"{_name_of(own)}. {_motion(velocity)}"
    return Caption(
        f"{elapsed:g} s without fixes", (text,), _headings("off by") if k else (), _rows(replay, names, own, k - 1) if k else (),
        remarks,
    )  # fmt: skip


def _motion(velocity: Floats) -> str:
    speed = float(np.hypot(velocity[0], velocity[1]))
    if not np.isfinite(speed) or speed < 1:
        return "The vehicle stands."
    course = float(np.degrees(np.arctan2(velocity[1], velocity[0]))) % 360
    return f"{3.6 * speed:.0f} km/h to the {WINDS[round(course / 45) % 8]} ({course:.0f}°)."


def _headings(heading: str) -> tuple[str, ...]:
    return ("filter", heading, "its sigma", "off / sigma")


def _rows(replay: Replay, names: Sequence[str], own: Shown, mark: int) -> tuple[tuple[str, ...], ...]:
    """Return the filters' errors at a mark of an outage, with their sigmas."""
    rows: list[tuple[str, ...]] = []
    for name in names[:ROWS]:
        scores = replay.runs[name].outages[own.duration].scores
        error, sigma = float(scores.horizontal[own.row, mark]), float(scores.sigma[own.row, mark])
        rows.append((name, f"{number_text(error)} m", f"{number_text(sigma)} m", f"{error / sigma:.1f}"))
    return tuple(rows)


def _bias(run: FilterRun, name: str, own: Shown) -> str:
    """Return the filter's estimates of the biases of the gyros at the last fix before an outage, with their largest sigma."""
    errors, sigma = axis_errors(run.solution)
    row = min(int(np.searchsorted(run.solution.time, own.start - 1e-3)), len(errors) - 1)
    x, y, z = np.degrees(errors[row, :3]) * 3600
    wide = float(np.degrees(sigma[row, :3].max())) * 3600
    return f"Gyro bias of {name} (x, y, z): {x:.0f}, {y:.0f}, {z:.0f} deg/h, sigma {wide:.2g} deg/h at most."


def _faults(faults: Sequence[Fault]) -> str:
    if not faults:
        return "No fault of the log at this time."
    return "Faults of the log at this time: " + "; ".join(f"{fault.stream}: {fault.what}" for fault in faults[:2])

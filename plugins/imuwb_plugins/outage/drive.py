"""The drive in time: the vehicle, its fixes by quality, and what the filters believe in some outages."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.colors import BLUE, GREEN, GREY, ORANGE, RED, YELLOW, Color
from imuwb.health import Fault, check
from imuwb.log import SECOND, Log
from imuwb.replay import Replay
from imuwb.scene import Caption, Event, Points, Pose, Scene, Span
from imuwb.selection import select
from imuwb_plugins.outage import drive_charts
from imuwb_plugins.outage.drive_outages import AFTER, BEFORE, Shown, episode, shown_outages, stamps
from imuwb_plugins.outage.result import Drive, DurationSummary

STEP = 1.0  #: s between two poses
LONG_GAP, USUAL_GAPS = 3.0, 2.5  #: s, and usual intervals; longer spans between fixes are gaps
#: fix type -> its name and colour; the numbers are those of ``GnssStream``
QUALITIES: dict[int, tuple[str, Color]] = {
    6: ("RTK fixed", GREEN), 8: ("PPP", GREEN), 5: ("RTK float", YELLOW), 4: ("differential", BLUE), 3: ("3D fix", ORANGE), 2: ("2D fix", RED),
}  # fmt: skip
FAINT = 90  #: opacity of fixes that are withheld
NEAREST = 30.0  #: m, from the camera to the vehicle
SHARE, TIMES = (
    0.55,
    2.4,
)  #: of the distance driven in the first outage, and of the errors and the sigma in it, to the camera


def drive(replay: Replay, summaries: Sequence[DurationSummary]) -> Drive:
    """Return the drive in time.

    Args:
        replay: all filters in the same outages.
        summaries: by duration, of which the last one names the best filter.
    """
    log = replay.prepared.log
    names = [name for name in (summaries[-1].ranked if summaries else ()) if name in replay.runs] or list(replay.runs)
    outages, about = shown_outages(replay, names[0])
    body = _body(replay, names[0], outages)
    faults = list(_faults(log, outages))
    episodes = tuple(episode(replay, names, own, faults) for own in outages)
    scene = Scene(
        f"Drive: the vehicle, and where each filter believes it to be (rings: 1 and 3 sigma, strong: {names[0]})", body,
        episodes, tuple(_fixes(replay, names[0], outages)), _distance(replay, names, outages), BEFORE, AFTER,
        about=Caption("Fixes are used", ("In the list at the lower left, choose an outage; time is the whole drive.",)),
        called="outages",
    )  # fmt: skip
    spans = [Span(own.begin, own.end, "outage") for own in episodes]
    spans += [Span(begin, end, "no fixes in the log", RED) for begin, end in _gaps(replay)]
    return Drive(
        scene, tuple(drive_charts.charts(replay, names, outages, body)), tuple(spans),
        tuple(_event(replay, fault) for fault in faults), about,
    )  # fmt: skip


def _faults(log: Log, outages: Sequence[Shown]) -> Iterator[Fault]:
    """Yield the faults at a known time: of clocks and receivers in the whole log, of samples in the outages that are shown."""
    yield from (fault for fault in check(log, lines=False, samples=False).faults if fault.start is not None)
    sensors = replace(log, references=())  # those of another file may have another clock
    for own in outages:
        begin, end = max(own.start - BEFORE, 0.0), own.start + own.duration + AFTER
        part = select(sensors, None, f"{begin:.6f}", f"{end:.6f}")
        known = {(fault.stream, fault.what) for fault in check(part, lines=False, samples=False).faults}
        for fault in check(part, lines=False).faults:
            if fault.start is not None and (fault.stream, fault.what) not in known:
                yield fault


def _event(replay: Replay, fault: Fault) -> Event:
    more = f" ({fault.count} of this kind)" if fault.count > 1 else ""
    return Event(
        stamps(replay, np.array([fault.start or 0.0]))[0].item(),
        fault.stream,
        f"{fault.what}{more}",
        fault.severity,
    )


def _body(replay: Replay, name: str, outages: Sequence[Shown]) -> Pose:
    """Return the vehicle on the reference, with the attitude of a filter's run over all fixes."""
    solution = replay.runs[name].solution
    begin, end = float(solution.time[0]), float(solution.time[-1])
    near = [np.arange(o.start - BEFORE, o.start + o.duration + AFTER, STEP) for o in outages]
    grid = np.arange(begin, end, STEP)
    for own in near:
        grid = grid[(grid < own[0] - STEP / 2) | (grid > own[-1] + STEP / 2)]
    time = np.sort(np.concatenate([grid, *near]))
    time = time[(time >= begin) & (time <= end)]
    own = np.stack([np.interp(time, solution.time, solution.position[:, i]) for i in range(3)], axis=1)
    position = replay.reference.at(time)[0]
    position = np.where(np.isfinite(position).all(axis=1, keepdims=True), position, own)
    return Pose("reference", stamps(replay, time), position, _turned(solution.time, solution.quaternion, time))


def _turned(known: Floats, quaternion: Floats, time: Floats) -> Floats:
    """Return attitudes between those that are known, (n, 4), by the shorter way."""
    after = np.clip(np.searchsorted(known, time), 1, known.size - 1)
    share = np.clip((time - known[after - 1]) / (known[after] - known[after - 1]), 0.0, 1.0)[:, None]
    first, last = quaternion[after - 1], quaternion[after]
    last = np.where((first * last).sum(axis=1)[:, None] < 0, -last, last)
    mixed = (1 - share) * first + share * last
    return mixed / np.linalg.norm(mixed, axis=1)[:, None]


def _fixes(replay: Replay, best: str, outages: Sequence[Shown]) -> Iterator[Points]:
    """Yield the fixes by quality, faint where they are withheld, and those whose position the best filter refused."""
    solution = replay.runs[best].solution
    corrections, track, gnss = solution.corrections, solution.track, replay.prepared.gnss
    fixes = corrections.fix >= 0
    rows = corrections.fix[fixes]
    refused = np.zeros(len(gnss), dtype=bool)
    refused[rows] = np.isfinite(track.nis[fixes, 0]) & ~track.used[fixes, 0]
    seconds = (gnss.time - (replay.prepared.log.zero or 0)) / SECOND
    withheld = np.zeros(len(gnss), dtype=bool)
    for own in outages:
        withheld |= (seconds > own.start) & (seconds < own.start + own.duration)
    kinds = np.full(len(gnss), -1) if gnss.fix_type is None else gnss.fix_type
    for kind in np.unique(kinds).tolist():
        name, color = QUALITIES.get(kind, ("fix", GREY))
        own = (kinds == kind) & ~refused
        if (own & ~withheld).any():
            yield Points(f"{name}: {np.count_nonzero(own)}", gnss.position[own & ~withheld], color)
        if (own & withheld).any():
            yield Points("", gnss.position[own & withheld], (*color, FAINT))
    if refused.any():
        yield Points(f"refused: {np.count_nonzero(refused)}", gnss.position[refused], RED)


def _gaps(replay: Replay) -> Iterator[tuple[int, int]]:
    """Yield begin and end of the spans in which the log itself has no fixes, ns."""
    time = replay.prepared.fix_time
    steps = np.diff(time)
    for k in np.flatnonzero(steps > max(LONG_GAP, USUAL_GAPS * float(np.median(steps)))).tolist():
        begin, end = stamps(replay, time[k : k + 2]).tolist()
        yield begin, end


def _distance(replay: Replay, names: Sequence[str], outages: Sequence[Shown]) -> float:
    """Return how far the camera is, m, so that the first outage is in the picture."""
    if not outages:
        return 500.0
    first = outages[0]
    scores = [replay.runs[name].outages[first.duration].scores for name in names]
    errors = [float(own.horizontal[first.row, -1]) for own in scores]
    driven = float(scores[0].distance[first.row, -1])
    sigma = float(scores[0].sigma[first.row, -1])
    known = [error for error in (*errors, sigma) if np.isfinite(error)]
    return max(SHARE * driven, TIMES * max(float(np.median(known)), known[-1]) if known else 0.0, NEAREST)

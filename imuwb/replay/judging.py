"""The scores of all filters against one reference, if the reference can judge."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans
from imuwb.navigation.outages import Drift
from imuwb.notes import Note
from imuwb.replay.prepared import Prepared
from imuwb.replay.references.reference import ReferenceTrack
from imuwb.replay.references.reference_check import (
    FROM_FIXES,
    NEARLY_ALL,
    contradiction,
    discrepancy,
    elsewhere,
    yardsticks,
)
from imuwb.replay.scoring.scores import Scores, scores

Drifts = Mapping[str, Mapping[float, Drift]]  #: filter -> duration -> its drift in the outages of this duration
OwnScores = Mapping[str, Mapping[float, Scores]]


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """The scores of filters against a reference."""

    track: ReferenceTrack
    scores: dict[str, dict[float, Scores]]  #: filter -> duration -> scores in all outages of this duration
    scored: dict[float, Booleans]  #: duration -> (s,) whether an outage is scored
    notes: tuple[Note, ...]
    refused: str = ""  #: why the reference cannot judge; empty: it can


def judge(
    prepared: Prepared, track: ReferenceTrack, drifts: Drifts, own: OwnScores, gaps: Mapping[float, Booleans]
) -> Judgement:
    """Return the scores of filters against a reference, and whether it can judge.

    Args:
        prepared: the log.
        track: the reference.
        drifts: of all filters in the same outages.
        own: the scores of these drifts against each filter's own run.
        gaps: duration -> (s,) whether an outage lacks samples of the IMU.
    """
    found: dict[str, dict[float, Scores]] = {name: {} for name in drifts}
    scored: dict[float, Booleans] = {}
    notes: list[Note] = []
    doubted = count = 0
    for duration, gap in gaps.items():
        first = next(iter(drifts.values()))[duration]
        extent = discrepancy(track, first.start, first.time) if track.kind != "own" else None
        for name, by_duration in drifts.items():
            found[name][duration] = scores(by_duration[duration], track, extent)
        good = np.all([np.isfinite(s[duration].horizontal).all(axis=1) for s in found.values()], axis=0)
        able = np.ones(good.size, dtype=bool)
        if extent is not None:
            able = yardsticks(extent[:, -1], [by_duration[duration] for by_duration in own.values()]) | ~good | gap
        doubted, count = doubted + int((~able).sum()), count + int((good & ~gap).sum())
        notes.extend(_unscored(duration, int((~good).sum()), int(gap.sum()), track.name))
        if not able.all() and extent is not None:
            notes.append(_contradicts(duration, track.name, int((~able).sum()), float(np.median(extent[~able, -1]))))
        scored[duration] = good & ~gap & able
    refused = elsewhere(track, prepared) or contradiction(track, prepared) or ""
    if refused and track.kind not in FROM_FIXES and not elsewhere(track, prepared):
        notes.append(Note("reference-against-fixes", f"{track.name} contradicts the fixes: {refused}"))
        refused = ""
    if not refused and doubted > NEARLY_ALL * count:
        refused = f"its positions contradict its own velocities by more than the drift in {doubted} of {count} outages"
    return Judgement(track, found, scored, tuple(notes), refused)


def _contradicts(duration: float, reference: str, count: int, extent: float) -> Note:
    text = (
        f"{_not_scored(count, duration)}: the positions of {reference} contradict its own velocities there, by "
        f"{extent:.1f} m (median), which is more than the drift"
    )
    return Note("reference-contradicts-itself", text)


def _unscored(duration: float, lost: int, gaps: int, reference: str) -> tuple[Note, ...]:
    notes = (
        Note("no-reference", f"{_not_scored(lost, duration)}: {reference} has a gap or ends there, or a filter failed"),
        Note("gap-in-outage", f"{_not_scored(gaps, duration)}: samples of the IMU are missing within them"),
    )
    return tuple(note for note, count in zip(notes, (lost, gaps), strict=True) if count)


def _not_scored(count: int, duration: float) -> str:
    return f"{count} outage{' of' if count == 1 else 's of'} {duration:g} s {'is' if count == 1 else 'are'} not scored"

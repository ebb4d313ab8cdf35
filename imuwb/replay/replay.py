"""The replay of outages: filters over a log, and their drift without fixes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans
from imuwb.errors import MissingDataError
from imuwb.navigation.filter import Solution
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.outages import Drift, drift
from imuwb.notes import Note
from imuwb.progress import tracked
from imuwb.replay.outages import SPACING, Outage, check_outages, events_of, with_gap
from imuwb.replay.prepared import Prepared, run
from imuwb.replay.reference import ReferenceTrack, needs_smoothing, own_track, reference_track
from imuwb.replay.scores import Scores, scores

BEST = ("tuned", "full", "18AV", "15AV")  #: the filters whose run is a reference, in order of preference


@dataclass(frozen=True, eq=False, slots=True)
class ScoredDrift:
    """One filter in the outages of one duration."""

    drift: Drift
    scores: Scores  #: against the common reference
    own: Scores  #: against the filter's own run without outages


@dataclass(frozen=True, eq=False, slots=True)
class FilterRun:
    """One filter: its run over the whole log, and its outages by duration."""

    solution: Solution
    outages: dict[float, ScoredDrift]


@dataclass(frozen=True, eq=False, slots=True)
class Replay:
    """All filters in the same outages."""

    prepared: Prepared
    reference: ReferenceTrack
    runs: dict[str, FilterRun]
    scored: dict[float, Booleans]  #: duration -> (s,) whether an outage is scored
    notes: tuple[str, ...]

    def __str__(self) -> str:
        """Return reference, outages and filters, a line each."""
        outages = ", ".join(f"{int(rows.sum())} of {duration:g} s" for duration, rows in self.scored.items())
        lines = [
            f"Replay against {self.reference.name}: outages: {outages}",
            *(str(r.solution) for r in self.runs.values()),
        ]
        return "\n  ".join(lines)

    __repr__ = __str__


def replay(
    prepared: Prepared, models: Sequence[FilterModel], outages: Sequence[Outage], *, reference: str = "best"
) -> Replay:
    """Return the drift of all filters in the same outages.

    Args:
        prepared: the log.
        models: the filters, with different names.
        outages: in order of time.
        reference: as for ``reference_track``.

    Raises:
        UsageError: an outage that is not possible.
        MissingDataError: a filter that becomes invalid; no outage that can be scored.
        ValueError: the log lacks the wanted reference; a process that cannot be written with states.
    """
    check_outages(prepared, models[0], outages)
    solutions = {model.name: run(model, prepared) for model in models}
    best = next((m for name in BEST for m in models if m.name == name), models[0])
    smooth = needs_smoothing(prepared.log, reference)
    track = reference_track(
        prepared.log, run(best, prepared, smooth=True) if smooth else solutions[best.name], reference
    )
    runs = {name: FilterRun(solution, {}) for name, solution in solutions.items()}
    scored: dict[float, Booleans] = {}
    early = _early(prepared, models[0], outages)
    unscored: list[Note] = []
    durations = sorted({outage.duration for outage in outages})
    for duration in tracked(durations, len(durations)):
        chosen = [outage for outage in outages if outage.duration == duration]
        good = _score(runs, chosen, duration, track)
        gap = with_gap(prepared, chosen)
        unscored.extend(_unscored(duration, int((~good).sum()), int(gap.sum()), track.name))
        scored[duration] = good & ~gap
    if not any(rows.any() for rows in scored.values()):
        raise MissingDataError(f"{prepared.log.provenance.path}: no outage can be scored: {'; '.join(unscored)}")
    return Replay(prepared, track, runs, scored, (*prepared.notes, *early, *_doubted(track), *unscored))


def _score(runs: dict[str, FilterRun], outages: Sequence[Outage], duration: float, track: ReferenceTrack) -> Booleans:
    """Add the outages of a duration to the runs; return for which of them every filter has scores."""
    good = np.ones(len(outages), dtype=bool)
    for filter_run in tracked(runs.values(), len(runs)):
        solution = filter_run.solution
        drifted = drift(solution, events_of(solution, outages), duration)
        against = scores(drifted, track)
        filter_run.outages[duration] = ScoredDrift(drifted, against, scores(drifted, own_track(solution)))
        good &= np.isfinite(against.horizontal).all(axis=1)
    return good


def _early(prepared: Prepared, model: FilterModel, outages: Sequence[Outage]) -> tuple[Note, ...]:
    settling = model.settings.settling
    early = [o for o in outages if o.start < prepared.start_time + settling - SPACING]
    if not early:
        return ()
    text = (
        f"{len(early)} outages begin before the filter has had {settling:g} s of fixes: it starts at {prepared.start_time:.1f} s, "
        f"and the first outage begins at {early[0].start:.1f} s"
    )
    return (Note("early-outages", text),)


def _doubted(track: ReferenceTrack) -> tuple[Note, ...]:
    """Return what must be known of a reference that is no truth."""
    if track.kind != "estimate":
        return ()
    text = (
        f"{track.name}, is the reference: it has used the same fixes, so it is no truth, and errors that it shares with the "
        "filters are not seen"
    )
    return (Note("reference-is-estimate", text),)


def _unscored(duration: float, lost: int, gaps: int, reference: str) -> tuple[Note, ...]:
    not_scored = f"outages of {duration:g} s are not scored"
    notes = (
        Note("no-reference", f"{lost} {not_scored}: {reference} has a gap or ends there, or a filter failed"),
        Note("gap-in-outage", f"{gaps} {not_scored}: samples of the IMU are missing within them"),
    )
    return tuple(note for note, count in zip(notes, (lost, gaps), strict=True) if count)

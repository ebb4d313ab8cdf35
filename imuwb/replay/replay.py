"""The replay of outages: filters over a log, and their drift without fixes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans
from imuwb.errors import ImuwbError, MissingDataError
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
MOST_INVALID = 0.5  #: share of the outages in which a filter may become invalid


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
    failed: dict[str, str]  #: filter that cannot run -> reason

    def __repr__(self) -> str:
        """Return reference, outages and filters, a line each."""
        outages = ", ".join(f"{int(rows.sum())} of {duration:g} s" for duration, rows in self.scored.items())
        lines = [
            f"Replay against {self.reference.name}: outages: {outages}",
            *(str(r.solution) for r in self.runs.values()),
            *(f"{name} cannot run: {reason}" for name, reason in self.failed.items()),
        ]
        return "\n  ".join(lines)


def replay(
    prepared: Prepared, models: Sequence[FilterModel], outages: Sequence[Outage], *, reference: str = "best"
) -> Replay:
    """Return the drift of all filters in the same outages. A filter that cannot run is left out; ``failed`` has the reason.

    Args:
        prepared: the log.
        models: the filters, with different names.
        outages: in order of time.
        reference: as for ``reference_track``.

    Raises:
        UsageError: an outage that is not possible.
        MissingDataError: no filter can run; no outage that can be scored.
        ValueError: the log lacks the wanted reference.
    """
    check_outages(prepared, models[0], outages)
    solutions, failed = _solutions(prepared, models)
    running = [model for model in models if model.name in solutions]
    best = next((m for name in BEST for m in running if m.name == name), running[0])
    smooth = needs_smoothing(prepared.log, reference)
    track = reference_track(
        prepared.log, run(best, prepared, smooth=True) if smooth else solutions[best.name], reference
    )
    runs = {name: FilterRun(solution, {}) for name, solution in solutions.items()}
    chosen = {d: [o for o in outages if o.duration == d] for d in sorted({outage.duration for outage in outages})}
    for duration in tracked(list(chosen), len(chosen)):
        _score(runs, chosen[duration], duration, track)
    runs, lost_filters = _sound(runs)
    scored: dict[float, Booleans] = {}
    early = _early(prepared, models[0], outages)
    unscored: list[Note] = []
    for duration, own in chosen.items():
        good = np.all([_finite(r.outages[duration]) for r in runs.values()], axis=0)
        gap = with_gap(prepared, own)
        unscored.extend(_unscored(duration, int((~good).sum()), int(gap.sum()), track.name))
        scored[duration] = good & ~gap
    if not any(rows.any() for rows in scored.values()):
        raise MissingDataError(f"{prepared.log.provenance.path}: no outage can be scored: {'; '.join(unscored)}")
    notes = (*prepared.notes, *early, *_doubted(track), *unscored)
    return Replay(prepared, track, runs, scored, notes, {**failed, **lost_filters})


def _solutions(prepared: Prepared, models: Sequence[FilterModel]) -> tuple[dict[str, Solution], dict[str, str]]:
    """Return the runs of the filters over the whole log, and the reasons of those that cannot run."""
    solutions: dict[str, Solution] = {}
    failed: dict[str, str] = {}
    for model in models:
        try:
            solutions[model.name] = run(model, prepared)
        except ImuwbError as error:
            failed[model.name] = str(error).removeprefix(f"{model.name}: ").removeprefix(f"{model.name}, ")
    if not solutions:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in failed.items())
        raise MissingDataError(f"{prepared.log.provenance.path}: no filter can run: {reasons}")
    return solutions, failed


def _finite(own: ScoredDrift) -> Booleans:
    return np.asarray(np.isfinite(own.scores.horizontal).all(axis=1))


def _sound(runs: dict[str, FilterRun]) -> tuple[dict[str, FilterRun], dict[str, str]]:
    """Return the filters that have scores in most outages in which any filter has some, and the reasons of the others."""
    finite = {name: np.concatenate([_finite(own) for own in r.outages.values()]) for name, r in runs.items()}
    possible = np.any(list(finite.values()), axis=0)
    lost = {name: int((possible & ~own).sum()) for name, own in finite.items()}
    failed = {
        name: f"its states or its variances become invalid in {count} of {int(possible.sum())} outages"
        for name, count in lost.items()
        if count > MOST_INVALID * possible.sum()
    }
    return {name: own for name, own in runs.items() if name not in failed}, failed


def _score(runs: dict[str, FilterRun], outages: Sequence[Outage], duration: float, track: ReferenceTrack) -> None:
    """Add the outages of a duration to the runs."""
    for filter_run in tracked(runs.values(), len(runs)):
        solution = filter_run.solution
        drifted = drift(solution, events_of(solution, outages), duration)
        against = scores(drifted, track)
        filter_run.outages[duration] = ScoredDrift(drifted, against, scores(drifted, own_track(solution)))


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

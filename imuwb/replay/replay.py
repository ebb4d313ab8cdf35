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
from imuwb.replay.judging import Drifts, Judgement, OwnScores, judge
from imuwb.replay.outages import SPACING, Outage, check_outages, events_of, with_gap
from imuwb.replay.prepared import Prepared, run
from imuwb.replay.references.reference import ReferenceTrack, own_track, reference_names, reference_track
from imuwb.replay.scoring.scores import Scores, scores

BEST = ("tuned", "motion", "full", "18AV", "15AV")  #: the filters whose run is a reference, in order of preference
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
    outages: dict[float, tuple[Outage, ...]]  #: duration -> its s outages

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
    by_duration = {d: [o for o in outages if o.duration == d] for d in sorted({outage.duration for outage in outages})}
    drifts: dict[str, dict[float, Drift]] = {name: {} for name in solutions}
    for duration, name in tracked([(d, n) for d in by_duration for n in solutions], len(by_duration) * len(solutions)):
        solution = solutions[name]
        drifts[name][duration] = drift(solution, events_of(solution, by_duration[duration]), duration)
    own = {
        name: {d: scores(drifted, own_track(solutions[name])) for d, drifted in of_name.items()}
        for name, of_name in drifts.items()
    }
    lost = _invalid(own)
    drifts = {name: of_name for name, of_name in drifts.items() if name not in lost}
    own = {name: own[name] for name in drifts}
    running = [model for model in models if model.name in drifts]
    best = next((m for name in BEST for m in running if m.name == name), running[0])
    gaps = {duration: with_gap(prepared, chosen) for duration, chosen in by_duration.items()}
    judgement, refused = _judged(prepared, best, solutions[best.name], reference, (drifts, own, gaps))
    if not any(rows.any() for rows in judgement.scored.values()):
        why = "; ".join((*refused, *judgement.notes))
        raise MissingDataError(f"{prepared.log.provenance.path}: no outage can be scored: {why}")
    runs = {
        name: FilterRun(
            solutions[name],
            {d: ScoredDrift(drifted, judgement.scores[name][d], own[name][d]) for d, drifted in of_name.items()},
        )
        for name, of_name in drifts.items()
    }
    notes = (*prepared.notes, *_early(prepared, models[0], outages), *refused, *_doubted(judgement.track))
    return Replay(
        prepared, judgement.track, runs, judgement.scored, (*notes, *judgement.notes), {**failed, **lost},
        {duration: tuple(chosen) for duration, chosen in by_duration.items()},
    )  # fmt: skip


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


def _invalid(own: OwnScores) -> dict[str, str]:
    """Return the filters that are invalid in many of the outages in which any filter is valid, and the reasons."""
    valid = {
        name: np.concatenate([np.isfinite(s.horizontal).all(axis=1) for s in of_name.values()])
        for name, of_name in own.items()
    }
    possible = np.any(list(valid.values()), axis=0)
    lost = {name: int((possible & ~rows).sum()) for name, rows in valid.items()}
    return {
        name: f"its states or its variances become invalid in {count} of {int(possible.sum())} outages"
        for name, count in lost.items()
        if count > MOST_INVALID * possible.sum()
    }


def _judged(
    prepared: Prepared,
    model: FilterModel,
    solution: Solution,
    wanted: str,
    outages: tuple[Drifts, OwnScores, dict[float, Booleans]],
) -> tuple[Judgement, tuple[Note, ...]]:
    """Return the scores against the wanted reference, and which references were refused; "best" takes the next one then.

    Raises:
        MissingDataError: no reference can judge.
        ValueError: the log lacks the wanted reference.
    """
    refused: list[Note] = []
    for name in reference_names(prepared.log, wanted):
        smooth = run(model, prepared, smooth=True) if name == "smoothed" else solution
        judgement = judge(prepared, reference_track(prepared.log, smooth, name), *outages)
        if not judgement.refused:
            return judgement, tuple(refused)
        text = f"{judgement.track.name} is refused as a reference: {judgement.refused}"
        refused.append(Note("reference-refused", text))
    remedy = (
        "state its --truth-delay or --truth-lever, name another file with --truth, or judge without it: --reference smoothed"
        if wanted == "truth"
        else "name another reference with --truth or --reference"
    )
    raise MissingDataError(f"{prepared.log.provenance.path}: no outage can be scored: {'; '.join(refused)}; {remedy}")


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

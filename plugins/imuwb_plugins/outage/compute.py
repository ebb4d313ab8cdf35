"""From a log to the result of an outage replay."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.conditioning import corrected_log
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.navigation import FilterModel
from imuwb.notes import Note
from imuwb.replay import (
    Degradation,
    Outage,
    Prepared,
    Replay,
    check_outages,
    own_outages,
    prepare,
    replay,
    sweep,
    verdict,
)
from imuwb_plugins.outage import filters, notes, summary, tracks
from imuwb_plugins.outage.drive import drive
from imuwb_plugins.outage.given_outages import outages_of
from imuwb_plugins.outage.installation import Installed, base_of, installed
from imuwb_plugins.outage.models import Filters, filters_of
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.pictures import pictures
from imuwb_plugins.outage.result import Result
from imuwb_plugins.outage.truth import truth_file, with_truth


def run_one(whole: Log, parameters: Parameters) -> Result:
    """Return the drift of each filter in the outages of a log.

    Raises:
        UsageError: no error model; an outage that is not possible.
        MissingDataError: the log lacks something.
    """
    log, _ = corrected_log(whole, base_of(parameters).error_model)
    given = truth_file(log, parameters)
    own = installed(log, parameters)
    base = own.base
    log, of_truth = with_truth(log, base, parameters, given)
    worse = Degradation(**parameters.degrade, seed=parameters.seed) if parameters.degrade else None
    prepared = prepare(log, base, parameters.receiver, worse)
    # What is not possible is said before the long work.
    if base.aids.speed and not log.speeds:
        raise MissingDataError(f"{log.provenance.path}: the log has no speed, which --speed needs; leave --speed out")
    outages = _outages(prepared, base, parameters)
    check_outages(prepared, base, outages)
    chosen = filters_of(base, prepared, parameters)
    prepared = replace(
        prepared, notes=(*prepared.notes, *of_truth, *own.notes, *chosen.notes, *_of_a_sweep(parameters))
    )
    try:
        replayed = replay(prepared, chosen.models, outages, reference=parameters.wanted_reference)
    except ValueError as error:
        raise MissingDataError(f"{log.provenance.path}: {error}") from error
    replayed = replace(replayed, failed={**chosen.failed, **replayed.failed})
    return _result(replayed, parameters, own, chosen)


def _result(replayed: Replay, parameters: Parameters, own: Installed, chosen: Filters) -> Result:
    outages = summary.outage_results(replayed)
    statistics = {duration: summary.summaries(replayed, duration, parameters.level) for duration in replayed.scored}
    durations = tuple(
        summary.duration_summary(replayed, duration, by_filter, parameters.level)
        for duration, by_filter in statistics.items()
    )
    causal = replayed.prepared.log.causal
    infos = tuple(filters.info(each, causal=causal) for each in replayed.runs.values())
    verdicts = [
        notes.prefixed(f"{d:g} s", verdict(s)) for d, by_filter in statistics.items() for s in by_filter.values()
    ]
    return Result(
        outages, summary.listed(outages), durations, summary.samples(replayed), summary.published(outages), infos,
        filters.budget(replayed), replayed.reference.name, tuple(dict.fromkeys(verdicts)),
        notes.notes(replayed, durations, infos, own, chosen), own.clocks, own.mounting, chosen.motion,
        own.correlation, chosen.tuned, chosen.error_model,
        replayed.reference.position, drive(replayed, durations), parameters.map,
        tracks.navigation(replayed), replayed.failed, replayed, autoregressive_origin=chosen.autoregressive,
        pictures=pictures(replayed) if parameters.at and parameters.at != "own" else (),
    )  # fmt: skip


def _of_a_sweep(parameters: Parameters) -> tuple[Note, ...]:
    """Return a note on the options of a sweep that are given although --at names the outages."""
    given = [name for name in ("durations", "random") if getattr(parameters, name) != getattr(Parameters, name)]
    if not parameters.at or not given:
        return ()
    names = " and ".join(f"--{name}" for name in given)
    return (Note("sweep-options", f"{names} without effect: --at names the outages, so there is no sweep"),)


def _outages(prepared: Prepared, base: FilterModel, parameters: Parameters) -> Sequence[Outage]:
    if parameters.at == "own":
        outages = own_outages(prepared, base)
        if not outages:
            raise MissingDataError(
                f"{prepared.log.provenance.path}: the log has no outage of its own after the filters have settled, at "
                f"{prepared.start_time + base.settings.settling:.1f} s: its good fixes are never apart for long; leave --at out for a "
                "sweep, or name the outages with --at START:DURATION"
            )
        return outages
    if parameters.at:
        return outages_of(prepared.log, parameters.at)
    chosen: list[Outage] = []
    for duration in sorted(set(parameters.durations)):
        swept = sweep(prepared, base, duration)
        if parameters.random and len(swept) > parameters.random:
            rng = np.random.default_rng(parameters.seed)
            rows = np.sort(rng.choice(len(swept), parameters.random, replace=False))
            swept = tuple(swept[i] for i in rows)
        chosen.extend(swept)
    return chosen

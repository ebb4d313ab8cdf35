"""Several drives: each alone, and all of them pooled."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.replay import HORIZONS, motion_classes, pooled, summarize, verdict
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import counted
from imuwb_plugins.outage import notes, summary
from imuwb_plugins.outage.compute import run_one
from imuwb_plugins.outage.engine_command import Command
from imuwb_plugins.outage.engine_rows import with_engines
from imuwb_plugins.outage.filters import nis_per_dof
from imuwb_plugins.outage.given_outages import name_of
from imuwb_plugins.outage.outage_list import given
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import DurationSummary, PublishedGain, Result
from imuwb_plugins.outage.smoothed import with_smoothed

ONE_LOG = ("navigation", "smoothed", "save_filter")  #: outputs that belong to one log


@dataclass(frozen=True, eq=False, slots=True)
class Drives:
    """The results of several drives."""

    pooled: tuple[DurationSummary, ...]  #: of the filters that ran in all drives
    drives: dict[str, Result]  #: name of a log -> its result
    verdicts: tuple[Note, ...]  #: on the pooled outages
    notes: tuple[str, ...]
    failed: dict[str, str]  #: name of a log that cannot be replayed -> reason
    published: dict[str, PublishedGain]  #: by filter, over the outages of all drives; empty without 18AVWD

    def __repr__(self) -> str:
        """Return the drives and the verdicts, a line each."""
        return "\n  ".join(
            [f"Outage replay of {counted(len(self.drives), 'drive')}: {', '.join(self.drives)}", *self.verdicts]
        )


def run(logs: Sequence[Log], parameters: Parameters) -> Result | Drives:
    """Return the drift of each filter in the outages of a log; of several logs, each alone and all pooled.

    Raises:
        UsageError: no error model; an outage that is not possible.
        MissingDataError: the log lacks something; of several logs, none can be replayed.
    """
    if len(logs) == 1:
        _check_logs(logs, parameters)
        return with_engines(with_smoothed(run_one(logs[0], parameters), parameters), parameters)
    for name in ONE_LOG:
        if getattr(parameters, name) is not None:
            raise UsageError(f"--{name.replace('_', '-')} writes the run of one log; {len(logs)} logs are given")
    _check_logs(logs, parameters)
    results: dict[str, Result] = {}
    failed: dict[str, str] = {}
    for name, log in zip(_names(logs), logs, strict=True):
        try:
            results[name] = with_engines(run_one(log, parameters), parameters)
        except MissingDataError as error:
            failed[name] = str(error)
    if not results:
        raise MissingDataError(f"no drive can be replayed: {'; '.join(failed.values())}")
    return _pooled(results, failed, parameters.level)


def error_model(result: Result | Drives) -> ImuErrorModel:
    """Return the error model in motion, or the tuned one.

    Raises:
        UsageError: no filter has such a model, or several logs.
    """
    if isinstance(result, Drives):
        raise UsageError(f"--save-model writes the model of one log; {len(result.drives)} logs are replayed")
    if result.error_model is None:
        raise UsageError("--save-model writes the error model in motion: give --models full,motion, or --tune")
    return result.error_model


def _check_logs(logs: Sequence[Log], parameters: Parameters) -> None:
    """Raise UsageError if an outage of --at names a log that is not given, or a command cannot be run."""
    if parameters.filter_command:
        Command.of(parameters.filter_command, parameters.filter_timeout)
    names = {name for log in logs for name in ("", name_of(log), Path(log.provenance.path).name)}
    strange = next((outage for outage in given(parameters.at) if outage.log not in names), None)
    if strange is not None:
        known = ", ".join(map(name_of, logs))
        raise UsageError(f"--at {parameters.at}: there is no log {strange.log!r}; the logs are {known}")


def _names(logs: Sequence[Log]) -> list[str]:
    """Return a name for each log; equal names of files get a number."""
    names = [name_of(log) for log in logs]
    return [f"{name} {names[: i + 1].count(name)}" if names.count(name) > 1 else name for i, name in enumerate(names)]


def _pooled(results: dict[str, Result], failed: dict[str, str], level: float) -> Drives:
    durations = sorted({s.duration for result in results.values() for s in result.summary})
    pooled_summaries = tuple(_of_duration(list(results.values()), duration, level) for duration in durations)
    verdicts: list[Note] = []
    for own, statistics in pooled_summaries:
        verdicts += [notes.prefixed(f"all drives, {own.duration:g} s", verdict(s)) for s in statistics.values()]
    texts = [f"{name} is left out: {reason}" for name, reason in failed.items()]
    counts = ", ".join(f"{name} ({counted(len(result.outages), 'outage')})" for name, result in results.items())
    pooled_note = Note("pooled", f"pooled: {counts}; blocks of the bootstrap do not cross drives")
    return Drives(
        tuple(own for own, _ in pooled_summaries), results, tuple(dict.fromkeys(verdicts)),
        (pooled_note, *(Note("drive-left-out", text) for text in texts)), failed,
        summary.published(tuple(own for result in results.values() for own in result.outages)),
    )  # fmt: skip


def _of_duration(
    results: Sequence[Result], duration: float, level: float
) -> tuple[DurationSummary, dict[str, summary.Summary]]:
    """Return the summary of the filters that ran in all drives that have outages of a duration."""
    replays = [r.replay for r in results if r.replay is not None and r.replay.scored.get(duration, np.zeros(1)).any()]
    if not replays:
        return DurationSummary(duration, {}, (), {}, None), {}
    parts = [summary.scored(replay, duration) for replay in replays]
    names = [name for name in parts[0] if all(name in part for part in parts)]
    kept = {name: pooled([part[name] for part in parts]) for name in names}
    horizons = tuple(sorted({*HORIZONS, duration}))
    statistics = {
        name: own
        for name, scores in kept.items()
        if (own := summarize(
            name, duration, scores, horizons, float(np.mean([nis_per_dof(r.runs[name])[0] for r in replays])), level
        )) is not None
    }  # fmt: skip
    motion = np.concatenate([motion_classes(replay, duration)[replay.scored[duration]] for replay in replays])
    return summary.summary_of(duration, kept, motion, statistics, level), statistics

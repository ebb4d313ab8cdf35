"""Other engines in the tables of a replay: solutions of --solution, and the engine of --filter-command."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from imuwb.arrays import Integers
from imuwb.errors import ImuwbError, UsageError
from imuwb.log import Reference
from imuwb.progress import tracked
from imuwb.readers import read_trajectory
from imuwb.replay import (
    Outage,
    Placing,
    Replay,
    Scores,
    external_reference,
    fixes_outside,
    overlapping,
    solution_scores,
    whole_run_scores,
    without_overlap,
)
from imuwb.replay.scoring.pooling import joined
from imuwb_plugins.outage.engine_command import Command, EngineRun, run_engine
from imuwb_plugins.outage.given_outages import name_of
from imuwb_plugins.outage.parameters import Parameters

WHOLE = "whole:"  #: before a path: the run has used all fixes
SHOWN = 3  #: failures that are listed
WORKERS = 2  #: parallel runs of a command, if the machine has as many processors


@dataclass(frozen=True, eq=False, slots=True)
class Engine:
    """The scores of another engine."""

    name: str
    source: str  #: its file, or its command
    sigmas: bool = False  #: whether its solutions state sigmas of positions
    parts: dict[float, tuple[Integers, Scores]] = field(default_factory=dict[float, tuple[Integers, Scores]])
    #: ^ duration -> (k,) outages of this duration, and the scores in them
    whole: Scores | None = None  #: over the whole run; None: scored in outages
    tried: int = 1  #: runs or files
    failures: tuple[str, ...] = ()  #: reasons, one for each run or file without a solution


def engines_of(replay: Replay, parameters: Parameters) -> tuple[Engine, ...]:
    """Return the engines that the user names, with their scores.

    Raises:
        UsageError: two engines with one name, or the name of a filter.
    """
    engines = [_of_file(name, str(path), replay, parameters) for name, path in parameters.solution.items()]
    if parameters.filter_command:
        command = Command.of(parameters.filter_command, parameters.filter_timeout)
        taken = {*replay.runs, *replay.failed, *parameters.solution}
        name = f"{command.name} (command)" if command.name in taken else command.name
        engines.append(_of_command(command, name, replay, parameters))
    same = [name for name in parameters.solution if name in (*replay.runs, *replay.failed)]
    if same:
        raise UsageError(f"--solution {same[0]}=...: a filter has this name; choose another one")
    return tuple(engines)


def _of_file(name: str, text: str, replay: Replay, parameters: Parameters) -> Engine:
    """Return the scores of a solution in one file or one for each outage."""
    text = text.replace("{log}", name_of(replay.prepared.log))
    if "{outage}" in text or "{start}" in text:
        numbered = [
            (duration, i, text.replace("{outage}", outage.name or str(i + 1)).replace("{start}", f"{outage.start:g}"))
            for duration, of_duration in replay.outages.items()
            for i, outage in enumerate(of_duration)
            if replay.scored[duration][i]
        ]
        runs = [(d, i, _read(Path(path), replay)) for d, i, path in numbered]
        return _in_outages(Engine(name, text), runs, replay, parameters)
    all_fixes = text.startswith(WHOLE)
    run = _read(Path(text.removeprefix(WHOLE)), replay)
    if all_fixes or overlapping(replay):
        try:
            solution = _placed(run, replay, (), parameters)
        except ImuwbError as error:
            return Engine(name, text, failures=(str(error),))
        scores = whole_run_scores(replay, solution)
        if not scores.start.size:
            return Engine(name, text, failures=("it has no position where the reference has one",))
        return Engine(name, text, solution.position_sigma is not None, whole=scores)
    every = [(d, i, run) for d, rows in replay.scored.items() for i in np.flatnonzero(rows).tolist()]
    found = _in_outages(Engine(name, text), every, replay, parameters, alone=False)
    return Engine(name, text, found.sigmas, found.parts, failures=found.failures[:1] if not found.parts else ())


def _of_command(command: Command, name: str, replay: Replay, parameters: Parameters) -> Engine:
    """Return the scores of a command that runs outage by outage."""
    chosen: list[tuple[float, int]] = []
    for duration, rows in replay.scored.items():
        possible = np.flatnonzero(rows)
        start = np.array([outage.start for outage in replay.outages[duration]])
        apart = possible[without_overlap(start[possible], duration)]
        most = min(parameters.filter_runs, apart.size)
        chosen += [(duration, int(i)) for i in apart[np.unique(np.linspace(0, apart.size - 1, most).astype(int))]]
    workers = parameters.filter_parallel or min(WORKERS, os.cpu_count() or 1)

    def one(item: tuple[float, int]) -> tuple[float, int, EngineRun]:
        duration, i = item
        prepared, outage = replay.prepared, replay.outages[duration][i]
        return duration, i, run_engine(command, prepared.log, prepared.gnss, outage, _delay(replay))

    with ThreadPoolExecutor(workers) as pool:
        runs = list(tracked(pool.map(one, chosen), len(chosen)))
    return _in_outages(Engine(name, " ".join(command.words)), runs, replay, parameters)


def _read(path: Path, replay: Replay) -> EngineRun:
    try:
        return EngineRun(read_trajectory(path, near=replay.prepared.log.zero))
    except ImuwbError as error:
        return EngineRun(None, str(error))


def _delay(replay: Replay) -> float:
    """Return the time by which the stamps of the fixes are late, s."""
    return next(iter(replay.runs.values())).solution.model.installation.gnss_delay


def _placed(run: EngineRun, replay: Replay, without: Sequence[Outage], parameters: Parameters) -> Reference:
    """Return a solution on the log's clock; a frame of its own is fitted to the fixes outside of some outages.

    Raises:
        ImuwbError: there is none.
    """
    if run.solution is None:
        raise ImuwbError(run.failure)
    log = replay.prepared.log
    gnss = fixes_outside(replay.prepared.gnss, log.zero or 0, without, _delay(replay))
    return external_reference(run.solution, log, gnss, Placing(parameters.solution_delay), "solution")[0]


def _in_outages(
    engine: Engine, runs: Sequence[tuple[float, int, EngineRun]], replay: Replay, parameters: Parameters, *, alone: bool = True
) -> Engine:  # fmt: skip
    """Return an engine with the scores of its runs.

    Args:
        engine: its name and source.
        runs: duration, outage among those of this duration, and solution.
        replay: the replay.
        parameters: the options.
        alone: whether each run lacks only the fixes of its own outage; else one run lacks those of all outages.
    """
    found: dict[float, list[tuple[int, Scores]]] = {}
    failures: list[str] = []
    sigmas = False
    every = [outage for of_duration in replay.outages.values() for outage in of_duration]
    known: dict[int, Reference] = {}
    for duration, i, run in runs:
        outage = replay.outages[duration][i]
        try:
            if id(run) not in known:
                known[id(run)] = _placed(run, replay, [outage] if alone else every, parameters)
            solution = known[id(run)]
        except ImuwbError as error:
            failures.append(f"outage at {outage.start:g} s: {error}")
            continue
        scores = solution_scores(replay, solution, duration, np.array([i]))
        sigmas = solution.position_sigma is not None
        if np.isfinite(scores.horizontal).all():
            found.setdefault(duration, []).append((i, scores))
        else:
            failures.append(f"outage at {outage.start:g} s: its solution has a gap there, or ends before")
    parts = {d: (np.array([i for i, _ in rows]), joined([s for _, s in rows])) for d, rows in found.items()}
    return Engine(engine.name, engine.source, sigmas, parts, None, len(runs), tuple(failures))

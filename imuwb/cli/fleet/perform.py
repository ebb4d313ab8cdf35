"""Runs an analysis over a fleet of logs, from the patterns to the tables."""

import hashlib
import json
import shlex
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, cast

import typer

from imuwb import __version__, registry
from imuwb.analysis import Analysis, offers
from imuwb.cli.fleet.display import watching
from imuwb.cli.fleet.options import Owners, Results, Work
from imuwb.cli.fleet.owners import rule_of
from imuwb.cli.fleet.panel import print_ending
from imuwb.cli.fleet.work import Job, Reply, Settings, prepare, work
from imuwb.cli.options import Conditions, Part
from imuwb.cli.through import step
from imuwb.errors import ImuwbError, UsageError
from imuwb.fleet import parts
from imuwb.fleet.executor import Bounds, Call, Completed, Executor
from imuwb.fleet.in_process import InProcess
from imuwb.fleet.listing import found
from imuwb.fleet.local_pool import LocalPool
from imuwb.fleet.plan import Task, ordered, planned
from imuwb.fleet.progress import Progress, ProgressFile
from imuwb.fleet.run_state import RunState, check_fits, run_state
from imuwb.fleet.running import completed
from imuwb.fleet.schemas import SCHEMA
from imuwb.fleet.store import Store, store_at
from imuwb.fleet.tables import Entry, Tables, hash_of_tables, tables_of
from imuwb.readers.bytes.address import without_secrets
from imuwb.readers.read_options import ReadOptions
from imuwb.review.answers.document import plain
from imuwb.selection import ALL
from imuwb.texts import counted

GB = 1e9
SAME = 5  #: logs, which end with one and the same fault of usage, after which a run ends: its options are wrong
WARM = 20  #: logs; with fewer, each worker compiles what it needs itself
FIRST_LOOK, LOOKS = 60.0, 100  #: s after which the tables are written early, and later times the time that this takes
STOPPED = ("time", "memory", "crash")  #: faults that are those of the log, and are not tried again with the same bounds


@dataclass(frozen=True, slots=True)
class Asked:
    """What a user asks of a fleet."""

    name: str  #: of the analysis, with its method
    source: str  #: name that finds it, or its file
    method: str  #: of a file with several; empty: none
    analysis: Analysis
    parameters: object
    part: Part
    reading: ReadOptions
    conditions: Conditions
    owners: Owners
    work: Work
    results: Results


@dataclass(slots=True)
class _Run:
    """A run under way: the tasks, and what became of each."""

    store: Store
    settings: Settings
    tasks: Sequence[Task]
    parts: dict[str, str]  #: tag -> name of the part
    bounds: Bounds
    kinds: Counter[str] = field(default_factory=Counter[str])  #: of the faults, of this run only
    faults: dict[str, dict[str, str]] = field(default_factory=dict[str, dict[str, str]])  #: tag -> stage, kind, message

    def entries(self) -> Iterator[Entry]:
        """Yield the logs that are ready."""
        for task in self.tasks:
            if task.tag in self.parts or task.tag in self.faults:
                yield Entry(task, self.parts.get(task.tag, ""), cast("Any", self.faults.get(task.tag)))

    def digest(self) -> str:
        """Return a hash of all that the tables are made of."""
        known = [
            (e.task.log.place, e.task.log.tag, e.task.identity.vehicle, e.task.identity.serial, e.task.identity.family,
             e.task.identity.date, e.part, sorted(cast("dict[str, str]", e.fault or {}).items()))
            for e in self.entries()
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(known).encode()).hexdigest()


def perform(patterns: Sequence[str], asked: Asked) -> None:
    """Find the logs, analyse those that have no result yet, and write the tables.

    Raises:
        UsageError: an option is wrong, no log matches, or the results are those of another run.
        ImuwbError: a store or a scheduler does not answer.
    """
    _check(asked)
    place = asked.results.output
    store = store_at(place)
    state = _state(patterns, asked)
    before = None if asked.results.force else run_state(store, place)
    check_fits(state, before, place)
    rule = rule_of(asked.owners)
    tasks = planned(found(patterns, place), rule, _values(asked))
    settings = Settings(
        asked.name, asked.source, asked.method, {f.name: getattr(asked.parameters, f.name) for f in fields(cast("Any", asked.parameters))},
        asked.part, asked.reading, tuple(asked.conditions.through), place, state.run,
    )  # fmt: skip
    bounds = Bounds(asked.work.task_time, asked.work.task_memory * GB)
    known = parts.known_parts(store, state.run, [parts.stopped_content(bounds)])
    own = {task.tag: known[task.tag] for task in tasks if task.tag in known}
    run = _Run(store, settings, tasks, own, bounds)
    for task in tasks:
        if task.missing:
            text = f"an option has {{{task.missing}}}, and the {task.missing} of this log is not known"
            run.faults[task.tag] = {"stage": "identity", "kind": "not known", "message": text}
    todo = ordered(task for task in tasks if task.tag not in own and not task.missing)
    executor = _executor(asked.work, todo)
    state = replace(state, logs=len(tasks), executor=executor.name)
    try:
        if todo:
            state.write(store)
            _work(run, todo, executor, state, look=bool(known))
    except (KeyboardInterrupt, ImuwbError) as stop:
        with suppress(ImuwbError):  # the store may be what has failed
            _finish(run, replace(state, state="interrupted"), None)
            if isinstance(stop, KeyboardInterrupt):
                typer.echo(
                    f"imuwb: the tables have {len(run.parts)} of {counted(len(tasks), 'log')}; the same command goes on with the others",
                    err=True,
                )
        raise
    finally:
        executor.close()
    ended, wrote = _finish(run, replace(state, state="ended"), before)
    unused = rule.unused([task.log for task in tasks])
    print_ending(ended, run.store, patterns, place, len(todo), wrote=wrote, unused=unused)


def _work(run: _Run, todo: Sequence[Task], executor: Executor, state: RunState, *, look: bool) -> None:
    """Analyse logs, and note the part or the fault of each; from time to time, write the tables of what is ready."""
    calls = (Call(work, Job(run.settings, task, look), run.bounds, prepare) for task in todo)
    if len(todo) >= WARM:
        executor.warm()
    file, progress = ProgressFile(run.store), Progress(len(todo))
    written, wait, said = time.monotonic(), FIRST_LOOK, set[str]()
    try:
        with watching(progress, executor.link) as update:
            for done in completed(calls, executor):
                task = todo[done.number]
                kind, message = _note(run, task, done)
                said.add(message if _is_of_options(done) and not look else "")
                file.add(progress.add(without_secrets(task.log.place), kind, message, done.worker))
                update()
                if progress.done == SAME and said == {message} and message:
                    raise UsageError(f"{message}. The first {SAME} logs all end so; no further one was read")
                if time.monotonic() - written > wait:
                    began = time.monotonic()
                    _finish(run, state, None)
                    written = time.monotonic()
                    wait = max(FIRST_LOOK, LOOKS * (written - began))
    finally:
        file.close()


def _is_of_options(done: Completed) -> bool:
    """Return whether an analysis refused its options, after the log was read."""
    reply = cast("Reply | None", done.value)
    return done.fault is None and reply is not None and (reply.kind, reply.stage) == ("usage", "analyse")


def _note(run: _Run, task: Task, done: Completed) -> tuple[str, str]:
    """Note what became of a log, and return the kind of its fault and the message; both are empty for a result."""
    if done.fault is None:
        reply: Reply = done.value
        run.parts[task.tag] = reply.part
        return reply.kind, reply.message
    kind, message = done.fault.kind, without_secrets(done.fault.message)
    row = {"stage": "analyse", "kind": "fault" if kind == "crash" else kind, "message": message}
    if kind in STOPPED:
        name = parts.part_name(run.settings.run, task.tag, parts.stopped_content(run.bounds))
        run.store.create(name, parts.Part(quarantine=(cast("Any", row),)).packed())
        run.parts[task.tag] = name
    else:
        run.faults[task.tag] = row
    return kind, message


def _finish(run: _Run, state: RunState, before: RunState | None) -> tuple[RunState, bool]:
    """Write the tables, unless they are there, and the state of the run; return the state, and whether the tables were written."""
    digest = run.digest()
    if before is not None and before.digest == digest and before.tables and before.tables == hash_of_tables(run.store):
        state = replace(state, done=before.done, quarantined=before.quarantined, digest=digest, tables=before.tables)
        if replace(state, executor=before.executor, command=before.command) != before:
            state.write(run.store)
        return state, False
    tables: Tables = tables_of(run.entries(), run.store)
    written = tables.write(run.store)
    states = Counter(tables.by_name["logs"].column("state").to_pylist())
    state = replace(state, done=states["done"], quarantined=states["quarantined"], digest=digest, tables=written)
    state.write(run.store)
    return state, True


def _check(asked: Asked) -> None:
    """Check the options that a fleet does not have, and those of the conditioners."""
    fewest, _ = cast("tuple[int, int | None]", getattr(asked.analysis, "LOGS", (1, 1)))
    if fewest > 1:
        raise UsageError(f"{asked.name} takes {fewest} logs at a time; over a fleet each log is analysed alone")
    if asked.part.imu == ALL and not getattr(asked.analysis, "EVERY_IMU", False):
        raise UsageError(f"--imu {ALL} compares the IMUs of one log; over a fleet, name one")
    if offers(asked.analysis, "outputs") and cast("Any", asked.analysis).outputs(asked.parameters):
        raise UsageError("an option names a file that the analysis writes for one log; leave it out over a fleet")
    for text in asked.conditions.through:
        step(text)
    if asked.work.scheduler is not None and asked.work.workers is not None and asked.work.scheduler != "local":
        raise UsageError("--workers is for this machine; the workers of --scheduler are those that the cluster has")


def _executor(asked: Work, todo: Sequence[Task]) -> Executor:
    if not todo:
        return InProcess()
    if asked.scheduler is not None:
        from imuwb.fleet.dask_cluster import DaskCluster, local_cluster  # noqa: PLC0415 - an extra

        own = local_cluster(asked.workers or 0) if asked.scheduler == "local" else None
        return DaskCluster(asked.scheduler, __version__, own)
    return InProcess() if asked.workers == 0 else LocalPool(asked.workers or 0, most=len(todo))


def _values(asked: Asked) -> Iterator[tuple[str, object]]:
    """Yield the options that may name files or have a part of the identity in braces."""
    for group, options in (("parameters", asked.parameters), ("part", asked.part), ("reading", asked.reading)):
        for f in fields(cast("Any", options)):
            value = getattr(options, f.name)
            if isinstance(value, str | Path | list | tuple) and value:
                yield f"{group}.{f.name}", value


def _state(patterns: Sequence[str], asked: Asked) -> RunState:
    """Return the state of a run that begins; its name is a hash of all that decides what is found in a log."""
    params = cast("dict[str, Any]", plain(asked.parameters, "parameters"))
    _, _, method = asked.name.partition(" ")
    decides = [
        asked.name, params, plain(asked.part), plain(asked.reading), asked.conditions.through, __version__, SCHEMA, _version(asked.source),
    ]  # fmt: skip
    name = hashlib.sha256(json.dumps(decides, sort_keys=True, default=str).encode()).hexdigest()[:16]
    return RunState(
        imuwb=__version__, analysis=asked.name, params={**({"method": method} if method else {}), **params}, command=_command(),
        inputs=tuple(map(without_secrets, patterns)), executor="", run=name, level=params.get("level"),
    )  # fmt: skip


def _version(name: str) -> str:
    """Return what tells two versions of an analysis apart: the content of its file, or the version of its package."""
    if name.endswith(".py"):
        return hashlib.sha256(Path(name).read_bytes()).hexdigest()
    package = registry.installed(registry.ANALYSES)[name.partition(" ")[0]].dist
    return "" if package is None else f"{package.name} {package.version}"


def _command() -> str:
    return shlex.join(["imuwb", *map(without_secrets, sys.argv[1:])])

"""The work on one log of a fleet. It runs on the workers: it imports neither rerun nor what shows results."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, cast

from imuwb import registry
from imuwb.analysis import Analysis
from imuwb.axes import check_scaled
from imuwb.cli.analyses import analysis_named, errors_named
from imuwb.cli.imus import with_choice
from imuwb.cli.options import Conditions, Outputs, Part, Request
from imuwb.cli.reading import read_log
from imuwb.cli.through import conditioned
from imuwb.errors import MissingDataError, TransferError, UnreadableLogError, UsageError
from imuwb.fleet import parts
from imuwb.fleet.executor import TransportError
from imuwb.fleet.found import Row, log_row, outage_rows, sensor_rows
from imuwb.fleet.plan import Task
from imuwb.fleet.store import Store, store_at
from imuwb.readers.bytes import source
from imuwb.readers.bytes.address import place_of, without_secrets
from imuwb.readers.read_options import ReadOptions
from imuwb.texts import printable

#: error -> kind of fault; the first that fits
KINDS: tuple[tuple[type[Exception], str], ...] = (
    (UnreadableLogError, "unreadable"), (MissingDataError, "lacks data"), (UsageError, "usage"), (Exception, "fault"),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Settings:
    """What a run does with each log."""

    name: str  #: of the analysis, with its method
    source: str  #: name that finds it, or its file
    method: str  #: of a file with several; empty: none
    parameters: Mapping[str, object]
    part: Part
    reading: ReadOptions
    through: tuple[str, ...]
    results: str
    run: str  #: name of the folder of parts


@dataclass(frozen=True, slots=True)
class Job:
    """One log to work on."""

    settings: Settings
    task: Task
    look: bool  #: whether there may be a part of the same bytes


@dataclass(frozen=True, slots=True)
class Reply:
    """What became of a log."""

    part: str  #: name of its part
    kind: str = ""  #: of the fault; empty: a result
    message: str = ""
    stage: str = ""  #: in which the fault was


@dataclass(slots=True)
class _Stage:
    """What is being done, for the quarantine."""

    name: str = "read"
    log: dict[str, Any] = field(default_factory=dict[str, Any])


def prepare(job: Job) -> None:
    """Import the analysis, the readers, and the compiled code that all logs need."""
    plugin = loaded(job.settings.source, job.settings.method)
    for part in ("run", "findings", "answer", "drifts"):
        getattr(plugin, part, None)
    import_module("imuwb.sampling")
    for point in registry.installed(registry.READERS).values():
        registry.load(point)


def work(job: Job) -> Reply:
    """Analyse a log, write its part, and return its name.

    Raises:
        TransportError: a store or a network failed.
    """
    settings, task = job.settings, job.task
    store = _store(settings.results)
    if job.look and (known := _same(store, settings, task)) is not None:
        return known
    stage = _Stage()
    try:
        part = _examined(settings, task, stage)
    except (TransportError, TransferError, OSError) as error:
        raise TransportError(_message(error, task)) from None
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001 - an analysis may raise anything
        if not stage.log:
            stage.log["log"] = _digest(task.log.place)
        kind = next(name for kind, name in KINDS if isinstance(error, kind))
        row = {"log": stage.log["log"], "stage": stage.name, "kind": kind, "message": _message(error, task)}
        part = parts.Part(stage.log, quarantine=(row,))
    content = parts.content_name(part.log["log"] or task.tag, task.options)
    name = parts.part_name(settings.run, task.tag, content)
    store.create(name, part.packed())
    return _reply(name, part)


def _reply(name: str, part: parts.Part) -> Reply:
    first: Row = next(iter(part.quarantine), {})
    return Reply(name, *(first.get(key, "") for key in ("kind", "message", "stage")))


def _same(store: Store, settings: Settings, task: Task) -> Reply | None:
    """Return the reply of a part of the same bytes, which gets the name of this task; None: there is none."""
    place = place_of(task.log.place)
    if not isinstance(place, Path) or not place.is_file():
        return None
    content = parts.content_name(source.fingerprint(place), task.options)
    found = parts.same_content(store, settings.run, content)
    packed = None if found is None else store.read(found)
    if packed is None:
        return None
    name = parts.part_name(settings.run, task.tag, content)
    store.create(name, packed)
    return _reply(name, parts.Part.unpacked(packed))


def _examined(settings: Settings, task: Task, stage: _Stage) -> parts.Part:
    plugin, parameters, part, reading = made(settings, task)
    request = Request(reading, part, Conditions(list(settings.through)), Outputs())
    whole = read_log(place_of(task.log.place), reading, part)
    log = with_choice(whole, cast("Analysis", plugin), parameters, request)
    stage.log.update(log_row(log))
    stage.name = "analyse"
    log = conditioned(log, settings.through)[0]
    with errors_named(settings.name, plugin):
        for imu in () if getattr(plugin, "TAKES_COUNTS", False) else log.imus:
            check_scaled(log.provenance.path, imu, settings.name)
        result = plugin.run([log], parameters)
        sensors = tuple(sensor_rows(settings.name, plugin, parameters, result, log))
        return parts.Part(stage.log, sensors, tuple(outage_rows(settings.name, plugin, result, log)))


def made(settings: Settings, task: Task) -> tuple[Any, object, Part, ReadOptions]:
    """Return the analysis, its parameters, the part of the log and how it is read, with the options that are this log's own.

    Raises:
        UsageError: there is no such analysis, or a value is not allowed.
    """
    plugin = loaded(settings.source, settings.method)
    groups: dict[str, dict[str, object]] = {"parameters": dict(settings.parameters), "part": {}, "reading": {}}
    for key, value in task.values:
        group, _, name = key.partition(".")
        groups[group][name] = value
    try:
        parameters = plugin.Parameters(**groups["parameters"])
    except ValueError as error:
        raise UsageError(str(error)) from error
    part = replace(settings.part, **cast("Any", groups["part"]))
    return plugin, parameters, part, replace(settings.reading, **cast("Any", groups["reading"]))


@cache
def loaded(name: str, method: str) -> Any:  # noqa: ANN401 - an analysis
    """Return an analysis by its name or file, or one of the methods of a file."""
    plugin: Any = analysis_named(name)
    return plugin.METHODS[method] if method else plugin


@cache
def _store(place: str) -> Store:
    return store_at(place)


def _digest(place: str) -> str | None:
    """Return the hash of a log that cannot be read; None if its bytes cannot be read either."""
    found = place_of(place)
    try:
        return source.fingerprint(found) if isinstance(found, Path) and found.is_file() else None
    except OSError:
        return None


def _message(error: Exception, task: Task) -> str:
    """Return the text of an error without the place of the log, which may change while the part stays."""
    text = (str(error) or type(error).__name__).removeprefix(f"{place_of(task.log.place)}: ")
    return printable(without_secrets(text))

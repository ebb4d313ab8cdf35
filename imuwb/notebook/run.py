"""Runs an analysis as the command line does, from a notebook or a program."""

import shlex
import shutil
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, cast

from imuwb.analysis import offers, takes_no_log
from imuwb.cli.analyses import analysis_named
from imuwb.cli.imus import compares, comparison
from imuwb.cli.options import Conditions, Outputs, Part, Request
from imuwb.cli.perform import analysed, check_count, with_folders
from imuwb.cli.places import Places, reserved
from imuwb.cli.studies import grid
from imuwb.cli.through import step
from imuwb.errors import UsageError
from imuwb.notebook.outcome import RECORDING, Outcome
from imuwb.options import Option, options_of, read, text_of
from imuwb.readers.bytes.address import place_of
from imuwb.readers.read_options import ReadOptions

SHARED = (Part, ReadOptions, Conditions)


def run(analysis: str, *logs: str | Path, force: bool = False, force_model: bool = False, **options: Any) -> Outcome:  # noqa: ANN401 - each option has its own type
    """Return the result of an analysis, which shows itself in a notebook.

    Args:
        analysis: its name on the command line, with its method if it has several: "noise", "calibration six-position"; or the path
            of a plugin's file.
        logs: paths or addresses.
        force: whether files that an option of the analysis names may be overwritten.
        force_model: as the option of the command line.
        options: those of the command line, with underscores: ``start=60``, ``imu="/imu/data"``, ``through=["wavelet:levels=6"]``,
            ``rate=100``, ``error_model="m.toml"``; as values, or as the texts of the command line.

    Raises:
        UsageError: there is no such analysis or option, or a value is not allowed.
        ImuwbError: as the command.
    """
    plugin: Any = analysis_named(analysis)
    own = {option.name: option for option in options_of(plugin.Parameters)}
    kinds = {f.name: kind for kind in SHARED for f in fields(kind)}
    _check_names(analysis, options, {**own, **kinds})
    shared: dict[type, Any] = {
        kind: _made(kind, {n: v for n, v in options.items() if kinds.get(n) is kind and n not in own})
        for kind in SHARED
    }
    parameters = _made(plugin.Parameters, {name: value for name, value in options.items() if name in own})
    outputs = Outputs(force=force, force_model=force_model)
    request = Request(shared[ReadOptions], shared[Part], shared[Conditions], outputs, _command(analysis, logs, options))
    paths = with_folders(plugin, [place_of(str(log)) for log in logs])
    if not paths and not takes_no_log(plugin):
        raise UsageError(f"imuwb.run({analysis!r}): no log is given")
    check_count(analysis, plugin, paths)
    for text in request.conditions.through:
        step(text)
    grid(request.conditions.study)
    compared, name = compares(plugin, request), Path(analysis).stem if analysis.endswith(".py") else analysis
    plugin = comparison(name, plugin, paths, request) if compared else plugin
    files = tuple(plugin.outputs(parameters)) if offers(plugin, "outputs") else ()
    folder = Path(mkdtemp(prefix="imuwb-"))
    try:
        places = Places(folder / RECORDING, None, None, to_stdout=False, own=files)
        gnss = [place_of(request.part.gnss)] if request.part.gnss is not None else []
        with reserved(places.all(), [*paths, *gnss], force=force):
            done, drawn = analysed(name, plugin, paths, parameters, request, places, compared=compared)
            if files:
                plugin.write_outputs(done.result, parameters)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return Outcome(plugin, done, drawn, folder)


def _check_names(analysis: str, options: Mapping[str, object], known: Mapping[str, object]) -> None:
    """Raise UsageError for an option that the analysis does not have, or that names an output."""
    files = {f.name for f in fields(Outputs)} & options.keys() - known.keys()
    if files:
        raise UsageError(f"{', '.join(sorted(files))}: imuwb.run writes no file; use save(path) of what it returns")
    if strange := options.keys() - known.keys():
        raise UsageError(
            f"{analysis} has no option {', '.join(sorted(strange))}; the options are {', '.join(sorted(known))}"
        )


def _made(kind: type, given: Mapping[str, object]) -> Any:  # noqa: ANN401 - of the kind
    """Return a dataclass of options from values or texts.

    Raises:
        UsageError: a value that is not allowed.
    """
    options = {option.name: option for option in options_of(kind)}
    try:
        return kind(**{name: _value(options[name], value) for name, value in given.items()})
    except (ValueError, TypeError) as error:
        raise UsageError(str(error)) from error


def _value(option: Option, value: object) -> object:
    if typing.get_origin(option.kind) is list:  # an option of the command line that can be repeated
        return (
            [str(value)] if isinstance(value, str | Path) else [str(part) for part in cast("Sequence[object]", value)]
        )
    members = (option.kind, *typing.get_args(option.kind))
    if isinstance(value, str):
        return value if str in members else read(option, value)
    if isinstance(value, list):
        return tuple(cast("list[object]", value))
    texts = str in members and not {float, int, bool} & set(members)
    return text_of(value) if texts and isinstance(value, int | float | Path) else value


def _command(analysis: str, logs: Sequence[str | Path], options: Mapping[str, object]) -> str:
    """Return the command that does the same."""
    return shlex.join(["imuwb", *analysis.split(" "), *map(str, logs), *_words(options)])


def _words(options: Mapping[str, object]) -> Iterator[str]:
    for name, value in options.items():
        flag = f"--{name.replace('_', '-')}"
        if isinstance(value, bool):
            yield flag if value else f"--no-{flag[2:]}"
        elif value is not None:
            repeated = isinstance(value, list) and name in {f.name for kind in (Part, Conditions) for f in fields(kind)}
            values = cast("list[object]", value) if repeated else [value]
            for one in values:
                yield from (flag, text_of(tuple(cast("list[object]", one)) if isinstance(one, list) else one))

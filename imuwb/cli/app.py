"""Builds the command line from the commands of the core and the analyses that are installed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from imuwb import registry
from imuwb.analysis import offers
from imuwb.cli.analysis_command import command_function
from imuwb.cli.options import PANELS
from imuwb.cli.parameters import expanded
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.analysis import Analysis

LOGS, ANALYSES, RESULTS = "Logs", "Analyses", "Results"
#: command of the core -> panel and line of the help, in the help's order. Each stands in the module of its name, as a
#: function or as an app of several commands, with that line as the first of its docstring.
COMMANDS = {
    "info": (LOGS, "Show the streams of a log: rates, gaps, clocks, units, frames and repairs."),
    "convert": (LOGS, "Write a log as MCAP or CSV: all streams, or a part in time."),
    "simulate": (LOGS, "Simulate logs of sensors whose errors are known."),
    "model": (RESULTS, "Show, compare, export and check error models."),
    "view": (RESULTS, "Open a recording in the Rerun viewer, on this machine only."),
    "plugins": (RESULTS, "List the installed analyses, conditioners and readers."),
    "demo": (RESULTS, "Run the two main jobs on the sample logs: identify noise, replay GNSS outages."),
}


def build(arguments: list[str]) -> typer.Typer:
    """Return the command line for some arguments.

    Only the command that the arguments name is built whole; of the others the help shows one line. A first argument that
    ends in .py is the file of a plugin.
    """
    app = typer.Typer(
        no_args_is_help=True, context_settings={"help_option_names": ["-h", "--help"]}, rich_markup_mode="rich",
        pretty_exceptions_enable=False,
    )  # fmt: skip
    app.callback()(_root)
    wanted = arguments[0] if arguments else ""
    if wanted in COMMANDS:
        _add_core(app, wanted)
        return app
    if wanted.endswith(".py"):
        _add(app, wanted, cast("Analysis", registry.load_file(Path(wanted))), wanted)
        return app
    points = registry.installed(registry.ANALYSES)
    if wanted in points and (analysis := registry.load(points[wanted])) is not None:
        _add(app, wanted, cast("Analysis", analysis), points[wanted].value)
        return app
    lines = {name: (ANALYSES, registry.summary_of(one)) for name, p in points.items() if (one := registry.load(p))}
    for panel in (LOGS, ANALYSES, RESULTS):
        for name, (its_panel, line) in (COMMANDS | lines).items():
            if its_panel == panel:
                app.command(name, help=line, rich_help_panel=panel)(_nothing)
    return app


def _add_core(app: typer.Typer, name: str) -> None:
    """Add a command of the core."""
    module = import_module(f"imuwb.cli.{name}")
    panel, _ = COMMANDS[name]
    if hasattr(module, "app"):
        app.add_typer(module.app, name=name, rich_help_panel=panel)
    else:
        app.command(name, rich_help_panel=panel)(expanded(getattr(module, name), PANELS))


def _nothing() -> None:
    """Stand for a command in the list of commands."""


def _version(wanted: bool) -> None:  # noqa: FBT001 - typer's callback has no keyword
    if wanted:
        from imuwb import __version__  # noqa: PLC0415 - looked up in the installed metadata

        typer.echo(__version__)
        raise typer.Exit


def _root(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """A workbench for inertial logs: how noisy is this sensor, and how far does it drift?"""
    del version


def _add(app: typer.Typer, name: str, analysis: Analysis, origin: str) -> None:
    short = Path(name).stem if name.endswith(".py") else name
    methods: object = getattr(analysis, "METHODS", None)
    if methods is None:
        _add_command(app, name, short, analysis, origin)
        return
    if not isinstance(methods, Mapping) or not methods:
        message = f"{origin}: METHODS must be a mapping of names to analyses; it is {methods!r}"
        raise UsageError(message)
    group = typer.Typer(no_args_is_help=True, help=(cast("Any", analysis).__doc__ or name).strip())
    for method, module in cast("Mapping[str, Analysis]", methods).items():
        _add_command(group, method, f"{short} {method}", module, f"{origin}, {method}")
    app.add_typer(group, name=name, rich_help_panel=ANALYSES)


def _add_command(app: typer.Typer, name: str, full: str, analysis: Analysis, origin: str) -> None:
    missing = [part for part in ("Parameters", "run", "draw") if not offers(analysis, part)]
    if missing:
        message = f"{origin}: a plugin must have Parameters, run and draw; this one lacks {', '.join(missing)}"
        raise UsageError(message)
    if not is_dataclass(analysis.Parameters):
        message = f"{origin}: Parameters must be a dataclass; it is {analysis.Parameters!r}"
        raise UsageError(message)
    function = command_function(full, analysis)
    text = (cast("Any", analysis).__doc__ or full).strip()
    app.command(name, help=text, short_help=text.splitlines()[0], rich_help_panel=ANALYSES)(function)

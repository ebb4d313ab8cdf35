"""Builds the command line from the commands of the core and the analyses that are installed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from imuwb import __version__, registry
from imuwb.analysis import offers
from imuwb.cli import commands, model, simulate
from imuwb.cli.options import command_function
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.analysis import Analysis

ANALYSES = "Analyses"


def build(arguments: list[str]) -> typer.Typer:
    """Return the command line for these arguments; a first argument that ends in .py is a plugin file."""
    app = typer.Typer(
        no_args_is_help=True, context_settings={"help_option_names": ["-h", "--help"]}, rich_markup_mode="rich",
        pretty_exceptions_enable=False,
    )  # fmt: skip
    app.callback()(_root)
    for name, command, panel in commands.COMMANDS:
        app.command(name, rich_help_panel=panel)(command)
    app.add_typer(simulate.app, name="simulate", rich_help_panel=commands.LOGS)
    app.add_typer(model.app, name="model", rich_help_panel=commands.RESULTS)
    for name, point in registry.installed(registry.ANALYSES).items():
        analysis = registry.load(point)
        if analysis is not None:
            _add(app, name, cast("Analysis", analysis), point.value)
    if arguments and arguments[0].endswith(".py"):
        path = Path(arguments[0])
        _add(app, arguments[0], cast("Analysis", registry.load_file(path)), str(path))
    return app


def _version(wanted: bool) -> None:  # noqa: FBT001 - typer's callback has no keyword
    if wanted:
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
        message = f"{origin}: a plugin has Parameters, run and draw; this one lacks {', '.join(missing)}"
        raise UsageError(message)
    if not is_dataclass(analysis.Parameters):
        message = f"{origin}: Parameters must be a dataclass; it is {analysis.Parameters!r}"
        raise UsageError(message)
    function = command_function(full, analysis)
    text = (cast("Any", analysis).__doc__ or full).strip()
    app.command(name, help=text, short_help=text.splitlines()[0], rich_help_panel=ANALYSES)(function)

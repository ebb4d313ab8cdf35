"""Analyse a fleet of logs, on this machine or a cluster: tables of what each sensor has.

Each log is analysed alone, as imuwb ANALYSIS does it. What is found becomes rows of tables (Parquet), which any program reads:
sensors.parquet, outages.parquet, logs.parquet and quarantine.parquet. A run that is repeated does what is missing, and nothing else.
"""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import cast

import typer

from imuwb import registry
from imuwb.analysis import Analysis, takes_no_log
from imuwb.cli.fleet.command import analysis_command
from imuwb.cli.help import HelpfulGroup
from imuwb.cli.once import OnceCommand
from imuwb.cli.parameters import expanded
from imuwb.cli.settings import with_settings

#: command that is no analysis -> its line in the list; each is a function in the module of its name, with the panels ``PANELS``
COMMANDS = {
    "list": "List the logs that patterns name, and whose they are; nothing is analysed.",
    "report": "Say which sensors are out of family, which change, and which logs are worthless.",
}
ANALYSES, OTHERS = "Analyses", "Before and after"


def build(arguments: list[str]) -> typer.Typer:
    """Return the group of commands for the arguments after its name; only the command that they name is built whole."""
    app = typer.Typer(cls=HelpfulGroup, no_args_is_help=True, help=__doc__)
    name = arguments[0] if arguments else ""
    if name in COMMANDS:
        _add_own(app, name)
    elif name.endswith(".py"):
        _add(app, name, cast("Analysis", registry.load_file(Path(name))))
    else:
        points = registry.installed(registry.ANALYSES)
        chosen = {name: points[name]} if name in points else points
        loaded = {one: plugin for one, point in chosen.items() if (plugin := registry.load(point)) is not None}
        for one, plugin in loaded.items():
            if not takes_no_log(cast("Analysis", plugin)):
                _add(app, one, cast("Analysis", plugin))
        for one in COMMANDS:
            _add_own(app, one)
    return app


def _add(app: typer.Typer, name: str, analysis: Analysis) -> None:
    """Add the command of an analysis, or a group of commands for an analysis of several methods."""
    methods = cast("Mapping[str, Analysis] | None", getattr(analysis, "METHODS", None))
    if methods is None:
        _add_analysis(app, name, name, "", analysis)
        return
    group = typer.Typer(cls=HelpfulGroup, no_args_is_help=True, help=registry.summary_of(analysis))
    for method, module in methods.items():
        file = name.endswith(".py")
        _add_analysis(group, method, name if file else f"{name} {method}", method if file else "", module)
    app.add_typer(group, name=name, rich_help_panel=ANALYSES)


def _add_analysis(app: typer.Typer, name: str, source: str, method: str, analysis: Analysis) -> None:
    text = f"{registry.summary_of(analysis)}\n\nExample: imuwb fleet {source} 'logs/**/*.mcap' -o results/"
    command = with_settings(analysis_command(source, method, analysis))
    app.command(name, cls=OnceCommand, help=text, short_help=text.splitlines()[0], rich_help_panel=ANALYSES)(command)


def _add_own(app: typer.Typer, name: str) -> None:
    module = import_module(f"imuwb.cli.fleet.{name}")
    function = getattr(module, f"{name}_logs" if name == "list" else name)
    command = with_settings(expanded(function, module.PANELS))
    app.command(name, cls=OnceCommand, help=function.__doc__, short_help=COMMANDS[name], rich_help_panel=OTHERS)(
        command
    )

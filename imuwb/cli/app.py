"""Builds the command line from the commands of the core and the installed analyses."""

from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from imuwb.analysis import Analysis, offers
from imuwb.cli.help import EXAMPLE, HelpfulGroup, columns, parted
from imuwb.cli.once import OnceCommand
from imuwb.cli.options import PANELS
from imuwb.cli.parameters import expanded
from imuwb.cli.settings import with_settings
from imuwb.errors import UsageError
from imuwb.readers.bytes.address import is_address, place_of

LOGS, ANALYSES, RESULTS = "Logs", "Analyses", "Results"
#: command of the core -> its panel and its line in the list of commands, in the order of that list. Each command is in the
#: module of its name: a function whose docstring begins with that line, or an app of several commands.
COMMANDS = {
    "info": (LOGS, "Show the streams of a log: rates, gaps, clocks, units, frames and repairs."),
    "convert": (LOGS, "Write all streams of a log, or a part of them, as MCAP or CSV."),
    "plan": (LOGS, "State how long to record a still sensor, so that its noise is known as well as wanted."),
    "simulate": (LOGS, "Simulate logs of sensors whose errors are known."),
    "model": (RESULTS, "Show, compare, check, export, import and explain error models."),
    "view": (RESULTS, "Open a recording in the Rerun viewer on this machine."),
    "report": (RESULTS, "Make one page of several analyses of a sensor or a drive, from their recordings."),
    "catalog": (RESULTS, "Write a page of a folder of recordings: what each found, with links, sortable."),
    "explain": (RESULTS, "Say in a paragraph what a term, a verdict or a fault means."),
    "plugins": (RESULTS, "List the installed plugins, write a new one, check one."),
    "fleet": (LOGS, "Analyse a fleet of logs, on this machine or a cluster: tables of what each sensor has."),
    "bug-report": (RESULTS, "Collect what a report of a fault needs, without any sample of a log."),
    "warm": (RESULTS, "Compile everything once, so that no later run has to."),
    "demo": (RESULTS, "Run the two main jobs on the sample logs: identify noise, replay GNSS outages."),
}


def build(arguments: list[str]) -> typer.Typer:
    """Return the command line for some arguments.

    If the first argument names a command, only this command is built; otherwise all commands are listed with one line each. A
    first argument that ends in .py is the file of a plugin.
    """
    app = typer.Typer(
        cls=HelpfulGroup, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "terminal_width": columns()},
    )  # fmt: skip
    app.callback()(_root)
    name = arguments[0] if arguments else ""
    if name in COMMANDS:
        _add_core(app, name, arguments[1:])
        return app
    _add_analyses(app, name)
    return app


def every_command() -> Iterator[tuple[str, Any]]:
    """Yield each command by its name after imuwb; a group is one only if it does something by itself."""
    from imuwb import registry  # noqa: PLC0415 - as below

    for name in (*COMMANDS, *registry.installed(registry.ANALYSES)):
        root: Any = typer.main.get_command(build([name]))
        yield from _inner(name, getattr(root, "commands", {}).get(name, root))


def _inner(name: str, command: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - a command of click
    own: dict[str, Any] = getattr(command, "commands", {})
    if not own or getattr(command, "invoke_without_command", False):
        yield name, command
    for part, inner in own.items():
        yield from _inner(f"{name} {part}", inner)


def _add_analyses(app: typer.Typer, name: str) -> None:
    """Add the analysis of that name or file; or, if the name is that of no analysis, list all commands."""
    from imuwb import registry  # noqa: PLC0415 - commands of the core do without the installed metadata

    if is_address(name):
        raise UsageError(f"{place_of(name)}: this is a log and no command; to see its streams, write info before it")
    if name.endswith(".py"):
        _add(app, name, cast("Analysis", registry.load_file(Path(name))), name)
        return
    points = registry.installed(registry.ANALYSES)
    if name in points and (analysis := registry.load(points[name])) is not None:
        _add(app, name, cast("Analysis", analysis), points[name].value)
        return
    loaded = {name: analysis for name, point in points.items() if (analysis := registry.load(point)) is not None}
    listed = COMMANDS | {name: (ANALYSES, registry.summary_of(analysis)) for name, analysis in loaded.items()}
    # typer shows the panels in the order in which their first commands are added.
    for command, (panel, line) in sorted(listed.items(), key=lambda item: (LOGS, ANALYSES, RESULTS).index(item[1][0])):
        app.command(command, help=line, rich_help_panel=panel)(_nothing)


def _add_core(app: typer.Typer, name: str, arguments: list[str]) -> None:
    """Add a command of the core; a module of commands that depend on the installed analyses has ``build``."""
    own = name.replace("-", "_")
    module = import_module(f"imuwb.cli.{own}")
    panel, _ = COMMANDS[name]
    if hasattr(module, "build"):
        app.add_typer(module.build(arguments), name=name, cls=HelpfulGroup, rich_help_panel=panel)
    elif hasattr(module, "app"):
        for command in module.app.registered_commands:
            command.cls = OnceCommand
            command.callback = with_settings(command.callback)
        app.add_typer(module.app, name=name, cls=HelpfulGroup, rich_help_panel=panel)
    else:
        function = getattr(module, own)
        help_text = paragraphs(function.__doc__)
        app.command(name, cls=OnceCommand, help=help_text, rich_help_panel=panel)(
            with_settings(expanded(function, PANELS))
        )


def _nothing() -> None:
    """Stand for a command that is only listed."""


def _version(asked: bool) -> None:  # noqa: FBT001 - typer's callback has no keyword
    if asked:
        from imuwb import __version__  # noqa: PLC0415 - it reads the installed metadata

        typer.echo(__version__)
        raise typer.Exit


def _root(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version of imuwb.")
    ] = False,
) -> None:
    """A workbench for inertial logs: how noisy is this sensor, and how far does it drift?"""
    del version


def _add(app: typer.Typer, name: str, analysis: Analysis, origin: str) -> None:
    """Add the command of an analysis, or a group of commands for an analysis of several methods."""
    short = Path(name).stem if name.endswith(".py") else name
    methods: object = getattr(analysis, "METHODS", None)
    if methods is None:
        _add_command(app, name, short, analysis, origin)
        return
    if not isinstance(methods, Mapping) or not methods:
        raise UsageError(f"{origin}: METHODS must be a mapping of names to analyses; it is {methods!r}")
    group = typer.Typer(cls=HelpfulGroup, no_args_is_help=True, help=paragraphs(analysis.__doc__ or name))
    for method, module in cast("Mapping[str, Analysis]", methods).items():
        _add_command(group, method, f"{short} {method}", module, f"{origin}, {method}")
    app.add_typer(group, name=name, rich_help_panel=ANALYSES)


def _add_command(app: typer.Typer, name: str, full: str, analysis: Analysis, origin: str) -> None:
    """Add one command; ``full`` is the name of the analysis with its method."""
    missing = [part for part in ("Parameters", "run", "draw") if not offers(analysis, part)]
    if missing:
        raise UsageError(
            f"{origin}: a plugin must have Parameters, run and draw; this plugin lacks {', '.join(missing)}"
        )
    if not is_dataclass(analysis.Parameters):
        raise UsageError(f"{origin}: Parameters must be a dataclass; it is {analysis.Parameters!r}")
    from imuwb.cli.analysis_command import command_function  # noqa: PLC0415 - for analyses only

    function = command_function(full, analysis)
    text = paragraphs(analysis.__doc__ or full)
    if not parted(text)[1]:
        text += f"\n\n{EXAMPLE} imuwb {name if name.endswith('.py') else full} LOG"
    app.command(name, cls=OnceCommand, help=text, short_help=text.splitlines()[0], rich_help_panel=ANALYSES)(
        with_settings(function)
    )


def paragraphs(text: str) -> str:
    """Return a docstring as paragraphs without line breaks, so that the help is as wide as the terminal."""
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.strip().split("\n\n"))

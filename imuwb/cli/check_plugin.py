"""imuwb plugins check: asks every rule of the contract of a plugin."""

import sys
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from imuwb import registry
from imuwb.cli.options import output_option
from imuwb.errors import ImuwbError, UsageError

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.analysis import Analysis
    from imuwb.testing import Outcome, Report

PLUGIN = "The plugin"  #: group of the options in the help
GROUPS = {"analysis": registry.ANALYSES, "conditioner": registry.CONDITIONERS, "reader": registry.READERS}
MARKS = {"passed": "passed", "failed": "FAILED", "not applicable": "—"}


def check(
    plugin: Annotated[
        str,
        typer.Argument(
            help="File of a plugin, or the name of an installed one.", metavar="PLUGIN", rich_help_panel=PLUGIN
        ),
    ],
    logs: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Logs on which it is tested; a reader needs one of its format. Default: small simulated logs.",
            metavar="LOG",
            rich_help_panel=PLUGIN,
        ),
    ] = None,
    *,
    option: Annotated[
        list[str] | None,
        typer.Option(
            "--with", help="An option of the plugin; may be repeated.", metavar="KEY=VALUE", rich_help_panel=PLUGIN
        ),
    ] = None,
    json: Annotated[bool, output_option("--json", text="Print JSON on stdout.")] = False,
) -> None:
    """Check that a plugin keeps its contract: options, help, purity, units, odd logs. Exit code 1: a rule is broken.

    A conditioner is also asked whether its claims of causality are true, and a reader whether it claims files of other formats.

    Example: imuwb plugins check ./scatter.py --with length=2
    """
    from imuwb.review.answers.document import json_text  # noqa: PLC0415 - help must not wait
    from imuwb.testing import check as checked  # noqa: PLC0415
    from imuwb.testing import methods_of  # noqa: PLC0415

    values = _values(option or [])
    with redirect_stdout(sys.stderr):  # what a plugin prints is no part of the report
        name, whole = _loaded(plugin)
        reports = [
            _with_command(checked(one, of, logs=logs or (), parameters=values), plugin, one)
            for of, one in methods_of(whole, name).items()
        ]
    if json:
        typer.echo(json_text({"schema": 1, "plugins": reports}))
    for report in reports if not json else ():
        _show(report)
    failed = sum(len(report.failed) for report in reports)
    if failed:
        raise ImuwbError(
            f"{plugin} breaks {failed} rule{'s' if failed > 1 else ''} of its contract; the text of each says what to do"
        )


def _values(texts: list[str]) -> dict[str, str]:
    values: dict[str, str] = {}
    for text in texts:
        key, mark, value = text.partition("=")
        if not mark:
            raise UsageError(f"--with {text}: write KEY=VALUE, such as length=2")
        values[key.strip().replace("-", "_")] = value
    return values


def _loaded(plugin: str) -> tuple[str, object]:
    """Return the name of a plugin, and the plugin.

    Raises:
        UsageError: there is none of that name, or it cannot be imported.
    """
    if plugin.endswith(".py"):
        return Path(plugin).stem, registry.load_file(plugin)
    for group in GROUPS.values():
        point = registry.installed(group).get(plugin)
        if point is not None:
            loaded = registry.load(point)
            if loaded is None:
                raise UsageError(f"{plugin}: the plugin cannot be imported; see the warning")
            return plugin, loaded
    if Path(plugin).is_dir():
        raise UsageError(
            f"{plugin}: this is a folder, and no installed plugin has this name; if it is a package, install it (pip install -e {plugin}) "
            "and give the plugin's name"
        )
    raise UsageError(
        f"{plugin}: no installed plugin has this name; imuwb plugins lists them, and a plugin's file ends in .py"
    )


def _with_command(report: "Report", plugin: str, loaded: object) -> "Report":
    """Return a report with one more rule: an analysis becomes a command whose options clash with none that all commands have."""
    if report.kind != "analysis":
        return report
    return replace(report, outcomes=(*report.outcomes, _command_outcome(report.name, plugin, loaded)))


def _command_outcome(name: str, plugin: str, loaded: object) -> "Outcome":
    from imuwb.cli.analysis_command import command_function  # noqa: PLC0415 - help must not wait
    from imuwb.testing import Outcome  # noqa: PLC0415

    try:
        command_function(name, cast("Analysis", loaded))
    except Exception as error:  # noqa: BLE001 - of another's plugin
        return Outcome("command", "failed", str(error))
    return Outcome("command", "passed", f"imuwb {plugin} is a command with an option for each parameter")


def _show(report: "Report") -> None:
    from imuwb.analysis import Table  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import shower  # noqa: PLC0415

    rows = tuple((one.rule, MARKS[one.state], one.text) for one in report.outcomes)
    passed = sum(one.state == "passed" for one in report.outcomes)
    caption = (
        f"{passed} passed, {len(report.failed)} failed, {len(rows) - passed - len(report.failed)} not applicable (—)"
    )
    shower(data=True)(
        Table(f"{report.kind.capitalize()} {report.name}", ("rule", "state", "what was found"), rows, caption)
    )

"""The options of an analysis: those that its Parameters declare, behind those that all share."""

from __future__ import annotations

import inspect
import typing
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from imuwb.cli.common import Common
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Callable

    from imuwb.analysis import Analysis

#: a common option -> what an analysis must have for it
NEEDED = {"save_model": "error_model", "study": "study"}


def command_function(name: str, analysis: Analysis) -> Callable[..., None]:
    """Return a function whose signature holds the logs, the parameters of an analysis, and the common options."""
    own = parameters_of(analysis.Parameters)
    shared = [
        inspect.Parameter(f.name, inspect.Parameter.KEYWORD_ONLY, default=default_of(f), annotation=hint)
        for f, hint in zip(fields(Common), hints(Common).values(), strict=True)
        if hasattr(analysis, NEEDED.get(f.name, "run"))
    ]
    clash = {p.name for p in own} & {p.name for p in shared}
    if clash:
        message = f"plugin {name}: its parameters {', '.join(sorted(clash))} are options of every analysis; rename them"
        raise UsageError(message)
    logs = inspect.Parameter(
        "logs", inspect.Parameter.KEYWORD_ONLY,
        annotation=Annotated[list[Path], typer.Argument(help="What to analyse: MCAP, CSV, RTKLIB .pos.", metavar="LOG...")],
    )  # fmt: skip

    def command(**values: Any) -> None:  # noqa: ANN401 - each option has its own type
        from imuwb.cli.perform import perform  # noqa: PLC0415 - help must not wait for numpy and rerun

        paths = values.pop("logs")
        given = {p.name: values.pop(p.name) for p in own}
        perform(name, analysis, paths, make(analysis.Parameters, given), Common(**values))

    cast("Any", command).__signature__ = inspect.Signature([logs, *own, *shared])
    command.__annotations__ = {p.name: p.annotation for p in (logs, *own, *shared)}
    command.__name__ = name.replace("-", "_")
    return command


def parameters_of(kind: Any) -> list[inspect.Parameter]:  # noqa: ANN401 - a dataclass of the plugin's
    """Return the fields of a Parameters class as options."""
    options: list[inspect.Parameter] = []
    for f, hint in zip(fields(kind), hints(kind).values(), strict=True):
        base, text = hint, ""
        if typing.get_origin(hint) is Annotated:
            base, *notes = typing.get_args(hint)
            text = next((note for note in notes if isinstance(note, str)), "")
        flag = f"--{f.name.replace('_', '-')}"
        flags = f"{flag}/--no-{flag[2:]}" if base is bool else flag
        option = typer.Option(flags, help=text[:1].upper() + text[1:] + ("." if text and text[-1] not in ".)" else ""))
        options.append(
            inspect.Parameter(
                f.name, inspect.Parameter.KEYWORD_ONLY, default=default_of(f), annotation=Annotated[base, option]
            )
        )
    return options


def default_of(f: Field[Any]) -> Any:  # noqa: ANN401 - of any type
    """Return a field's default; ``inspect.Parameter.empty`` where it has none."""
    if f.default is not MISSING:
        return f.default
    return f.default_factory() if f.default_factory is not MISSING else inspect.Parameter.empty


def make(kind: Any, values: dict[str, Any]) -> Any:  # noqa: ANN401 - the plugin's own class
    """Return the parameters, or say what is wrong with them."""
    try:
        return kind(**values)
    except ValueError as error:
        raise UsageError(str(error)) from error


def hints(kind: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    """Return the annotations of a dataclass's fields, in order."""
    found = typing.get_type_hints(kind, include_extras=True)
    return {f.name: found[f.name] for f in fields(kind)}

"""The options of an analysis: those that its Parameters declare, behind those that all share."""

from __future__ import annotations

import inspect
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from imuwb.analysis import offers
from imuwb.cli.common import ANY_LOG, Common
from imuwb.cli.parameters import default_of, hints, make, parameters_of
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
        if offers(analysis, NEEDED.get(f.name, "run"))
    ]
    clash = {p.name for p in own} & {p.name for p in shared}
    if clash:
        message = f"plugin {name}: its parameters {', '.join(sorted(clash))} are options of every analysis; rename them"
        raise UsageError(message)
    logs = inspect.Parameter(
        "logs", inspect.Parameter.KEYWORD_ONLY,
        annotation=Annotated[list[Path], typer.Argument(help=ANY_LOG, metavar="LOG...")],
    )  # fmt: skip

    def command(**values: Any) -> None:  # noqa: ANN401 - each option has its own type
        from imuwb.cli.perform import perform  # noqa: PLC0415 - help must not wait for numpy and rerun

        paths = values.pop("logs")
        given = {p.name: values.pop(p.name) for p in own}
        perform(name, analysis, paths, make(analysis.Parameters, given), Common(**values))

    cast("Any", command).__signature__ = inspect.Signature([logs, *own, *shared])
    command.__annotations__ = {p.name: p.annotation for p in (logs, *own, *shared)}
    command.__name__ = name.replace("-", "_").replace(" ", "_")
    return command

"""The options that a dataclass of parameters declares, as the command line has them."""

from __future__ import annotations

import inspect
import types
import typing
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from imuwb.errors import UsageError
from imuwb.options import options_of, text_of
from imuwb.units import UNITS

if TYPE_CHECKING:
    from imuwb.options import Option

#: Types that typer reads itself. Whatever else is handed on as text, for the parameters' own ``check`` to read.
NATIVE = (bool, int, float, str, Path)


def parameters_of(kind: Any) -> list[inspect.Parameter]:  # noqa: ANN401 - a dataclass of the plugin's
    """Return the fields of a Parameters class as options."""
    return [_parameter(option, f) for option, f in zip(options_of(kind), fields(kind), strict=True)]


def _parameter(option: Option, f: Field[Any]) -> inspect.Parameter:
    flag = f"--{option.name.replace('_', '-')}"
    native = _is_native(option.kind)
    default = default_of(f)
    if not native and default not in (None, inspect.Parameter.empty):
        default = text_of(default)
    typed = typer.Option(
        f"{flag}/--no-{flag[2:]}" if option.kind is bool else flag, help=_sentence(option.help),
        metavar=option.form.pattern if option.form is not None else None,
    )  # fmt: skip
    kind = option.kind if native else str | None if default is None else str
    return inspect.Parameter(
        option.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, typed]
    )


def _is_native(kind: Any) -> bool:  # noqa: ANN401 - a type
    """Return whether typer reads a type by itself: a simple one, words, or one of those or None."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        members = [member for member in typing.get_args(kind) if member is not type(None)]
        return len(members) == 1 and _is_native(members[0])
    return kind in NATIVE or typing.get_origin(kind) is Literal


def default_of(f: Field[Any]) -> Any:  # noqa: ANN401 - of any type
    """Return a field's default; ``inspect.Parameter.empty`` where it has none."""
    if f.default is not MISSING:
        return f.default
    return f.default_factory() if f.default_factory is not MISSING else inspect.Parameter.empty


def make(kind: Any, values: dict[str, Any]) -> Any:  # noqa: ANN401 - the plugin's own class
    """Return the parameters.

    Raises:
        UsageError: a value that cannot be; the message says which and why.
    """
    try:
        return kind(**values)
    except ValueError as error:
        raise UsageError(str(error)) from error


def hints(kind: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    """Return the annotations of a dataclass's fields, in order."""
    found = typing.get_type_hints(kind, include_extras=True)
    return {f.name: found[f.name] for f in fields(kind)}


def _sentence(text: str) -> str:
    """Return a help text as a sentence; a unit at its beginning stays as it is written."""
    first = text.partition(" ")[0].rstrip(",;:")
    begin = text[:1] if first in UNITS else text[:1].upper()
    return begin + text[1:] + ("." if text and text[-1] not in ".)" else "")

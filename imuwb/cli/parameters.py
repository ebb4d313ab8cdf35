"""From dataclasses of options to the command line: one option for each field, one dataclass for each group."""

from __future__ import annotations

import inspect
import types
import typing
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import typer
from typer.models import OptionInfo

from imuwb.errors import UsageError
from imuwb.options import options_of, read, text_of
from imuwb.units import UNITS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from imuwb.options import Option

#: Types that typer reads itself. Whatever else is read from its text by ``imuwb.options``.
NATIVE = (bool, int, float, str, Path, list[str], list[Path])


def parameters_of(kind: Any, panel: str | None = None) -> list[inspect.Parameter]:  # noqa: ANN401 - a dataclass of the plugin's
    """Return the fields of a dataclass as options, under a panel of the help."""
    hints = typing.get_type_hints(kind, include_extras=True)
    return [
        _parameter(option, f, hints[f.name], panel) for option, f in zip(options_of(kind), fields(kind), strict=True)
    ]


def _parameter(option: Option, f: Field[Any], hint: Any, panel: str | None) -> inspect.Parameter:  # noqa: ANN401 - an annotation
    default = default_of(f)
    if any(isinstance(note, OptionInfo) for note in getattr(hint, "__metadata__", ())):
        return inspect.Parameter(option.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint)
    flag = f"--{option.name.replace('_', '-')}"
    native = _is_native(option.kind)
    if not native and default not in (None, inspect.Parameter.empty):
        default = text_of(default)
    if not native:
        kind = str | None if default in (None, "") else str
        default = None if default == "" else default
    else:
        kind = option.kind
    typed = typer.Option(
        f"{flag}/--no-{flag[2:]}" if option.kind is bool else flag, help=_sentence(option.help), rich_help_panel=panel,
        metavar=option.form.pattern if option.form is not None else None,
    )  # fmt: skip
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


def make(kind: Any, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - the dataclass's own type
    """Return a dataclass of options made of values, or of the texts that stand for them; None stands for the default.

    Raises:
        UsageError: a value that cannot be; the message says which and why.
    """
    options = {option.name: option for option in options_of(kind)}
    try:
        return kind(**{
            name: read(options[name], value) if isinstance(value, str) and not _is_native(options[name].kind) else value
            for name, value in values.items()
            if value is not None or _is_native(options[name].kind)
        })  # fmt: skip
    except (ValueError, UsageError) as error:
        name, _, rest = str(error).partition(" ")
        message = f"--{name.replace('_', '-')} {rest}" if name in options else str(error)
        raise UsageError(message) from error


def expanded(function: Callable[..., None], panels: Mapping[str, str] | None = None) -> Callable[..., None]:
    """Return a command whose parameters that are dataclasses have become options, one for each field.

    Args:
        function: a command; its annotations may be dataclasses of options.
        panels: {name of a dataclass: panel of the help}.
    """
    signature = inspect.signature(function, eval_str=True)
    groups = {p.name: cast("type", p.annotation) for p in signature.parameters.values() if is_dataclass(p.annotation)}
    expansion: list[inspect.Parameter] = []
    members: dict[str, list[str]] = {}
    for parameter in signature.parameters.values():
        if parameter.name not in groups:
            expansion.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        kind = groups[parameter.name]
        options = parameters_of(kind, (panels or {}).get(kind.__name__))
        members[parameter.name] = [option.name for option in options]
        expansion += options

    @wraps(function)
    def command(**values: Any) -> None:  # noqa: ANN401 - each option has its own type
        made = {
            name: make(groups[name], {member: values.pop(member) for member in names})
            for name, names in members.items()
        }
        function(**values, **made)

    cast("Any", command).__signature__ = inspect.Signature(expansion)
    command.__annotations__ = {p.name: p.annotation for p in expansion}
    return command


def _sentence(text: str) -> str:
    """Return a help text as a sentence; a unit at its beginning stays as it is written."""
    first = text.partition(" ")[0].rstrip(",;:")
    begin = text[:1] if first in UNITS else text[:1].upper()
    return begin + text[1:] + ("." if text and not text.endswith(".") else "")

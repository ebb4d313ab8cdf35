"""From dataclasses of options to the command line: an option for each field, a panel of the help for each dataclass."""

import inspect
import re
import types
import typing
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import typer
from typer.models import OptionInfo

from imuwb.cli.completion import completer
from imuwb.cli.help import ANALYSIS, KINDS
from imuwb.errors import UsageError
from imuwb.options import Form, Option, options_of, read, text_of, words_of
from imuwb.units import UNITS

_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:[/\\]")  # a path has one slash of the two
#: Types that typer reads itself. ``imuwb.options`` reads all others from their texts.
NATIVE = (bool, int, float, str, Path, list[str], list[Path])
_METAVARS = {int: KINDS["int"], float: KINDS["float"], str: KINDS["str"], Path: KINDS["path"]}


def parameters_of(kind: Any, panel: str | None = None) -> list[inspect.Parameter]:  # noqa: ANN401 - a dataclass of the plugin's
    """Return the fields of a dataclass as options of a command, under a panel of the help."""
    hints = typing.get_type_hints(kind, include_extras=True)
    return [
        _parameter(option, default_of(f), hints[f.name], panel)
        for option, f in zip(options_of(kind), fields(kind), strict=True)
    ]


def _parameter(option: Option, default: Any, hint: Any, panel: str | None) -> inspect.Parameter:  # noqa: ANN401 - of any type
    """Return one option; its default as a text if typer cannot read its type."""
    if not any(isinstance(mark, OptionInfo) for mark in getattr(hint, "__metadata__", ())):
        kind = option.kind
        if not _is_native(kind):
            if default not in (None, inspect.Parameter.empty):
                default = text_of(default) or None
            kind = list[str] if _is_mapping(kind) else str | None if default is None else str
        flag = f"--{option.name.replace('_', '-')}"
        typed = typer.Option(
            f"{flag}/--no-{flag[2:]}" if kind is bool else flag, help=_sentence(option.help),
            rich_help_panel=option.group or panel or ANALYSIS, show_default=default is not False,
            metavar=option.form.pattern if option.form is not None else metavar(option.kind),
            autocompletion=completer(form_of(option)),
        )  # fmt: skip
        hint = Annotated[kind, typed]
    return inspect.Parameter(option.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint)


def metavar(kind: Any) -> str | None:  # noqa: ANN401 - a type
    """Return what stands for a value of a type in ``--help``: N, NUMBER, FILE, or the words of a Literal."""
    members = [member for member in typing.get_args(kind) or (kind,) if member is not type(None)]
    if typing.get_origin(kind) is Literal:
        return "|".join(map(str, members))
    if len(members) > 1:
        return None
    return _METAVARS.get(members[0]) or (metavar(members[0]) if typing.get_args(members[0]) else None)


def form_of(option: Option) -> Form:
    """Return the form of an option; its words are those of its form, or those of its type."""
    form = option.form or Form("")
    return form if form.words else replace(form, words=tuple(words_of(option.kind)))


def _is_native(kind: Any) -> bool:  # noqa: ANN401 - a type
    """Return whether typer reads a type itself: a simple type, the words of a Literal, or a union of one of these with None."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        members = [member for member in typing.get_args(kind) if member is not type(None)]
        return len(members) == 1 and _is_native(members[0])
    return kind in NATIVE or typing.get_origin(kind) is Literal


def _is_mapping(kind: Any) -> bool:  # noqa: ANN401 - a type
    """Return whether an option has keys and values: such an option may be given several times."""
    return typing.get_origin(kind) in (dict, Mapping)


def default_of(f: Field[Any]) -> Any:  # noqa: ANN401 - of any type
    """Return the default of a field, or ``inspect.Parameter.empty`` for a field without a default."""
    if f.default is not MISSING:
        return f.default
    return f.default_factory() if f.default_factory is not MISSING else inspect.Parameter.empty


def make(kind: Any, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - the dataclass's own type
    """Return a dataclass of options from values or from their texts; None stands for the default.

    Raises:
        UsageError: a value that is not allowed; the message names the option as a user writes it.
    """
    options = {option.name: option for option in options_of(kind)}
    values = {
        name: (",".join(value) or None) if isinstance(value, list) and _is_mapping(options[name].kind) else value
        for name, value in values.items()
    }
    try:
        return kind(**{
            name: read(options[name], value) if isinstance(value, str) and not _is_native(options[name].kind) else value
            for name, value in values.items()
            if value is not None or _is_native(options[name].kind)
        })  # fmt: skip
    except (ValueError, UsageError) as error:
        name, _, rest = str(error).partition(" ")
        raise UsageError(f"--{name.replace('_', '-')} {rest}" if name in options else str(error)) from error


def expanded(
    function: Callable[..., None], panels: Mapping[str, str] | None = None, left_out: Collection[str] = ()
) -> Callable[..., None]:
    """Return a command in which each parameter that is a dataclass of options has become an option for each field.

    Args:
        function: a command; some of its parameters are dataclasses of options.
        panels: {name of a dataclass: panel of the help}.
        left_out: fields of the dataclasses with a panel that are not options; they keep their defaults.
    """
    expansion: list[inspect.Parameter] = []
    groups: dict[str, tuple[type, list[str]]] = {}  #: parameter -> its dataclass, and the names of its options
    for parameter in inspect.signature(function, eval_str=True).parameters.values():
        kind = parameter.annotation
        if not is_dataclass(kind):
            expansion.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        panel = (panels or {}).get(cast("type", kind).__name__)
        options = [option for option in parameters_of(kind, panel) if panel is None or option.name not in left_out]
        groups[parameter.name] = cast("type", kind), [option.name for option in options]
        expansion += options

    @wraps(function)
    def command(**values: Any) -> None:  # noqa: ANN401 - each option has its own type
        _check_local(values)
        made = {
            group: make(kind, {name: values.pop(name) for name in names}) for group, (kind, names) in groups.items()
        }
        function(**values, **made)

    cast("Any", command).__signature__ = inspect.Signature(expansion)
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in expansion}
    return command


def _check_local(values: Mapping[str, object]) -> None:
    """Raise UsageError for an address in place of a file; the message does not repeat it, because it may have secrets."""
    for name, value in values.items():
        if isinstance(value, Path) and _ADDRESS.match(str(value)):
            option = f"--{name.replace('_', '-')}"
            raise UsageError(f"{option} is an address; only logs are read from addresses: name a file of this machine")


def _sentence(text: str) -> str:
    """Return a help text as a sentence; a unit at its beginning stays as it is written."""
    first = text.partition(" ")[0].rstrip(",;:")
    begin = text[:1] if first in UNITS else text[:1].upper()
    return begin + text[1:] + ("." if text and not text.endswith(".") else "")

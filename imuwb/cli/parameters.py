"""What a dataclass of parameters says of itself: its options, their types and defaults."""

from __future__ import annotations

import inspect
import typing
from dataclasses import MISSING, Field, fields
from typing import Annotated, Any

import typer

from imuwb.errors import UsageError
from imuwb.units import UNITS


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
        option = typer.Option(flags, help=_sentence(text))
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


def _sentence(text: str) -> str:
    """Return a help text as a sentence; a unit at its beginning stays as it is written."""
    first = text.partition(" ")[0].rstrip(",;:")
    begin = text[:1] if first in UNITS else text[:1].upper()
    return begin + text[1:] + ("." if text and text[-1] not in ".)" else "")

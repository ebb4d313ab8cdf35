"""The JSON Schema of a settings file: for each command, its options and the kinds of their values."""

from collections.abc import Iterator
from typing import Any

import typer.main

from imuwb.cli.app import COMMANDS, build
from imuwb.cli.settings import COMMAND, OWN, key_of
from imuwb.registry import ANALYSES, installed

Schema = dict[str, Any]

#: what the text of an option may be in TOML
_VALUE: Schema = {
    "description": "A text, a number, a date, a list in place of commas, or a table in place of key=value",
    "anyOf": [{"type": ["string", "number"]}, {"type": "array"}, {"type": "object"}],
}


def settings_schema() -> Schema:
    """Return the schema of settings files of all commands."""
    commands = [_command(name, command) for name, command in _commands()]
    return {"type": "object", "oneOf": commands, "$defs": {"value": _VALUE}}


def _commands() -> Iterator[tuple[str, Any]]:
    """Yield each command by its name as it is typed after imuwb."""
    for name in (*COMMANDS, *installed(ANALYSES)):
        root = typer.main.get_command(build([name]))
        yield from _inner(name, getattr(root, "commands", {}).get(name, root))


def _inner(name: str, command: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - a command of click
    own: dict[str, Any] = getattr(command, "commands", {})
    if not own:
        yield name, command
    for part, inner in own.items():
        yield from _inner(f"{name} {part}", inner)


def _command(name: str, command: Any) -> Schema:  # noqa: ANN401 - a command of click
    params = {key_of(param): param for param in command.params if param.name not in OWN}
    properties: dict[str, Schema] = {COMMAND: {"const": name}, **{key: _param(param) for key, param in params.items()}}
    return {
        "title": f"imuwb {name}",
        "type": "object",
        "properties": properties,
        "required": [COMMAND],
        "additionalProperties": False,
    }


def _param(param: Any) -> Schema:  # noqa: ANN401 - an option or an argument of click
    help_text = " ".join((getattr(param, "help", None) or "").split())
    kind: Schema = {"type": "boolean"} if getattr(param, "is_flag", False) else {"$ref": "#/$defs/value"}
    return {**({"description": help_text} if help_text else {}), **kind}

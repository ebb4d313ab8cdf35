"""The JSON Schema of a settings file: for each command, its options and the kinds of their values."""

from typing import Any

from imuwb.cli.app import every_command
from imuwb.cli.settings import COMMAND, OWN, key_of

Schema = dict[str, Any]

#: what the text of an option may be in TOML
_VALUE: Schema = {
    "description": "A text, a number, a date, a list in place of commas, or a table in place of key=value",
    "anyOf": [{"type": ["string", "number"]}, {"type": "array"}, {"type": "object"}],
}


def settings_schema() -> Schema:
    """Return the schema of settings files of all commands."""
    commands = [_command(name, command) for name, command in every_command() if not hasattr(command, "commands")]
    return {"type": "object", "oneOf": commands, "$defs": {"value": _VALUE}}


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

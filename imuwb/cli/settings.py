"""A settings file of a command: ``--config run.toml`` reads its options from a file, ``--save-config run.toml`` writes them.

The file is TOML. Its keys are the options as users write them, without the dashes (``lever-arm``), and the names of the arguments
(``logs``). Its values are what the command line has: texts, numbers, true or false; a list stands for numbers with commas, or for an
option that is repeated; a table for key=value pairs. ``command`` states which command the file is for. What the command line states beats the
file. Paths are those of the command line: relative to the folder in which the command runs.
"""

import difflib
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import date, time
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from imuwb.cli.help import GENERAL
from imuwb.documents import document_of, refuse
from imuwb.errors import UsageError
from imuwb.readers.bytes.address import without_secrets

COMMAND = "command"  #: key of the command's name
OWN = ("config", "save_config", "help")  #: options that no settings file has
PROGRAM = "imuwb"
_Config = Annotated[
    Path | None,
    typer.Option(
        "--config", help="Read options from a settings file. The command line beats it.", metavar="FILE.toml",
        rich_help_panel=GENERAL,
    ),
]  # fmt: skip
_SaveConfig = Annotated[
    Path | None,
    typer.Option(
        "--save-config", help="Write all options of this run, so that --config repeats it.", metavar="FILE.toml",
        rich_help_panel=GENERAL,
    ),
]  # fmt: skip


def with_settings(function: Callable[..., None]) -> Callable[..., None]:
    """Return a command that also has the options of settings files; ``OnceCommand`` reads and writes these."""
    before = inspect.signature(function, eval_str=True).parameters
    if "save_config" in before:
        return function

    @wraps(function)
    def command(*, config: Path | None, save_config: Path | None, **values: Any) -> None:  # noqa: ANN401 - each of its own type
        del config, save_config
        function(**values)

    def parameter(name: str, hint: Any) -> inspect.Parameter:  # noqa: ANN401 - an annotation
        return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint)

    own = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in before.values()]
    added = [*own, parameter("config", _Config), parameter("save_config", _SaveConfig)]
    cast("Any", command).__signature__ = inspect.Signature(added)
    command.__annotations__ = {p.name: p.annotation for p in added}
    return command


def key_of(param: Any) -> str:  # noqa: ANN401 - typer's option or argument
    """Return the key of an option or an argument in a settings file."""
    long = [flag for flag in param.opts if flag.startswith("--")]
    return long[0][2:] if param.param_type_name == "option" and long else param.name


@dataclass(frozen=True, slots=True)
class Settings:
    """What a settings file states."""

    file: Path
    values: Mapping[str, object]

    def words(self, params: Mapping[str, Any], given: Mapping[str, object]) -> tuple[list[str], list[str]]:
        """Return the file's options and arguments as words of a command line, without those that are given.

        Args:
            params: {key: option or argument of the command}.
            given: {name of a parameter: its value on the command line}.

        Raises:
            UsageError: a value that no option of its kind has.
        """
        options: list[str] = []
        arguments: list[str] = []
        for key, value in self.values.items():
            param = params[key]
            if given.get(param.name):
                continue
            texts = self._texts(key, param, value)
            if param.param_type_name == "argument":
                arguments += texts
            elif param.is_flag:
                off = param.secondary_opts
                options += [f"--{key}"] if value else off[:1]
            else:
                options += [f"--{key}={text}" for text in texts]
        return options, arguments

    def _texts(self, key: str, param: Any, value: object) -> list[str]:  # noqa: ANN401 - typer's option or argument
        """Return the texts of a value; several only for an option that may be repeated."""
        many = param.param_type_name == "argument" and param.nargs != 1
        many = many or getattr(param, "multiple", False)
        flag = getattr(param, "is_flag", False)
        expected = "true or false" if flag else "a list of texts" if many else "a text, a number, or a list of numbers"
        try:
            if flag:
                return [] if isinstance(value, bool) else [_text(True)]
            if many:
                return [_text(item) for item in (cast("list[object]", value) if isinstance(value, list) else [value])]
            return [_text(value)]
        except TypeError:
            refuse(f"{self.file}: {key}", value, expected)


def read_settings(file: Path, command: str, params: Mapping[str, Any]) -> Settings:
    """Return what a settings file states for a command.

    Args:
        file: of settings.
        command: name of the command, as it is typed after imuwb.
        params: {key: option or argument of the command}.

    Raises:
        UsageError: there is no such file, it is no TOML, it is for another command, or it has an unknown key.
    """
    values = document_of(file, "a settings file")
    named = values.pop(COMMAND, command)
    if named != command:
        raise UsageError(
            f"{file}: it is for {PROGRAM} {named}; this is {PROGRAM} {command}: give the file of this command"
        )
    for key in values:
        if key not in params:
            near = difflib.get_close_matches(key.replace("_", "-"), params, 1)
            hint = f"did you mean {near[0]}?" if near else f"{PROGRAM} {command} --help lists the options"
            raise UsageError(f"{file}: {PROGRAM} {command} has no option {key!r}; {hint}")
    return Settings(file, values)


def settings_text(command: str, version: str, values: Mapping[str, object], given: Mapping[str, bool]) -> str:
    """Return a settings file.

    Args:
        command: name of the command, as it is typed after imuwb.
        version: of imuwb.
        values: {key: value of an option or argument}.
        given: {key: whether the user stated it}; all others are defaults.
    """
    import tomli_w  # noqa: PLC0415 - only here

    plain = {key: _plain(value) for key, value in values.items() if value is not None and value not in ([], ())}
    stated = {key: value for key, value in plain.items() if given[key]}
    defaults = {key: value for key, value in plain.items() if not given[key]}
    head = (
        f"# Settings of {PROGRAM} {version}; {PROGRAM} {command} --config FILE runs with them again.\n"
        "# Paths are relative to the folder in which the command runs.\n"
    )
    rest = f"\n# Not stated, so by default:\n{tomli_w.dumps(defaults)}" if defaults else ""
    return head + tomli_w.dumps({COMMAND: command, **stated}) + rest


def _plain(value: object) -> object:
    if isinstance(value, list | tuple):
        return [_plain(item) for item in cast("list[object]", value)]
    return value if isinstance(value, bool | int | float) else without_secrets(str(value))


def _text(value: object) -> str:
    """Return the text of a TOML value on the command line; TypeError for one that has none."""
    if isinstance(value, bool):
        raise TypeError
    if isinstance(value, Mapping):
        return ",".join(f"{key}={_text(item)}" for key, item in cast("Mapping[str, object]", value).items())
    if isinstance(value, list):
        return ",".join(_parts(cast("list[object]", value)))
    return value.isoformat() if isinstance(value, date | time) else str(value)


def _parts(values: list[object]) -> Iterator[str]:
    for value in values:
        inner = cast("list[object]", value) if isinstance(value, list) else [value]
        yield ":".join(map(_text, inner))

"""A command whose options may each be given once, unless they take several values, and may come from a settings file."""

from collections import Counter
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperOption

from imuwb.cli.help import HelpfulCommand
from imuwb.cli.settings import OWN, PROGRAM, Settings, key_of, read_settings, settings_text
from imuwb.errors import UsageError

KEPT = "imuwb.settings"  #: key of the context's data: the settings file, and what the user states


class OnceCommand(HelpfulCommand):
    """A command that refuses an option that is given twice, of which only the last value would count; it has settings files."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401 - its type moved between versions of typer
        """Read the command line, and the settings file that it names.

        Raises:
            UsageError: an option that takes one value is given twice, or the settings file has an error.
        """
        if ctx.resilient_parsing:
            return super().parse_args(ctx, args)
        given, _, order = self.make_parser(ctx).parse_args(list(args))
        for parameter, count in Counter(order).items():
            if count > 1 and isinstance(parameter, TyperOption) and not (parameter.multiple or parameter.is_flag):
                raise UsageError(f"{parameter.opts[0]} is given {count} times; state it once")
        settings = None
        if given.get("config") and not given.get("help"):
            params = self._params(ctx)
            settings = read_settings(Path(given["config"]), _name(ctx), params)
            options, arguments = settings.words(params, given)
            args = [*options, *args, *(["--", *arguments] if arguments else [])]
            given = {**given, **{params[key].name: True for key in settings.values}}
        ctx.meta[KEPT] = settings, given
        with _named(settings):
            return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401 - as above
        """Run the command; afterwards write its settings, if that is wanted."""
        settings, given = ctx.meta.get(KEPT, (None, {}))
        file = ctx.params.get("save_config")
        if file is not None:
            _check(file, ctx.params)
        with _named(settings):
            result = super().invoke(ctx)
        if file is not None:
            self._save(ctx, file, given)
        return result

    def _params(self, ctx: Any) -> dict[str, Any]:  # noqa: ANN401 - as above
        return {key_of(param): param for param in self.get_params(ctx) if param.name not in OWN}

    def _save(self, ctx: Any, file: Path, given: Mapping[str, object]) -> None:  # noqa: ANN401 - as above
        from imuwb import __version__  # noqa: PLC0415 - it reads the installed metadata
        from imuwb.texts import printable  # noqa: PLC0415
        from imuwb.writers import write_text  # noqa: PLC0415 - help must not wait for numpy

        params = self._params(ctx)
        values = {
            key: ctx.params.get(param.name)
            for key, param in params.items()
            if ctx.params.get(param.name) or not getattr(param, "is_flag", False) or param.secondary_opts
        }
        stated = {key: bool(given.get(param.name)) for key, param in params.items()}
        write_text(file, settings_text(_name(ctx), __version__, values, stated))
        typer.echo(f"Wrote  {printable(str(file))}", err=True)  # as the last line of the panel above it


def _name(ctx: Any) -> str:  # noqa: ANN401 - as above
    """Return the name of a command as it is typed after imuwb: model show."""
    return str(ctx.command_path).removeprefix(f"{PROGRAM} ")


def _check(file: Path, params: Mapping[str, object]) -> None:
    """Check before the work begins that the settings can be written.

    Raises:
        UsageError: the file exists, or another output has its name.
    """
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait for numpy

    if any(isinstance(other, Path | str) and Path(other) == file for name, other in params.items() if name not in OWN):
        raise UsageError(f"--save-config {file} is another file of this command; give it a different name")
    check_place(file, force=bool(params.get("force")))


@contextmanager
def _named(settings: Settings | None) -> Generator[None]:
    """Name the settings file in an error about one of its options."""
    if settings is None:
        yield
        return
    try:
        yield
    except Exception as error:
        flags = [flag.strip("'\"") for flag in getattr(getattr(error, "param", None), "opts", ())]
        first = str(error).partition(" ")[0] if isinstance(error, UsageError) else ""
        keys = [key for key in settings.values if f"--{key}" in (*flags, first.rstrip(":"))]
        if not keys:
            raise
        said = str(error) if first else f"{keys[0]} is {settings.values[keys[0]]!r}: {getattr(error, 'message', error)}"
        raise UsageError(f"{settings.file}: {said.removeprefix('--')}") from error

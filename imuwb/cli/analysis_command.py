"""The command of an analysis: its own parameters, then the options that all analyses share."""

from collections.abc import Callable
from dataclasses import fields
from typing import Annotated, Any

from imuwb.analysis import Analysis, offers, takes_no_log
from imuwb.cli.options import LOG_ARGUMENT, PANELS, Conditions, Outputs, Part, Request
from imuwb.cli.parameters import expanded
from imuwb.errors import UsageError
from imuwb.readers.bytes.address import place_of

#: a shared option -> the part that an analysis must offer for it
NEEDED = {"save_model": "error_model", "force_model": "objections", "study": "study"}


def command_function(name: str, analysis: Analysis) -> Callable[..., None]:
    """Return a function whose signature has the logs, the parameters of an analysis, and the shared options.

    Raises:
        UsageError: a parameter of the analysis has the name of a shared option.
    """
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415 - the list of commands does not need it

    def command(
        *, logs: Annotated[list[str], LOG_ARGUMENT], parameters: Any, part: Part, reading: ReadOptions,  # noqa: ANN401 - the plugin's
        conditions: Conditions, outputs: Outputs,
    ) -> None:  # fmt: skip
        from imuwb.cli.perform import perform  # noqa: PLC0415 - help must not wait for numpy and rerun

        perform(name, analysis, list(map(place_of, logs)), parameters, Request(reading, part, conditions, outputs))

    left_out = {option for option, needed in NEEDED.items() if not offers(analysis, needed)}
    shared = {f.name for kind in (Part, ReadOptions, Conditions, Outputs) for f in fields(kind)} - left_out
    clash = shared & {f.name for f in fields(analysis.Parameters)}
    if clash:
        raise UsageError(
            f"plugin {name}: every analysis has the options {', '.join(sorted(clash))}; rename the plugin's parameters"
        )
    if takes_no_log(analysis):
        command = _without_logs(name, analysis)
    command.__annotations__["parameters"] = analysis.Parameters
    command.__name__ = name.replace("-", "_").replace(" ", "_")
    return expanded(command, PANELS, left_out)


def _without_logs(name: str, analysis: Analysis) -> Callable[..., None]:
    """Return the command of an analysis that makes its own logs: it has no options of reading and conditioning."""

    def command(*, parameters: Any, outputs: Outputs) -> None:  # noqa: ANN401 - the plugin's
        from imuwb.cli.perform import perform  # noqa: PLC0415 - as above
        from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415 - as above

        perform(name, analysis, [], parameters, Request(ReadOptions(), Part(), Conditions(), outputs))

    return command

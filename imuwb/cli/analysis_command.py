"""The command of an analysis: its own parameters, then the options that all analyses share."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, cast

from imuwb.analysis import Analysis, offers
from imuwb.cli.options import LOG_ARGUMENT, PANELS, Conditions, Outputs, Part, Request
from imuwb.cli.parameters import make, parameters_of
from imuwb.errors import UsageError

#: a shared option -> the part that an analysis must offer for it
NEEDED = {"save_model": "error_model", "study": "study"}


def command_function(name: str, analysis: Analysis) -> Callable[..., None]:
    """Return a function whose signature has the logs, the parameters of an analysis, and the shared options.

    Raises:
        UsageError: a parameter of the analysis has the name of a shared option.
    """
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415 - the list of commands does not need it

    groups = {"part": Part, "reading": ReadOptions, "conditions": Conditions, "outputs": Outputs}
    own = parameters_of(analysis.Parameters)
    shared = {
        group: [p for p in parameters_of(kind, PANELS[kind.__name__]) if offers(analysis, NEEDED.get(p.name, "run"))]
        for group, kind in groups.items()
    }
    options = [parameter for parameters in shared.values() for parameter in parameters]
    clash = {p.name for p in own} & {p.name for p in options}
    if clash:
        raise UsageError(
            f"plugin {name}: every analysis has the options {', '.join(sorted(clash))}; rename the plugin's parameters"
        )
    logs = inspect.Parameter("logs", inspect.Parameter.KEYWORD_ONLY, annotation=Annotated[list[Path], LOG_ARGUMENT])

    def command(**values: Any) -> None:  # noqa: ANN401 - each option has its own type
        from imuwb.cli.perform import perform  # noqa: PLC0415 - help must not wait for numpy and rerun

        def given(parameters: list[inspect.Parameter]) -> dict[str, Any]:
            return {p.name: values[p.name] for p in parameters}

        request = Request(**{group: make(kind, given(shared[group])) for group, kind in groups.items()})
        perform(name, analysis, values["logs"], make(analysis.Parameters, given(own)), request)

    cast("Any", command).__signature__ = inspect.Signature([logs, *own, *options])
    command.__annotations__ = {p.name: p.annotation for p in (logs, *own, *options)}
    command.__name__ = name.replace("-", "_").replace(" ", "_")
    return command

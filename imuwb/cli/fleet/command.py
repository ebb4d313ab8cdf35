"""The command of an analysis over a fleet: the parameters of the analysis, then the options that all analyses share."""

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from imuwb.analysis import Analysis
from imuwb.cli.fleet.options import PANELS, PATTERNS, Owners, Results, Work
from imuwb.cli.options import Conditions, Part
from imuwb.cli.parameters import expanded
from imuwb.errors import UsageError

LEFT_OUT = ("study",)  #: it compares several settings for one log


def analysis_command(source: str, method: str, analysis: Analysis) -> Callable[..., None]:
    """Return a function whose signature has the patterns, the parameters of an analysis, and the options of a fleet.

    Args:
        source: name that finds the analysis, or its file.
        method: of a file with several; empty: none.
        analysis: the analysis, or the method.

    Raises:
        UsageError: a parameter of the analysis has the name of an option of a fleet.
    """
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415 - the list of commands does not need it

    name = " ".join(filter(None, (Path(source).stem if source.endswith(".py") else source, method)))

    def command(
        *, logs: Annotated[list[str], PATTERNS], parameters: Any, owners: Owners, work: Work, part: Part,  # noqa: ANN401 - the plugin's
        reading: ReadOptions, conditions: Conditions, results: Results,
    ) -> None:  # fmt: skip
        from imuwb.cli.fleet.perform import Asked, perform  # noqa: PLC0415 - help must not wait for numpy

        perform(
            logs, Asked(name, source, method, analysis, parameters, part, reading, conditions, owners, work, results)
        )

    shared = {f.name for kind in (Owners, Work, Part, ReadOptions, Conditions, Results) for f in fields(kind)}
    clash = (shared - set(LEFT_OUT)) & {f.name for f in fields(analysis.Parameters)}
    if clash:
        raise UsageError(
            f"plugin {name}: over a fleet every analysis has the options {', '.join(sorted(clash))}; rename the plugin's parameters"
        )
    command.__annotations__["parameters"] = analysis.Parameters
    command.__name__ = name.replace("-", "_").replace(" ", "_")
    return expanded(command, PANELS, LEFT_OUT)

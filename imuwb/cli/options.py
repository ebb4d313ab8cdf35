"""The options that all analyses share, beside those that say how a log is read (``imuwb.readers.ReadOptions``)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path  # noqa: TC003 - the command line reads the annotations as the program runs
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from imuwb.readers import ReadOptions

ANY_LOG = "A log: MCAP, ROS bag, db3, tlog, bin, ulg, CSV or RTKLIB .pos."
IMU_HELP = "Name of the IMU to use, as in imuwb info. A+B: the gyro of A with the accelerometer of B."
#: Panels of ``--help``.
LOG_PANEL, OUTPUT_PANEL = "How the log is read", "Output"
#: group of options -> its panel, by the name of its dataclass
PANELS = {"ReadOptions": LOG_PANEL}

#: ``Annotated[Path, LOG_ARGUMENT]``: the one log of a command.
LOG_ARGUMENT = typer.Argument(help=ANY_LOG, metavar="LOG")


def _output(*flags: str, text: str, metavar: str | None = None) -> Any:  # noqa: ANN401 - typer's own marker
    return typer.Option(*flags, help=text, rich_help_panel=OUTPUT_PANEL, metavar=metavar)


def _log(flag: str, text: str, metavar: str | None = None) -> Any:  # noqa: ANN401 - typer's own marker
    return typer.Option(flag, help=text, rich_help_panel=LOG_PANEL, metavar=metavar)


Force = Annotated[bool, _output("--force", text="Overwrite files that exist.")]


@dataclass(frozen=True)
class Part:
    """Which part of the log is used."""

    imu: Annotated[str | None, _log("--imu", IMU_HELP, "NAME|A+B")] = None
    start: Annotated[
        str | None,
        _log("--start", "Begin of the part to use: seconds from the log's start, or a time in ISO 8601.", "TIME"),
    ] = None
    end: Annotated[str | None, _log("--end", "End of the part to use, written like --start.", "TIME")] = None
    gnss: Annotated[
        Path | None,
        _log("--gnss", "A second file, with the fixes of the GNSS receiver: RTKLIB .pos, CSV, any log.", "FILE"),
    ] = None


@dataclass(frozen=True)
class Conditions:
    """What is done to the samples before the analysis."""

    through: Annotated[
        list[str],
        _log(
            "--through",
            "Condition the samples first. Repeat the option for several conditioners, in order; imuwb plugins lists them.",
            "NAME:key=value,...",
        ),
    ] = field(default_factory=list[str])
    study: Annotated[
        list[str],
        _log(
            "--study",
            "Repeat the analysis for several values of a conditioner's parameter. Two such options make a grid.",
            "NAME.key=1,2,3|1..3",
        ),
    ] = field(default_factory=list[str])


@dataclass(frozen=True)
class Outputs:
    """Where the results go."""

    output: Annotated[
        Path | None,
        _output(
            "--output", "-o", text="The recording to write. Default: the log's name with .rrd.", metavar="FILE.rrd"
        ),
    ] = None
    force: Force = False
    json: Annotated[str | None, _output("--json", text="Write the result as JSON; - for stdout.", metavar="FILE")] = (
        None
    )
    save_model: Annotated[
        Path | None, _output("--save-model", text="Write the error model that is identified.", metavar="FILE.toml")
    ] = None
    live: Annotated[bool, _output("--live", text="Also show the result in a running viewer.")] = False


@dataclass(frozen=True)
class Request:
    """All that a user asks of any analysis."""

    reading: ReadOptions
    part: Part
    conditions: Conditions
    outputs: Outputs

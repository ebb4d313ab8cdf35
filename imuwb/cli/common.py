"""The options that all analyses share."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path  # noqa: TC003 - typer reads the annotations as the program runs
from typing import Annotated, Any, Literal

import typer

ANY_LOG = "Any log: MCAP, bag, db3, tlog, bin, ulg, CSV, RTKLIB .pos."
IMU_HELP = "Which IMU, by its name in `imuwb info`; A+B takes the gyro of A with the accelerometer of B."
LOG_PANEL, OUTPUT_PANEL = "How the log is read", "Output"


def _log(flag: str, text: str, metavar: str | None = None) -> Any:  # noqa: ANN401 - typer's own marker
    return typer.Option(flag, help=text, rich_help_panel=LOG_PANEL, metavar=metavar)


def _out(*flags: str, text: str, metavar: str | None = None) -> Any:  # noqa: ANN401 - typer's own marker
    return typer.Option(*flags, help=text, rich_help_panel=OUTPUT_PANEL, metavar=metavar)


@dataclass(frozen=True)
class Common:
    """What every analysis takes."""

    imu: Annotated[str | None, _log("--imu", IMU_HELP, "NAME|A+B")] = None
    start: Annotated[str | None, _log("--start", "From here on: seconds from the log's start, or ISO.", "TIME")] = None
    end: Annotated[str | None, _log("--end", "Up to here.", "TIME")] = None
    time_source: Annotated[
        Literal["header", "log", "publish"], _log("--time-source", "Which stamp of a message counts.")
    ] = "header"
    rate: Annotated[float | None, _log("--rate", "Of text without a time column.", "HZ")] = None
    columns: Annotated[
        str | None, _log("--columns", "Of text without a header: names in order, - for none.", "NAMES")
    ] = None
    units: Annotated[str | None, _log("--units", "Such as gyro=deg/s,accel=g,time=ms.", "UNITS")] = None
    frame: Annotated[Literal["FRD", "FLU"] | None, _log("--frame", "Body frame, where the log does not say.")] = None
    gnss: Annotated[
        Path | None,
        _log("--gnss", "A file of its own with the receiver's fixes: RTKLIB .pos, CSV, any log.", "FILE"),
    ] = None
    through: Annotated[
        list[str],
        _log(
            "--through",
            "Condition the samples first; repeatable, in order. `imuwb plugins` lists them.",
            "NAME:key=value,...",
        ),
    ] = field(default_factory=list[str])
    output: Annotated[
        Path | None,
        _out("--output", "-o", text="The recording; default: the log's name with .rrd.", metavar="FILE.rrd"),
    ] = None
    force: Annotated[bool, _out("--force", text="Write over files that exist.")] = False
    json: Annotated[str | None, _out("--json", text="The result as JSON; - for stdout.", metavar="FILE")] = None
    save_model: Annotated[
        Path | None, _out("--save-model", text="The error model that was found.", metavar="FILE.toml")
    ] = None
    study: Annotated[
        list[str],
        _out("--study", text="Repeat for values of a conditioner; several make a grid.", metavar="NAME.key=1,2,3|1..3"),
    ] = field(default_factory=list[str])
    live: Annotated[bool, _out("--live", text="Show it in a running viewer too.")] = False

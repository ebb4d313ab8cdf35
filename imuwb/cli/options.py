"""The options that all analyses share, except those of reading a log (``imuwb.readers.ReadOptions``)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from imuwb.cli.completion import completer, conditioner_words, study_words
from imuwb.cli.help import CONDITIONERS, LOG, OUTPUT, READING
from imuwb.options import Form

if TYPE_CHECKING:
    from imuwb.readers import ReadOptions

#: dataclass of options -> its group in ``--help``
PANELS = {"Part": LOG, "ReadOptions": READING, "Conditions": CONDITIONERS, "Outputs": OUTPUT}
LOG_HELP = "A log, or its address (https, s3, gs, az, file): MCAP, ROS bag, db3, tlog, bin, ulg, CSV or RTKLIB .pos."
#: ``Annotated[str, LOG_ARGUMENT]``: the log of a command, or its logs.
LOG_ARGUMENT = typer.Argument(help=LOG_HELP, metavar="LOG", rich_help_panel=LOG)


def output_option(
    *flags: str, text: str, metavar: str | None = None, words: Callable[[], Iterable[str]] | None = None
) -> Any:  # noqa: ANN401 - typer's own marker
    """Return the marker of an option in the group of outputs; a shell offers its words."""
    offered = None if words is None else completer(Form(metavar or "", words=words))
    return typer.Option(*flags, help=text, rich_help_panel=OUTPUT, metavar=metavar, autocompletion=offered)


Full = Annotated[bool, output_option("--full", text="Print all tables and notes too.")]
Force = Annotated[bool, output_option("--force", text="Overwrite files that exist.")]
Html = Annotated[
    Path | None,
    output_option("--html", text="Also write a page that needs no viewer: one file.", metavar="FILE.html"),
]
Pdf = Annotated[
    Path | None,
    output_option("--pdf", text='Also write the page as PDF; needs the extra "pdf" of imuwb.', metavar="FILE.pdf"),
]
Figures = Annotated[
    Path | None,
    output_option("--figures", text="Also write each figure to a file in a folder, for a paper.", metavar="FOLDER"),
]
FigureFormat = Annotated[
    Literal["png", "pdf", "svg"] | None,
    output_option("--figure-format", "--format", text="Format of --figures. Default: png."),
]
Tables = Annotated[
    Path | None,
    output_option(
        "--tables", text="Also write each table to a file in a folder; units are in the headings.", metavar="FOLDER"
    ),
]
TableFormat = Annotated[
    Literal["csv", "latex", "md"] | None,
    output_option(
        "--table-format", text="Format of --tables. Default: csv, with a column for each end of an interval."
    ),
]


@dataclass(frozen=True)
class Part:
    """The part of a log that is used."""

    imu: Annotated[
        str | None,
        "IMU to use, by its name in imuwb info. A+B: the gyroscopes of A with the accelerometers of B. "
        "all: compare all IMUs (noise, allan, temperature).",
        Form("NAME|A+B|all", words=("all",), streams="imu"),
    ] = None
    start: Annotated[
        str | None, "Start of the part: seconds from the log's start, or a date and time (ISO 8601).", Form("TIME")
    ] = None
    end: Annotated[
        str | None, "End of the part: seconds from the log's start, or a date and time (ISO 8601).", Form("TIME")
    ] = None
    gnss: Annotated[
        str | None,
        "Second log with the fixes of the GNSS receiver, such as RTKLIB .pos or CSV.",
        Form("LOG"),
    ] = None
    gnss_shift: Annotated[
        str | None,
        "Seconds that are added to the times of --gnss, or of the log's own receivers, if their clock is not that of the IMU; "
        "start: both begin at the same time.",
        Form("SECONDS|start"),
    ] = None
    join: Annotated[
        list[str],
        "File with the gyro, the accelerometer or the temperature that the log lacks, such as the other file of a phone. Repeat the "
        "option for several files.",
        Form("LOG"),
    ] = field(default_factory=list[str])


@dataclass(frozen=True)
class Conditions:
    """What conditioners do to the samples before the analysis."""

    through: Annotated[
        list[str],
        "Conditioner for the samples. Repeat the option for several conditioners, in their order. "
        "imuwb plugins lists the conditioners; a file is one too: ./mine.py.",
        Form("NAME:key=value,...", words=conditioner_words),
    ] = field(default_factory=list[str])
    study: Annotated[
        list[str],
        "Repeat the analysis for several values of a conditioner's parameter. Repeat the option for a grid of two parameters.",
        Form("NAME.key=1,2,3|1..3", words=study_words),
    ] = field(default_factory=list[str])


@dataclass(frozen=True)
class Outputs:
    """Where the results are written."""

    output: Annotated[
        Path | None,
        output_option("--output", "-o", text="Recording to write. Default: LOG with .rrd.", metavar="FILE.rrd"),
    ] = None
    force: Force = False
    html: Html = None
    pdf: Pdf = None
    figures: Figures = None
    figure_format: FigureFormat = None
    tables: Tables = None
    table_format: TableFormat = None
    json: Annotated[
        str | None, output_option("--json", text="Write the result as JSON to a file; - for stdout.", metavar="FILE")
    ] = None
    save_model: Annotated[
        Path | None,
        output_option("--save-model", text="Write the identified error model to a file.", metavar="FILE.toml"),
    ] = None
    force_model: Annotated[
        bool,
        output_option(
            "--force-model",
            text="Write the error model even of a record that does not suit it; the model states the doubts.",
        ),
    ] = False
    full: Annotated[
        bool, output_option("--full", text="Print all tables and notes too; the recording always has them.")
    ] = False
    live: Annotated[bool, output_option("--live", text="Also show the result in a running Rerun viewer.")] = False


@dataclass(frozen=True)
class Request:
    """The values of the options that all analyses share."""

    reading: ReadOptions
    part: Part
    conditions: Conditions
    outputs: Outputs
    command: str = ""  #: that does the same; empty: the one that was typed

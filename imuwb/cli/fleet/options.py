"""The options of a run over a fleet of logs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from imuwb.cli.help import LOG
from imuwb.cli.options import PANELS as SHARED
from imuwb.cli.options import output_option
from imuwb.options import NOT_NEGATIVE, POSITIVE, Between, Form, Options

OWNERS, WORK = "Whose the logs are", "Where it runs"
PANELS = {**SHARED, "Owners": OWNERS, "Work": WORK, "Results": "Output"}
PATTERNS = typer.Argument(
    help="Logs: paths, globs in quotes ('logs/**/*.mcap'), folders, or the same in a store (s3://bucket/drives/**/*.bin).",
    metavar="LOGS", rich_help_panel=LOG,
)  # fmt: skip


@dataclass(frozen=True)
class Owners(Options):
    """How the vehicle and the sensor of a log are known; without an option they are not."""

    group: Annotated[
        str | None,
        "Regular expression with named groups vehicle, serial (of the sensor), family (its type) or date, searched in each path.",
        Form("REGEX", "'(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/[^/]+$'"),
    ] = None
    identities: Annotated[
        Path | None, "CSV with a column log (path or name) and columns among vehicle, serial, family and date.", Form("FILE.csv")
    ] = None  # fmt: skip
    metadata: Annotated[
        str | None,
        "Keys of the metadata in the logs (MCAP: NAME.KEY, ULog: NAME) that state vehicle, serial, family or date.",
        Form("serial=KEY,vehicle=KEY"),
    ] = None


@dataclass(frozen=True)
class Work(Options):
    """Where a fleet is analysed, and how much each log may take."""

    workers: Annotated[
        int | None, "Processes of this machine; 0: none but this one. Default: one for each core.", NOT_NEGATIVE
    ] = None  # fmt: skip
    scheduler: Annotated[
        str | None,
        "Dask cluster: the address of its scheduler, or local for one of this machine; needs the extra fleet.",
        Form("tcp://HOST:PORT|local", words=("local",)),
    ] = None
    task_time: Annotated[float, "Time that a log may take (s).", POSITIVE] = 3600.0
    task_memory: Annotated[float, "Memory that the analysis of a log may take (GB).", Between(0.1)] = 4.0


@dataclass(frozen=True)
class Results:
    """Where the tables are written."""

    output: Annotated[
        str,
        output_option(
            "--output", "-o", text="Folder of the results, also in a store (s3://bucket/results/).", metavar="FOLDER"
        ),
    ]
    force: Annotated[
        bool, output_option("--force", text="Replace the tables of another analysis, or of another version of imuwb.")
    ] = False

"""imuwb demo: the two main jobs on the sample logs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from imuwb import registry
from imuwb.cli.options import Conditions, Force, Outputs, Part
from imuwb.errors import MissingDataError

if TYPE_CHECKING:
    from imuwb.analysis import Analysis

LOGS = {"still": "static.mcap", "drive": "drive.mcap"}  #: what an analysis is marked for -> its sample log


def demo(
    *,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            help="The recording of the noise; that of the drive has -drive in its name.",
            metavar="FILE.rrd",
        ),
    ] = Path("imuwb-demo.rrd"),
    force: Force = False,
) -> None:
    """Run the two main jobs on the sample logs: identify noise, replay GNSS outages.

    The noise of a still log gives the error model with which the outages of a drive are replayed.
    """
    from imuwb.cli.analysis_command import Request  # noqa: PLC0415 - help must not wait
    from imuwb.cli.parameters import make  # noqa: PLC0415
    from imuwb.cli.perform import perform  # noqa: PLC0415
    from imuwb.cli.places import Places, check_places  # noqa: PLC0415
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415

    still, drive = (samples() / log for log in LOGS.values())
    (first, identify), (second, replay) = (marked(log) for log in LOGS)
    noise_outputs = Outputs(output=output, force=force)
    drive_outputs = Outputs(output=output.with_name(f"{output.stem}-drive.rrd"), force=force)
    places = Places.of(identify, [still], noise_outputs)
    check_places([*places.all(), *Places.of(replay, [drive], drive_outputs).all()], [still, drive], force=force)

    def request(outputs: Outputs) -> Request:
        return Request(ReadOptions(), Part(), Conditions(), outputs)

    perform(first, identify, [still], make(identify.Parameters, {}), request(noise_outputs))
    parameters = make(replay.Parameters, {"error_model": places.model})
    perform(second, replay, [drive], parameters, request(drive_outputs))
    typer.echo(f"look at them: imuwb view {output}; imuwb view {drive_outputs.output}", err=True)


def marked(log: str) -> tuple[str, Analysis]:
    """Return the name and the analysis that is marked for a sample log.

    Raises:
        MissingDataError: no installed analysis is.
    """
    if plugin := registry.marked(registry.ANALYSES, "DEMO", value=log):
        return plugin[0], cast("Analysis", plugin[1])
    message = f"no analysis that is installed is marked for the demo of the {log} log"
    raise MissingDataError(message)


def samples() -> Path:
    """Return the folder of sample logs: in the package, or beside it in a checkout.

    Raises:
        MissingDataError: neither folder exists.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / "samples", package.parent / "samples"):
        if all((folder / log).is_file() for log in LOGS.values()):
            return folder
    message = f"the sample logs are not installed; they would be in {package / 'samples'}"
    raise MissingDataError(message)

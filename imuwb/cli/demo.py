"""imuwb demo: the two main jobs on the sample logs."""

import shlex
from dataclasses import replace
from pathlib import Path
from typing import Annotated, cast

from imuwb import registry
from imuwb.analysis import Analysis, Answer, Step
from imuwb.cli.options import Conditions, Force, Outputs, Part, Request, output_option
from imuwb.errors import MissingDataError

LOGS = {"still": "static.mcap", "drive": "drive.mcap"}  #: value of an analysis's DEMO -> its sample log


def demo(
    *,
    output: Annotated[
        Path,
        output_option(
            "--output",
            "-o",
            text="Recording of the still log's analysis. The recording of the drive has -drive added to its name.",
            metavar="FILE.rrd",
        ),
    ] = Path("imuwb-demo.rrd"),
    force: Force = False,
) -> None:
    """Run the two main jobs on the sample logs: identify noise, replay GNSS outages.

    The noise of a still log gives the error model with which the outages of a drive are replayed.

    Example: imuwb demo -o demo.rrd
    """
    from imuwb.cli.parameters import make  # noqa: PLC0415 - help must not wait
    from imuwb.cli.perform import perform  # noqa: PLC0415
    from imuwb.cli.places import Places, check_places  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel  # noqa: PLC0415
    from imuwb.cli.typed import options_given  # noqa: PLC0415
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415

    still, drive = (samples() / log for log in LOGS.values())
    (still_name, still_analysis), (drive_name, drive_analysis) = (marked(log) for log in LOGS)
    drive_output = output.with_name(f"{output.stem}-drive.rrd")
    still_outputs, drive_outputs = (
        Outputs(output=file, html=file.with_suffix(".html"), force=force) for file in (output, drive_output)
    )
    settings = make(still_analysis.Parameters, {})
    places = Places.of(still_name, still_analysis, [still], still_outputs, settings)
    drive_settings = make(drive_analysis.Parameters, {"error_model": places.model})
    drive_places = Places.of(drive_name, drive_analysis, [drive], drive_outputs, drive_settings)
    check_places([*places.all(), *drive_places.all()], [still, drive], force=force)

    def request(name: str, log: Path, outputs: Outputs, settings: object) -> Request:
        own = options_given(settings, replace(outputs, force=True))
        return Request(
            ReadOptions(), Part(), Conditions(), outputs, " ".join(("imuwb", name, shlex.quote(str(log)), *own))
        )

    perform(still_name, still_analysis, [still], settings, request(still_name, still, still_outputs, settings))
    perform(
        drive_name, drive_analysis, [drive], drive_settings, request(drive_name, drive, drive_outputs, drive_settings)
    )
    steps = (
        Step(f"imuwb view {shlex.quote(str(output))}", "the noise; the same without a viewer is in its .html"),
        Step(f"imuwb view {shlex.quote(str(drive_output))}", "the outages; the same without a viewer is in its .html"),
    )
    print_panel(Answer("both jobs are done", next=steps), Origin("demo", ()), data=False)


def marked(log: str) -> tuple[str, Analysis]:
    """Return the name of the analysis that the demo runs on a sample log, and the analysis.

    Raises:
        MissingDataError: no installed analysis is marked for that log.
    """
    if plugin := registry.marked(registry.ANALYSES, "DEMO", value=log):
        return plugin[0], cast("Analysis", plugin[1])
    raise MissingDataError(f"no installed analysis has DEMO = {log!r}; install imuwb with its plugins")


def samples() -> Path:
    """Return the folder of the sample logs: in the package, or beside the package in a checkout.

    Raises:
        MissingDataError: neither folder has the sample logs.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / "samples", package.parent / "samples"):
        if all((folder / log).is_file() for log in LOGS.values()):
            return folder
    raise MissingDataError(f"the sample logs are missing in {package / 'samples'}; install imuwb again")

"""What the commands of ``imuwb simulate`` share: their options, the sensor, and where logs go."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel

SENSOR = "The IMU"

Output = Annotated[
    Path, typer.Option("--output", "-o", help="The log; its suffix, .mcap or .csv, is its format.", metavar="FILE")
]
Model = Annotated[
    Path | None,
    typer.Option("--error-model", help="An error model of your own.", metavar="MODEL.toml", rich_help_panel=SENSOR),
]
Rate = Annotated[float, typer.Option(help="Samples a second, Hz.", metavar="HZ", rich_help_panel=SENSOR)]
Seed = Annotated[int, typer.Option(help="Of all noise; the same seed gives the same log.", min=0)]
Temperature = Annotated[
    str | None,
    typer.Option(
        help="Of the sensor, °C: 25 all the while, -40:70 from the start to the end, or 0:-30,600:-30,1200:45, corners s:°C.",
        metavar="CELSIUS|FROM:TO|S:CELSIUS,...",
        rich_help_panel=SENSOR,
    ),
]
Preset = Annotated[
    str | None, typer.Option(help="A published sensor (an unknown name lists them).", rich_help_panel=SENSOR)
]
Quantize = Annotated[bool, typer.Option("--quantize", help="Round to the model's lsb.", rich_help_panel=SENSOR)]
Bandwidth = Annotated[
    float | None,
    typer.Option(help="Low-pass the noise (Butterworth, second order), Hz.", metavar="HZ", rich_help_panel=SENSOR),
]
Force = Annotated[bool, typer.Option("--force", help="Write over a file that exists.")]


def sensor_of(name: str | None, option: str, error_model: Path | None) -> ImuErrorModel:
    """Return the error model of a published sensor, or of one's own."""
    from imuwb.simulation import preset  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    if name is not None and error_model is None:
        return preset(name)
    if error_model is not None and name is None:
        return ImuErrorModel.read(error_model)
    message = f"simulate needs a sensor: either {option} NAME or --error-model MODEL.toml"
    raise UsageError(message)


def check(output: Path, *, force: bool) -> None:
    """Say before the work when a log could not be written."""
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        message = f"--output {output}: a log is written as {' or '.join(SUFFIXES)}"
        raise UsageError(message)
    check_place(output, force=force)


def check_folder(folder: Path, files: list[Path], *, force: bool) -> None:
    """Say before the work when a folder could not be filled, or holds what would be taken for its logs."""
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if folder.suffix in SUFFIXES:
        message = f"--output {folder}: a folder of logs is written; give it a name without {folder.suffix}"
        raise UsageError(message)
    if not folder.is_dir():
        check_place(folder, force=False)
        return
    held = sorted(set(folder.iterdir()) - set(files))
    if held or any(file.exists() for file in files):
        if not force:
            message = (
                f"--output {folder}: the folder holds files; --force writes over logs of these names, or choose another"
            )
            raise UsageError(message)
        if held:
            typer.echo(f"note: {folder} holds {len(held)} other files, such as {held[0].name}: they stay", err=True)
    for file in files:
        check_place(file, force=force)


def save(log: Log, output: Path, *, force: bool) -> None:
    """Write a log, and say where."""
    from imuwb.cli.places import check_places  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415
    from imuwb.writers import places, write  # noqa: PLC0415

    files = places(log, output)
    check_places(files, [], force=force)
    with progress(f"writing {output.name}") as report:
        write(log, output, report)
    for file in files:
        typer.echo(f"wrote {file}", err=True)

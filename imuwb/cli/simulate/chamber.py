"""imuwb simulate chamber: a still IMU at one temperature after the other."""

from __future__ import annotations

from pathlib import Path  # noqa: TC003 - the command line reads annotations when it runs
from typing import Annotated

import typer

from imuwb.cli.simulate.options import Bandwidth, Model, Preset, Quantize, Rate, Seed, check_folder, sensor_of


def chamber(
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="The folder of the logs, one a set-point.", metavar="FOLDER")
    ],
    first: Annotated[float, typer.Option("--from", help="The first set-point, °C.", metavar="CELSIUS")] = -30.0,
    last: Annotated[float, typer.Option("--to", help="The last one, °C.", metavar="CELSIUS")] = 60.0,
    step: Annotated[float, typer.Option(help="From one to the next, °C; below 0 it grows colder.")] = 10.0,
    hours: Annotated[float, typer.Option(help="Duration of each log in hours.")] = 3.0,
    preset: Preset = None,
    error_model: Model = None,
    rate: Rate = 100.0,
    seed: Seed = 0,
    quantize: Quantize = False,
    bandwidth: Bandwidth = None,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder that holds files.")] = False,
) -> None:
    """A still IMU in a climate chamber: a log at each temperature. For one log that ramps: static --temperature -40:70."""
    from imuwb.cli.terminal import progress  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.simulation import chamber as recorded  # noqa: PLC0415
    from imuwb.simulation import set_points  # noqa: PLC0415
    from imuwb.simulation.chamber import names  # noqa: PLC0415
    from imuwb.stochastic import is_thermal  # noqa: PLC0415
    from imuwb.writers import write  # noqa: PLC0415

    model = sensor_of(preset, "--preset", error_model)
    points = set_points(first, last, step)
    files = [output / f"{name}.mcap" for name in names(points)]
    check_folder(output, files, force=force)
    if not is_thermal(model) and not any(axis.thermal for axis in model.axes.values()):
        typer.echo(f"note: {model.name} says nothing of temperature: all set-points have the same noise", err=True)
    with progress("simulating") as report:
        logs = recorded(
            model, points, hours * 3600, rate, seed, quantize=quantize, bandwidth=bandwidth, progress=report
        )
        for log, file in zip(logs, files, strict=True):
            output.mkdir(exist_ok=True)
            write(log, file)
            typer.echo(f"wrote {file}", err=True)

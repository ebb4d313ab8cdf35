"""imuwb simulate chamber: a still IMU at one temperature after another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import output_option
from imuwb.cli.simulate.options import TRUTH, Filtered, Sensor, check_folder, made
from imuwb.options import POSITIVE, Options

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.log import Log


@dataclass(frozen=True)
class SetPoints(Options):
    """The temperatures of the chamber, and how long it stays at each."""

    first: Annotated[
        float,
        typer.Option("--from", help="The first set-point (°C).", metavar="CELSIUS", rich_help_panel="The chamber"),
    ] = -30.0
    last: Annotated[
        float, typer.Option("--to", help="The last set-point (°C).", metavar="CELSIUS", rich_help_panel="The chamber")
    ] = 60.0
    step: Annotated[float, "difference between two set-points, negative if they fall (°C)"] = 10.0
    hours: Annotated[float, "duration of each log (h)", POSITIVE] = 3.0


def chamber(
    *,
    output: Annotated[
        Path, output_option("--output", "-o", text="The folder of the logs, one for each set-point.", metavar="FOLDER")
    ],
    points: SetPoints,
    sensor: Sensor,
    samples: Filtered,
    force: Annotated[bool, output_option("--force", text="Write into a folder that is not empty.")] = False,
) -> None:
    """Simulate a still IMU in a climate chamber: a log at each temperature.

    For one log with a ramp of temperature, use static --temperature -40:70.

    Example: imuwb simulate chamber --preset mpu-6050 --from -20 --to 50 --hours 1 -o chamber
    """
    from imuwb.cli.terminal import progress  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.written import print_written  # noqa: PLC0415
    from imuwb.simulation import chamber as recorded  # noqa: PLC0415
    from imuwb.simulation import set_points  # noqa: PLC0415
    from imuwb.simulation.chamber import names  # noqa: PLC0415
    from imuwb.stochastic import is_thermal  # noqa: PLC0415
    from imuwb.writers import together, write  # noqa: PLC0415

    model = sensor.model()
    temperatures = set_points(points.first, points.last, points.step)
    files = [output / f"{name}.mcap" for name in names(temperatures)]
    check_folder(output, files, force=force)
    if not is_thermal(model) and not any(axis.thermal for axis in model.axes.values()):
        typer.echo(f"note: {model.name} does not depend on temperature: all set-points have the same noise", err=True)
    with made(output), together(files), progress("simulating") as report:
        logs = recorded(
            model, temperatures, points.hours * 3600, samples.rate, samples.seed, quantize=samples.quantize,
            bandwidth=samples.bandwidth, progress=report,
        )  # fmt: skip
        first: Log | None = None
        for log, file in zip(logs, files, strict=True):
            write(log, file)
            first = first or log
    if first is not None:
        print_written("simulate", first, files, (TRUTH,), len(files))

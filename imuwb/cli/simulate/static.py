"""imuwb simulate static: a still IMU on a bench."""

from __future__ import annotations

from typing import Annotated

import typer

from imuwb.cli.simulate.options import (
    Bandwidth,
    Force,
    Model,
    Output,
    Preset,
    Quantize,
    Rate,
    Seed,
    Temperature,
    check,
    save,
    sensor_of,
)


def static(
    *,
    output: Output,
    preset: Preset = None,
    error_model: Model = None,
    hours: Annotated[float, typer.Option(help="Duration in hours.")] = 1.0,
    rate: Rate = 100.0,
    seed: Seed = 0,
    temperature: Temperature = None,
    quantize: Quantize = False,
    bandwidth: Bandwidth = None,
    force: Force = False,
) -> None:
    """A still IMU with the noise of a published sensor, or of a model of yours."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.simulate.temperatures import temperature_of  # noqa: PLC0415
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = sensor_of(preset, "--preset", error_model)
    celsius = temperature_of(temperature, hours * 3600)
    check(output, force=force)
    with progress("simulating") as report:
        log = simulation.static(
            model,
            hours * 3600,
            rate,
            seed,
            celsius=celsius,
            quantize=quantize,
            bandwidth=bandwidth,
            progress=report,
        )
    save(log, output, force=force)

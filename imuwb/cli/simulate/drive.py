"""imuwb simulate drive: a car with an IMU and GNSS, and the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.simulate.options import (
    SENSOR,
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
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.simulation import Route

DRIVE, GNSS, ODOMETER = "The drive", "The GNSS receiver", "The odometer"


def drive(
    *,
    output: Output,
    preset: Annotated[
        str | None,
        typer.Option(
            help="A route after Quinchia et al. (2013): turin-1 (17.3 min, town) or turin-2 (15.05 min, with highway).",
            rich_help_panel=DRIVE,
        ),
    ] = None,
    duration: Annotated[
        float | None,
        typer.Option(
            help="In place of a preset: town, country road and highway for so long, s.",
            metavar="SECONDS",
            rich_help_panel=DRIVE,
        ),
    ] = None,
    route_seed: Annotated[
        int, typer.Option(help="Another one, other turns, stops and slopes.", min=0, rich_help_panel=DRIVE)
    ] = 0,
    truth_rate: Annotated[
        float, typer.Option(help="Of the true trajectory in the log, Hz.", metavar="HZ", rich_help_panel=DRIVE)
    ] = 10.0,
    sensor: Preset = None,
    error_model: Model = None,
    rate: Rate = 100.0,
    seed: Seed = 0,
    temperature: Temperature = None,
    quantize: Quantize = False,
    bandwidth: Bandwidth = None,
    vibration: Annotated[
        float,
        typer.Option(
            help="Of road (5-50 Hz) and engine (27 Hz), rms of an accelerometer axis, m/s².",
            metavar="M/S2",
            rich_help_panel=SENSOR,
        ),
    ] = 0.0,
    gnss_rate: Annotated[float, typer.Option(help="Fixes a second, Hz.", metavar="HZ", rich_help_panel=GNSS)] = 1.0,
    position_sigma: Annotated[
        str, typer.Option(help="Of its white noise, m.", metavar="N,E,D", rich_help_panel=GNSS)
    ] = "2,2,3.5",
    velocity_sigma: Annotated[
        str, typer.Option(help="Likewise, m/s.", metavar="N,E,D", rich_help_panel=GNSS)
    ] = "0.1,0.1,0.15",
    latency: Annotated[
        float, typer.Option(help="By which a fix is older than its stamp, s.", metavar="SECONDS", rich_help_panel=GNSS)
    ] = 0.0,
    lever_arm: Annotated[
        str,
        typer.Option(
            help="From the IMU to the antenna, forward, right, down, m.", metavar="F,R,D", rich_help_panel=GNSS
        ),
    ] = "0,0,0",
    odometer: Annotated[bool, typer.Option("--odometer", help="Have one, 10 Hz.", rich_help_panel=ODOMETER)] = False,
    odometer_scale: Annotated[
        float, typer.Option(help="Its scale error, a fraction.", metavar="FRACTION", rich_help_panel=ODOMETER)
    ] = 0.0,
    odometer_step: Annotated[
        float, typer.Option(help="It rounds to whole ones, m/s; 0: not.", metavar="M/S", rich_help_panel=ODOMETER)
    ] = 0.0,
    force: Force = False,
) -> None:
    """A car with an IMU and GNSS, and the truth; prints a preset's outages as imuwb outage takes them."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.simulate.temperatures import temperature_of  # noqa: PLC0415
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = sensor_of(sensor, "--sensor", error_model)
    route = _route(preset, duration, route_seed)
    celsius = temperature_of(temperature, route.duration)
    receiver = simulation.Receiver(
        gnss_rate,
        _triple("--position-sigma", position_sigma),
        _triple("--velocity-sigma", velocity_sigma),
        latency,
        _triple("--lever-arm", lever_arm),
    )
    if not odometer and (odometer_scale or odometer_step):
        message = "--odometer-scale and --odometer-step are of an odometer; give --odometer as well"
        raise UsageError(message)
    check(output, force=force)
    with progress("simulating") as report:
        log = simulation.drive(
            model,
            route,
            seed,
            rate=rate,
            receiver=receiver,
            odometer=simulation.Odometer(scale_error=odometer_scale, step=odometer_step) if odometer else None,
            truth_rate=truth_rate,
            celsius=celsius,
            quantize=quantize,
            bandwidth=bandwidth,
            vibration=vibration,
            progress=report,
        )
    save(log, output, force=force)
    if preset is not None:
        outages = simulation.planned_outages(preset)
        typer.echo("--at " + ",".join(f"{o.start:g}:{o.duration:g}" for o in outages))


def _route(preset: str | None, duration: float | None, route_seed: int) -> Route:
    from imuwb.simulation import mixed_route, planned_route  # noqa: PLC0415 - help must not wait for numpy

    if preset is not None and duration is None:
        return planned_route(preset, route_seed)
    if duration is not None and preset is None:
        return mixed_route(duration, route_seed)
    message = "simulate drive needs a route: either --preset turin-1 or turin-2, or --duration SECONDS"
    raise UsageError(message)


def _triple(option: str, text: str) -> tuple[float, float, float]:
    try:
        first, second, third = (float(part) for part in text.split(","))
    except ValueError as error:
        message = f"{option} {text!r}: it must be three numbers with commas between"
        raise UsageError(message) from error
    return first, second, third

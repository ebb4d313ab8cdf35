"""imuwb simulate: logs of known truth, of a still IMU, of a climate chamber, and of a drive."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli import simulate_calibration
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.log import Log
    from imuwb.simulation import Route
    from imuwb.stochastic import ImuErrorModel

DRIVE, SENSOR, GNSS, ODOMETER = "The drive", "The IMU", "The GNSS receiver", "The odometer"

app = typer.Typer(no_args_is_help=True, help="Logs of known truth: of a still IMU, or of a drive with GNSS.")

app.command("six-position")(simulate_calibration.six_position)
app.command("rate-table")(simulate_calibration.rate_table)

_Output = Annotated[
    Path, typer.Option("--output", "-o", help="The log; its suffix, .mcap or .csv, is its format.", metavar="FILE")
]
_Model = Annotated[
    Path | None,
    typer.Option("--error-model", help="An error model of your own.", metavar="MODEL.toml", rich_help_panel=SENSOR),
]
_Rate = Annotated[float, typer.Option(help="Samples a second, Hz.", metavar="HZ", rich_help_panel=SENSOR)]
_Seed = Annotated[int, typer.Option(help="Of all noise; the same seed gives the same log.", min=0)]
_Temperature = Annotated[
    str | None,
    typer.Option(
        help="Of the sensor, °C: 25 all the while, -40:70 from the start to the end, or 0:-30,600:-30,1200:45, corners s:°C.",
        metavar="CELSIUS|FROM:TO|S:CELSIUS,...",
        rich_help_panel=SENSOR,
    ),
]
_Preset = Annotated[
    str | None, typer.Option(help="A published sensor (an unknown name lists them).", rich_help_panel=SENSOR)
]
_Quantize = Annotated[bool, typer.Option("--quantize", help="Round to the model's lsb.", rich_help_panel=SENSOR)]
_Bandwidth = Annotated[
    float | None,
    typer.Option(help="Low-pass the noise (Butterworth, second order), Hz.", metavar="HZ", rich_help_panel=SENSOR),
]
_Force = Annotated[bool, typer.Option("--force", help="Write over a file that exists.")]


@app.command()
def static(
    *,
    output: _Output,
    preset: _Preset = None,
    error_model: _Model = None,
    hours: Annotated[float, typer.Option(help="Duration in hours.")] = 1.0,
    rate: _Rate = 100.0,
    seed: _Seed = 0,
    temperature: _Temperature = None,
    quantize: _Quantize = False,
    bandwidth: _Bandwidth = None,
    force: _Force = False,
) -> None:
    """A still IMU with the noise of a published sensor, or of a model of yours."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.temperatures import temperature_of  # noqa: PLC0415
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = _sensor(preset, "--preset", error_model)
    celsius = temperature_of(temperature, hours * 3600)
    _check(output, force=force)
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
    _write(log, output, force=force)


@app.command()
def chamber(
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="The folder of the logs, one a set-point.", metavar="FOLDER")
    ],
    first: Annotated[float, typer.Option("--from", help="The first set-point, °C.", metavar="CELSIUS")] = -30.0,
    last: Annotated[float, typer.Option("--to", help="The last one, °C.", metavar="CELSIUS")] = 60.0,
    step: Annotated[float, typer.Option(help="From one to the next, °C; below 0 it grows colder.")] = 10.0,
    hours: Annotated[float, typer.Option(help="Duration of each log in hours.")] = 3.0,
    preset: _Preset = None,
    error_model: _Model = None,
    rate: _Rate = 100.0,
    seed: _Seed = 0,
    quantize: _Quantize = False,
    bandwidth: _Bandwidth = None,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder that holds files.")] = False,
) -> None:
    """A still IMU in a climate chamber: a log at each temperature. For one log that ramps: static --temperature -40:70."""
    from imuwb.cli.terminal import progress  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.simulation import chamber as recorded  # noqa: PLC0415
    from imuwb.simulation import set_points  # noqa: PLC0415
    from imuwb.simulation.chamber import names  # noqa: PLC0415
    from imuwb.stochastic import is_thermal  # noqa: PLC0415
    from imuwb.writers import write  # noqa: PLC0415

    model = _sensor(preset, "--preset", error_model)
    points = set_points(first, last, step)
    files = [output / f"{name}.mcap" for name in names(points)]
    _check_folder(output, files, force=force)
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


@app.command()
def drive(
    *,
    output: _Output,
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
    sensor: _Preset = None,
    error_model: _Model = None,
    rate: _Rate = 100.0,
    seed: _Seed = 0,
    temperature: _Temperature = None,
    quantize: _Quantize = False,
    bandwidth: _Bandwidth = None,
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
    force: _Force = False,
) -> None:
    """A car with an IMU and GNSS, and the truth; prints a preset's outages as imuwb outage takes them."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.temperatures import temperature_of  # noqa: PLC0415
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = _sensor(sensor, "--sensor", error_model)
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
    _check(output, force=force)
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
    _write(log, output, force=force)
    if preset is not None:
        outages = simulation.planned_outages(preset)
        typer.echo("--at " + ",".join(f"{o.start:g}:{o.duration:g}" for o in outages))


def _sensor(name: str | None, option: str, error_model: Path | None) -> ImuErrorModel:
    from imuwb.simulation import preset  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    if name is not None and error_model is None:
        return preset(name)
    if error_model is not None and name is None:
        return ImuErrorModel.read(error_model)
    message = f"simulate needs a sensor: either {option} NAME or --error-model MODEL.toml"
    raise UsageError(message)


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


def _check(output: Path, *, force: bool) -> None:
    from imuwb.cli.perform import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        message = f"--output {output}: a log is written as {' or '.join(SUFFIXES)}"
        raise UsageError(message)
    check_place(output, force=force)


def _check_folder(folder: Path, files: list[Path], *, force: bool) -> None:
    """Say before the work when a folder could not be filled, or holds what would be taken for its logs."""
    from imuwb.cli.perform import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if folder.suffix in SUFFIXES:
        message = f"--output {folder}: chamber writes a folder of logs, one a set-point; give it a name without {folder.suffix}"
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


def _write(log: Log, output: Path, *, force: bool) -> None:
    from imuwb.cli.perform import check_places  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415
    from imuwb.writers import places, write  # noqa: PLC0415

    files = places(log, output)
    check_places(files, [], force=force)
    with progress(f"writing {output.name}") as report:
        write(log, output, report)
    for file in files:
        typer.echo(f"wrote {file}", err=True)

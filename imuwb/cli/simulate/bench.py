"""imuwb simulate six-position and rate-table: what a calibration bench would record, and the truth."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from imuwb.cli.simulate.options import SENSOR, Quantize, Rate, check_folder
from imuwb.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from imuwb.log import Log
    from imuwb.simulation import Site
    from imuwb.stochastic import ImuErrorModel

BENCH = "The bench"
TRUTH, ATTITUDES = "truth.toml", "attitudes.txt"

_Output = Annotated[Path, typer.Option("--output", "-o", help="The folder of the logs.", metavar="FOLDER")]
_Preset = Annotated[
    str | None,
    typer.Option(
        help="A published sensor; scale factors, cross-couplings and so on are drawn within the tolerances of an MPU-6050.",
        rich_help_panel=SENSOR,
    ),
]
_Model = Annotated[
    Path | None,
    typer.Option(
        "--error-model",
        help="A model of your own, whose terms are the truth.",
        metavar="MODEL.toml",
        rich_help_panel=SENSOR,
    ),
]
_Seed = Annotated[int, typer.Option(help="Of the sensor and all noise; the same seed gives the same logs.", min=0)]
_Temperature = Annotated[
    float | None, typer.Option(help="Of the sensor, °C.", metavar="CELSIUS", rich_help_panel=SENSOR)
]
_Misplacement = Annotated[
    float, typer.Option(help="rms of each of two tilts, deg.", metavar="DEG", rich_help_panel=BENCH)
]
_Latitude = Annotated[
    float | None,
    typer.Option(
        help="deg; gravity is that of the ellipsoid there, and the earth turns.", metavar="DEG", rich_help_panel=BENCH
    ),
]
_Height = Annotated[float, typer.Option(help="Above the ellipsoid, m.", metavar="M", rich_help_panel=BENCH)]
_Format = Annotated[Literal["mcap", "csv"], typer.Option("--format", help="Of the logs.")]
_Force = Annotated[bool, typer.Option("--force", help="Write over files that exist.")]


def six_position(
    *,
    output: _Output,
    preset: _Preset = None,
    error_model: _Model = None,
    positions: Annotated[
        int, typer.Option(help="6: a cube's faces; 9 to 100: spread over all directions.", rich_help_panel=BENCH)
    ] = 6,
    minutes: Annotated[float, typer.Option(help="In each position.", rich_help_panel=BENCH)] = 10.0,
    misplacement: _Misplacement = 0.05,
    one_log: Annotated[
        bool, typer.Option("--one-log", help="All positions in one log, with turns between.", rich_help_panel=BENCH)
    ] = False,
    latitude: _Latitude = None,
    height: _Height = 0.0,
    rate: Rate = 100.0,
    seed: _Seed = 0,
    temperature: _Temperature = None,
    quantize: Quantize = False,
    kind: _Format = "mcap",
    force: _Force = False,
) -> None:
    """An IMU that is set down on the faces of a cube, or in many positions, and the truth, for imuwb calibration."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = _specimen(preset, error_model, seed)
    check_folder(output, [], force=force)
    with progress("simulating") as report:
        made = simulation.six_position(
            model,
            seed,
            positions=positions,
            seconds=minutes * 60,
            rate=rate,
            misplacement=math.radians(misplacement),
            one_log=one_log,
            site=_site(latitude, height),
            celsius=temperature,
            quantize=quantize,
            progress=report,
        )
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["roll_deg", "pitch_deg"])
    rows.writerows([f"{math.degrees(angle):.6f}" for angle in row] for row in made.attitudes.tolist())
    _write(made.logs, output, kind, {TRUTH: made.truth.to_toml(), ATTITUDES: text.getvalue()}, force=force)


def rate_table(
    *,
    output: _Output,
    rates: Annotated[str, typer.Option(help="deg/s, with commas; turned both ways.", metavar="R,R,...")],
    preset: _Preset = None,
    error_model: _Model = None,
    axis: Annotated[str, typer.Option(help="Which axes, a log each.", rich_help_panel=BENCH)] = "xyz",
    seconds: Annotated[float, typer.Option(help="On each step.", rich_help_panel=BENCH)] = 30.0,
    misplacement: _Misplacement = 0.05,
    latitude: _Latitude = None,
    height: _Height = 0.0,
    rate: Rate = 100.0,
    seed: _Seed = 0,
    temperature: _Temperature = None,
    quantize: Quantize = False,
    kind: _Format = "mcap",
    force: _Force = False,
) -> None:
    """An IMU on a rate table, a staircase of rates both ways, and the truth, for imuwb calibration."""
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = _specimen(preset, error_model, seed)
    try:
        wanted = [math.radians(float(part)) for part in rates.split(",")]
    except ValueError as error:
        message = f"--rates {rates!r}: write deg/s with commas between, as 10,50,100"
        raise UsageError(message) from error
    check_folder(output, [], force=force)
    with progress("simulating") as report:
        made = simulation.rate_table(
            model,
            seed,
            wanted,
            axes=axis,
            seconds=seconds,
            rate=rate,
            misplacement=math.radians(misplacement),
            site=_site(latitude, height),
            celsius=temperature,
            quantize=quantize,
            progress=report,
        )
    _write(made.logs, output, kind, {TRUTH: made.truth.to_toml()}, force=force)


def _specimen(preset: str | None, error_model: Path | None, seed: int) -> ImuErrorModel:
    from imuwb.simulation import Tolerances, specimen  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.simulation import preset as published  # noqa: PLC0415
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    if preset is not None and error_model is None:
        return specimen(published(preset), seed, Tolerances())
    if error_model is not None and preset is None:
        return specimen(ImuErrorModel.read(error_model), seed, None)
    message = "simulate needs a sensor: either --preset NAME or --error-model MODEL.toml"
    raise UsageError(message)


def _site(latitude: float | None, height: float) -> Site:
    import numpy as np  # noqa: PLC0415 - help must not wait for it

    from imuwb.geodesy.earth import gravity  # noqa: PLC0415
    from imuwb.simulation import Site  # noqa: PLC0415

    if latitude is None:
        return Site()
    if not -90 <= latitude <= 90:  # noqa: PLR2004 - the poles
        message = f"--latitude {latitude}: it must be -90 to 90"
        raise UsageError(message)
    angle = math.radians(latitude)
    return Site(float(gravity(np.array([angle]), np.array([height]))[0]), angle)


def _write(logs: Mapping[str, Log], folder: Path, kind: str, texts: Mapping[str, str], *, force: bool) -> None:
    from imuwb.cli.places import check_places  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415
    from imuwb.writers import places, write, write_text  # noqa: PLC0415

    folder.mkdir(exist_ok=True)
    files = {folder / f"{name}.{kind}": log for name, log in logs.items()}
    every = [place for path, log in files.items() for place in places(log, path)]
    check_places([*every, *(folder / name for name in texts)], [], force=force)
    with progress("writing") as report:
        for i, (path, log) in enumerate(files.items()):
            write(log, path)
            report(i + 1, len(files))
    for name, text in texts.items():
        write_text(folder / name, text)
        every.append(folder / name)
    for file in every:
        typer.echo(f"wrote {file}", err=True)

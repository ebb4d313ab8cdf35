"""imuwb simulate six-position, hand-held and rate-table: what a calibration bench would record, and the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from imuwb.cli.options import Force, output_option
from imuwb.cli.simulate.options import Samples, Sensor, check_folder, save, sensor_names
from imuwb.options import POSITIVE, Between, Form, Options

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.simulation import Site
    from imuwb.stochastic import ImuErrorModel

TRUTH, ATTITUDES = "truth.toml", "attitudes.txt"

_Output = Annotated[Path, output_option("--output", "-o", text="The folder of the logs.", metavar="FOLDER")]
_Format = Annotated[Literal["mcap", "csv"], output_option("--format", text="Format of the logs.", metavar="mcap|csv")]


@dataclass(frozen=True)
class BenchSensor(Sensor):
    """The sensor on the bench."""

    preset: Annotated[
        str | None,
        "name of a published sensor; scale factors, cross-couplings and g-sensitivities are random, within the tolerances of an MPU-6050",
        Form("NAME", words=sensor_names),
    ] = None
    error_model: Annotated[
        Path | None, "error model of a sensor of your own; its terms are the truth", Form("MODEL.toml")
    ] = None

    def specimen(self, seed: int) -> ImuErrorModel:
        """Return one sensor of the kind, with random turn-on biases.

        Raises:
            UsageError: neither preset nor error model is given, or both are.
        """
        from imuwb.simulation import Tolerances, specimen  # noqa: PLC0415 - help must not wait for numpy

        return specimen(self.model(), seed, None if self.preset is None else Tolerances())


@dataclass(frozen=True)
class BenchSamples(Samples):
    """The samples of a log; all have one temperature."""

    temperature: Annotated[float | None, "temperature of the sensor (°C)", Form("CELSIUS")] = None


@dataclass(frozen=True)
class Place(Options):
    """The place of the bench."""

    latitude: Annotated[
        float | None,
        "latitude of the bench, for the gravity of the ellipsoid and the earth's rotation; without it, standard gravity and no rotation (deg)",
        Between(-90, 90),
        Form("DEG"),
    ] = None
    height: Annotated[float, "height of the bench above the ellipsoid, with --latitude (m)", Form("M")] = 0.0

    def site(self) -> Site:
        """Return gravity and latitude."""
        import numpy as np  # noqa: PLC0415 - help must not wait for it

        from imuwb.geodesy.earth import gravity  # noqa: PLC0415
        from imuwb.simulation import Site  # noqa: PLC0415

        if self.latitude is None:
            return Site()
        angle = math.radians(self.latitude)
        return Site(float(gravity(np.array([angle]), np.array([self.height]))[0]), angle)


@dataclass(frozen=True)
class Bench(Place):
    """The place of the bench, and how exactly the IMU is mounted on it."""

    misplacement: Annotated[float, "rms of each of two tilts of the IMU on the bench (deg)", Form("DEG")] = 0.05


@dataclass(frozen=True)
class Positions(Options):
    """The positions."""

    positions: Annotated[int, "number of positions; 6: a cube's faces, 9 to 100: spread over all directions"] = 6
    minutes: Annotated[float, "duration in each position (min)", POSITIVE] = 10.0
    one_log: Annotated[bool, "record all positions in one log, with the turns between them"] = False


@dataclass(frozen=True)
class Held(Options):
    """The positions in which a hand holds the sensor."""

    positions: Annotated[int, "number of positions, spread over all directions (9 to 100)"] = 24
    seconds: Annotated[float, "mean duration of a hold (s)", POSITIVE] = 4.0
    table: Annotated[float, "duration on a table before the first motion (s)", POSITIVE] = 30.0
    tremor: Annotated[float, "rms angle by which the hand sways about each axis; 0: a support (deg)", Form("DEG")] = 0.1


@dataclass(frozen=True)
class Table(Options):
    """The rates of a rate table."""

    rates: Annotated[
        tuple[float, ...], "rates of the table, each turned both ways (deg/s)", Form("R,R,...", "10,50,100")
    ]
    axis: Annotated[str, "axes that are turned; one log for each axis"] = "xyz"
    seconds: Annotated[float, "duration at each rate (s)", POSITIVE] = 30.0


def six_position(
    *, output: _Output, sensor: BenchSensor, turns: Positions, bench: Bench, samples: BenchSamples,
    kind: _Format = "mcap", force: Force = False,
) -> None:  # fmt: skip
    """Simulate an IMU on the faces of a cube, or in many positions, and the truth, for imuwb calibration.

    Example: imuwb simulate six-position --preset mpu-6050 --minutes 1 -o cube
    """
    import numpy as np  # noqa: PLC0415 - help must not wait for it

    from imuwb import simulation  # noqa: PLC0415
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = sensor.specimen(samples.seed)
    check_folder(output, [], force=force)
    with progress("simulating") as report:
        made = simulation.six_position(
            model, samples.seed, positions=turns.positions, seconds=turns.minutes * 60, rate=samples.rate,
            misplacement=math.radians(bench.misplacement), one_log=turns.one_log, site=bench.site(),
            celsius=samples.temperature, quantize=samples.quantize, progress=report,
        )  # fmt: skip
    angles = "".join(f"{roll:.6f},{pitch:.6f}\n" for roll, pitch in np.degrees(made.attitudes))
    texts = {output / TRUTH: made.truth.to_toml(), output / ATTITUDES: f"roll_deg,pitch_deg\n{angles}"}
    output.mkdir(exist_ok=True)
    save({output / f"{name}.{kind}": log for name, log in made.logs.items()}, texts, force=force)


def hand_held(
    *, output: _Output, sensor: BenchSensor, held: Held, place: Place, samples: BenchSamples,
    kind: _Format = "mcap", force: Force = False,
) -> None:  # fmt: skip
    """Simulate an IMU that is turned by hand and held still in many attitudes, and the truth, for imuwb calibration multi-position.

    Example: imuwb simulate hand-held --preset mpu-6050 -o hand
    """
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = sensor.specimen(samples.seed)
    check_folder(output, [], force=force)
    with progress("simulating") as report:
        made = simulation.hand_held(
            model, samples.seed, positions=held.positions, seconds=held.seconds, table=held.table, rate=samples.rate,
            tremor=math.radians(held.tremor), site=place.site(), celsius=samples.temperature,
            quantize=samples.quantize, progress=report,
        )  # fmt: skip
    output.mkdir(exist_ok=True)
    save({output / f"hand_held.{kind}": made.log}, {output / TRUTH: made.truth.to_toml()}, force=force)


def rate_table(
    *, output: _Output, table: Table, sensor: BenchSensor, bench: Bench, samples: BenchSamples,
    kind: _Format = "mcap", force: Force = False,
) -> None:  # fmt: skip
    """Simulate an IMU on a rate table, a staircase of rates both ways, and the truth, for imuwb calibration.

    Example: imuwb simulate rate-table --preset mpu-6050 --rates 10,50,100 -o table
    """
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model = sensor.specimen(samples.seed)
    check_folder(output, [], force=force)
    with progress("simulating") as report:
        made = simulation.rate_table(
            model, samples.seed, [math.radians(rate) for rate in table.rates], axes=table.axis, seconds=table.seconds,
            rate=samples.rate, misplacement=math.radians(bench.misplacement), site=bench.site(),
            celsius=samples.temperature, quantize=samples.quantize, progress=report,
        )  # fmt: skip
    output.mkdir(exist_ok=True)
    logs = {output / f"{name}.{kind}": log for name, log in made.logs.items()}
    save(logs, {output / TRUTH: made.truth.to_toml()}, force=force)

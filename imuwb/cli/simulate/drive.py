"""imuwb simulate drive: a car with an IMU and GNSS, and the truth."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from imuwb.cli.options import Force
from imuwb.cli.simulate.disturbances import Disturbances, ErrorsOfFixes, gnss_errors
from imuwb.cli.simulate.options import Output, Warm, check_output, model_of, save, sensor_names
from imuwb.errors import UsageError
from imuwb.options import NOT_NEGATIVE, POSITIVE, Form, Options

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.simulation import Odometer, Receiver, Route
    from imuwb.stochastic import ImuErrorModel

Triple: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Drive(Options):
    """The route, and its true trajectory."""

    preset: Annotated[
        str | None,
        "route after Quinchia et al. (2013): turin-1 (17.3 min, town) or turin-2 (15.05 min, with highway)",
        Form("NAME", words=("turin-1", "turin-2")),
    ] = None
    duration: Annotated[
        float | None, "duration of a route through town, country and highway, in place of a preset (s)", Form("SECONDS")
    ] = None
    route_seed: Annotated[int, "seed of the route's turns, stops and slopes", NOT_NEGATIVE] = 0
    truth_rate: Annotated[float, "rate of the true trajectory in the log (Hz)", Form("HZ")] = 10.0

    def route(self) -> Route:
        """Return the route.

        Raises:
            UsageError: neither preset nor duration is given, or both are, or the route is not possible.
        """
        from imuwb.simulation import mixed_route, planned_route  # noqa: PLC0415 - help must not wait for numpy

        if self.preset is not None and self.duration is None:
            return planned_route(self.preset, self.route_seed)
        if self.duration is not None and self.preset is None:
            return mixed_route(self.duration, self.route_seed)
        raise UsageError(
            "simulate drive needs one route: give either --preset turin-1 or turin-2, or --duration SECONDS"
        )


@dataclass(frozen=True)
class Vehicle(Warm):
    """The IMU of the car."""

    sensor: Annotated[
        str | None,
        "name of a published sensor; with an unknown name, the error lists all sensors",
        Form("NAME", words=sensor_names),
    ] = None
    error_model: Annotated[Path | None, "error model of a sensor of your own", Form("MODEL.toml")] = None
    vibration: Annotated[
        float,
        "rms on each accelerometer axis of the vibration from the road (5-50 Hz) and the engine (27 Hz) (m/s²)",
        Form("M/S2"),
    ] = 0.0

    def model(self) -> ImuErrorModel:
        """Return the error model of the IMU."""
        return model_of(self.sensor, "--sensor", self.error_model)


@dataclass(frozen=True)
class Gnss(Options):
    """The GNSS receiver."""

    gnss_rate: Annotated[float, "fixes per second (Hz)", POSITIVE, Form("HZ")] = 1.0
    position_sigma: Annotated[Triple, "sigma of the positions' white noise (m)", Form("N,E,D", "2,2,3.5")] = (
        2.0,
        2.0,
        3.5,
    )
    velocity_sigma: Annotated[Triple, "sigma of the velocities' white noise (m/s)", Form("N,E,D", "0.1,0.1,0.15")] = (
        0.1,
        0.1,
        0.15,
    )
    latency: Annotated[float, "delay of the fixes: age of a fix at its time stamp (s)", Form("SECONDS")] = 0.0
    lever_arm: Annotated[
        Triple, "lever arm from the IMU to the antenna: forward, right, down (m)", Form("F,R,D", "0.4,0,-1.2")
    ] = (0.0, 0.0, 0.0)
    gnss_errors: ErrorsOfFixes = None

    def receiver(self) -> Receiver:
        """Return the receiver."""
        from imuwb.simulation import Receiver  # noqa: PLC0415 - help must not wait for numpy

        errors = gnss_errors(self.gnss_errors or {})
        return Receiver(self.gnss_rate, self.position_sigma, self.velocity_sigma, self.latency, self.lever_arm, errors)


@dataclass(frozen=True)
class Wheels(Options):
    """The odometer."""

    odometer: Annotated[bool, "add an odometer of 10 Hz"] = False
    odometer_scale: Annotated[float, "scale error of the odometer, as a fraction", Form("FRACTION")] = 0.0
    odometer_step: Annotated[float, "step to which the odometer rounds; 0: no rounding (m/s)", Form("M/S")] = 0.0

    def device(self) -> Odometer | None:
        """Return the odometer, if there is one.

        Raises:
            UsageError: the errors of an odometer are given, but no odometer.
        """
        from imuwb.simulation import Odometer  # noqa: PLC0415 - help must not wait for numpy

        if self.odometer:
            return Odometer(scale_error=self.odometer_scale, step=self.odometer_step)
        if self.odometer_scale or self.odometer_step:
            raise UsageError("--odometer-scale and --odometer-step need an odometer; give --odometer as well")
        return None


def drive(
    *,
    output: Output,
    trip: Drive,
    vehicle: Vehicle,
    disturbances: Disturbances,
    gnss: Gnss,
    wheels: Wheels,
    force: Force = False,
) -> None:
    """Simulate a car with an IMU and GNSS, and the truth. A preset's outages are printed as imuwb outage takes them.

    Example: imuwb simulate drive --preset turin-1 --sensor mpu-6050 --seed 1 -o drive.mcap
    """
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    check_output(output, force=force)
    with progress("simulating") as report:
        model, route = vehicle.model(), trip.route()
        celsius, receiver, odometer = vehicle.celsius(route.duration), gnss.receiver(), wheels.device()
        noise, road = disturbances.noise(), disturbances.surface(trip.route_seed)
        log = simulation.drive(
            model, route, vehicle.seed, rate=vehicle.rate, receiver=receiver, odometer=odometer,
            truth_rate=trip.truth_rate, celsius=celsius, quantize=vehicle.quantize, bandwidth=vehicle.bandwidth,
            vibration=vehicle.vibration, motion_noise=noise, road=road, progress=report,
        )  # fmt: skip
    save({output: log}, force=force)
    if trip.preset is not None:
        outages = simulation.planned_outages(trip.preset)
        typer.echo("--at " + ",".join(f"{o.start:g}:{o.duration:g}" for o in outages))

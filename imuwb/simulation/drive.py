"""A car with an IMU and a GNSS receiver, and the truth.

An IMU sample stamped t_k is the average of the true angular rate omega_ib^b and specific force f^b over (t_(k-1), t_k],
so that its product with dt is the increment of the step that ends there; the errors of the sensor are added.
"""

import hashlib
from collections.abc import Callable, Mapping

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import AXES, Log, Nanoseconds, Origin, Provenance, Reference
from imuwb.simulation.motion_noise import STANDING, MotionNoise
from imuwb.simulation.receiver import WHITE, Odometer, Receiver
from imuwb.simulation.road import Road
from imuwb.simulation.route import Route
from imuwb.simulation.sensor import LONGEST, Sensor, stamps
from imuwb.simulation.thermal import Temperature, recipe_of, temperature
from imuwb.simulation.vibration import vibration as shaking
from imuwb.stochastic import ImuErrorModel

LOWEST_RATE, HIGHEST_RATE = 20.0, 10_000.0  #: Hz; at lower rates four nodes in a sample do not follow the motion
LOWEST_ON_A_ROAD = 50.0  #: Hz, likewise with the motion on a suspension
RECEIVER = Receiver()


def drive(
    model: ImuErrorModel,
    route: Route,
    seed: int,
    *,
    rate: float = 100.0,
    receiver: Receiver = RECEIVER,
    odometer: Odometer | None = None,
    truth_rate: float = 10.0,
    celsius: float | Temperature | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    vibration: float = 0.0,
    motion_noise: MotionNoise | None = None,
    road: Road | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Log:
    """Return the log of a drive: IMU, GNSS, an odometer if there is one, and the truth at samples of the IMU.

    Args:
        model: the sensor; a model without axes is an ideal sensor.
        route: where the car goes, ``planned_route`` or ``mixed_route``.
        seed: of all noise; the same seed, route and options give the same log.
        rate: Hz, of the IMU.
        receiver: the GNSS receiver.
        odometer: None: there is no odometer.
        truth_rate: Hz; the truth is at every n-th sample of the IMU, as near to this rate as possible.
        celsius: the sensor's temperature, constant or over time; None: 25 °C.
        quantize: round to each axis's ``lsb``, and clip to its ``range``.
        bandwidth: Hz, of the noise and of the road's vibration; None: the bandwidth that the axis states, if any.
        vibration: m/s² rms of each accelerometer axis.
        motion_noise: white noise and random walks that the sensors have in motion only, or always.
        road: a rough road; ``road.under(route)`` is then the true motion. None: the road is smooth.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a rate, bandwidth or vibration out of its range, or an axis that states no ``lsb``.
    """
    _check(route, rate, truth_rate, LOWEST_RATE if road is None else LOWEST_ON_A_ROAD)
    sensor = Sensor(model, temperature(celsius), quantize, bandwidth)
    n = round(route.duration * rate)
    time = stamps(n, rate)
    *axes, of_receiver, of_vibration, of_noise, of_road = np.random.SeedSequence(seed).spawn(len(AXES) + 4)
    added, truth = _in_motion(route, (n, rate), motion_noise, road, sensor.bandwidths(), (of_noise, of_road))
    if road is not None:
        route = road.under(route)
    rates, forces = route.averages(n, rate)
    if vibration:
        shaken = shaking(n, rate, vibration, np.random.default_rng(of_vibration))
        rates, forces = rates + shaken[0], forces + shaken[1]
    more = "".join(f"|{part}" for part in (motion_noise, receiver.errors, road) if part not in (None, WHITE))
    recipe = f"{model.to_toml()}|{seed}|{rate}|{receiver}|{odometer}|{truth_rate}|{recipe_of(celsius)}|{quantize}|{bandwidth}|{vibration}{more}"
    return Log(
        Provenance(f"drive {route.name} of {model.name}", "simulation", _digest(recipe, route), 0),
        imus=(sensor.measure(time, rate, (rates, forces), axes, progress, added),),
        gnss=(receiver.fixes(route, np.random.default_rng(of_receiver)),),
        speeds=() if odometer is None else (odometer.speeds(route),),
        references=(_truth(route, time, rate, truth_rate),),
        truth=truth | receiver.truth(),
    )


def _in_motion(
    route: Route,
    samples: tuple[int, float],
    noise: MotionNoise | None,
    road: Road | None,
    bandwidths: Mapping[str, float | None],
    seeds: tuple[np.random.SeedSequence, np.random.SeedSequence],
) -> tuple[tuple[Floats, Floats] | None, dict[str, str]]:
    """Return what motion adds to the errors of the samples, and its true parameters; None if it adds nothing.

    ``samples`` are their number and their rate in Hz; ``seeds`` are those of the noise and of the road.
    """
    if noise is None and road is None:
        return None, {}
    count, rate = samples
    speed = route.speed(np.arange(float(count)) / rate)
    rates, forces, truth = np.zeros((count, 3)), np.zeros((count, 3)), dict[str, str]()
    if road is not None:
        more, truth = road.vibration_errors(speed, rate, bandwidths, seeds[1])
        rates, forces = rates + more[0], forces + more[1]
    if noise is not None:
        more = noise.sample(speed > STANDING, 1 / rate, np.random.default_rng(seeds[0]))
        rates, forces, truth = rates + more[0], forces + more[1], truth | noise.truth()
    return (rates, forces), truth


def _check(route: Route, rate: float, truth_rate: float, lowest: float = LOWEST_RATE) -> None:
    if not lowest <= rate <= HIGHEST_RATE or not route.duration * rate <= LONGEST:
        where = "" if lowest == LOWEST_RATE else " on a rough road"
        raise UsageError(
            f"the rate of the drive{where} is {rate} Hz; it must be {lowest:g} to {HIGHEST_RATE:g} Hz, and give at most {LONGEST} samples"
        )
    if not 0 < truth_rate <= rate:
        raise UsageError(
            f"the rate of the truth is {truth_rate} Hz; it must be above 0, and at most the IMU's {rate:g} Hz"
        )


def _truth(route: Route, time: Nanoseconds, rate: float, truth_rate: float) -> Reference:
    rows = np.arange(0, time.size, max(1, round(rate / truth_rate)))
    state = route.state(rows / rate)
    return Reference("truth", time[rows], state.position, state.velocity, state.attitude, Origin("SI", "FRD", "unix"))


def _digest(recipe: str, route: Route) -> str:
    digest = hashlib.sha256(f"{recipe}|{route.start}|{route.duration}".encode())
    digest.update(route.profile.manoeuvres.c.tobytes())
    digest.update(route.profile.road.c.tobytes())
    return f"sha256:{digest.hexdigest()}"

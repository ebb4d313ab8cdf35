"""The record of a calibration bench: one motion without a break, so that slow noise continues, cut into logs."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.log import AXES, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.simulation.sensor import LONGEST, Sensor, stamps
from imuwb.stochastic import ImuErrorModel

FEWEST = 16  #: samples in one position
MOST_TILT = 0.2  #: rad


@dataclass(frozen=True, slots=True)
class Site:
    """The place of the bench. Without a latitude, the earth's rotation is left out."""

    gravity: float = 9.80665  #: m/s²
    latitude: float | None = None  #: rad

    def earth_rate(self, up: Floats, heading: float) -> Floats:
        """Return the earth's rate in the body frame, (3,) rad/s, of a body with this up and any horizontal heading."""
        if self.latitude is None:
            return np.zeros(3)
        first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
        first /= np.linalg.norm(first)
        north = np.cos(heading) * first + np.sin(heading) * np.cross(up, first)
        return EARTH_RATE * (np.sin(self.latitude) * up + np.cos(self.latitude) * north)


@dataclass(frozen=True, eq=False, slots=True)
class Bench:
    """A motion, and the logs into which its record is cut."""

    rate: float  #: Hz
    motion: tuple[Floats, Floats]  #: (n, 3) rad/s and (n, 3) m/s², true
    parts: Mapping[str, tuple[int, int]]  #: name of a log -> rows (first, end)

    def record(
        self, sensor: Sensor, seed: int, recipe: str, progress: Callable[[int, int], None] | None = None
    ) -> dict[str, Log]:
        """Return the logs by name."""
        n = len(self.motion[0])
        whole = sensor.measure(
            stamps(n, self.rate), self.rate, self.motion, np.random.SeedSequence(seed).spawn(len(AXES)), progress
        )
        digest = hashlib.sha256(f"{sensor.model.to_toml()}|{recipe}|{seed}".encode()).hexdigest()
        return {
            name: Log(
                Provenance(f"simulation of {sensor.model.name}, {name}", "simulation", f"sha256:{digest}", 0),
                imus=(_cut(whole, first, end),),
            )
            for name, (first, end) in self.parts.items()
        }


def check_size(seconds: float, each: int, rate: float) -> None:
    """Raise UsageError unless a record of ``each`` stretches, all of the given seconds, has a possible size."""
    if not 0 < seconds * rate < LONGEST or round(seconds * rate) < FEWEST:
        raise UsageError(
            f"{seconds:g} s at {rate} Hz in each position are {seconds * rate:.3g} samples; there must be {FEWEST} or more"
        )
    samples = seconds * rate * each
    if not 1 <= rate <= 1e5 or not 2 <= samples <= LONGEST:  # noqa: PLR2004 - a rate needs two samples
        raise UsageError(f"{samples:.0f} samples at {rate} Hz; there must be 2 to {LONGEST}, at 1 Hz to 100 kHz")


def check_misplacement(misplacement: float) -> None:
    """Raise UsageError unless the tilts of the sensor on the bench (rms, rad) are small."""
    if not 0 <= misplacement <= MOST_TILT:
        raise UsageError(
            f"the misplacement is {np.degrees(misplacement):g}°; it must be 0 to {np.degrees(MOST_TILT):.0f}°"
        )


def noted(model: ImuErrorModel, text: str) -> ImuErrorModel:
    """Return the true model with a note on what else was drawn at random."""
    return replace(model, provenance={**model.provenance, "bench": text})


def _cut(imu: ImuStream, first: int, end: int) -> ImuStream:
    def triad(whole: Triad | None) -> Triad | None:
        return None if whole is None else Triad(whole.time[first:end], whole.value[first:end])

    gyro = triad(imu.angular_rate)
    temperature = imu.temperature
    if temperature is not None and gyro is not None:
        inside = (temperature.time >= gyro.time[0]) & (temperature.time <= gyro.time[-1])
        temperature = (
            Scalars(temperature.name, temperature.time[inside], temperature.value[inside]) if inside.any() else None
        )
    return replace(imu, angular_rate=gyro, specific_force=triad(imu.specific_force), temperature=temperature)

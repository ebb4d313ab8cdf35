"""The still records of the y axes, simulated with the random walk of table 1 and the coefficient of table 2, or the user's own."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.axes import axes_of
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.stochastic import Autoregressive
from imuwb.units import UNITS
from imuwb_plugins.reproduce.printed import Key, Paper

RATE = 100.0  #: Hz
CELSIUS = (-30, 0, 30, 60)
IMUS = ("MotionPakII", "AHRS300CC")
AXES = {"gyro y": "gyro_y", "accel y": "accel_y"}  #: name in the paper's tables -> axis
UNIT = {"gyro y": "deg/√h", "accel y": "m/s/√h"}


@dataclass(frozen=True, eq=False, slots=True)
class Record:
    """One axis of one IMU at one temperature."""

    imu: str
    axis: str  #: "gyro y"
    celsius: int
    values: Floats  #: (n,) SI
    dt: float  #: s

    @property
    def item(self) -> str:
        """Its name in the paper's tables."""
        return f"{self.imu}, {self.celsius} °C"

    def log(self) -> Log:
        """Return a log of this axis alone."""
        time = np.rint(np.arange(self.values.size) * self.dt * SECOND).astype(np.int64)
        columns = np.full((self.values.size, 3), np.nan)
        columns[:, 1] = self.values
        triad = Triad(time, columns)
        rate, force = (triad, None) if self.axis == "gyro y" else (None, triad)
        return Log(Provenance(self.item, "simulation", "", 0), imus=(ImuStream(self.imu, rate, force),))


def simulated(printed: Paper, hours: float, seed: int) -> Iterator[Record]:
    """Yield records with the noise that the paper prints.

    Table 2 has b(k+1) = C b(k) + e, so alpha = -C. An autoregressive process of order 1 has at long times the random walk N = beta0 √dt / (1 + alpha).
    """
    known = {value.key: value.value for value in printed.values()}
    dt, n = 1 / RATE, round(hours * 3600 * RATE)
    streams = iter(np.random.SeedSequence(seed).spawn(len(IMUS) * len(AXES) * len(CELSIUS)))
    for imu in IMUS:
        for axis in AXES:
            for celsius in CELSIUS:
                item = f"{imu}, {celsius} °C"
                walk = UNITS[UNIT[axis]].to_si(known[Key("1", f"{axis}, N", item)])
                alpha = -known[Key("2", f"{axis}, C", item)]
                process = Autoregressive((alpha,), walk * (1 + alpha) / math.sqrt(dt), dt)
                yield Record(imu, axis, celsius, process.sample(n, dt, np.random.default_rng(next(streams))), dt)


def own(logs: Sequence[Log]) -> Iterator[Record]:
    """Yield the y axes of the user's own logs, one for each temperature of the tables, as those of the first IMU.

    Raises:
        MissingDataError: a log has no y axis.
    """
    for log, celsius in zip(logs, CELSIUS, strict=True):
        axes = axes_of(log.imu())
        for name, axis in AXES.items():
            if axis not in axes:
                raise MissingDataError(
                    f"{log.provenance.path}: {log.imu().name} has no {axis}, which the tables are of"
                )
            yield Record(IMUS[0], name, celsius, axes[axis].longest, axes[axis].clock.interval)

"""What a replay runs: an error model, the states that stand for it, and how the filter is set."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import AXES
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.shaping import Reading, Shaping, shaping
from imuwb.navigation.tables import AxisTables
from imuwb.navigation.workspace import MOST_STATES

if TYPE_CHECKING:
    from imuwb.log import Floats
    from imuwb.stochastic import ImuErrorModel

NAVIGATION_STATES = (
    *(f"position {axis}, m" for axis in ("north", "east", "down")),
    *(f"velocity {axis}, m/s" for axis in ("north", "east", "down")),
    *(f"attitude {axis}, rad" for axis in ("north", "east", "down")),
)


@dataclass(frozen=True, slots=True)
class Aids:
    """What corrects the filter besides fixes, also in an outage; a sigma of 0 switches an aid off."""

    straight: float = (
        0.0  #: m/s, of the velocity across and down in the vehicle (non-holonomic constraint), each second
    )
    still: float = 0.0  #: m/s, of a velocity of zero where the IMU stands still (zero-velocity update)
    speed: float = 0.0  #: m/s, of the log's own forward speed


@dataclass(frozen=True, slots=True)
class Installation:
    """How the IMU and the antenna sit in the vehicle, and how their clocks differ."""

    mounting: tuple[float, float, float] = (
        0.0,
        0.0,
        0.0,
    )  #: deg; roll, pitch, heading that turn vectors from vehicle to IMU
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: m FRD in the vehicle, from the IMU to the antenna
    gnss_delay: float = 0.0  #: s; a fix shows where the IMU was at its own stamp less this
    velocity_delay: float = (
        0.0  #: s; a fix's velocity is of a time so much earlier than its position (a mean over its interval)
    )
    clock_rate: float = 1.0  #: of the IMU's seconds, how many true ones each lasts
    skew: float = 0.0  #: s, by which the accelerometer's stamps are later than the gyro's for the same instant


@dataclass(frozen=True, slots=True)
class Settings:
    """Numbers of the filter itself."""

    every: int = 10  #: samples between two covariances
    gate: float = 40.0  #: normalised innovation squared, of three, above which a fix is refused
    patience: int = 5  #: fixes refused one behind the other before the filter believes them
    position_sigma: tuple[float, float] = (2.5, 5.0)  #: m, horizontal and vertical, of fixes that claim none
    velocity_sigma: tuple[float, float] = (0.15, 0.3)  #: m/s, likewise
    sigma_scale: float = 1.0  #: by which the receiver's own sigmas are multiplied
    tilt: float = 1.0  #: deg, sigma of roll and pitch at the start
    heading: float = 3.0  #: deg, sigma of heading at the start, besides what the velocity's gives
    start_speed: float = 3.0  #: m/s, above which velocity gives the heading
    settling: float = 60.0  #: s of fixes in motion before an outage is scored


@dataclass(frozen=True, slots=True)
class FilterModel:
    """A filter that can be run over a log."""

    name: str
    error_model: ImuErrorModel
    reading: Reading = "corrected"  #: of Quinchia's formulas
    scale_factor: tuple[float, float] = (0.0, 0.0)  #: sigmas, of gyros and accelerometers; 0: no state
    wavelet_levels: tuple[
        int, ...
    ] = ()  #: of denoising before the mechanization, ``gyro_x`` ... ``accel_z``; empty: none
    installation: Installation = field(default_factory=Installation)
    settings: Settings = field(default_factory=Settings)
    aids: Aids = field(default_factory=Aids)

    @property
    def causal(self) -> bool:
        """Whether no sample knows of later ones: denoising as a whole does."""
        return not any(self.wavelet_levels)

    def shapings(self, dt: float, celsius: float | None = None) -> tuple[Shaping, ...]:
        """Return the six axes' states at a sampling interval.

        Raises:
            ValueError: a process that no filter can carry, or more states than it has room for.
        """
        found: list[Shaping] = []
        for axis in AXES:
            model = self.error_model.axes.get(axis)
            if model is None:
                message = f"{self.name}: the error model {self.error_model.name!r} says nothing of {axis}"
                raise ValueError(message)
            try:
                found.append(shaping(model.at(celsius), dt, self.reading))
            except ValueError as error:
                message = f"{self.name}, {axis}: {error}"
                raise ValueError(message) from error
        return tuple(found)

    def states(self, dt: float) -> tuple[str, ...]:
        """Return what each error state is (Quinchia, table 8)."""
        units = ("rad/s",) * 3 + ("m/s²",) * 3
        axes = [
            [*(f"{axis}: {state}, {unit}" for state in one.states), *((f"{axis}: scale factor",) if scale else ())]
            for axis, unit, one, scale in zip(AXES, units, self.shapings(dt), self._scales(), strict=True)
        ]
        return (*NAVIGATION_STATES, *(state for axis in axes for state in axis))

    def left_out(self, dt: float) -> tuple[str, ...]:
        """Return the processes that no state stands for, by axis."""
        return tuple(f"{a}: {p}" for a, one in zip(AXES, self.shapings(dt), strict=True) for p in one.left_out)

    def _scales(self) -> tuple[float, ...]:
        return (self.scale_factor[0],) * 3 + (self.scale_factor[1],) * 3

    def tables(self, dt: float, celsius: tuple[float | None, ...] = (None,)) -> tuple[AxisTables, Floats]:
        """Return what the kernels take, and the covariance of the axes' states at the start.

        Args:
            dt: s.
            celsius: a temperature for each regime.

        Raises:
            ValueError: as ``shapings``; more states than there is room for.
        """
        regimes = [self.shapings(dt, t) for t in celsius]
        scales = self._scales()
        orders = [one.order + (scale > 0) for one, scale in zip(regimes[0], scales, strict=True)]
        first = NAVIGATION + np.concatenate([[0], np.cumsum(orders)]).astype(np.int64)
        if first[6] > MOST_STATES:
            message = f"{self.name}: {first[6]} states; a filter has room for {MOST_STATES}"
            raise ValueError(message)
        spans, most = self.settings.every + 1, max(*orders, 1)
        shape = len(celsius), spans, 6, most, most
        tables = AxisTables(
            first=first, step=np.zeros((len(celsius), sum(orders))), scale=np.zeros(sum(orders), dtype=bool),
            output=np.zeros((len(celsius), spans, sum(orders))), transition=np.zeros(shape), noise=np.zeros(shape),
            inside=np.zeros((len(celsius), spans, 6)), cross=np.zeros((len(celsius), spans, sum(orders))),
            white=np.zeros((len(celsius), 6)),
        )  # fmt: skip
        start = np.zeros((sum(orders), sum(orders)))
        for r, axes in enumerate(regimes):
            for i, (one, scale) in enumerate(zip(axes, scales, strict=True)):
                low, high = int(first[i]) - NAVIGATION, int(first[i + 1]) - NAVIGATION
                _fill(tables, r, i, one, slice(low, low + one.order))
                if scale:
                    tables.step[r, high - 1], tables.output[r, :, high - 1], tables.scale[high - 1] = 1.0, 1.0, True
                    tables.transition[r, :, i, one.order, one.order] = 1.0
                    start[high - 1, high - 1] = scale**2
                if r == 0:
                    start[low : low + one.order, low : low + one.order] = one.P0
        return tables, start


def _fill(tables: AxisTables, regime: int, axis: int, one: Shaping, place: slice) -> None:
    """Write one axis's tables, for spans of 0, 1, ... samples.

    With S the sum of a span's errors, x(k) = A x(k-1) + w(k) and S(k) = S(k-1) + c x(k): both are carried on together.
    """
    p = one.order
    tables.white[regime, axis] = one.white
    tables.step[regime, place] = one.c
    a = np.zeros((p + 1, p + 1))
    a[:p, :p], a[p, :p], a[p, p] = one.A, one.c @ one.A, 1.0
    q = np.zeros((p + 1, p + 1))
    q[:p, :p], q[p, :p], q[:p, p], q[p, p] = one.Q, one.c @ one.Q, one.Q @ one.c, one.c @ one.Q @ one.c
    power, noise = np.eye(p + 1), np.zeros((p + 1, p + 1))
    for samples in range(tables.output.shape[1]):
        tables.transition[regime, samples, axis, :p, :p] = power[:p, :p]
        tables.noise[regime, samples, axis, :p, :p] = noise[:p, :p]
        tables.output[regime, samples, place] = power[p, :p] / max(samples, 1)
        tables.cross[regime, samples, place] = noise[:p, p]
        tables.inside[regime, samples, axis] = noise[p, p]
        power, noise = a @ power, a @ noise @ a.T + q


def degrees(angles: tuple[float, float, float]) -> Floats:
    """Return angles given in degrees in rad."""
    return np.array([math.radians(a) for a in angles])

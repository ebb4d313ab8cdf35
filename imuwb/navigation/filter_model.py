"""The model of a filter: an error model, the states that represent it, and the filter's settings."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.lines import LineShare, left_out
from imuwb.navigation.shaping import Reading, Shaping, shaping
from imuwb.navigation.tables import AxisTables
from imuwb.navigation.workspace import MOST_STATES
from imuwb.stochastic import AxisModel, ImuErrorModel, Sinusoid, Sum

RECEIVER = "receiver"  #: in the names of the states of a receiver's error
NAVIGATION_STATES = (
    *(f"position {axis}, m" for axis in ("north", "east", "down")),
    *(f"velocity {axis}, m/s" for axis in ("north", "east", "down")),
    *(f"attitude {axis}, rad" for axis in ("north", "east", "down")),
)


@dataclass(frozen=True, slots=True)
class Vibration:
    """White noise that grows with the square of the vibration, beside that of the error model."""

    white: tuple[float, float] = (0.0, 0.0)  #: N of gyros, rad/s/√Hz, and accelerometers, m/s²/√Hz, at the reference
    reference: float = (
        0.0  #: m/s², the level of vibration at which the noise has these values; 0: there is no such noise
    )


@dataclass(frozen=True, slots=True)
class Aids:
    """Sigmas of the aids, which correct the filter besides fixes, also in an outage; 0 switches an aid off."""

    straight: float = 0.0  #: m/s, of the vehicle's velocity across and down (non-holonomic constraint), each second
    still: float = 0.0  #: m/s, of a velocity of zero in a standstill (zero-velocity update), each second
    speed: float = 0.0  #: m/s, of the log's own forward speed (odometer)


@dataclass(frozen=True, slots=True)
class Installation:
    """How the IMU and the antenna are mounted in the vehicle, and how their clocks differ."""

    #: deg; roll, pitch and heading that turn vectors from the vehicle's axes to the IMU's
    mounting: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: m, FRD in the vehicle, from the IMU to the antenna
    gnss_delay: float = 0.0  #: s; a fix shows the position at its stamp minus this delay
    velocity_delay: float = 0.0  #: s, by which a fix's velocity is older than its position
    clock_rate: float = 1.0  #: true seconds in a second of the IMU's clock
    skew: float = 0.0  #: s, by which the accelerometer's stamp of an instant is later than the gyro's
    #: m, FRD in the vehicle, from the IMU to the point that moves straight ahead and whose speed the odometer shows
    vehicle_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Settings:
    """The settings of the filter itself."""

    every: int = 10  #: samples between two propagations of the covariance
    gate: float = 40.0  #: NIS of the three components of a position or velocity, above which it is refused
    patience: int = 5  #: fixes refused in a row before the filter accepts the next one
    position_sigma: tuple[float, float] = (2.5, 5.0)  #: m, horizontal and vertical, of fixes without sigmas
    velocity_sigma: tuple[float, float] = (0.15, 0.3)  #: m/s, horizontal and vertical, of fixes without sigmas
    #: m and m/s, sigmas of positions and velocities in place of the receiver's own; a height's is twice as large; 0: its own
    sigma_stated: tuple[float, float] = (0.0, 0.0)
    sigma_scale: tuple[float, float] = (1.0, 1.0)  #: factors of the receiver's own sigmas of positions and velocities
    #: m and m/s; the squares are added to the variances of positions and velocities, four times for a height
    sigma_floor: tuple[float, float] = (0.0, 0.0)
    #: m and s, sigma (horizontal; a height's is twice as large) and correlation time of a first-order Gauss-Markov error of the
    #: receiver's position, which is a part of the sigmas of its fixes and has three states; 0: there is no such error
    gnss_correlation: tuple[float, float] = (0.0, 0.0)
    spacing: float = 0.0  #: s between two fixes that are used, at least; 0: all are used
    tilt: float = 1.0  #: deg, sigma of roll and pitch at the alignment
    heading: float = 3.0  #: deg, sigma of heading at the alignment; the velocity's sigma adds to it
    start_speed: float = 3.0  #: m/s; above this speed the velocity gives the heading
    #: s from the log's start, and heading and its sigma, deg, of a start that is known for one log; sigma 0: it is not known
    known_start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    settling: float = 60.0  #: s of fixes after the alignment and before the first outage of a sweep
    horizons: tuple[float, float] = (
        10.0,
        60.0,
    )  #: s, shortest and longest outage, in which lines must matter to get states


@dataclass(frozen=True, slots=True)
class FilterModel:
    """A filter that can be run over a log."""

    name: str
    error_model: ImuErrorModel
    reading: Reading = "corrected"  #: how Quinchia's formulas are read
    scale_factor: tuple[float, float] = (0.0, 0.0)  #: sigmas, of gyros and accelerometers; 0: no state
    #: levels of denoising before the mechanization, ``gyro_x`` ... ``accel_z``; empty: no denoising
    wavelet_levels: tuple[int, ...] = ()
    #: sigma of the noise in the thresholds: of each level, of the finest level, or none (1 in SI units, as the paper's 18AVWD)
    wavelet_scale: Literal["level", "first", "none"] = "level"
    vibration: Vibration = field(default_factory=Vibration)
    installation: Installation = field(default_factory=Installation)
    settings: Settings = field(default_factory=Settings)
    aids: Aids = field(default_factory=Aids)

    def __repr__(self) -> str:
        """Return the name, the error model and what differs from the defaults, in a few lines."""
        changed = [
            f"{name} = {value}"
            for part in (self.vibration, self.installation, self.settings, self.aids)
            for name in type(part).__dataclass_fields__
            if (value := getattr(part, name)) != getattr(type(part)(), name)
        ]
        if any(self.wavelet_levels):
            changed.append(f"wavelet_levels = {self.wavelet_levels}, wavelet_scale = {self.wavelet_scale}")
        if any(self.scale_factor):
            changed.append(f"scale_factor = {self.scale_factor}")
        first = f"FilterModel {self.name}: error model {self.error_model.name}, formulas {self.reading}"
        return "\n  ".join([first, *changed])

    @property
    def causal(self) -> bool:
        """Whether no sample depends on later samples; after denoising of the whole record, each does."""
        return not any(self.wavelet_levels)

    def shapings(self, dt: float, celsius: float | None = None) -> tuple[Shaping, ...]:
        """Return the shaping filters of the six axes at a sampling interval.

        Args:
            dt: s.
            celsius: °C; None: the model's plain parameters.

        Raises:
            UsageError: an axis that the error model lacks, or a process that cannot be written with states.
        """
        left_out = self.lines_left_out(dt)
        return tuple(
            self._shaping(axis, self._axis(axis).at(celsius), dt, [line.term for line in left_out if line.axis == axis])
            for axis in AXES
        )

    def lines_left_out(self, dt: float) -> tuple[LineShare, ...]:
        """Return the periodic lines of the error model that have no states, as ``imuwb.navigation.lines`` chooses them.

        Args:
            dt: s.

        Raises:
            UsageError: as ``shapings``.
        """
        axes = [model.thermal[0][1] if model.thermal else model.processes for model in map(self._axis, AXES)]
        lines = [[k for k, term in enumerate(s.terms) if isinstance(term, Sinusoid)] for s in axes]
        if not any(lines):
            return ()
        orders = [self._shaping(*own).order for own in zip(AXES, axes, [dt] * len(AXES), lines, strict=True)]
        taken = NAVIGATION + sum(orders) + sum(scale > 0 for scale in self._scales()) + sum(self._received())
        return left_out(axes, max(MOST_STATES - taken, 0) // 2, self.settings.horizons)

    def _axis(self, axis: str) -> AxisModel:
        model = self.error_model.axes.get(axis)
        if model is None:
            raise UsageError(f"{self.name}: the error model {self.error_model.name!r} has no axis {axis}; add it")
        return model

    def _shaping(self, axis: str, processes: Sum, dt: float, without: Sequence[int]) -> Shaping:
        """Return the shaping filter of an axis without some of its processes, which ``left_out`` then names."""
        terms = processes.terms
        kept = Sum(tuple(term for k, term in enumerate(terms) if k not in without))
        try:
            own = shaping(kept, dt, self.reading)
        except ValueError as error:
            raise UsageError(f"{self.name}, {axis}: {error}") from error
        lines = [f"line at {term.frequency:.4g} Hz" for k in without if isinstance(term := terms[k], Sinusoid)]
        return replace(own, left_out=(*own.left_out, *lines))

    def states(self, dt: float) -> tuple[str, ...]:
        """Return the name of each error state (Quinchia, table 8)."""
        units = ("rad/s",) * 3 + ("m/s²",) * 3
        received = zip(self._received(), ("", "", "", "north", "east", "down"), strict=True)
        axes = [
            [
                *(f"{axis}: {state}, {unit}" for state in own.states),
                *((f"{axis}: scale factor",) if scale else ()),
                *((f"{RECEIVER}: position error {name}, m",) if correlated else ()),
            ]
            for axis, unit, own, scale, (correlated, name) in zip(
                AXES, units, self.shapings(dt), self._scales(), received, strict=True
            )
        ]
        return (*NAVIGATION_STATES, *(state for axis in axes for state in axis))

    def left_out(self, dt: float) -> tuple[str, ...]:
        """Return the processes without a state, each with its axis."""
        return tuple(f"{a}: {p}" for a, own in zip(AXES, self.shapings(dt), strict=True) for p in own.left_out)

    def _scales(self) -> tuple[float, ...]:
        return (self.scale_factor[0],) * 3 + (self.scale_factor[1],) * 3

    def _received(self) -> tuple[bool, ...]:
        """Return whether a state of the receiver's error follows the states of each axis: those of accelerometers have one."""
        sigma, time = self.settings.gnss_correlation
        if sigma < 0 or time < 0 or (sigma > 0) != (time > 0):
            raise UsageError(
                f"{self.name}: the receiver's correlated error has a sigma of {sigma:g} m and a correlation time of {time:g} s; both "
                "must be above 0, or both 0"
            )
        return (False,) * 3 + (sigma > 0,) * 3

    def tables(self, dt: float, celsius: tuple[float | None, ...] = (None,)) -> tuple[AxisTables, Floats]:
        """Return the tables for the kernels, and the covariance of the axes' states at the log's start.

        Args:
            dt: s.
            celsius: °C, a temperature for each regime.

        Raises:
            UsageError: as ``shapings``; or too many states.
        """
        each = {t: self.shapings(dt, t) for t in dict.fromkeys(celsius)}
        regimes = [each[t] for t in celsius]
        scales, received = self._scales(), self._received()
        orders = [own.order + (s > 0) + more for own, s, more in zip(regimes[0], scales, received, strict=True)]
        tables = self._empty_tables(len(celsius), orders)
        start = np.zeros((sum(orders), sum(orders)))
        for r, axes in enumerate(regimes):
            if (same := celsius.index(celsius[r])) < r:
                _copy(tables, same, r)
                continue
            for i, (own, scale) in enumerate(zip(axes, scales, strict=True)):
                low = int(tables.first[i]) - NAVIGATION
                high = low + own.order
                _fill(tables, r, i, own, slice(low, high))
                if scale:
                    tables.step[r, high], tables.output[r, :, high], tables.scale[high] = 1.0, 1.0, True
                    tables.transition[r, :, i, own.order, own.order] = 1.0
                    start[high, high] = scale**2
                if received[i]:
                    place = int(tables.first[i + 1]) - 1 - NAVIGATION
                    start[place, place] = _receive(tables, r, i, self.settings.gnss_correlation, dt)
                if r == 0:
                    start[low : low + own.order, low : low + own.order] = own.P0
        return tables, start

    def _empty_tables(self, regimes: int, orders: list[int]) -> AxisTables:
        first = NAVIGATION + np.concatenate([[0], np.cumsum(orders)]).astype(np.int64)
        if first[6] > MOST_STATES:
            raise UsageError(
                f"{self.name}: {first[6]} states; a filter has at most {MOST_STATES}: remove processes from the error model"
            )
        count, spans, most = sum(orders), self.settings.every + 1, max(*orders, 1)
        shape = regimes, spans, 6, most, most
        return AxisTables(
            first=first, step=np.zeros((regimes, count)), scale=np.zeros(count, dtype=bool),
            output=np.zeros((regimes, spans, count)), transition=np.zeros(shape), noise=np.zeros(shape),
            inside=np.zeros((regimes, spans, 6)), cross=np.zeros((regimes, spans, count)), white=np.zeros((regimes, 6)),
            receiver=np.where(self._received()[3:], first[4:] - 1, 0),
        )  # fmt: skip


def _copy(tables: AxisTables, regime: int, to: int) -> None:
    """Write the tables of a regime with those of another one at the same temperature."""
    for part in (
        tables.step,
        tables.output,
        tables.transition,
        tables.noise,
        tables.inside,
        tables.cross,
        tables.white,
    ):
        part[to] = part[regime]


def _receive(tables: AxisTables, regime: int, axis: int, correlation: tuple[float, float], dt: float) -> float:
    """Write the tables of the receiver's error that follows an axis's states; return its variance, m².

    The error is first-order Gauss-Markov: over h seconds it decays by a = exp(-h/tau), and noise of the variance
    sigma² (1 - a²) is added (Groves, 3.2.4). It is no error of the axis: the axis's output does not depend on it.
    """
    sigma, time = correlation
    variance = receiver_variance(sigma)[axis - 3]
    at = int(tables.first[axis + 1] - tables.first[axis]) - 1
    decay = np.exp(-dt / time * np.arange(tables.output.shape[1]))
    tables.transition[regime, :, axis, at, at] = decay
    tables.noise[regime, :, axis, at, at] = variance * (1 - decay**2)
    return float(variance)


def receiver_variance(sigma: float) -> Floats:
    """Return the variances of a receiver's correlated position error, (3,) m² NED; a height's sigma is twice as large."""
    return np.square([sigma, sigma, 2 * sigma])


def _fill(tables: AxisTables, regime: int, axis: int, shaping: Shaping, place: slice) -> None:
    """Write the tables of one axis, for spans of 0, 1, ... samples."""
    p = shaping.order
    tables.white[regime, axis] = shaping.white
    tables.step[regime, place] = shaping.c
    a, q = shaping.with_sum()
    power, noise = np.eye(p + 1), np.zeros((p + 1, p + 1))
    for samples in range(tables.output.shape[1]):
        tables.transition[regime, samples, axis, :p, :p] = power[:p, :p]
        tables.noise[regime, samples, axis, :p, :p] = noise[:p, :p]
        tables.output[regime, samples, place] = power[p, :p] / max(samples, 1)
        tables.cross[regime, samples, place] = noise[:p, p]
        tables.inside[regime, samples, axis] = noise[p, p]
        power, noise = a @ power, a @ noise @ a.T + q

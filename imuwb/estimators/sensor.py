"""What estimators ask of the three axes of one sensor, taken from an error model."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from imuwb.errors import UsageError
from imuwb.estimators.growth import TO_POSITION, slow_part, turn_on
from imuwb.estimators.matching import Match, as_gauss_markov, as_walk
from imuwb.stochastic import AxisModel, FlickerNoise, ImuErrorModel, RandomWalk, Sum, WhiteNoise

LARGEST = 1e6  #: factor of noise in motion
SENSORS = ("gyro", "accel")
#: limit of a coefficient that a record does not show -> the process that it limits
_LIMITS: Mapping[str, Callable[[float], WhiteNoise | FlickerNoise | RandomWalk]] = {
    "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis: white noise, slow errors, and the bias at turn-on. SI; None or an empty sum where nothing is known."""

    name: str  #: such as "gyro_x"
    processes: Sum
    white: float | None  #: N
    turn_on: float | None  #: sigma of the bias at turn-on

    def walk(self, horizon: float) -> Match | None:
        """Return the random walk that stands for the slow errors over a horizon (s)."""
        return as_walk(self.processes, self.white, horizon, TO_POSITION[self.name.partition("_")[0]])

    def gauss_markov(self, horizon: float) -> Match | None:
        """Return the Gauss-Markov process that stands for the slow errors over a horizon (s)."""
        return as_gauss_markov(self.processes, horizon, TO_POSITION[self.name.partition("_")[0]])

    @property
    def flicker(self) -> float | None:
        """Return B, the root of the sum of squares where there are several."""
        squares = [term.B**2 for term in self.processes.terms if isinstance(term, FlickerNoise)]
        return math.sqrt(sum(squares)) if squares else None

    @property
    def own_walk(self) -> float | None:
        """Return K of the random walks that the model itself has."""
        squares = [term.K**2 for term in self.processes.terms if isinstance(term, RandomWalk)]
        return math.sqrt(sum(squares)) if squares else None


def axes_of(model: ImuErrorModel, sensor: str) -> tuple[Axis | None, ...]:
    """Return the axes x, y, z of ``gyro`` or ``accel``; None where the model has no such axis."""
    axes = (model.axes.get(f"{sensor}_{axis}") for axis in "xyz")
    return tuple(
        None if axis is None else _axis(f"{sensor}_{name}", axis) for name, axis in zip("xyz", axes, strict=True)
    )


def _axis(name: str, model: AxisModel) -> Axis:
    terms = model.processes.terms
    squares = [term.N**2 for term in terms if isinstance(term, WhiteNoise)]
    white = math.sqrt(sum(squares)) if squares and any(squares) else None
    return Axis(name, model.processes, white, turn_on(model.processes) or None)


def with_limits(model: ImuErrorModel) -> tuple[ImuErrorModel, tuple[str, ...]]:
    """Return the model with N, B and K that the record does not show at their upper limits, and a sentence for each.

    B and K limit the same slow errors, so an axis that shows one of them gets no limit of the other; where it shows neither,
    it gets the limit that lets a filter drift further.
    """
    notes: list[str] = []
    axes: dict[str, AxisModel] = {}
    for name, axis in model.axes.items():
        terms = list(axis.processes.terms)
        white = next((term.N for term in terms if isinstance(term, WhiteNoise)), None)
        if white is None and "N" in axis.limits:
            white = axis.limits["N"]
            terms.append(WhiteNoise(white))
            notes.append(f"{name}: N is not identified; its upper limit is written")
        if not slow_part(axis.processes).terms:
            found = _largest_limit(name, axis, white)
            if found is not None:
                letter, process = found
                terms.append(process)
                notes.append(f"{name}: no slow error is identified; the upper limit of {letter} is taken")
        axes[name] = replace(axis, processes=Sum(tuple(terms)))
    return replace(model, axes=axes), tuple(notes)


def _largest_limit(name: str, axis: AxisModel, white: float | None) -> tuple[str, FlickerNoise | RandomWalk] | None:
    times = TO_POSITION[name.partition("_")[0]]
    found: list[tuple[float, str, FlickerNoise | RandomWalk]] = []
    for letter in "BK":
        if letter in axis.limits:
            process = _LIMITS[letter](axis.limits[letter])
            assert not isinstance(process, WhiteNoise)  # noqa: S101 - for the type checker
            match = as_walk(Sum((process,)), white, 60.0, times)
            if match is not None and isinstance(match.process, RandomWalk):
                found.append((match.process.K, letter, process))
    if not found:
        return None
    _, letter, process = max(found, key=lambda item: item[0])
    return letter, process


@dataclass(frozen=True, slots=True)
class Factors:
    """How much noisier a sensor is in motion than on its bench."""

    gyro: float
    accel: float

    @staticmethod
    def of_text(text: str) -> "Factors":
        """Return the factors of ``gyro=23,accel=10``.

        Raises:
            UsageError: another form, or a factor that is not above 0 and below ``LARGEST``.
        """
        parts = {name: factor for name, _, factor in (part.partition("=") for part in text.replace(" ", "").split(","))}
        try:
            factors = Factors(float(parts.pop("gyro", "1")), float(parts.pop("accel", "1")))
        except ValueError:
            factors = Factors(math.nan, math.nan)
        if parts or not (0 < factors.gyro < LARGEST and 0 < factors.accel < LARGEST):
            raise UsageError(
                f"--in-motion {text}: write factors of white noise above 0 and below {LARGEST:g}, such as gyro=23,accel=10, or a file"
            )
        return factors

    def applied(self, model: ImuErrorModel) -> ImuErrorModel:
        """Return the model with its white noise times the factors."""
        axes = {name: _louder(axis, getattr(self, name.partition("_")[0])) for name, axis in model.axes.items()}
        return replace(model, axes=axes)


def _louder(axis: AxisModel, factor: float) -> AxisModel:
    terms = (WhiteNoise(term.N * factor) if isinstance(term, WhiteNoise) else term for term in axis.processes.terms)
    return axis.with_processes(Sum(tuple(terms)))

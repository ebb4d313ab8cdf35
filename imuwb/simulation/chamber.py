"""A climate chamber: a still IMU, recorded at one temperature after another."""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.simulation.static import static
from imuwb.simulation.thermal import ABSOLUTE_ZERO, temperature
from imuwb.stochastic import ImuErrorModel

MOST = 200  #: set-points
CLOSE = 1e-9  #: share of a step by which the last set-point may miss the end
FINE = 1000  #: steps in a degree; temperatures that differ by a step or more have different seeds


def set_points(first: float, last: float, step: float) -> tuple[float, ...]:
    """Return the temperatures from the first to the last by steps, °C; the last one only if a whole step leads to it.

    Raises:
        UsageError: a step of the wrong sign, or too small; a temperature that no sensor has.
    """
    for celsius in (first, last):
        temperature(celsius)  # raises an error if it is out of range
    if not math.isfinite(step) or step * (last - first) < 0 or (step == 0 and first != last):
        raise UsageError(
            f"set-points from {first:g} to {last:g} °C in steps of {step:g} °C: the step must lead from the first to the last"
        )
    count = 1 if first == last else math.floor((last - first) / step + CLOSE) + 1
    if count > MOST:
        raise UsageError(
            f"{count} set-points from {first:g} to {last:g} °C in steps of {step:g} °C; there must be at most {MOST}"
        )
    if abs(step) * FINE < 1 and count > 1:
        raise UsageError(f"the step is {step:g} °C; it must be {1 / FINE:g} °C or more")
    return tuple(round(first + k * step, 9) for k in range(count))


def chamber(
    model: ImuErrorModel,
    points: Sequence[float],
    duration: float,
    rate: float,
    seed: int,
    *,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Log]:
    """Yield the static log of each set-point, each with turn-on biases of its own.

    Args:
        model: the sensor.
        points: °C; the noise at a set-point does not depend on the other set-points.
        duration: s, of each log.
        rate: Hz.
        seed: the same seed gives the same log at a temperature.
        quantize: as in ``static``.
        bandwidth: as in ``static``.
        progress: called with (set-points done, set-points).

    Raises:
        UsageError: as ``static``.
    """
    for k, celsius in enumerate(points):
        mixed = np.random.SeedSequence([seed, round((celsius - ABSOLUTE_ZERO) * FINE)])
        own = int(mixed.generate_state(1, np.uint64)[0])
        yield static(model, duration, rate, own, celsius=celsius, quantize=quantize, bandwidth=bandwidth)
        if progress is not None:
            progress(k + 1, len(points))


def names(points: Sequence[float]) -> tuple[str, ...]:
    """Return a name for each set-point's log, such as ``03_minus-10C``; sorted, they are in the order of recording."""
    width = len(str(len(points)))
    return tuple(f"{k + 1:0{width}d}_{_word(c)}C" for k, c in enumerate(points))


def _word(celsius: float) -> str:
    sign = "minus-" if celsius < 0 else "plus-" if celsius > 0 else ""
    return f"{sign}{abs(celsius):g}"

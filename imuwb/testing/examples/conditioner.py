"""Running mean: each sample becomes the mean of its neighbours, or of those before it.

A running mean of n samples keeps frequencies far below the rate / n, and takes out those of the rate / n and its multiples.
"""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from imuwb.analysis import Curve, Figure, Review
from imuwb.arrays import Floats
from imuwb.colors import BLUE
from imuwb.conditioning import Change, condition_streams
from imuwb.log import Conditioning, Log
from imuwb.options import Between, Options

POINTS = 400  #: of the drawn gain
FLAT = 0.055  #: frequency times samples over rate, below which the gain squared is above 0.99


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``--through plugin_name:...``."""

    samples: Annotated[int, "number of samples of a mean; an odd number", Between(3, 9999)] = 5
    causal: Annotated[bool, "use past samples only, and be late by half of the samples"] = False

    def __post_init__(self) -> None:
        """Check the values, and that the number is odd.

        Raises:
            ValueError: a value that is not allowed.
        """
        super().__post_init__()
        if self.samples % 2 == 0:
            raise ValueError(f"samples is {self.samples}; it must be an odd number, so that a mean has a middle")


@dataclass(frozen=True)
class Applied:
    """What was done to the samples."""

    samples: int
    rate: float  #: Hz, of the first sensor


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with the means of its samples, and what was done.

    Raises:
        MissingDataError: no IMU, or no part between gaps with enough samples.
    """
    log.imu()  # raises MissingDataError if there is none
    rates: list[float] = []
    half = parameters.samples // 2
    left_out = (parameters.samples - 1, 0) if parameters.causal else (half, half)

    def design(sensor: str, rate: float) -> Change:
        del sensor  # gyros and accelerometers are treated alike
        rates.append(rate)
        first, last = left_out
        return Change(lambda values: _means(values, parameters.samples), parameters.samples, first, last)

    changed = condition_streams(log, design)
    delay = half / min(rates) if parameters.causal else 0.0
    text = f"samples={parameters.samples},causal={parameters.causal}".lower()
    step = Conditioning("plugin_name", text, parameters.causal, delay, band=FLAT * min(rates) / parameters.samples)
    return replace(changed, conditioning=(*log.conditioning, step)), Applied(parameters.samples, rates[0])


def _means(values: Floats, samples: int) -> Floats:
    """Return the means of all runs of that many rows, (n - samples + 1, 3)."""
    return np.lib.stride_tricks.sliding_window_view(values, samples, axis=0).mean(axis=-1)


def draw(applied: Applied, review: Review) -> None:
    """Show the gain at each frequency."""
    frequency = np.linspace(0.0, applied.rate / 2, POINTS)
    phase = np.pi * frequency / applied.rate
    gain = np.ones(POINTS)
    gain[1:] = np.abs(np.sin(applied.samples * phase[1:]) / (applied.samples * np.sin(phase[1:])))
    curve = Curve("gain", frequency, gain, BLUE, style="curve")
    title = f"Running mean of {applied.samples} samples"
    review.figure(Figure(title, "frequency [Hz]", "gain [1]", (curve,), x_scale="linear", y_scale="linear"))

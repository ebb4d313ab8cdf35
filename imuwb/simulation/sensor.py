"""What the sensors of an error model put out for a given motion: deterministic terms, noise, bandwidth, whole steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from imuwb.errors import UsageError
from imuwb.log import AXES, SECOND, ImuStream, Origin, Scalars, Triad
from imuwb.stochastic import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from imuwb.log import Floats, Nanoseconds
    from imuwb.stochastic import AxisModel, ImuErrorModel

START = 1_704_067_200 * SECOND  #: 2024-01-01T00:00:00Z, so that the same seed gives the same bytes
LONGEST = 2**31  #: samples
ABSOLUTE_ZERO, HOTTEST = -273.15, 1000.0  #: °C
ROOM_TEMPERATURE = 25.0  #: °C


def stamps(count: int, rate: float) -> Nanoseconds:
    """Return the times of ``count`` samples at ``rate`` Hz, (n,) ns, from the log's start on."""
    return START + np.rint(np.arange(count) * (SECOND / rate)).astype(np.int64)


@dataclass(frozen=True, slots=True)
class Sensor:
    """An IMU and how it is run.

    Raises:
        UsageError: a temperature that no sensor is at.
    """

    model: ImuErrorModel
    celsius: float | None = None  #: None: 25, and the model's own processes where it has no thermal table
    quantize: bool = False  #: round to each axis's ``lsb``, and clip to its ``range``
    #: Hz; the noise goes through a Butterworth low-pass of second order. None: the axis's own bandwidth, if it states one
    bandwidth: float | None = None

    def __post_init__(self) -> None:
        """Check the temperature."""
        if self.celsius is not None and not ABSOLUTE_ZERO < self.celsius < HOTTEST:
            message = f"a temperature of {self.celsius} °C: no sensor is at it"
            raise UsageError(message)

    def measure(
        self,
        time: Nanoseconds,
        rate: float,
        motion: tuple[Floats, Floats],
        streams: Sequence[np.random.SeedSequence],
        progress: Callable[[int, int], None] | None = None,
    ) -> ImuStream:
        """Return what the sensor puts out.

        Args:
            time: (n,) ns.
            rate: Hz, of the samples.
            motion: (n, 3) rad/s and (n, 3) m/s², the true averages over each sample's interval, FRD.
            streams: a seed for each axis.
            progress: called with (axes done, axes).

        Raises:
            UsageError: a bandwidth that cannot be, an axis that states no ``lsb``, an AR set of another rate.
        """
        values = np.empty((2, time.size, 3))
        shows = shown(self.model, motion, None if self.celsius is None else np.array(self.celsius))
        for i, (axis, stream) in enumerate(zip(AXES, streams, strict=True)):
            values[i // 3, :, i % 3] = self._axis(axis, shows, rate, np.random.default_rng(stream))
            if progress is not None:
                progress(i + 1, len(AXES))
        if not np.isfinite(values).all():
            message = f"{self.model.name}: its figures are so large that the samples overflow"
            raise UsageError(message)
        seconds = np.arange(0, time.size, max(1, round(rate)))
        celsius = np.full(seconds.size, ROOM_TEMPERATURE if self.celsius is None else self.celsius)
        temperature = Scalars("/imu/temperature", time[seconds], celsius)
        return ImuStream(
            "/imu/data", Triad(time, values[0]), Triad(time, values[1]), temperature, Origin("SI", "FRD", "unix")
        )

    def _axis(self, axis: str, motion: tuple[Floats, Floats], rate: float, rng: np.random.Generator) -> Floats:
        place = AXES.index(axis)
        model = self.model.axes.get(axis)
        true = motion[place // 3][:, place % 3]
        if model is None:
            return true
        values = true + self._noise(model, true.size, rate, rng)
        return _quantized(values, model, axis) if self.quantize else values

    def _noise(self, model: AxisModel, n: int, rate: float, rng: np.random.Generator) -> Floats:
        try:
            noise = model.at(self.celsius).sample(n, 1 / rate, rng)
        except (ValueError, OverflowError) as error:  # an AR set of another rate, or one that is not stable in between
            raise UsageError(str(error)) from error
        cutoff = self.bandwidth if self.bandwidth is not None else model.bandwidth
        if cutoff is None:
            return noise
        if not 1e-6 * rate < cutoff < rate / 2:
            message = f"a bandwidth of {cutoff} Hz must lie between a millionth and half of the rate ({rate / 2} Hz)"
            raise UsageError(message)
        sections = signal.butter(2, cutoff, fs=rate, output="sos")
        settled = signal.sosfilt_zi(sections) * noise[0]
        return signal.sosfilt(sections, noise, zi=settled)[0]


def _quantized(values: Floats, model: AxisModel, axis: str) -> Floats:
    if not model.lsb:
        message = f"--quantize: the model states no lsb for {axis}"
        raise UsageError(message)
    steps = np.rint(values / model.lsb)
    if model.range:
        most = np.floor(model.range / model.lsb)
        steps = np.clip(steps, -most, most)
    return steps * model.lsb

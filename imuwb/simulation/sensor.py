"""The output of an error model's sensors for a motion: deterministic terms, noise, bandwidth, quantization."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import AXES, SECOND, ImuStream, Nanoseconds, Origin, Scalars, Triad
from imuwb.simulation.thermal import Temperature
from imuwb.simulation.thermal_noise import thermal_noise
from imuwb.stochastic import AxisModel, ImuErrorModel, shown

START = 1_704_067_200 * SECOND  #: 2024-01-01T00:00:00Z, so that the same seed gives the same bytes
LONGEST = 2**31  #: samples


def stamps(count: int, rate: float) -> Nanoseconds:
    """Return the times of ``count`` samples at ``rate`` Hz from the log's start, (n,) ns."""
    return START + np.rint(np.arange(count) * (SECOND / rate)).astype(np.int64)


@dataclass(frozen=True, slots=True)
class Sensor:
    """An IMU, its temperature and its settings."""

    model: ImuErrorModel
    celsius: Temperature
    quantize: bool = False  #: round to each axis's ``lsb``, and clip to its ``range``
    #: Hz; the noise goes through a Butterworth low-pass of second order. None: the bandwidth that the axis states, if any
    bandwidth: float | None = None

    def bandwidths(self) -> dict[str, float | None]:
        """Return the bandwidth of each axis, Hz; None: no low-pass."""
        stated = {axis: self.model.axes[axis].bandwidth if axis in self.model.axes else None for axis in AXES}
        return stated if self.bandwidth is None else dict.fromkeys(AXES, self.bandwidth)

    def measure(
        self,
        time: Nanoseconds,
        rate: float,
        motion: tuple[Floats, Floats],
        streams: Sequence[np.random.SeedSequence],
        progress: Callable[[int, int], None] | None = None,
        added: tuple[Floats, Floats] | None = None,
    ) -> ImuStream:
        """Return the output of the sensor.

        Args:
            time: (n,) ns.
            rate: Hz, of the samples.
            motion: (n, 3) rad/s and (n, 3) m/s², the true averages over each sample's interval, FRD.
            streams: a seed for each axis.
            progress: called with (axes done, axes).
            added: (n, 3) rad/s and (n, 3) m/s², errors in addition to those of the model.

        Raises:
            UsageError: a bandwidth out of its range, an axis that states no ``lsb``, an AR set for another rate.
        """
        values = np.empty((2, time.size, 3))
        seconds = (time - time[0]) / SECOND
        constant = self.celsius.constant
        celsius = self.celsius.at(seconds) if constant is None else np.array(constant)
        shows = shown(self.model, motion, celsius)
        for i, (axis, stream) in enumerate(zip(AXES, streams, strict=True)):
            more = None if added is None else added[i // 3][:, i % 3]
            values[i // 3, :, i % 3] = self._axis(axis, shows, celsius, rate, np.random.default_rng(stream), more)
            if progress is not None:
                progress(i + 1, len(AXES))
        if not np.isfinite(values).all():
            raise UsageError(f"{self.model.name}: its terms are so large that the samples overflow")
        rows = slice(None, None, max(1, round(rate)))  # one each second
        thermometer = Scalars("/imu/temperature", time[rows], self.celsius.at(seconds[rows]))
        return ImuStream(
            "/imu/data", Triad(time, values[0]), Triad(time, values[1]), thermometer, Origin("SI", "FRD", "unix")
        )

    def _axis(
        self,
        axis: str,
        motion: tuple[Floats, Floats],
        celsius: Floats,
        rate: float,
        rng: np.random.Generator,
        added: Floats | None,
    ) -> Floats:
        place = AXES.index(axis)
        model = self.model.axes.get(axis)
        true = motion[place // 3][:, place % 3]
        if added is not None:
            true = true + added
        if model is None:
            return true
        values = true + self._noise(model, celsius, true.size, rate, rng)
        return _quantized(values, model, axis) if self.quantize else values

    def _noise(self, model: AxisModel, celsius: Floats, n: int, rate: float, rng: np.random.Generator) -> Floats:
        try:
            if celsius.ndim:
                noise = thermal_noise(model, celsius, 1 / rate, rng)
            else:
                noise = model.at(float(celsius)).sample(n, 1 / rate, rng)
        except (ValueError, OverflowError) as error:  # an AR set of another rate, or not stable between two set-points
            raise UsageError(str(error)) from error
        cutoff = self.bandwidth if self.bandwidth is not None else model.bandwidth
        if cutoff is None:
            return noise
        if not 1e-6 * rate < cutoff < rate / 2:
            raise UsageError(
                f"the bandwidth is {cutoff} Hz; it must be between a millionth and half of the rate ({rate / 2} Hz)"
            )
        from scipy import signal  # noqa: PLC0415 - scipy.signal is slow to import

        sections = signal.butter(2, cutoff, fs=rate, output="sos")
        settled = signal.sosfilt_zi(sections) * noise[0]
        return signal.sosfilt(sections, noise, zi=settled)[0]


def _quantized(values: Floats, model: AxisModel, axis: str) -> Floats:
    if not model.lsb:
        raise UsageError(f"--quantize: the error model states no lsb for {axis}; add it, or leave --quantize out")
    steps = np.rint(values / model.lsb)
    if model.range:
        most = np.floor(model.range / model.lsb)
        steps = np.clip(steps, -most, most)
    return steps * model.lsb

"""A still IMU on a bench."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from imuwb.errors import UsageError
from imuwb.log import AXES, SECOND, ImuStream, Log, Origin, Provenance, Scalars, Triad
from imuwb.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from collections.abc import Callable

    from imuwb.log import Floats
    from imuwb.stochastic import AxisModel, ImuErrorModel

START = 1_704_067_200 * SECOND  #: 2024-01-01T00:00:00Z, so that the same seed gives the same bytes
LONGEST = 2**31  #: samples
ABSOLUTE_ZERO, HOTTEST = -273.15, 1000.0  #: °C
ROOM_TEMPERATURE = 25.0  #: °C


def static(
    model: ImuErrorModel,
    duration: float,
    rate: float,
    seed: int,
    *,
    celsius: float | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Log:
    """Return the log of a level, still IMU: gravity on z as the model's scale factors show it, noise, no earth rate.

    Args:
        model: the sensor.
        duration: s.
        rate: Hz.
        seed: the same seed, model, rate and duration give the same log.
        celsius: the sensor's temperature; None: 25, and the model's own processes where it has no thermal table.
        quantize: round to each axis's ``lsb``, and clip to its ``range``.
        bandwidth: Hz; each axis's noise goes through a Butterworth low-pass of second order. None: the
            axis's own bandwidth, if it states one.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a duration, rate or bandwidth that cannot be, or an axis that states no ``lsb``.
    """
    samples = duration * rate
    if not 1e-3 <= rate <= 1e6 or not 2 <= samples <= LONGEST:  # noqa: PLR2004 - a rate needs two samples
        message = f"{duration} s at {rate} Hz are {samples} samples; there must be 2 to {LONGEST}, at 0.001 Hz to 1 MHz"
        raise UsageError(message)
    if celsius is not None and not ABSOLUTE_ZERO < celsius < HOTTEST:
        message = f"a temperature of {celsius} °C: no sensor is at it"
        raise UsageError(message)
    n = round(samples)
    time = START + np.rint(np.arange(n) * (SECOND / rate)).astype(np.int64)
    values = np.zeros((2, n, 3))
    for i, axis in enumerate(AXES):
        values[i // 3, :, i % 3] = _at_rest(model.axes.get(axis), i)
    streams = np.random.SeedSequence(seed).spawn(len(AXES))
    for i, (axis, stream) in enumerate(zip(AXES, streams, strict=True)):
        if axis in model.axes:
            noise = _axis(model.axes[axis], n, rate, np.random.default_rng(stream), celsius, bandwidth)
            values[i // 3, :, i % 3] += noise
            if quantize:
                values[i // 3, :, i % 3] = _quantized(values[i // 3, :, i % 3], model.axes[axis], axis)
        if progress is not None:
            progress(i + 1, len(AXES))
    if not np.isfinite(values).all():
        message = f"{model.name}: its figures are so large that the samples overflow"
        raise UsageError(message)
    seconds = np.arange(0, n, max(1, round(rate)))
    temperature = Scalars(
        "/imu/temperature", time[seconds], np.full(seconds.size, ROOM_TEMPERATURE if celsius is None else celsius)
    )
    origin = Origin("SI", "FRD", "unix")
    imu = ImuStream("/imu/data", Triad(time, values[0]), Triad(time, values[1]), temperature, origin)
    recipe = f"{model.to_toml()}|{duration}|{rate}|{seed}|{celsius}|{quantize}|{bandwidth}"
    digest = hashlib.sha256(recipe.encode()).hexdigest()
    return Log(Provenance(f"simulation of {model.name}", "simulation", f"sha256:{digest}", 0), imus=(imu,))


def _at_rest(model: AxisModel | None, i: int) -> float:
    """Return what axis i of a level, still IMU reads without noise: gravity, as its deterministic terms show it."""
    force = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    place = i % 3
    true = force[place] if i >= 3 else 0.0  # noqa: PLR2004 - accelerometers behind gyros
    if model is None:
        return float(true)
    others = [k for k in range(3) if k != place]
    crossed = sum(c * force[k] for c, k in zip(model.cross_coupling, others, strict=True)) if i >= 3 else 0.0  # noqa: PLR2004
    bent = model.scale_factor_nonlinear * abs(true) / model.range if model.range else 0.0
    leaked = float(np.dot(model.g_sensitivity, force)) if i < 3 else 0.0  # noqa: PLR2004
    return float((1 + model.scale_factor + bent) * true + crossed + leaked)


def _axis(
    model: AxisModel, n: int, rate: float, rng: np.random.Generator, celsius: float | None, bandwidth: float | None
) -> Floats:
    try:
        noise = model.at(celsius).sample(n, 1 / rate, rng)
    except (ValueError, OverflowError) as error:  # an AR set of another rate, or one that is not stable in between
        raise UsageError(str(error)) from error
    cutoff = bandwidth if bandwidth is not None else model.bandwidth
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

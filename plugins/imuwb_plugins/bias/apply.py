"""The removal of the mean from each axis of a log."""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, Conditioning, ImuStream, Log, Triad
from imuwb_plugins.bias.parameters import Parameters


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, list[float]]]:
    """Return the log without biases, and the biases of the first IMU: sensor -> x, y, z in rad/s or m/s².

    Raises:
        MissingDataError: no IMU, or one whose sensor has no samples.
    """
    if not log.imus or not all(map(len, _all(log))):
        raise MissingDataError(f"{log.provenance.path}: bias needs an IMU with samples, and there are none")
    sensors = [s for s in ("gyro", "accel") if parameters.sensors in ("both", s)]
    means = [
        {s: _mean(t, parameters.seconds) for s, t in _triads(imu).items() if s in sensors and t is not None}
        for imu in log.imus
    ]
    imus = tuple(_without(imu, mean) for imu, mean in zip(log.imus, means, strict=True))
    end = float(log.seconds(np.array([triad.time[-1] for triad in _all(log)])).max())
    # If the beginning is the whole record, its mean is not causal.
    causal = parameters.seconds is not None and parameters.seconds < end
    text = f"seconds={'all' if parameters.seconds is None else f'{parameters.seconds:g}'},sensors={parameters.sensors}"
    step = Conditioning("bias", text, causal, 0.0, without_mean=tuple(sensors))
    taken = {sensor: mean.tolist() for sensor, mean in means[0].items()}
    return replace(log, imus=imus, conditioning=(*log.conditioning, step)), taken


def _all(log: Log) -> list[Triad]:
    return [triad for imu in log.imus for triad in _triads(imu).values() if triad is not None]


def _triads(imu: ImuStream) -> dict[str, Triad | None]:
    return {"gyro": imu.angular_rate, "accel": imu.specific_force}


def _mean(triad: Triad, seconds: float | None) -> Floats:
    """Return the mean of a triad, or of its first seconds, at least of one sample."""
    if seconds is None:
        return triad.value.mean(axis=0)
    end = int(np.searchsorted(triad.time, triad.time[0] + round(seconds * SECOND)))
    return triad.value[: max(end, 1)].mean(axis=0)


def _without(imu: ImuStream, means: dict[str, Floats]) -> ImuStream:
    rate, force = (
        Triad(triad.time, triad.value - means[sensor]) if triad is not None and sensor in means else triad
        for sensor, triad in _triads(imu).items()
    )
    return replace(imu, angular_rate=rate, specific_force=force)

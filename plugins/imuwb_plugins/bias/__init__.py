"""Bias removal: each axis less its mean, of the whole record or of its first seconds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

if TYPE_CHECKING:
    from imuwb.log import Log


@dataclass(frozen=True)
class Parameters:
    """What can be asked."""

    seconds: Annotated[
        float | None, "take the mean of so many seconds at the begin (causal); else of the whole record"
    ] = None
    sensors: Annotated[Literal["both", "gyro", "accel"], "whose bias; an accelerometer's mean holds gravity"] = "both"

    def __post_init__(self) -> None:
        """Check the time."""
        if self.seconds is not None and not 0 < self.seconds < math.inf:
            message = f"seconds is {self.seconds}; it must be positive"
            raise ValueError(message)


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, list[float]]]:
    """Return the log without the bias, and what was taken off (first IMU; rad/s or m/s², x, y, z)."""
    from dataclasses import replace  # noqa: PLC0415 - help must not wait

    import numpy as np  # noqa: PLC0415 - as above

    from imuwb.log import Conditioning, Triad  # noqa: PLC0415 - as above

    taken: dict[str, list[float]] = {}

    def without(sensor: str, triad: Triad | None) -> Triad | None:
        if triad is None or parameters.sensors not in ("both", sensor):
            return triad
        end = len(triad)
        if parameters.seconds is not None:
            end = max(int(np.searchsorted(triad.time, triad.time[0] + round(parameters.seconds * 1e9))), 1)
        mean = triad.value[:end].mean(axis=0)
        taken.setdefault(sensor, [float(m) for m in mean])
        return Triad(triad.time, triad.value - mean)

    last = np.array(
        [triad.time[-1] for imu in log.imus for triad in (imu.angular_rate, imu.specific_force) if triad is not None]
    )
    imus = tuple(
        replace(
            imu, angular_rate=without("gyro", imu.angular_rate), specific_force=without("accel", imu.specific_force)
        )
        for imu in log.imus
    )
    # Causal where it knows a beginning alone: samples behind it come later.
    causal = parameters.seconds is not None and parameters.seconds < float(log.seconds(last).max())
    text = f"seconds={'all' if parameters.seconds is None else f'{parameters.seconds:g}'},sensors={parameters.sensors}"
    made = Conditioning("bias", text, causal, 0.0)
    return replace(log, imus=imus, conditioning=(*log.conditioning, made)), taken

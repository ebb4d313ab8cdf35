"""From arrays to streams: a conditioner's change, applied to each triad between its gaps."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import ImuStream, Log, Triad
from imuwb.sampling import sampling


@dataclass(frozen=True, slots=True)
class Change:
    """A change of evenly spaced samples (n, 3); an axis that a sensor does not have is nan throughout, and stays so."""

    apply: Callable[[Floats], Floats]  #: (n, 3) -> (n - first - last, 3), or every ``step``-th of those
    shortest: int = 1  #: samples of a part between gaps; shorter parts are dropped
    first: int = 0  #: samples that are left out at the beginning of a part
    last: int = 0  #: samples that are left out at its end
    step: int = 1  #: one of this many samples is kept


def condition_streams(log: Log, design: Callable[[str, float], Change]) -> Log:
    """Return the log with every IMU's triads changed; the caller adds the step to ``Log.conditioning``.

    Args:
        log: the log.
        design: returns the change for a sensor, ``"gyro"`` or ``"accel"``, at its rate in Hz; ValueError where the rate does not
            allow it.

    Raises:
        MissingDataError: no part between gaps is long enough.
    """
    return replace(log, imus=tuple(_imu(log, imu, design) for imu in log.imus))


def _imu(log: Log, imu: ImuStream, design: Callable[[str, float], Change]) -> ImuStream:
    triads = {"gyro": imu.angular_rate, "accel": imu.specific_force}
    changed = {
        sensor: None if t is None else _triad(log, f"{imu.name} {sensor}", t, sensor, design)
        for sensor, t in triads.items()
    }
    return replace(imu, angular_rate=changed["gyro"], specific_force=changed["accel"])


def _triad(log: Log, name: str, triad: Triad, sensor: str, design: Callable[[str, float], Change]) -> Triad:
    clock = sampling(triad.time)
    if clock.rate is None:
        raise MissingDataError(
            f"{log.provenance.path}: {name} has {len(triad)} samples; a conditioner needs at least 2"
        )
    change = design(sensor, clock.rate)
    times, values = [], []
    for begin, end in pairwise([0, *clock.breaks, len(triad)]):
        if end - begin >= max(change.shortest, change.first + change.last + 1):
            times.append(triad.time[begin + change.first : end - change.last : change.step])
            values.append(change.apply(triad.value[begin:end]))
    if not times:
        raise MissingDataError(
            f"{log.provenance.path}: {name}: no part between gaps has the {max(change.shortest, change.first + change.last + 1)} samples "
            "that this conditioner needs"
        )
    return Triad(np.concatenate(times), np.concatenate(values))

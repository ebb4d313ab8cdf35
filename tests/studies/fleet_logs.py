"""A simulated fleet: sensors with their own noise, logged month by month, some planted to be found, some logs damaged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from fleet_analysis import GREEDY, HANGS

from imuwb.simulation import preset, static
from imuwb.writers import write

SPREAD, DRIFT, APART = (
    0.03,
    0.08,
    0.4,
)  #: sigma between sensors; of the drifting one over all months; of those out of family
MONTHS, A_VEHICLE = 5, 6  #: logs of a sensor; sensors of a vehicle
GROUP = r"(?P<vehicle>v\d+)/(?P<serial>s\d+)/(?P<date>[\d-]+)"
DAMAGED = 0.03


def scaled(log, factor):
    """Return a log whose noise is larger by a factor."""
    imu = log.imus[0]
    triads = {}
    for name in ("angular_rate", "specific_force"):
        triad = getattr(imu, name)
        mean = triad.value.mean(axis=0)
        triads[name] = replace(triad, value=mean + factor * (triad.value - mean))
    return replace(log, imus=(replace(imu, **triads),))


def fleet(folder, sensors, seconds, rate, seed=1):
    """Write the logs of a fleet into ``folder/vV/sS/DATE.mcap``, and return how many there are of each kind."""
    random, model = np.random.default_rng(seed), preset("3dm-gx3-25")
    factors = np.exp(random.normal(0, SPREAD, sensors))
    factors[1:4] *= 1 + APART
    paths = []
    for sensor in range(sensors):
        for month in range(MONTHS):
            path = folder / f"v{sensor // A_VEHICLE:03d}/s{sensor:03d}/2026-{month + 1:02d}-01.mcap"
            path.parent.mkdir(parents=True, exist_ok=True)
            drift = 1 + DRIFT * month / (MONTHS - 1) if sensor == 0 else 1.0
            write(
                scaled(static(model, seconds, rate, seed * 10**6 + 100 * sensor + month), factors[sensor] * drift), path
            )
            paths.append(path)
    chosen = random.permutation(range(4 * MONTHS, len(paths)))[: max(round(DAMAGED * len(paths)), 7)]
    for number, place in enumerate(chosen):
        _damage(paths[place], number, model, random)
    return len(paths), len(chosen)


def _damage(path, number, model, random):
    if number < 2:  # the logs that hang and that take memory
        write(static(model, (HANGS, GREEDY)[number] / 50, 50, number), path)
        return
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    kinds = (
        lambda: content[: middle // 8],  # cut
        lambda: b"",
        lambda: b"\0" * len(content),
        lambda: b"a page and no log\n" * 50,
        lambda: content[:8] + random.bytes(len(content) - 8),
    )
    path.write_bytes(kinds[(number - 2) % len(kinds)]())

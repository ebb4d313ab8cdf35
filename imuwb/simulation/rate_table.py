"""An IMU on a rate table: a staircase of rates, counter-clockwise and clockwise, one log for each axis."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.simulation.bench import Bench, Site, check_misplacement, check_size, noted
from imuwb.simulation.sensor import Sensor
from imuwb.simulation.six_position import SITE, tilted
from imuwb.simulation.thermal import Temperature, recipe_of, temperature
from imuwb.stochastic import ImuErrorModel

ACCELERATION = 100 * np.pi / 180  #: rad/s², from step to step
FASTEST = 2e4 * np.pi / 180  #: rad/s
MOST_RATES = 50


@dataclass(frozen=True, eq=False, slots=True)
class RateTable:
    """Logs of the axes, and the truth."""

    logs: dict[str, Log]
    truth: ImuErrorModel


def rate_table(
    model: ImuErrorModel,
    seed: int,
    rates: Sequence[float],
    *,
    axes: str = "xyz",
    seconds: float = 30.0,
    rate: float = 100.0,
    misplacement: float = 0.0,
    site: Site = SITE,
    celsius: float | Temperature | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> RateTable:
    """Return a log for each axis: at rest, all rates one way, at rest, all rates the other way, at rest.

    The turned axis points up, and positive rates turn it counter-clockwise as seen from above.

    Args:
        model: one sensor; its deterministic terms are the truth.
        seed: the same seed and settings give the same logs.
        rates: rad/s, magnitudes.
        axes: the turned axes, in order.
        seconds: s, on each step.
        rate: Hz, of the samples.
        misplacement: rad, rms of each of two tilts of the sensor on the table.
        site: gravity, and the earth's rate.
        celsius: as in ``static``.
        quantize: as in ``static``.
        bandwidth: as in ``static``.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a setting out of its range.
    """
    steps = sorted({abs(float(r)) for r in rates})
    if not steps or len(steps) > MOST_RATES or not all(0 < r <= FASTEST for r in steps):
        raise UsageError(
            f"rates are {', '.join(f'{np.degrees(r):g}' for r in steps) or 'none'} deg/s; there must be 1 to {MOST_RATES}, above 0 and at most {np.degrees(FASTEST):g}"
        )
    if not axes or set(axes) - set("xyz") or len(set(axes)) < len(axes):
        raise UsageError(f"axis is {axes!r}; it must be x, y or z, or several of them")
    check_misplacement(misplacement)
    check_size(seconds, (2 * len(steps) + 3) * len(axes), rate)
    rng = np.random.default_rng([seed, len(axes)])
    profile = _profile([0.0, *steps, 0.0, *(-s for s in steps), 0.0], seconds, rate)
    motions = [_motion(tilted(np.eye(3)["xyz".index(a)], misplacement, rng), profile, rate, site, rng) for a in axes]
    motion = (np.concatenate([m[0] for m in motions]), np.concatenate([m[1] for m in motions]))
    parts = {f"rate_{a}": (i * len(profile), (i + 1) * len(profile)) for i, a in enumerate(axes)}
    recipe = f"{steps}|{axes}|{seconds}|{rate}|{misplacement}|{site}|{recipe_of(celsius)}|{quantize}|{bandwidth}"
    logs = Bench(rate, motion, parts).record(
        Sensor(model, temperature(celsius), quantize, bandwidth), seed, recipe, progress
    )
    note = f"rate table, mounting misplaced by {np.degrees(misplacement):g}° rms, seed {seed}"
    return RateTable(logs, noted(model, note))


def _profile(steps: Sequence[float], seconds: float, rate: float) -> Floats:
    """Return the table's rate at each sample, rad/s: steps with straight ramps between them."""
    parts: list[Floats] = []
    for i, step in enumerate(steps):
        if i:
            before = steps[i - 1]
            count = max(round(abs(step - before) / ACCELERATION * rate), 1)
            parts.append(before + (step - before) * (np.arange(count) + 0.5) / count)
        parts.append(np.full(max(round(seconds * rate), 1), step))
    return np.concatenate(parts)


def _motion(up: Floats, profile: Floats, rate: float, site: Site, rng: np.random.Generator) -> tuple[Floats, Floats]:
    turned = profile[:, None] * up
    if site.latitude is not None:
        # In the table's axes, the horizontal part of the earth's rate turns in the opposite direction.
        angle = np.cumsum(profile) / rate + rng.uniform(0, 2 * np.pi)
        still, aside = site.earth_rate(up, 0.0), site.earth_rate(up, np.pi / 2)
        vertical = up * float(still @ up)
        turned = (
            turned
            + vertical
            + np.cos(angle)[:, None] * (still - vertical)
            - np.sin(angle)[:, None] * (aside - vertical)
        )
    return turned, np.broadcast_to(site.gravity * up, turned.shape)

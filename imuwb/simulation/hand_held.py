"""An IMU that lies on a table, and is then turned by hand and held still in many attitudes, in one log."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import signal
from scipy.spatial.transform import Rotation

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.log import Log
from imuwb.simulation.bench import Bench, Site, check_size, noted
from imuwb.simulation.sensor import Sensor
from imuwb.simulation.six_position import SITE, spread
from imuwb.simulation.thermal import Temperature, recipe_of, temperature
from imuwb.stochastic import ImuErrorModel

LOG = "hand_held"
FEWEST, MOST = 9, 100  #: positions
MOST_TREMOR = 0.1  #: rad
FINE = 4  #: steps of the motion in each sample
UNEQUAL = (0.85, 1.35)  #: shortest and longest hold, over the mean one
TURN = (1.5, 3.0)  #: s, shortest and longest motion
DETOUR = 0.6  #: rad, rms of each component of the turn that a motion makes in addition and takes back
PATH = 0.15  #: m, rms of each component of the way from one position to the next
LEVER = 0.1  #: m, from the point about which the hand sways to the sensor
SWAY, SHAKE = (0.1, 0.8), (6.0, 12.0)  #: Hz, bands of a hand's slow sway and of its physiological tremor
SHARE = 0.03  #: amplitude of the tremor over that of the sway


@dataclass(frozen=True, eq=False, slots=True)
class HandHeld:
    """The log, and the truth."""

    log: Log
    truth: ImuErrorModel
    ups: Floats  #: (P, 3) direction of up in each position, in the body's frame, without the sway of the hand


def hand_held(
    model: ImuErrorModel,
    seed: int,
    *,
    positions: int = 24,
    seconds: float = 4.0,
    table: float = 30.0,
    rate: float = 100.0,
    tremor: float = float(np.radians(0.1)),
    site: Site = SITE,
    celsius: float | Temperature | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> HandHeld:
    """Return one log: at rest on a table, then each position held by hand, with motions between them.

    The holds last 0.85 to 1.35 times ``seconds``, the motions 1.5 to 3 s, with headings and ways at random. A hand sways slowly
    (0.1 to 0.8 Hz) and trembles (6 to 12 Hz, 3 % of the sway); both turn the sensor and move it.

    Args:
        model: one sensor; its deterministic terms are the truth.
        seed: the same seed and settings give the same log.
        positions: 9 to 100, spread over all directions.
        seconds: s, mean duration of a hold.
        table: s at rest on the table, level, before the first motion.
        rate: Hz.
        tremor: rad, rms of the sway about each axis while the sensor is held; 0: as if each position were on a support.
        site: gravity, and the earth's rate.
        celsius: as in ``static``.
        quantize: as in ``static``.
        bandwidth: as in ``static``.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a setting out of its range.
    """
    if not FEWEST <= positions <= MOST:
        raise UsageError(f"{positions} positions are given; there must be {FEWEST} to {MOST}")
    if not 0 <= tremor <= MOST_TREMOR:
        raise UsageError(f"the tremor is {np.degrees(tremor):g}°; it must be 0 to {np.degrees(MOST_TREMOR):.1f}°")
    check_size(seconds, positions + 1, rate)
    check_size(table, 1, rate)
    rng = np.random.default_rng([seed, positions, FINE])
    ups = np.concatenate([[[0.0, 0.0, -1.0]], spread(positions)[rng.permutation(positions)]])
    attitudes = [attitude_of(up, heading) for up, heading in zip(ups, rng.uniform(0, 2 * np.pi, len(ups)), strict=True)]
    holds = np.concatenate([[table], seconds * rng.uniform(*UNEQUAL, positions)])
    turned, place = _path(attitudes, holds, rate * FINE, rng)
    turned, place = _swayed(turned, place, table, tremor, rate * FINE, rng)
    motion = _felt(turned, place, site, rate)
    recipe = f"{positions}|{seconds}|{table}|{rate}|{tremor}|{site}|{recipe_of(celsius)}|{quantize}|{bandwidth}"
    logs = Bench(rate, motion, {LOG: (0, len(motion[0]))}).record(
        Sensor(model, temperature(celsius), quantize, bandwidth), seed, recipe, progress
    )
    note = f"held by hand, gravity {site.gravity:.6f} m/s², sway {np.degrees(tremor):g}° rms, seed {seed}"
    return HandHeld(logs[LOG], noted(model, note), ups[1:])


def attitude_of(up: Floats, heading: float) -> Rotation:
    """Return the rotation from the body to a frame whose z axis points up, for the direction of up in the body."""
    first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    first /= np.linalg.norm(first)
    return Rotation.from_euler("z", heading) * Rotation.from_matrix(np.stack([first, np.cross(up, first), up]))


def _path(attitudes: list[Rotation], holds: Floats, rate: float, rng: np.random.Generator) -> tuple[Rotation, Floats]:
    """Return the attitude, (n + 1) rotations, and the place, (n + 1, 3) m, at the borders of n steps."""
    turns: list[Floats] = []
    places: list[Floats] = []
    here = np.zeros(3)
    for i, (attitude, hold) in enumerate(zip(attitudes, holds, strict=True)):
        if i:
            count = round(float(rng.uniform(*TURN)) * rate)
            share = np.arange(count)[:, None] / count
            smooth = share - np.sin(2 * np.pi * share) / (2 * np.pi)
            before = attitudes[i - 1]
            whole = (before.inv() * attitude).as_rotvec()
            detour = rng.normal(0, DETOUR, 3) * np.sin(np.pi * share) ** 2
            turns.append((before * Rotation.from_rotvec(smooth * whole) * Rotation.from_rotvec(detour)).as_quat())
            way = rng.normal(0, PATH, 3)
            places.append(here + smooth * way)
            here = here + way
        still = round(float(hold) * rate)
        turns.append(np.tile(attitude.as_quat(), (still, 1)))
        places.append(np.tile(here, (still, 1)))
    size = (sum(map(len, turns)) - 1) // FINE * FINE + 1
    return Rotation.from_quat(np.concatenate(turns)[:size]), np.concatenate(places)[:size]


def _swayed(
    turned: Rotation, place: Floats, table: float, tremor: float, rate: float, rng: np.random.Generator
) -> tuple[Rotation, Floats]:
    """Return attitude and place with the sway and the tremor of a hand, which begin after the table."""
    if not tremor:
        return turned, place
    angle, shift = (_noise(len(place), rate, rng) for _ in range(2))
    begun = np.clip((np.arange(len(place)) / rate - table) / TURN[0], 0, 1)[:, None]
    held = tremor * begun**3 * (10 - 15 * begun + 6 * begun**2)
    return turned * Rotation.from_rotvec(held * angle), place + LEVER * held * shift


def _noise(count: int, rate: float, rng: np.random.Generator) -> Floats:
    """Return the sway, (count, 3) of rms 1, with the tremor on it."""
    parts: list[Floats] = []
    for band in (SWAY, SHAKE):
        sections = signal.butter(2, band, "bandpass", fs=rate, output="sos")
        part = signal.sosfiltfilt(sections, rng.standard_normal((count, 3)), axis=0)
        parts.append(np.asarray(part / part.std(axis=0), dtype=np.float64))
    return parts[0] + SHARE * parts[1]


def _felt(turned: Rotation, place: Floats, site: Site, rate: float) -> tuple[Floats, Floats]:
    """Return angular rate and specific force, (n, 3) each, averaged over the samples' intervals."""
    fine = rate * FINE
    step = (turned[:-1].inv() * turned[1:]).as_rotvec()
    middle = (turned[:-1] * Rotation.from_rotvec(step / 2)).inv()
    speed = np.gradient(place, 1 / fine, axis=0)
    force = middle.apply(np.diff(speed, axis=0) * fine + [0, 0, site.gravity])
    spin = step * fine
    if site.latitude is not None:
        spin = spin + middle.apply(EARTH_RATE * np.array([np.cos(site.latitude), 0.0, np.sin(site.latitude)]))
    return spin.reshape(-1, FINE, 3).mean(axis=1), force.reshape(-1, FINE, 3).mean(axis=1)

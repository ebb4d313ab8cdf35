"""An IMU in positions at rest: on the six faces of a cube, or in many directions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.simulation.bench import Bench, Site, check_misplacement, check_size, noted
from imuwb.simulation.sensor import Sensor
from imuwb.simulation.thermal import Temperature, recipe_of, temperature
from imuwb.stochastic import ImuErrorModel

FACES = ("up_x", "down_x", "up_y", "down_y", "up_z", "down_z")
FEWEST, MOST = 9, 100  #: positions spread over all directions
TURN = 3.0  #: s from one position to the next
SITE = Site()


@dataclass(frozen=True, eq=False, slots=True)
class Positions:
    """Logs of positions, and the truth."""

    logs: dict[str, Log]
    truth: ImuErrorModel
    attitudes: Floats  #: (P, 2) roll and pitch, rad, as intended
    names: tuple[str, ...]  #: name of each position


def six_position(
    model: ImuErrorModel,
    seed: int,
    *,
    positions: int = 6,
    seconds: float = 600.0,
    rate: float = 100.0,
    misplacement: float = 0.0,
    one_log: bool = False,
    site: Site = SITE,
    celsius: float | Temperature | None = None,
    quantize: bool = False,
    bandwidth: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Positions:
    """Return a log of each position, or one log of all positions with turns between them.

    Args:
        model: one sensor; its deterministic terms are the truth.
        seed: the same seed and settings give the same logs.
        positions: 6: the faces of a cube; 9 to 100: spread over all directions.
        seconds: s in each position.
        rate: Hz.
        misplacement: rad, rms of each of two tilts of a position.
        one_log: all positions in one log.
        site: gravity, and the earth's rate; headings are random.
        celsius: as in ``static``.
        quantize: as in ``static``.
        bandwidth: as in ``static``.
        progress: called with (axes done, axes).

    Raises:
        UsageError: a setting out of its range.
    """
    if positions != len(FACES) and not FEWEST <= positions <= MOST:
        raise UsageError(
            f"{positions} positions are given; there must be 6 (the faces of a cube), or {FEWEST} to {MOST} (spread over all directions)"
        )
    check_misplacement(misplacement)
    check_size(seconds, positions, rate)
    still, turn = round(seconds * rate), round(TURN * rate)
    names = FACES if positions == len(FACES) else tuple(f"position_{i + 1:02d}" for i in range(positions))
    rng = np.random.default_rng([seed, positions])
    wanted = np.kron(np.eye(3), [[1.0], [-1.0]]) if positions == len(FACES) else spread(positions)
    ups = np.stack([tilted(up, misplacement, rng) for up in wanted])
    headings = rng.uniform(0, 2 * np.pi, positions)
    motion, rows = _motion(ups, headings, site, still, turn, rate)
    parts = {"positions": (0, len(motion[0]))} if one_log else dict(zip(names, rows, strict=True))
    recipe = f"{positions}|{seconds}|{rate}|{misplacement}|{one_log}|{site}|{recipe_of(celsius)}|{quantize}|{bandwidth}"
    logs = Bench(rate, motion, parts).record(
        Sensor(model, temperature(celsius), quantize, bandwidth), seed, recipe, progress
    )
    note = f"gravity {site.gravity:.6f} m/s², positions misplaced by {np.degrees(misplacement):g}° rms, seed {seed}"
    attitudes = np.stack([np.arctan2(-wanted[:, 1], -wanted[:, 2]), np.arcsin(wanted[:, 0].clip(-1, 1))], axis=1)
    return Positions(logs, noted(model, note), attitudes, names)


def spread(count: int) -> Floats:
    """Return directions spread evenly over a sphere, (count, 3), by the golden angle."""
    height = 1 - (2 * np.arange(count) + 1) / count
    angle = np.pi * (3 - 5**0.5) * np.arange(count)
    across = np.sqrt(1 - height**2)
    return np.stack([across * np.cos(angle), across * np.sin(angle), height], axis=1)


def tilted(up: Floats, misplacement: float, rng: np.random.Generator) -> Floats:
    """Return a direction tilted by two normal angles about axes at right angles to it."""
    tilt = rng.normal(0.0, 1.0, 3) * misplacement
    return Rotation.from_rotvec(tilt - up * (tilt @ up)).apply(up)


def _motion(
    ups: Floats, headings: Floats, site: Site, still: int, turn: int, rate: float
) -> tuple[tuple[Floats, Floats], list[tuple[int, int]]]:
    """Return angular rate and specific force of all samples, and the rows (first, end) of each position."""
    rates: list[Floats] = []
    forces: list[Floats] = []
    rows: list[tuple[int, int]] = []
    at = 0
    for i, (up, heading) in enumerate(zip(ups, headings, strict=True)):
        if i:
            turned, ways = _turn(ups[i - 1], up, turn, rate)
            rates.append(turned)
            forces.append(site.gravity * ways)
            at += turn
        rates.append(np.broadcast_to(site.earth_rate(up, heading), (still, 3)))
        forces.append(np.broadcast_to(site.gravity * up, (still, 3)))
        rows.append((at, at + still))
        at += still
    return (np.concatenate(rates), np.concatenate(forces)), rows


def _turn(before: Floats, after: Floats, count: int, rate: float) -> tuple[Floats, Floats]:
    """Return the body's rate and the direction up in it, (count, 3) each, over a turn that begins and ends at rest."""
    axis = np.cross(after, before)  # in the body's frame, the direction up turns in the opposite direction
    if np.linalg.norm(axis) < 1e-3:  # noqa: PLR2004 - upside down, or nearly: any axis at right angles is right
        axis = np.cross(before, np.eye(3)[int(np.argmin(np.abs(before)))])
    axis = axis / np.linalg.norm(axis)
    angle = float(np.arctan2(np.linalg.norm(np.cross(before, after)), before @ after))
    share = (np.arange(count) + 0.5) / count
    speed = angle * np.pi / 2 * np.sin(np.pi * share) / (count / rate)
    turned = angle * (1 - np.cos(np.pi * share)) / 2
    up = np.asarray(Rotation.from_rotvec(-turned[:, None] * axis).apply(before), dtype=np.float64)
    return np.asarray(speed[:, None] * axis, dtype=np.float64), up

"""Routes: two after Quinchia's drives in Turin, with outages of the published lengths and speeds, and mixed ones."""

import math
from dataclasses import dataclass
from itertools import cycle

import numpy as np

from imuwb.errors import UsageError
from imuwb.simulation.legs import COUNTRY, HIGHWAY, KMH, TOWN, Leg, Pin, between, wander
from imuwb.simulation.profile import profile
from imuwb.simulation.route import Route

STANDING = 62.0  #: s, before the car moves
FAST = 25.0  #: m/s; if two outages in sequence are both faster, a highway lies between them
TURN_SLOWS = 0.75  #: ratio of the speed in an outage's turn to the outage's mean speed
CURVE = 12.0  #: s of a slight curve
SHORTEST, LONGEST = 90.0, 86_400.0  #: s
LONGEST_ZONE = 300.0  #: s


@dataclass(frozen=True, slots=True)
class PlannedOutage:
    """An outage from a table of Quinchia et al. (2013)."""

    table: int
    number: int
    start: float  #: s from the log's start; not in the paper, chosen here
    duration: float  #: s
    speed: float  #: m/s, mean


@dataclass(frozen=True, slots=True)
class _Plan:
    duration: float  #: s
    outages: tuple[PlannedOutage, ...]  #: in the order of time


def _outage(table: int, number: int, start: float, duration: float, kmh: float) -> PlannedOutage:
    return PlannedOutage(table, number, start, duration, kmh * KMH)


PLANS = {
    "turin-1": _Plan(
        17.3 * 60,
        (
            _outage(9, 1, 200, 30, 23.58), _outage(6, 1, 310, 30, 25.16), _outage(9, 2, 430, 60, 42.31),
            _outage(6, 2, 590, 30, 18.86), _outage(9, 3, 720, 30, 47.60), _outage(6, 3, 850, 30, 42.53),
        ),
    ),
    "turin-2": _Plan(
        15.05 * 60,
        (
            _outage(10, 4, 185, 30, 33.60), _outage(6, 4, 262, 30, 23.56), _outage(10, 5, 340, 30, 52.25),
            _outage(6, 5, 417, 30, 39.32), _outage(10, 6, 492, 30, 20.44), _outage(6, 6, 592, 60, 103.36),
            _outage(6, 7, 690, 60, 122.73), _outage(10, 7, 790, 60, 112.42),
        ),
    ),
}  # fmt: skip
#: (table, number) -> angle of the turn that the paper mentions, rad
TURNS = {(9, 1): math.radians(90), (10, 5): math.radians(90)}
CURVES_AT_THE_END = {(10, 7): math.radians(12)}


def planned_outages(preset: str) -> tuple[PlannedOutage, ...]:
    """Return the outages of a preset route, in the order of time; they are the same for every route seed.

    Raises:
        UsageError: no such preset; the message lists all.
    """
    return _plan(preset).outages


def planned_route(preset: str, route_seed: int = 0) -> Route:
    """Return a preset route: ``turin-1`` (17.3 min, town) or ``turin-2`` (15.05 min, town and highway).

    Args:
        preset: its name.
        route_seed: seed of the turns, stops and speeds between the outages, and of the road.

    Raises:
        UsageError: no such preset.
    """
    plan, rng = _plan(preset), np.random.default_rng(route_seed)
    legs, now, speed = [Leg(STANDING, 0.0)], STANDING, 0.0
    for outage in plan.outages:
        zone = HIGHWAY if min(speed, outage.speed) > FAST else TOWN
        legs += [*between(zone, outage.start - now, speed, outage.speed, rng), *_driven(outage, rng)]
        now, speed = outage.start + outage.duration, outage.speed
    legs += between(TOWN, plan.duration - now, speed, 0.0, rng)
    pins = [Pin(o.start, o.duration, o.speed) for o in plan.outages]
    return Route(preset, plan.duration, profile(legs, pins, rng))


def mixed_route(duration: float, route_seed: int = 0) -> Route:
    """Return a route through towns and over country roads and highways.

    Args:
        duration: s, 90 to 86400; from 10 minutes on the route has all kinds of roads.
        route_seed: seed of the route.

    Raises:
        UsageError: a duration out of its range.
    """
    if not SHORTEST <= duration <= LONGEST:
        raise UsageError(
            f"the duration of the drive is {duration} s; it must be {SHORTEST:g} to {LONGEST:g} s ({STANDING:g} s of them standing)"
        )
    rng = np.random.default_rng(route_seed)
    legs, left = [Leg(STANDING, 0.0)], duration - STANDING
    longest = min(LONGEST_ZONE, left / 4)
    for zone in cycle((TOWN, COUNTRY, HIGHWAY, COUNTRY)):
        if left <= 0:
            break
        part = min(left, longest * rng.uniform(0.7, 1.3))
        legs += wander(zone, part, rng)
        left -= part
    return Route("mixed", duration, profile(legs, (), rng))


def _plan(preset: str) -> _Plan:
    if preset not in PLANS:
        raise UsageError(f"there is no route {preset!r}; there are: {', '.join(PLANS)}")
    return PLANS[preset]


def _driven(outage: PlannedOutage, rng: np.random.Generator) -> list[Leg]:
    """Return the legs of an outage: straight on, except for a turn that the paper mentions."""
    side, key = rng.choice([-1.0, 1.0]), (outage.table, outage.number)
    if key in TURNS:
        turn = TOWN.corner(side * TURNS[key], TURN_SLOWS * outage.speed)
        half = Leg((outage.duration - turn.duration) / 2, outage.speed)
        return [half, turn, half]
    if key in CURVES_AT_THE_END:
        curve = Leg(CURVE, outage.speed, side * CURVES_AT_THE_END[key])
        return [Leg(outage.duration - CURVE, outage.speed), curve]
    return [Leg(outage.duration, outage.speed)]

"""The legs of a drive, drawn at random as people drive in a town, on a country road or on a highway."""

import math
from dataclasses import dataclass

import numpy as np

KMH = 1 / 3.6  #: m/s
SHORTEST_TURN = 4.0  #: s
SPEEDING_UP, SLOWING_DOWN = 1.4, 1.8  #: m/s², largest
SETTLING = 8.0  #: s of driving on after a stop or a turn


@dataclass(frozen=True, slots=True)
class Leg:
    """A span at one speed; a turn is spread evenly over it."""

    duration: float  #: s
    speed: float  #: m/s, wanted; reached as far as braking and speeding up allow
    turn: float = 0.0  #: rad, to the right


@dataclass(frozen=True, slots=True)
class Pin:
    """The mean speed that a span must have."""

    start: float  #: s
    duration: float  #: s
    speed: float  #: m/s


@dataclass(frozen=True, slots=True)
class Zone:
    """How people drive on a kind of road; each pair is (least, most) of a uniform distribution."""

    speed: tuple[float, float]  #: m/s
    going_on: tuple[float, float]  #: s between two events
    turn: tuple[float, float]  #: rad, to either side
    turning: float  #: m/s in a turn
    lateral: float  #: m/s² in a turn
    stops: float  #: share of the events that are stops; the others are turns
    stop: tuple[float, float]  #: s

    @property
    def slowest(self) -> float:
        """Return the lowest speed of the zone, m/s."""
        return 0.0 if self.stops else min(self.turning, self.speed[0])

    def corner(self, angle: float, speed: float) -> Leg:
        """Return a turn with the lateral acceleration of the zone, or with less in a short turn."""
        return Leg(max(SHORTEST_TURN, abs(angle) * speed / self.lateral), speed, angle)


TOWN = Zone((28 * KMH, 50 * KMH), (10, 25), (math.radians(75), math.radians(105)), 22 * KMH, 2.2, 0.4, (6, 20))
COUNTRY = Zone((60 * KMH, 90 * KMH), (15, 40), (math.radians(15), math.radians(60)), 60 * KMH, 1.8, 0.1, (5, 12))
HIGHWAY = Zone((105 * KMH, 126 * KMH), (20, 60), (math.radians(4), math.radians(20)), 105 * KMH, 1.2, 0.0, (0, 0))


def wander(zone: Zone, duration: float, rng: np.random.Generator) -> list[Leg]:
    """Return legs of a zone that last ``duration`` s: driving on, with stops and turns between."""
    legs: list[Leg] = []
    left = duration
    while left > 0:
        legs.append(Leg(min(left, rng.uniform(*zone.going_on)), rng.uniform(*zone.speed)))
        left -= legs[-1].duration
        side = rng.choice([-1.0, 1.0])
        if rng.random() < zone.stops:
            event = Leg(rng.uniform(*zone.stop), 0.0)
        else:
            event = zone.corner(side * rng.uniform(*zone.turn), zone.turning)
        if event.duration + SETTLING < left:
            legs.append(event)
            left -= event.duration
    return legs


def between(zone: Zone, duration: float, before: float, after: float, rng: np.random.Generator) -> list[Leg]:
    """Return legs that last ``duration`` s, from the speed before them to the speed after them (m/s)."""
    leaving = Leg(max(0.0, before - zone.slowest) / SLOWING_DOWN + 2, before)
    meeting = Leg(max(0.0, after - zone.slowest) / SPEEDING_UP + 4, after)
    return [leaving, *wander(zone, duration - leaving.duration - meeting.duration, rng), meeting]

"""Count the false findings of the judgement of a fleet, and measure its power and the coverage of its intervals.

A fleet has sensors of one type, each with several logs a month apart. The logarithm of a coefficient varies between sensors, and from
log to log of a sensor. A log estimates the square of the coefficient, with an error that is a chi-square variable over its degrees of
freedom; interval and value are those that an estimator states. Three axes have a white noise N, whose logs have many degrees of
freedom, and a bias instability B, whose logs have few: six families. Fleets are judged at 1 %, over all families, sensors and kinds
of findings together.

Command: ``nice python tests/studies/fleet_judgement.py`` (1,000 fleets of each of the first two kinds and of the small ones, 200 of each of the others: about 10 minutes).
Seeds: fleet r of case k uses ``default_rng([k, r])``.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrices are small: threads would slow each other down

from dataclasses import dataclass

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification.family import judge, observations
from imuwb.statistics.distributions import chi_square_limits

QUESTION = "False findings, power and coverage of the judgement of a fleet"
LEVEL, ERROR = 0.95, 0.01
MONTH = 30 * 86400.0
BLOCK = 25  #: fleets of one job
POWER, COVERAGE = 100, 400  #: fleets


@dataclass(frozen=True)
class Fleet:
    """The sizes of a fleet; standard deviations are of the natural logarithm."""

    sensors: int = 120
    logs: tuple[int, int] = (5, 5)  #: fewest and most of a sensor
    between: float = 0.05
    within: float = 0.005
    freedom: tuple[float, float] = (5000.0, 8.0)  #: of N and of B
    temperature: float = 0.0  #: per °C
    heavy: bool = False  #: Student variables with 5 degrees of freedom between sensors in place of normal ones


CASES = {
    "120 sensors of 5 logs": Fleet(),
    "120 sensors of 1 to 20 logs": Fleet(logs=(1, 20)),
    "30 sensors of 5 logs": Fleet(30),
    "12 sensors of 5 logs": Fleet(12),
    "6 sensors of 3 logs": Fleet(6, (3, 3)),
    "120 sensors of 1 log": Fleet(logs=(1, 1)),
    "120 sensors, none differ": Fleet(between=0.0, within=0.0),
    "120 sensors, 0.5 % per °C": Fleet(temperature=0.005),
    "120 sensors, spread with heavy tails": Fleet(heavy=True),
    "5 sensors of 3 logs": Fleet(5, (3, 3)),
    "8 sensors of 1 log": Fleet(8, (1, 1)),
    "11 sensors of 3 logs": Fleet(11, (3, 3)),
    "16 sensors of 3 logs, B of 100 degrees of freedom": Fleet(16, (3, 3), freedom=(5000.0, 100.0)),
    "24 sensors of 3 logs": Fleet(24, (3, 3)),
}
MAIN, UNEVEN = list(CASES)[:2]
SMALL = 30  #: sensors, up to which a fleet costs so little that as many of them are judged as of the first two kinds


def families(fleet, rng, planted=None):
    """Return six families; ``planted``: (name, sensor, months) -> what is added to the logarithm."""
    count = rng.integers(fleet.logs[0], fleet.logs[1] + 1, fleet.sensors)
    sensor = np.repeat(np.arange(fleet.sensors), count)
    place = np.concatenate([np.arange(n) for n in count])
    months = place + rng.uniform(0, 0.2, sensor.size)
    temperature = rng.normal(25, 6, sensor.size)
    found = {}
    for axis in ("gyro_x", "gyro_y", "gyro_z"):
        for letter, nu in zip("NB", fleet.freedom, strict=True):
            drawn = (
                rng.standard_t(5, fleet.sensors) / np.sqrt(5 / 3) if fleet.heavy else rng.standard_normal(fleet.sensors)
            )
            y = fleet.between * drawn[sensor] + fleet.within * rng.standard_normal(sensor.size)
            y += fleet.temperature * (temperature - 25)
            if planted is not None:
                y += planted(f"{axis} {letter}", sensor, months)
            value = np.exp(y) * np.sqrt(rng.chisquare(nu, sensor.size) / nu)
            low, high = (np.sqrt(factor) for factor in chi_square_limits(LEVEL, nu))
            found[f"{axis} {letter}"] = observations(
                sensor, value, value * low, value * high, level=LEVEL, time=months * MONTH, temperature=temperature
            )
    return found


def false_findings(case, first, last):
    """Return the numbers of fleets, of fleets with a finding, with a sensor outside, with a change, with a temperature that counts; with any finding in N, and in B."""
    counts = np.zeros(7, dtype=int)
    for seed in range(first, last):
        found = judge(families(CASES[case], np.random.default_rng([list(CASES).index(case), seed])), ERROR, LEVEL)
        out, changed, sloped = (
            {name for name, one in found.families.items() if has(one)}
            for has in (lambda one: one.outside, lambda one: one.changes, lambda one: one.slope and one.slope.used)
        )
        false = out | changed | (sloped if not CASES[case].temperature else set())
        letters = {name[-1] for name in false}
        counts += tuple(map(bool, (True, false, out, changed, sloped, "N" in letters, "B" in letters)))
    return counts


DRIFTING, OUT = 7, {23: 0.35, 61: -0.35, 99: 0.45}
PLANTS = {
    "one sensor with N drifting by 8 %, three out of family": (DRIFTING, "trend"),
    "one sensor with a step of 8 % of N, three out of family": (DRIFTING, "step"),
    "one log with N 10 % larger, three out of family": (DRIFTING, "log"),
}


def plant(kind):
    """Return what is added to N of all gyros."""

    def added(name, sensor, months):
        if not name.startswith("gyro") or not name.endswith("N"):
            return 0.0
        out = sum(size * (sensor == number) for number, size in OUT.items())
        share = {
            "trend": 0.08 * months / 4,
            "step": 0.08 * (months > 1.5),
            "log": 0.10 * ((months > 1.5) & (months < 2.5)),
        }
        return out + share[kind] * (sensor == DRIFTING)

    return added


def finds(name, first, last):
    """Return the numbers of fleets, with the change found, with its kind right, with all three outside, with any other sensor found."""
    _, kind = PLANTS[name]
    counts = np.zeros(5, dtype=int)
    for seed in range(first, last):
        rng = np.random.default_rng([50 + list(PLANTS).index(name), seed])
        found = judge(families(CASES[MAIN], rng, plant(kind)), ERROR, LEVEL).families.values()
        changes = [change for one in found for change in one.changes]
        out = {one.sensor for family in found for one in family.outside}
        own = [change.kind for change in changes if change.sensor == DRIFTING]
        others = out | {change.sensor for change in changes}
        counts += (1, bool(own), kind in own, set(OUT) <= out, bool(others - {DRIFTING, *OUT}))
    return counts


SIZES, FACTORS = (5, 6, 8, 10, 12, 16, 24), (1.3, 1.5, 2.0, 3.0)


def finds_in_small(count, factor, first, last):
    """Return the numbers of fleets, of those where the one sensor with another N on one axis is found, and of those with any other finding."""
    counts, name = np.zeros(3, dtype=int), "gyro_x N"
    for seed in range(first, last):
        rng = np.random.default_rng([200, count, round(10 * factor), seed])

        def added(of, sensor, months):
            return np.log(factor) * (sensor == 2) * (of == name)

        judged = judge(families(Fleet(count, (3, 3)), rng, added), ERROR, LEVEL).families
        found = {(of, sensor) for of, one in judged.items() for sensor in one.found}
        counts += (1, (name, 2) in found, bool(found - {(name, 2)}))
    return counts


def small_families(records, workers):
    """Return the table of one sensor outside a small family."""
    rows = []
    for size in SIZES:
        each = []
        for factor in FACTORS:
            jobs = [(size, factor, a, b) for _, a, b in _jobs("", min(POWER, records))]
            each.append(sum(over_records(finds_in_small, jobs, workers)))
        count, _, others = sum(each)
        rows.append(
            (size, *(Share(int(n), int(of)).text(0) for of, n, _ in each), Share(int(others), int(count)).text(1))
        )
    return Table(
        "One sensor outside a small family",
        ("sensors of 3 logs", *(f"its N is {factor:g} times the others'" for factor in FACTORS), "any other finding"),
        tuple(rows),
        "Fleets in which it is found, on the one axis on which it differs; the spread between sensors is 5 %.",
    )


QUANTITIES = ("mean", "between sensors", "from log to log", "a further sensor", "a further log")


def covered(case, first, last):
    """Return counts (2, letters, quantities): of intervals, and of those that contain the truth."""
    fleet, counts = CASES[case], np.zeros((2, 2, len(QUANTITIES)), dtype=int)
    for seed in range(first, last):
        rng = np.random.default_rng([90 + list(CASES).index(case), seed])
        for name, one in judge(families(fleet, rng), ERROR, LEVEL).families.items():
            sensor = fleet.between * rng.standard_normal()
            nu = fleet.freedom["NB".index(name[-1])]
            log = sensor + fleet.within * rng.standard_normal() + np.log(rng.chisquare(nu) / nu) / 2
            inside = (
                0.0 in one.mean, _in(one.between, fleet.between), _in(one.within, fleet.within), sensor in one.sensor_range,
                log in one.log_range,
            )  # fmt: skip
            counts[0, "NB".index(name[-1])] += 1
            counts[1, "NB".index(name[-1])] += inside
    return counts


def _in(spread, truth):
    return (spread.lower or 0.0) <= truth <= spread.upper


def _jobs(name, records):
    return [(name, a, min(a + BLOCK, records)) for a in range(0, records, BLOCK)]


def study(records=1000, workers=1):
    """Return the tables."""
    rows = []
    for case, fleet in CASES.items():
        many = case in (MAIN, UNEVEN) or fleet.sensors <= SMALL
        fleets = records if many else max(records // 5, 20)
        count, any_of, *apart = sum(over_records(false_findings, _jobs(case, fleets), workers))
        share = Share(int(any_of), int(count))
        rows.append((
            case, int(count), share.text(2), *(Share(int(n), int(count)).text(2) for n in apart),
            verdict(share.interval[0] <= ERROR),
        ))  # fmt: skip
    false = Table(
        "Fleets with any false finding at 1 %",
        (
            "fleet",
            "fleets",
            "any finding",
            "a sensor outside",
            "a change",
            "temperature counts",
            "any in N",
            "any in B",
            "goal: not above 1 %",
        ),
        tuple(rows),
        "Share and its 95 % interval. The goal is reached where the interval reaches down to 1 %. Temperature is no false finding where "
        "the fleet depends on it. Heavy tails are against the assumption: there, sensors are far from the family in truth.",
    )
    rows = []
    for name in PLANTS:
        count, *found = sum(over_records(finds, _jobs(name, min(POWER, records)), workers))
        rows.append((name, int(count), *(Share(int(n), int(count)).text(1) for n in found)))
    power = Table(
        "Planted sensors",
        ("planted in the gyros of 120 sensors of 5 logs", "fleets", "change found", "its kind right", "all three outside", "any other sensor found"),
        tuple(rows),
        "The three sensors have N changed by +42, -30 and +57 %; the spread between sensors is 5 %, a log estimates N to 1 %.",
    )  # fmt: skip
    rows = []
    for case in list(CASES)[:5]:
        of, inside = sum(over_records(covered, _jobs(case, max(min(COVERAGE, records) // 4, 5)), workers))
        for place, letter in enumerate("NB"):
            rows.append(
                (case, letter, *(Share(int(a), int(b)).text(1) for a, b in zip(inside[place], of[place], strict=True)))
            )
    coverage = Table("95 % intervals that contain the truth", ("fleet", "coefficient", *QUANTITIES), tuple(rows))
    return false, power, small_families(records, workers), coverage


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 1000,
        lambda n: f"seeds 0..{n - 1} of the first two fleets and of those of {SMALL} sensors or fewer, a fifth as many of the others, six families each",
    )  # fmt: skip

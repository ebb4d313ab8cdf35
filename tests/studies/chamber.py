"""A climate chamber of El-Diasty's two units: does the interval of N hold the truth, and what is AR(1) behind a filter?

The presets ``motionpakii`` and ``ahrs300cc`` (table 1 at its four temperatures, linear between, the y axis's values on all
axes), -30 to 60 °C in steps of 10, 3 h at 100 Hz each, by ``identify`` and ``over_temperature``. Wanted: N inside its 95 % interval in
93 to 97 % of all axes, temperatures and seeds.

AR(1) behind Kaiser low-passes of 8, 16 and 24 Hz, of the y axes of seed 0, beside tables 2 to 5: the presets are white,
so that theirs follows from the filter alone (table 2's own coefficients are put through the same filters in
``filtered_ar1.py``). The paper's figures are read from ``../shared/papers/tables.toml`` where there is such a file.

Command: ``python tests/studies/chamber.py`` (5 seeds: about 4 minutes in one process).
Seeds: the log of preset p at temperature k, seed s, has all six axes of ``SeedSequence([p, k, s])``.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb.conditioning import design_kaiser, filtered
from imuwb.identification.temperature import Record, first_order, identify, over_temperature
from imuwb.log import AXES
from imuwb.simulation import preset
from imuwb.units import coefficient_units

QUESTION = "A chamber of two published units: N by temperature, and AR(1) by temperature and cut-off"
PRESETS = ("motionpakii", "ahrs300cc")
CELSIUS = tuple(range(-30, 61, 10))
TABULATED = (-30, 0, 30, 60)
RATE, HOURS, CUTOFFS = 100.0, 3.0, (None, 8.0, 16.0, 24.0)
LOW, HIGH = 0.93, 0.97
PAPER = Path(__file__).parents[2] / ".." / "shared" / "papers" / "tables.toml"
NAMES = {"motionpakii": "MotionPakII", "ahrs300cc": "AHRS300CC"}


@cache
def taps(cutoff):
    """Return the filter of a cutoff in Hz, 4 Hz from pass to stop band."""
    return design_kaiser(RATE, cutoff - 2.0, cutoff + 2.0, 100.0).taps


def samples(unit, place, seed, hours):
    """Return {axis: samples} of one log."""
    model = preset(PRESETS[unit])
    streams = np.random.SeedSequence([unit, place, seed]).spawn(len(AXES))
    n = round(hours * 3600 * RATE)
    return {
        axis: model.axes[axis].at(CELSIUS[place]).sample(n, 1 / RATE, np.random.default_rng(stream))
        for axis, stream in zip(AXES, streams, strict=True)
    }


def record(unit, seed, hours):
    """Return, of one unit's chamber, {axis: ((truth, N, lower, upper) at each temperature, whether it depends)} and AR(1)s."""
    points = {axis: [] for axis in AXES}
    first = {}
    for place, t in enumerate(CELSIUS):
        for axis, x in samples(unit, place, seed, hours).items():
            points[axis].append(identify([Record(x, place * hours * 3600, float(t), log=place)], 1 / RATE))
            if axis.endswith("_y") and t in TABULATED and not seed:
                for cutoff in CUTOFFS:
                    series = x if cutoff is None else filtered(x, taps(cutoff))
                    f = first_order([Record(series, 0.0, float(t))], 1 / RATE)
                    first[axis, t, cutoff] = (f.alpha, f.sigma, f.sigma_if_ar)
    found = {}
    for axis, some in points.items():
        over = over_temperature(some)
        rows = []
        for t, p in zip(CELSIUS, over.points, strict=True):
            n = p.coefficients["N"]
            rows.append((preset(PRESETS[unit]).axes[axis].at(t).terms[0].N, n.value or 0.0, n.lower or 0.0, n.upper))
        found[axis] = rows, bool(over.dependence["N"].depends), over.laws["N"].function.kind
    return found, first


def study(seeds=5, hours=HOURS, workers=1):
    """Return the tables: a summary, N by temperature, AR(1) without filter and behind each."""
    jobs = [(unit, seed, hours) for unit in range(len(PRESETS)) for seed in range(seeds)]
    done = dict(zip(jobs, over_records(record, jobs, workers), strict=True))
    cells = [
        (job[0], axis, row) for job, (found, _) in done.items() for axis, (rows, *_) in found.items() for row in rows
    ]
    first = {unit: done[unit, 0, hours][1] for unit in range(len(PRESETS))}
    return (
        _summary(cells, done),
        *(_white(done, unit, seeds, hours) for unit in range(len(PRESETS))),
        *(_ar1(first, cutoff) for cutoff in CUTOFFS),
    )


def inside(cells):
    """Return how many intervals hold the truth."""
    return Share(sum(lower <= true <= upper for *_, (true, _, lower, upper) in cells), len(cells))


def _summary(cells, done):
    both = inside(cells)
    rows = [("N inside its 95 % interval, all", "93 to 97 %", both, verdict(LOW <= both.value <= HIGH))]
    for unit, name in enumerate(PRESETS):
        for sensor, what in (("gyro", "angular random walk"), ("accel", "velocity random walk")):
            some = [c for c in cells if c[0] == unit and c[1].startswith(sensor)]
            rows.append((f"{name}, {what}", "–", inside(some), "–"))
    error = np.array([n / true - 1 for *_, (true, n, _, _) in cells])
    rows.append(("rms error of N, %", "–", f"{100 * np.sqrt(np.mean(error**2)):.4f}", "–"))
    bound = 100 / (2 * HOURS * 3600 * RATE) ** 0.5
    rows.append(("its bound were nothing else unknown, for 3 h, %", "–", f"{bound:.4f}", "–"))
    told = [depends for found, _ in done.values() for _, depends, _ in found.values()]
    rows.append(("N found to depend on temperature", "all", Share(sum(told), len(told)), "–"))
    return Table("What was wanted", ("figure", "wanted", "reached", "verdict"), tuple(rows))


def _white(done, unit, seeds, hours):
    rows = []
    for place, t in enumerate(CELSIUS):
        cells = [f"{t}"]
        for axis in ("gyro_y", "accel_y"):
            display = coefficient_units(axis, "N")[1]
            true, value, lower, upper = done[unit, 0, hours][0][axis][0][place]
            sensor = axis.partition("_")[0]
            some = [
                (unit, a, done[unit, seed, hours][0][a][0][place])
                for seed in range(seeds)
                for a in AXES
                if a.startswith(sensor)
            ]
            cells += [f"{display.from_si(true):.4f}"]
            cells += [
                f"{display.from_si(value):.4f} [{display.from_si(lower):.4f}, {display.from_si(upper):.4f}]",
                str(inside(some)),
            ]
        rows.append(tuple(cells))
    headings = (
        "°C",
        "ARW, true, deg/√h",
        "y axis, seed 0",
        "held, 3 axes",
        "VRW, true, m/s/√h",
        "y axis, seed 0",
        "held, 3 axes",
    )
    return Table(f"{NAMES[PRESETS[unit]]} (table 1 at -30, 0, 30 and 60 °C)", headings, tuple(rows))


@cache
def printed():
    """Return the paper's coefficients; nothing where they are not there."""
    return tomllib.loads(PAPER.read_text("utf-8"))["eldiasty"]["ar1"] if PAPER.exists() else {}


def _ar1(first, cutoff):
    rows = []
    for unit, name in enumerate(PRESETS):
        for axis, short in (("gyro_y", "gyro"), ("accel_y", "acc")):
            for place, t in enumerate(TABULATED):
                alpha, sigma, ideal = first[unit][axis, t, cutoff]
                paper = (
                    printed().get(f"{NAMES[name]}_{short}", {}).get("none" if cutoff is None else f"fc{cutoff:g}", [])
                )
                told = (f"{paper[place]:.4f}",) if paper else ()
                rows.append((NAMES[name], axis, t, f"{alpha:.5f} ± {sigma:.1g}", f"{ideal:.1g}", *told))
    number = {None: 2, 8.0: 3, 16.0: 4, 24.0: 5}[cutoff]
    title = "AR(1) without a filter" if cutoff is None else f"AR(1) behind a low-pass of {cutoff:g} Hz"
    note = "x(n) = -alpha x(n-1) + beta0 w(n). ± Bartlett's standard error."
    headings = (
        "unit",
        "axis",
        "°C",
        "alpha of the white preset",
        "error were it an AR(1)",
        *(("paper",) if printed() else ()),
    )
    return Table(f"{title} (table {number})", headings, tuple(rows), note)


if __name__ == "__main__":
    main(
        __file__,
        QUESTION,
        study,
        5,
        lambda n: f"seeds (p, k, 0..{n - 1}) for presets p = 0, 1 and temperatures k = 0..9",
    )

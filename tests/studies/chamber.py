"""Test the coverage of N in a climate chamber, and fit AR(1) after low-pass filters, for El-Diasty's two units.

The presets ``motionpakii`` and ``ahrs300cc`` hold table 1 at its four temperatures, interpolate linearly between them, and
have the y axis's values on all axes. The chamber goes from -30 to 60 °C in steps of 10 °C, with 3 h at 100 Hz at each step;
``set_point_of`` and ``over_temperature`` estimate N. Goal: the 95 % interval contains the true N in 93 to 97 % of all axes,
temperatures and seeds.

AR(1) is fitted to the y axes of seed 0 after Kaiser low-passes of 8, 16 and 24 Hz, and stands beside tables 2 to 5. The presets
are white, so their coefficient follows from the filter alone; ``filtered_ar1.py`` filters table 2's own coefficients in the same
way. The tables show the paper's figures where the folder of recordings has them (tests/recordings.py).

Command: ``python tests/studies/chamber.py`` (5 seeds: about 4 minutes in one process).
Seeds: ``SeedSequence([p, k, s])`` makes all six axes of the log of preset p at temperature k with seed s.
"""

from __future__ import annotations

import numpy as np
from filtered_ar1 import printed, taps
from study_report import GOALS, Share, Table, main, over_records, verdict

from imuwb.conditioning import filtered
from imuwb.identification.temperature import Record, first_order, over_temperature, set_point_of
from imuwb.log import AXES
from imuwb.simulation import preset
from imuwb.units import coefficient_units

QUESTION = "Two published units in a climate chamber: N by temperature, AR(1) by temperature and cut-off"
PRESETS = ("motionpakii", "ahrs300cc")
CELSIUS = tuple(range(-30, 61, 10))
TABULATED = (-30, 0, 30, 60)
RATE, HOURS, CUTOFFS = 100.0, 3.0, (None, 8.0, 16.0, 24.0)
LOW, HIGH = 0.93, 0.97
NAMES = {"motionpakii": "MotionPakII", "ahrs300cc": "AHRS300CC"}


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
    """Return {axis: ([(truth, N, lower, upper) by temperature], N depends on temperature, kind of N(T))} and {(axis, °C, cut-off): AR(1)}."""
    points = {axis: [] for axis in AXES}
    first = {}
    for place, t in enumerate(CELSIUS):
        for axis, x in samples(unit, place, seed, hours).items():
            points[axis].append(set_point_of([Record(x, place * hours * 3600, float(t), log=place)], 1 / RATE))
            if axis.endswith("_y") and t in TABULATED and not seed:
                for cutoff in CUTOFFS:
                    series = x if cutoff is None else filtered(x, taps(cutoff))
                    f = first_order([Record(series, 0.0, float(t))], 1 / RATE)
                    first[axis, t, cutoff] = (f.alpha, f.sigma, f.sigma_if_ar)
    white = {}
    for axis, by_temperature in points.items():
        over = over_temperature(by_temperature)
        rows = []
        for t, p in zip(CELSIUS, over.points, strict=True):
            n = p.coefficients["N"]
            rows.append((preset(PRESETS[unit]).axes[axis].at(t).terms[0].N, n.value or 0.0, n.lower or 0.0, n.upper))
        white[axis] = rows, bool(over.dependence["N"].depends), over.laws["N"].function.kind
    return white, first


def study(seeds=5, hours=HOURS, workers=1):
    """Return the tables: a summary, N by temperature, AR(1) without a filter and after each filter."""
    jobs = [(unit, seed, hours) for unit in range(len(PRESETS)) for seed in range(seeds)]
    done = dict(zip(jobs, over_records(record, jobs, workers), strict=True))
    cells = [
        (job[0], axis, row) for job, (white, _) in done.items() for axis, (rows, *_) in white.items() for row in rows
    ]
    first = {unit: done[unit, 0, hours][1] for unit in range(len(PRESETS))}
    return (
        _summary(cells, done),
        *(_white(done, unit, seeds, hours) for unit in range(len(PRESETS))),
        *(_ar1(first, cutoff) for cutoff in CUTOFFS),
    )


def inside(cells):
    """Return the share of intervals that contain the truth."""
    return Share(sum(lower <= true <= upper for *_, (true, _, lower, upper) in cells), len(cells))


def _summary(cells, done):
    every = inside(cells)
    rows = [("coverage of N by its 95 % interval, all", "93 to 97 %", every, verdict(LOW <= every.value <= HIGH))]
    for unit, name in enumerate(PRESETS):
        for sensor, term in (("gyro", "angle random walk"), ("accel", "velocity random walk")):
            own = [c for c in cells if c[0] == unit and c[1].startswith(sensor)]
            rows.append((f"coverage of {term}, {name}", "–", inside(own), "–"))
    error = np.array([n / true - 1 for *_, (true, n, _, _) in cells])
    rows.append(("rms error of N, %", "–", f"{100 * np.sqrt(np.mean(error**2)):.4f}", "–"))
    bound = 100 / (2 * HOURS * 3600 * RATE) ** 0.5
    rows.append(("bound of that error for 3 h if all else is known, %", "–", f"{bound:.4f}", "–"))
    depends = [depends for white, _ in done.values() for _, depends, _ in white.values()]
    rows.append(("test finds that N depends on temperature", "all", Share(sum(depends), len(depends)), "–"))
    return Table("Goals", GOALS, tuple(rows))


def _white(done, unit, seeds, hours):
    rows = []
    for place, t in enumerate(CELSIUS):
        cells = [f"{t}"]
        for axis in ("gyro_y", "accel_y"):
            display = coefficient_units(axis, "N")[1]
            true, value, lower, upper = done[unit, 0, hours][0][axis][0][place]
            sensor = axis.partition("_")[0]
            own = [
                (unit, a, done[unit, seed, hours][0][a][0][place])
                for seed in range(seeds)
                for a in AXES
                if a.startswith(sensor)
            ]
            cells += [f"{display.from_si(true):.4f}"]
            cells += [
                f"{display.from_si(value):.4f} [{display.from_si(lower):.4f}, {display.from_si(upper):.4f}]",
                str(inside(own)),
            ]
        rows.append(tuple(cells))
    figures = [
        (f"true {name}", "estimate, y axis, seed 0", "coverage, 3 axes") for name in ("ARW, deg/√h", "VRW, m/s/√h")
    ]
    headings = ("°C", *figures[0], *figures[1])
    return Table(f"{NAMES[PRESETS[unit]]} (table 1 at -30, 0, 30 and 60 °C)", headings, tuple(rows))


def _ar1(first, cutoff):
    rows = []
    for unit, name in enumerate(PRESETS):
        for axis, short in (("gyro_y", "gyro"), ("accel_y", "acc")):
            for place, t in enumerate(TABULATED):
                alpha, sigma, ideal = first[unit][axis, t, cutoff]
                paper = (
                    printed().get(f"{NAMES[name]}_{short}", {}).get("none" if cutoff is None else f"fc{cutoff:g}", [])
                )
                theirs = (f"{paper[place]:.4f}",) if paper else ()
                rows.append((NAMES[name], axis, t, f"{alpha:.5f} ± {sigma:.1g}", f"{ideal:.1g}", *theirs))
    number = {None: 2, 8.0: 3, 16.0: 4, 24.0: 5}[cutoff]
    title = "AR(1) without a filter" if cutoff is None else f"AR(1) after a low-pass of {cutoff:g} Hz"
    note = "x(n) = -alpha x(n-1) + beta0 w(n); ± is Bartlett's standard error."
    headings = ("unit", "axis", "°C", "alpha of the white preset", "standard error if it were AR(1)")
    headings += ("paper",) if printed() else ()
    return Table(f"{title} (table {number})", headings, tuple(rows), note)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 5,
        lambda n: f"seeds (p, k, 0..{n - 1}) for presets p = 0, 1 and temperatures k = 0..9",
    )  # fmt: skip

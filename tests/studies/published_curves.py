"""What does ``fit_allan`` make of published Allan curves of real sensors?

Five static records, from navigation to MEMS grade, as the R package avar publishes them: overlapping Allan variances at octaves
from two samples on, with the number of samples and the rate. Each curve, without its record, becomes an ``AllanDeviation`` and
goes to ``fit_allan``. There is no truth here: the table shows what is found, from which averaging time on the sum
explains the curve, and how well.

The files name no units. The fit needs none, so its figures are in the unit that is stored, times the power of a second
that each coefficient has. Which unit that is can only be guessed from the sensors' data sheets: the guess is printed with what it
rests on, and one column is worked out with it.

Command: ``python tests/studies/published_curves.py`` (some seconds); reads ``../shared/data/vectors/smac_avar/*_av.csv`` from the
repository's root and does nothing where there are none. No seeds.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats
from study_report import Table, main

from imuwb.identification import AllanDeviation, equivalent_degrees_of_freedom, fit_allan
from imuwb.identification.allan_variance.term_selection import ACCEPTED

QUESTION = "Published Allan curves, fitted"
CURVES = Path(__file__).parents[2] / ".." / "shared" / "data" / "vectors" / "smac_avar"
LETTERS = ("Q", "N", "B", "K", "R")
LEVEL = 0.95
MOST_OFF = 1e-6
#: What the magnitudes say: {(file, sensor): (unit, why)}; no file states it. What is usual is as data sheets have it, roughly.
GUESSES = {
    ("adis", "Gyroscope"): ("deg/s", "N near the usual 2 deg/√h; in rad/s it would be 60 times that"),
    ("adis", "Accelerometer"): ("g", "B near the usual 0.2 mg; in m/s² it would be a tenth of that"),
    ("imar", "Gyroscope"): ("deg/s", "N is 0.002 deg/√h, as of navigation grade; in rad/s it would be tactical grade. Unsure"),
    ("kvh1750", "Gyroscope"): ("deg/s", "N and B somewhat below the usual 0.01 deg/√h and 0.05 deg/h; in rad/s ten times above. Unsure"),
    ("kvh1750", "Accelerometer"): ("g", "B near the usual 0.05 mg; in m/s² it would be a tenth of that. Unsure"),
    ("ln200", "Gyroscope"): ("rad/s", "N near the usual 0.05 deg/√h; in deg/s it would be a sixtieth of that"),
    ("ln200", "Accelerometer"): ("m/s²", "as the same file's gyroscopes are in SI: N is 10 µg/√Hz, in g it would be 100; usual is 50. Unsure"),
    ("navchip", "Gyroscope"): ("rad/s", "N near the usual 0.2 deg/√h; in deg/s it would be a sixtieth of that"),
    ("navchip", "Accelerometer"): ("m/s²", "N near the usual 50 µg/√Hz; in g it would be ten times that"),
}  # fmt: skip
#: N in 1 unit/√Hz, in the unit that data sheets use
SHEETS = {"deg/s": ("deg/√h", 60.0), "rad/s": ("deg/√h", 60 * 180 / np.pi), "g": ("µg/√Hz", 1e6), "m/s²": ("µg/√Hz", 1e6 / 9.80665)}  # fmt: skip


class Published(NamedTuple):
    """One axis of a file."""

    file: str
    sensor: str
    kind: str
    axis: str
    curve: AllanDeviation


def published(folder=CURVES):
    """Return every axis of every file; none where there are none."""
    found = []
    for path in sorted(folder.glob("*_av.csv")):
        with path.open(encoding="utf-8") as text:
            rows = list(csv.DictReader(text))
        for kind, axis in dict.fromkeys((row["type"], row["axis"]) for row in rows):
            mine = [row for row in rows if (row["type"], row["axis"]) == (kind, axis)]
            found.append(Published(path.name.removesuffix("_av.csv"), mine[0]["sensor"], kind, axis, curve_of(mine)))
    return found


def curve_of(rows):
    """Return the curve of one axis. Intervals and their degrees of freedom are as for white noise; the fit uses neither."""
    n, rate = int(rows[0]["n"]), float(rows[0]["freq"])
    tau, variance = (np.array([float(row[name]) for row in rows]) for name in ("tau", "avar"))
    factor = np.rint(tau * rate).astype(np.int64)
    if np.abs(factor / (tau * rate) - 1).max() > MOST_OFF:
        message = "averaging times that are no multiples of the sampling interval"
        raise ValueError(message)
    deviation = np.sqrt(variance)
    edf = np.array([equivalent_degrees_of_freedom(int(m), n, 0) for m in factor])
    lower, upper = (deviation * np.sqrt(edf / stats.chi2.ppf(q, edf)) for q in ((1 + LEVEL) / 2, (1 - LEVEL) / 2))
    return AllanDeviation(
        n, 1 / rate, LEVEL, factor, tau, deviation, lower, upper, edf, np.zeros(factor.size, np.int64), n + 1 - 2 * factor
    )  # fmt: skip


def study(records=0, folder=CURVES):
    """Return the tables: coefficients of every axis, how well the sum explains the curve, the units that were guessed."""
    fits = [(one, fit_allan(one.curve)) for one in published(folder)]
    if not fits:
        return (Table("Nothing", ("file",), (), f"There are no curves in {folder.name}."),)
    return (_coefficients(fits), _misfits(fits), _guesses(fits))


def _cell(coefficient):
    c = coefficient
    return f"< {c.upper:.3g}" if c.value is None else f"{c.value:.4g} ({c.lower or 0:.3g}–{c.upper:.3g})"


def _said(one, fit):
    word = "yes" if fit.probability > ACCEPTED else "NO"
    return word if fit.shortest <= one.curve.averaging_time[0] else f"{word}, from {fit.shortest:g} s on"


def _coefficients(fits):
    rows = tuple(
        (one.sensor, one.kind, one.axis, *(_cell(fit.coefficients[letter]) for letter in LETTERS), _said(one, fit))
        for one, fit in fits
    )
    note = (
        "In the unit u that is stored, with 95 % intervals; < is an upper limit of a term that was not identified. Where the sum "
        "does not explain the curve the intervals are widened. A curve alone cannot tell a line from quantization noise: the "
        "ADIS 16405's accelerometers have one at 0.56 Hz, found in the record itself, and what is called Q there is that line "
        "(in the record, with the line taken off, Q is a limit and N is 0.26 m/s/√h)."
    )
    headings = ("sensor", "type", "axis", "Q, u·s", "N, u·√s", "B, u", "K, u/√s", "R, u/s", "explained")
    return Table("Coefficients", headings, rows, note)


def _misfits(fits):
    rows = []
    for one, fit in fits:
        unit, _ = GUESSES.get((one.file, one.kind), ("?", ""))
        sheet, scale = SHEETS.get(unit, ("", 1.0))
        n = fit.coefficients["N"]
        flat = next((r for r in fit.regions if r.letter == "B"), None)
        rows.append((
            one.sensor, one.kind, one.axis, f"{one.curve.dt * one.curve.n / 3600:.2g} h", f"{fit.shortest:g}", fit.misfit, f"{fit.probability:.2g}",
            "–" if flat is None else f"{flat.start:g}–{flat.end:g}",
            "–" if n.value is None else f"{n.value * scale:.3g} {sheet}",
        ))  # fmt: skip
    note = "Explained from: the shortest averaging time in the fit. The last column holds if the guessed unit does."
    return Table(
        "How well the sum explains the curve",
        (
            "sensor", "type", "axis", "record", "explained from tau, s", "chi-square over degrees of freedom", "probability",
            "flat region, s", "N if the unit is right",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _guesses(fits):
    known = dict.fromkeys((one.file, one.sensor, one.kind) for one, _ in fits)
    rows = [(sensor, kind, *GUESSES.get((file, kind), ("unknown", "–"))) for file, sensor, kind in known]
    note = "The files and the package's documentation name no unit; these are guesses from magnitudes."
    return Table("Units, guessed", ("sensor", "type", "unit", "because"), tuple(rows), note)


if __name__ == "__main__":
    if any(CURVES.glob("*_av.csv")):
        main(__file__, QUESTION, study, 0, lambda _: "curves of the R package avar (SMAC-Group/avar, data/*_av.rda)")
    else:
        print("there are no published curves at ../shared/data/vectors/smac_avar; nothing was done")

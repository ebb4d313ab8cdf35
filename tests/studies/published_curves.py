"""Fit published Allan curves of real sensors with ``fit_allan``.

The R package avar publishes the curves of five static records, from navigation grade to MEMS: overlapping Allan variances at
octaves from two samples on, with the number of samples and the rate. Each curve becomes an ``AllanDeviation`` without its record
and goes to ``fit_allan``. The true coefficients are unknown: the tables show the estimates, the averaging time from which the
sum of processes explains the curve, and the quality of the fit.

The files name no units. The fit needs no unit, so its figures are in the stored unit, times the power of a second that each
coefficient has. The stored unit can only be guessed from the sensors' data sheets: the last table gives each guess and its
reason, and one column of the second table uses the guess.

Command: ``python tests/studies/published_curves.py`` (some seconds). It reads ``data/vectors/smac_avar/*_av.csv`` in the folder
of recordings (tests/recordings.py), and does nothing where there are no such files. There are no seeds.
"""

from __future__ import annotations

import csv
from typing import NamedTuple

import numpy as np
from scipy import stats
from study_report import FOLDER, Table, main

from imuwb.identification import AllanDeviation, equivalent_degrees_of_freedom, fit_allan
from imuwb.identification.sum_fit import ACCEPTED

QUESTION = "Fits of published Allan curves"
CURVES = FOLDER / "data" / "vectors" / "smac_avar"
LETTERS = ("Q", "N", "B", "K", "R")
LEVEL = 0.95
MOST_OFF = 1e-6
#: {(file, sensor): (unit, reason)}, guessed from magnitudes: no file states a unit. "Usual" is a rough figure of data sheets.
GUESSES = {
    ("adis", "Gyroscope"): ("deg/s", "N is near the usual 2 deg/√h; in rad/s N would be 60 times that"),
    ("adis", "Accelerometer"): ("g", "B is near the usual 0.2 mg; in m/s² B would be a tenth of that"),
    ("imar", "Gyroscope"): ("deg/s", "N is 0.002 deg/√h, which is navigation grade; in rad/s N would be tactical grade. Unsure"),
    ("kvh1750", "Gyroscope"): ("deg/s", "N and B are somewhat below the usual 0.01 deg/√h and 0.05 deg/h; in rad/s they would be ten times above. Unsure"),
    ("kvh1750", "Accelerometer"): ("g", "B is near the usual 0.05 mg; in m/s² B would be a tenth of that. Unsure"),
    ("ln200", "Gyroscope"): ("rad/s", "N is near the usual 0.05 deg/√h; in deg/s N would be a sixtieth of that"),
    ("ln200", "Accelerometer"): ("m/s²", "the gyroscopes of the same file are in SI; N is 10 µg/√Hz, in g N would be 100; 50 is usual. Unsure"),
    ("navchip", "Gyroscope"): ("rad/s", "N is near the usual 0.2 deg/√h; in deg/s N would be a sixtieth of that"),
    ("navchip", "Accelerometer"): ("m/s²", "N is near the usual 50 µg/√Hz; in g N would be ten times that"),
}  # fmt: skip
#: unit of a record -> (unit of N on data sheets, N of 1 unit/√Hz in it)
SHEETS = {"deg/s": ("deg/√h", 60.0), "rad/s": ("deg/√h", 60 * 180 / np.pi), "g": ("µg/√Hz", 1e6), "m/s²": ("µg/√Hz", 1e6 / 9.80665)}  # fmt: skip


class Published(NamedTuple):
    """One axis of a file."""

    file: str
    sensor: str
    kind: str
    axis: str
    curve: AllanDeviation


def published_axes(folder=CURVES):
    """Return every axis of every file of a folder; an empty list where the folder has no such file."""
    axes = []
    for path in sorted(folder.glob("*_av.csv")):
        with path.open(encoding="utf-8") as text:
            rows = list(csv.DictReader(text))
        for kind, axis in dict.fromkeys((row["type"], row["axis"]) for row in rows):
            own = [row for row in rows if (row["type"], row["axis"]) == (kind, axis)]
            axes.append(Published(path.name.removesuffix("_av.csv"), own[0]["sensor"], kind, axis, curve_of(own)))
    return axes


def curve_of(rows):
    """Return the curve of one axis. Its intervals and degrees of freedom assume white noise; the fit does not use them."""
    n, rate = int(rows[0]["n"]), float(rows[0]["freq"])
    tau, variance = (np.array([float(row[name]) for row in rows]) for name in ("tau", "avar"))
    factor = np.rint(tau * rate).astype(np.int64)
    if np.abs(factor / (tau * rate) - 1).max() > MOST_OFF:
        raise ValueError("an averaging time is not a multiple of the sampling interval")
    deviation = np.sqrt(variance)
    edf = np.array([equivalent_degrees_of_freedom(int(m), n, 0) for m in factor])
    lower, upper = (deviation * np.sqrt(edf / stats.chi2.ppf(q, edf)) for q in ((1 + LEVEL) / 2, (1 - LEVEL) / 2))
    return AllanDeviation(
        n, 1 / rate, LEVEL, factor, tau, deviation, lower, upper, edf, np.zeros(factor.size, np.int64), n + 1 - 2 * factor
    )  # fmt: skip


def study(records=0, folder=CURVES):
    """Return the tables: coefficients of every axis, quality of the fits, guessed units."""
    fits = [(axis, fit_allan(axis.curve)) for axis in published_axes(folder)]
    if not fits:
        return (Table("No curves", ("file",), (), f"The folder {folder} contains no *_av.csv."),)
    return (_coefficients(fits), _misfits(fits), _guesses(fits))


def _cell(coefficient):
    c = coefficient
    return f"< {c.upper:.3g}" if c.value is None else f"{c.value:.4g} ({c.lower or 0:.3g}–{c.upper:.3g})"


def _explained(axis, fit):
    answer = "yes" if fit.probability > ACCEPTED else "NO"
    return answer if fit.shortest <= axis.curve.averaging_time[0] else f"{answer}, from {fit.shortest:g} s on"


def _coefficients(fits):
    rows = tuple(
        (a.sensor, a.kind, a.axis, *(_cell(fit.coefficients[letter]) for letter in LETTERS), _explained(a, fit))
        for a, fit in fits
    )
    note = (
        "u is the stored unit; intervals are at 95 %; < is the upper limit of a term that was not identified. Where the sum of "
        "processes does not explain the curve, the intervals are widened. A curve alone cannot distinguish a line from quantization "
        "noise: the record of the ADIS 16405's accelerometers has a line at 0.56 Hz, and the Q of this table is that line "
        "(after removal of the line from the record, Q is not identified and N is 0.26 m/s/√h)."
    )
    headings = ("sensor", "type", "axis", "Q, u·s", "N, u·√s", "B, u", "K, u/√s", "R, u/s", "curve explained")
    return Table("Coefficients", headings, rows, note)


def _misfits(fits):
    rows = []
    for axis, fit in fits:
        unit, _ = GUESSES.get((axis.file, axis.kind), ("?", ""))
        sheet, scale = SHEETS.get(unit, ("", 1.0))
        n = fit.coefficients["N"]
        flat = next((r for r in fit.regions if r.letter == "B"), None)
        rows.append((
            axis.sensor, axis.kind, axis.axis, f"{axis.curve.dt * axis.curve.n / 3600:.2g} h", f"{fit.shortest:g}", fit.misfit, f"{fit.probability:.2g}",
            "–" if flat is None else f"{flat.start:g}–{flat.end:g}",
            "–" if n.value is None else f"{n.value * scale:.3g} {sheet}",
        ))  # fmt: skip
    note = "The curve is explained from the shortest averaging time in the fit. The last column is right if the guessed unit is right."
    return Table(
        "Quality of the fits",
        (
            "sensor", "type", "axis", "length of the record", "curve explained from, s", "chi-square over degrees of freedom",
            "probability of a larger chi-square", "flat region, s", "N in the guessed unit",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _guesses(fits):
    known = dict.fromkeys((axis.file, axis.sensor, axis.kind) for axis, _ in fits)
    rows = [(sensor, kind, *GUESSES.get((file, kind), ("unknown", "–"))) for file, sensor, kind in known]
    note = "The files and the documentation of the package name no unit; these units are guessed from magnitudes."
    return Table("Guessed units", ("sensor", "type", "unit", "reason"), tuple(rows), note)


if __name__ == "__main__":
    if any(CURVES.glob("*_av.csv")):
        main(__file__, QUESTION, study, 0, lambda _: "curves of the R package avar (SMAC-Group/avar, data/*_av.rda)")
    else:
        print(f"The folder {CURVES} contains no published curves (*_av.csv); the study did nothing.")

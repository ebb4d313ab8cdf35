"""Simulate Quinchia's outages, and compare wavelet denoising with 18AV with the other filters (tables 6, 9 and 10, figure 26).

The drives are the two of ``planned_route``, with the paper's sensor (N, B and K of table 4, with flicker for B) and noise by seed. The
outages have the paper's durations and speeds. Each filter's horizontal error, mean and largest over an outage, is taken against its
own run without outages, as in the paper, and against the truth. The paper claims a gain: the mean over the seven outages of
1 - 18AVWD/other is 50.95 % (15AR), 48.20 % (27AR), 31.89 % (15AV) and 26.06 % (18AV) for the largest errors. The study takes the mean
of this gain over seeds, with its 95 % interval. Table 6 has filters without biases, at 0, 3 and 7 levels of denoising.

The tables show the paper's figures where the folder of recordings has them (tests/recordings.py).

Readings: "corrected" has filters from table 4's N, B and K, and AR processes that these have in expectation. "Printed variances" and
"printed densities" have exactly the parameters of tables 2, 4 and 5 (preset 3dm-gx3-25-paper), with eqs. 21 and 27 to 36 read as
variances of a sample or as densities. Denoising has the levels of table 7 and thresholds without a scale, as table 2.

Command: ``python tests/studies/turin.py`` (10 seeds: about 4 minutes in one process).
Seeds: seed r makes the noise of record r, which is both drives.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import stats
from study_report import Table, main, over_records, published

from imuwb.navigation import FilterModel
from imuwb.replay import Outage, model_named, prepare, replay
from imuwb.simulation import drive, planned_outages, planned_route, preset

QUESTION = "The outages of Quinchia et al., simulated"
PRESET, PAPER, INTERVAL = "3dm-gx3-25", "3dm-gx3-25-paper", 0.01
FILTERS = ("15AV", "18AV", "18AVWD", "15AR", "27AR", "full")
LEVELS = {"0": (), "3": (3, 2, 2, 3, 2, 2), "7": (7, 7, 7, 7, 6, 6)}
DRIVES = ("turin-1", "turin-2")
NINE, SIX = "9/10", "6"  #: numbers of the paper's tables
#: reading of the formulas -> sensor whose parameters the filters have; the printed readings have the printed parameters
READINGS = {"corrected": PRESET, "printed variances": PAPER, "printed densities": PAPER}


def outages(name, table):
    """Return a drive's outages of a table, by start."""
    planned = [o for o in planned_outages(name) if (str(o.table) == SIX) == (table == SIX)]
    return sorted(planned, key=lambda o: o.start)


def filters_of(reading):
    """Return {table: filters} with the formulas of a reading."""
    base = FilterModel("base", preset(READINGS[reading]))
    nine = [model_named(name, base, interval=INTERVAL, reading=reading) for name in FILTERS]
    bare = model_named("none", base, interval=INTERVAL, reading=reading)
    six = [
        replace(bare, name=f"{level} levels", wavelet_levels=levels, wavelet_scale="none")
        for level, levels in LEVELS.items()
    ]
    return {NINE: nine, SIX: six}


def errors(name, seed, filters):
    """Return {table: {outage: {filter: (own mean, own largest, true mean, true largest)}}} of one drive and seed, m."""
    log = drive(preset(PRESET), planned_route(name), seed)
    prepared = prepare(log, filters[NINE][0])
    return {table: _errors(prepared, models, outages(name, table)) for table, models in filters.items()}


def _errors(prepared, models, planned):
    replayed = replay(prepared, models, [Outage(float(o.start), float(o.duration)) for o in planned], reference="truth")
    result = {}
    for duration in replayed.scored:
        for i, o in enumerate(o for o in planned if o.duration == duration):
            result[o.number] = {
                model: tuple(
                    float(part)
                    for scores in (run.outages[duration].own, run.outages[duration].scores)
                    for part in (scores.horizontal[i].mean(), scores.horizontal[i].max())
                )
                for model, run in replayed.runs.items()
            }
    return result


def record(reading, seed):
    """Return {table: {outage: {filter: errors}}} of both drives."""
    filters = filters_of(reading)
    first, second = (errors(name, seed, filters) for name in DRIVES)
    return {table: first[table] | second[table] for table in filters}


def study(records=10, workers=1):
    """Return three tables of each reading of the formulas."""
    tables = []
    for reading in READINGS:
        seeds = over_records(record, [(reading, seed) for seed in range(records)], workers)
        nine, six = ([seed[table] for seed in seeds] for table in (NINE, SIX))
        tables += [_largest(nine, reading), _gains(nine, reading), _levels(six, reading)]
    return tuple(tables)


def gain(values):
    """Return a mean over seeds with its 95 % interval, in per cent."""
    half = stats.t.ppf(0.975, values.size - 1) * values.std(ddof=1) / np.sqrt(values.size)
    return f"{values.mean() * 100:.1f} [{(values.mean() - half) * 100:.1f}, {(values.mean() + half) * 100:.1f}] %"


def spread(values):
    """Return a median and the 16 and 84 % quantiles."""
    low, middle, high = np.quantile(values, [0.16, 0.5, 0.84])
    return f"{middle:.1f} ({low:.1f} to {high:.1f})"


def _of(seeds, outage, name, place):
    """Return one error of a filter in an outage, by seed."""
    return np.array([seed[outage][name][place] for seed in seeds])


def _paper(*keys):
    """Return a figure of the paper; None where it is absent."""
    figure = published("quinchia2013")
    for key in keys:
        figure = figure.get(key) if figure else None
    return figure


def _cells(seeds, names, figures):
    """Return rows of the largest errors against a filter's own run, each with the paper's figure."""
    for i, outage in enumerate(sorted(seeds[0])):
        cells = (spread(_of(seeds, outage, name, 1)) for name in names)
        theirs = ("" if column is None else f"; {column[i]:.1f}" for column in figures)
        yield (outage, *map("".join, zip(cells, theirs, strict=True)))


def _largest(seeds, reading):
    note = "Largest horizontal error against the filter's own run, m: median (16 to 84 %) over seeds; then the paper's figure."
    rows = _cells(seeds, FILTERS, [_paper("table9_10_outages", f"max_{name}") for name in FILTERS])
    return Table(f"Formulas {reading}: the outages of tables 9 and 10", ("outage", *FILTERS), tuple(rows), note)


def _gains(seeds, reading):
    note = "Mean over the seven outages of 1 - 18AVWD/other: mean over seeds with its 95 % interval; then the paper's figures."
    rows = []
    for name in FILTERS:
        if name == "18AVWD":
            continue
        gains = (
            np.mean([1 - _of(seeds, o, "18AVWD", k) / _of(seeds, o, name, k) for o in seeds[0]], axis=0)
            for k in (1, 0, 3, 2)
        )
        theirs = [_paper("claims", f"{kind}_vs", name) for kind in ("max", "mean")]
        rows.append((name, *map(gain, gains), "—" if None in theirs else f"{theirs[0]} and {theirs[1]} %"))
    headings = (
        "other filter", "largest error against own run", "mean error against own run", "largest error against truth",
        "mean error against truth", "paper: largest and mean error",
    )  # fmt: skip
    return Table(f"Formulas {reading}: gain of 18AVWD", headings, tuple(rows), note)


def _levels(seeds, reading):
    names = [f"{level} levels" for level in LEVELS]
    sums = [sum(_of(seeds, outage, name, 1) for outage in sorted(seeds[0])) for name in names]
    note = (
        "Largest horizontal error of nine states against the filter's own run, m: median (16 to 84 %) over seeds; then the paper's "
        f"figure. Gain of 7 levels over 0 by sums, as in the paper (4.3 %): {gain(1 - sums[2] / sums[0])}"
    )
    rows = _cells(seeds, names, [_paper("table6_wavelet_levels", f"lod{level}") for level in LEVELS])
    return Table(f"Formulas {reading}: levels of denoising (table 6)", ("outage", *names), tuple(rows), note)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 10, lambda n: f"seeds 0..{n - 1}; n = {n} records of two drives")

"""Read the correlation time of bias instability as Quinchia's table 5, from simulated records of table 4's sensor.

Preset 3dm-gx3-25 (table 4: white noise, flicker noise and, on accelerometers, a random walk): static records of 7 h at 100 Hz, six axes.
``fit_allan`` reads Tc from each octave curve: the arithmetic middle of the flat part, between its begin and its end, or a bound where
the flat part lasts to averages of a ninth of the record.

Command: ``python tests/studies/quinchia_table5.py`` (10 records: about a minute in one process).
Seeds: record r uses ``SeedSequence(r).spawn(6)``, a stream for each axis in the order of ``AXES``, as quinchia.py.
"""

from __future__ import annotations

import numpy as np
from coverage_table4 import PRESET
from quinchia import HOURS, RATE, samples
from quinchia_table2 import PAPER_AXES
from study_report import Share, Table, main, over_records, published

from imuwb.identification import allan, fit_allan

QUESTION = "Quinchia's table 5 from simulated static records"


def record(seed, axis, hours=HOURS):
    """Return the correlation time of an axis; None without B."""
    return fit_allan(allan(samples(PRESET, axis, seed, hours), 1 / RATE, fast=True)).correlation_time


def study(records=10, hours=HOURS, workers=1):
    """Return the table of correlation times."""
    jobs = [(seed, axis, hours) for seed in range(records) for axis in PAPER_AXES]
    done = over_records(record, jobs, workers)
    paper = published("quinchia2013")
    rows = []
    for i, axis in enumerate(PAPER_AXES):
        found = [t for (_, a, _), t in zip(jobs, done, strict=True) if a == axis]
        read = [t for t in found if t is not None]
        ends = [t for t in read if np.isfinite(t.upper)]
        inside = None if paper is None else Share(sum(paper["table5"]["Tc_s"][i] in t for t in read), len(read))
        rows.append((
            axis, "–" if paper is None else f"{paper['table5']['Tc_s'][i]:g}", Share(len(read), len(found)), Share(len(read) - len(ends), len(read)),
            _spread([t.value for t in ends]), _spread([t.lower for t in read]), _spread([t.upper for t in ends]), "–" if inside is None else inside,
        ))  # fmt: skip
    note = (
        "Median (smallest–largest) over the records. Bounds: records in which the flat part may last beyond the curve; their middle is not "
        "in the column. Last column: records in which table 5 lies between begin and end."
    )
    headings = (
        "axis", "table 5, s", "with a Tc or a bound", "bounds among them", "middle, s", "begin, s", "end, s", "table 5 inside"
    )  # fmt: skip
    return (Table("Correlation times", headings, tuple(rows), note),)


def _spread(values):
    return f"{np.median(values):.3g} ({min(values):.3g}–{max(values):.3g})" if values else "–"


if __name__ == "__main__":
    main(__file__, QUESTION, study, 10, lambda n: f"seeds 0..{n - 1} of {PRESET}; {HOURS:g} h at {RATE:g} Hz")

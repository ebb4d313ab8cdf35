"""What an outage replay shows."""

import re
from dataclasses import replace

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.review.answers.document import plain
from imuwb_plugins import outage
from imuwb_plugins.outage.notes import misfits

from .made import Shown, stated


def test_tables_and_notes(few):
    shown = Shown()
    outage.draw(few, shown)
    tables = {t.title: t for t in shown.tables}
    drift = tables["Drift after 10 s without GNSS"]
    medians = {name: own.median_end for name, own in few.summary[0].models.items()}
    assert [row[0] for row in drift.rows] == sorted(medians, key=medians.get)  # too few outages for a likelihood
    assert {row[0]: row[-1] for row in drift.rows} == {name: "no" if name == "18AVWD" else "yes" for name in medians}
    for row in drift.rows:
        assert row[1] == "7 (7)"
        assert row[2].startswith(f"{medians[row[0]]:.3g} [")
        assert row[2].endswith("] m")
    assert {"Consistency in outages of 10 s", "Pairs in the same outages of 10 s", "Filters and their states"} <= set(
        tables
    )
    states = {row[0]: row[1] for row in tables["Filters and their states"].rows}
    assert states == {"none": "9", "15AV": "21", "18AV": "24", "18AVWD": "24", "full": "27"}  # six turn-on biases
    (printed,) = [t for title, t in tables.items() if "Quinchia, tables 9 and 10" in title]
    gains = [1 - o.models["18AVWD"].own_max / o.models["15AV"].own_max for o in few.outages]
    assert few.published["15AV"].own_max == pytest.approx(np.mean(gains))
    assert "18AVWD" in printed.rows[-1][0]
    assert printed.rows[-1][4].endswith(f"/ {100 * np.mean(gains):.1f} %")
    assert {"reference", "alignment-after-standstill", "aids", "sigma-right", "drive"} <= set(ids(shown.notes))
    assert any(n.startswith("10 s: full: ") for n in shown.notes)


@pytest.mark.slow
def test_every_figure_has_units_and_finite_curves(swept):
    shown = Shown()
    outage.draw(swept, shown)
    assert len(shown.figures) >= 5
    for figure in shown.figures:
        for label in (figure.x_title, figure.y_title):
            assert "[" in label
        assert figure.curves
    assert {"Consistency", "Errors", "Drive", "Outages", "Comparison", "Filters"} <= set(shown.tabs)
    assert any(name == "reference" for name, _, _ in shown.tracks)
    assert any(name == "full, typical outage" for name, _, _ in shown.tracks)


def test_a_sweep_lists_the_worst(swept):
    shown = Shown()
    outage.draw(swept, shown)
    (table,) = [t for t in shown.tables if t.title.startswith("Outages (the ")]
    named = {(f"{o.start:.1f} s", f"{o.duration:g} s"): o for o in swept.outages}
    listed = [named[row[:2]] for row in table.rows]
    assert f"the {len(listed)} worst of {len(swept.outages)} that do not overlap, by the best filter" in table.title
    assert 5 < len(listed) <= 20

    def best(one):
        return min(m.end for m in one.models.values())

    def overlap(one, other):
        return one.start < other.start + other.duration and other.start < one.start + one.duration

    best_first = swept.summary[-1].ranked
    assert table.headings[4:] == tuple(best_first)
    errors = [figure.title for figure in shown.figures if ": errors in " in figure.title]
    assert [title.partition(":")[0] for title in errors] == best_first
    for i, one in enumerate(listed):
        assert not any(overlap(one, other) for other in listed[:i])
        ends = [float(cell.split(" / ")[2].split()[0]) for cell in table.rows[i][4:]]
        assert ends == pytest.approx([one.models[name].end for name in best_first], rel=6e-3)
    least = min(map(best, listed)) if len(listed) == 20 else 0.0
    for one in swept.outages:  # what is left out is no worse, or overlaps with something worse
        if one not in listed:
            assert best(one) <= least or any(overlap(one, o) and best(o) >= best(one) for o in listed)


def test_one_outage_is_no_verdict(log, toml):
    found = outage.run([log], stated(error_model=toml, models="full", at="150:30"))
    assert ids(found.verdicts) == ("few-outages",)
    assert found.verdicts[0].startswith("30 s: 1 outage ")
    of = plain(found)["summary"][0]["models"]["full"]
    assert of["median_end"] > 0
    assert of["median_end_interval"] == [None, None]
    shown = Shown()
    outage.draw(found, shown)
    (drift,) = [t for t in shown.tables if t.title.startswith("Drift after 30 s")]
    assert drift.rows[0][2] == f"{of['median_end']:.3g} m"


def test_too_few_outages_show_no_nan(log, toml):
    found = outage.run([log], stated(error_model=toml, models="none,full", at="140:10,160:10,180:10"))
    shown = Shown()
    outage.draw(found, shown)
    assert not [cell for t in shown.tables for row in t.rows for cell in row if "nan" in cell]


def test_a_caption_is_of_what_is_there(swept):
    shown = Shown()
    outage.draw(replace(swept, outages=swept.outages[:5], listed=(0, 1, 2, 3, 4)), shown)
    (table,) = [t for t in shown.tables if "Quinchia, tables 9 and 10" in t.title]
    assert "Last row" not in table.caption


def test_figures_are_written_without_powers_of_ten(log, toml):
    shown = Shown()
    outage.draw(outage.run([log], stated(error_model=toml, models="none", at="125:100", mounting="3,3,0")), shown)
    cells = [cell for t in shown.tables for row in t.rows for cell in row]
    assert not [cell for cell in cells if re.search(r"\de[+-]\d", cell)]


@pytest.mark.parametrize(
    ("position", "velocity", "refused", "fits"),
    [(2.9, 1.0, 10, True), (3.1, 1.0, 10, False), (1.0, 3.1, 10, False), (1.0, None, 10, True), (1.0, 1.0, 11, False)],
)
def test_a_filter_that_does_not_fit(few, position, velocity, refused, fits):
    """NIS over its degrees of freedom above 3, or more than a tenth of the fixes refused."""
    own = replace(few.filters[0], nis_position=position, nis_velocity=velocity, refused=refused, fixes=100)
    assert ids(misfits((own,))) == (() if fits else ("misfit",))

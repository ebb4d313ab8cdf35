"""Quinchia's tables: each printed value has a key in what the still record and the drives give."""

from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import AXES
from imuwb.simulation import preset, static
from imuwb.statistics import Estimate
from imuwb_plugins.reproduce.printed import paper
from imuwb_plugins.reproduce.quinchia import bench, figures, road

STILL, DRIVEN = ("2", "3", "4", "5"), ("6", "7", "8", "9", "10", "section 7")


def keys(tables):
    """Return the keys of the values of some tables."""
    return {value.key for value in paper("quinchia").values() if value.key.table in tables}


def test_still_record_has_every_value_and_figure():
    log = static(preset("3dm-gx3-25"), 500.0, 100.0, 1)
    found = bench.still(log)
    assert keys(STILL) <= found.values.keys()
    assert all(found.figures[str(number)] for number in range(10, 18))
    alphas = [found.values[key] for key in keys(("2",)) if key.quantity == "AR(3) α1"]
    assert all(isinstance(a, Estimate) and -2.65 < a.value < -2.4 for a in alphas)  # -2.58 to -2.56 in the paper


def outage(number, growth):
    """Return an outage in which the error of a filter grows by so many metres in each second."""
    elapsed = np.arange(1.0, 31.0)
    apart = {name: np.stack([growth[name] * elapsed, 0 * elapsed], axis=1) for name in growth}
    return road.Outages(number, 30.0, 10.0, elapsed, np.stack([10 * elapsed, elapsed], axis=1), apart)


@pytest.fixture
def drives():
    """Return two drives: 18AVWD is half as far off as every other filter, and denoising with 7 levels takes off a tenth."""
    five = {name: 0.5 if name == "18AVWD" else 1.0 for name in road.FILTERS}
    nine = {"0 levels": 2.0, "3 levels": 2.0, "7 levels": 1.8}
    choice = SimpleNamespace(level=7, band=0.39)
    denoised = SimpleNamespace(axes=dict.fromkeys(AXES, choice))
    made = []
    for table, numbers in (("9", (1, 2, 3)), ("10", (4, 5, 6, 7))):
        plan = road.Plan(table, (), ())
        outages, levels = ([outage(n, growth) for n in numbers] for growth in (five, nine))
        states = {"15AV": 15, "18AV": 18, "15AR": 15, "27AR": 27}
        made.append(road.Driven(plan, np.zeros((2, 2)), tuple(outages), tuple(levels), states, denoised))
    return made


def test_drives_have_every_value(drives):
    values = road.tables(drives)
    assert keys(DRIVEN) <= values.keys()
    by_name = {(key.quantity, key.item): value for key, value in values.items()}
    assert by_name["largest error, gain over", "15AV"].value == pytest.approx(50.0)
    assert by_name["gain of 7 levels over 0, by sums", "all outages"].value == pytest.approx(10.0)
    assert by_name["15AR, largest", "outage 4"].value == pytest.approx(30.0)
    assert by_name["15AR, mean", "outage 4"].value == pytest.approx(15.5)


def test_drives_have_every_figure(drives):
    drawn = figures.drawn(drives)
    assert set(drawn) == {"18", "20", "21", "22", "23", "24", "25", "26"}
    assert all(drawn.values())
    assert len(drawn["26"]) == 2

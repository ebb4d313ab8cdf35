"""One word for each axis: the first reason that holds, in a stated order."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import Doubts
from imuwb.identification import Stationarity
from imuwb.noise_results import LineResult
from imuwb.notes import Note
from imuwb.simulation import preset, static
from imuwb.statistics import Estimate
from imuwb_plugins import allan
from imuwb_plugins.allan.trust import trust

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result():
    found = allan.run([static(preset("3dm-gx3-25"), 300, 50, 4)], allan.Parameters())
    axes = {axis: replace(r, lines=(), fit=replace(r.fit, probability=0.5)) for axis, r in found.axes.items()}
    quiet = {
        axis: replace(r, estimates=replace(r.estimates, agree=True, stationarity=None)) for axis, r in axes.items()
    }
    return replace(found, axes=quiet, doubts=Doubts())


def changed(result, **fields):
    return replace(result, axes={**result.axes, "gyro_x": replace(result.axes["gyro_x"], **fields)})


def uneven(ratio):
    return Stationarity(
        start=np.zeros(2), length=25.0, averaging_time=np.ones(1), deviation=np.ones((2, 1)), probability=np.full(1, 1e-9),
        stationary=False, smallest=1e-9, worst_part=1, worst_time=1.0, worst_ratio=ratio,
    )  # fmt: skip


def test_each_doubt_has_its_word_and_the_gravest_comes_first(result):
    assert trust(result, "gyro_x").word == "yes"
    r = result.axes["gyro_x"]
    disputed = changed(result, estimates=replace(r.estimates, agree=False))
    assert trust(disputed, "gyro_x").word == "disputed"
    assert trust(disputed, "gyro_y").word == "yes"
    line = LineResult(0.56, Estimate(1e-3, 9e-4, 1.1e-3, unit="rad/s"))
    shaken = changed(disputed, lines=(line,))
    assert trust(shaken, "gyro_x").word == "shaken"
    assert "0.0573 deg/s" in trust(shaken, "gyro_x").sentence
    unexplained = changed(shaken, fit=replace(r.fit, probability=1e-4))
    assert trust(unexplained, "gyro_x").word == "unexplained"
    moved = replace(unexplained, doubts=Doubts((Note("moving", "the record moves"),)))
    assert trust(moved, "gyro_x").word == "moved"
    none = changed(moved, why_no_fit="the channel is constant")
    assert trust(none, "gyro_x").word == "none"
    assert trust(none, "gyro_y").word == "moved"


@pytest.mark.parametrize(("ratio", "word"), [(1.1, "yes"), (1.3, "changes"), (0.7, "changes")])
def test_a_change_counts_from_a_fifth_on(result, ratio, word):
    r = result.axes["gyro_x"]
    found = changed(result, estimates=replace(r.estimates, stationarity=uneven(ratio)))
    assert trust(found, "gyro_x").word == word

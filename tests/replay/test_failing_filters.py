"""A filter that cannot run does not end the others."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import AXES
from imuwb.navigation import FilterModel, Settings
from imuwb.replay import Outage, prepare, replay
from imuwb.simulation import drive, mixed_route
from imuwb.stochastic import AxisModel, GaussMarkov, ImuErrorModel, Sum, WhiteNoise

from .made import error_model

SETTINGS = Settings(settling=30.0)
WIDE = ImuErrorModel(
    "wide", dict.fromkeys(AXES, AxisModel(Sum(tuple(GaussMarkov(1.0, float(t)) for t in range(1, 8)))))
)


@pytest.fixture(scope="module")
def good():
    return FilterModel("good", error_model(), settings=SETTINGS)


@pytest.fixture(scope="module")
def prepared(good):
    return prepare(drive(error_model(), mixed_route(150, 3), 1, rate=25.0), good)


def test_the_others_go_on(prepared, good):
    broken = ImuErrorModel("broken", dict.fromkeys(AXES, AxisModel(Sum((WhiteNoise(1e60),)))))
    models = [FilterModel("wide", WIDE), good, FilterModel("broken", broken)]
    start = prepared.start_time + 20
    found = replay(prepared, models, [Outage(start + k, 10.0) for k in range(5)])
    assert list(found.runs) == ["good"]
    assert found.scored[10.0].all()
    assert "51 states" in found.failed["wide"]
    assert found.failed["broken"]
    assert not found.failed["wide"].startswith("wide")
    assert "wide cannot run" in str(found)


def test_none_that_runs_is_an_error_with_the_reason(prepared, good):
    with pytest.raises(MissingDataError, match="wide: 51 states"):
        replay(prepared, [replace(good, name="wide", error_model=WIDE)], [Outage(prepared.start_time + 20, 10.0)])


def test_a_filter_without_finite_errors_does_not_take_the_outages_of_others(prepared, good, monkeypatch):
    module = sys.modules["imuwb.replay.replay"]
    real = module.scores

    def scores(drifted, track):
        own = real(drifted, track)
        return replace(own, north_east=own.north_east * np.nan) if drifted.covariance[0, 0, 0, 0] > 1e3 else own

    monkeypatch.setattr(module, "scores", scores)
    loud = ImuErrorModel("loud", dict.fromkeys(AXES, AxisModel(Sum((WhiteNoise(100.0),)))))
    found = replay(prepared, [good, FilterModel("loud", loud)], [Outage(prepared.start_time + 20, 10.0)])
    assert list(found.runs) == ["good"]
    assert "1 of 1" in found.failed["loud"]

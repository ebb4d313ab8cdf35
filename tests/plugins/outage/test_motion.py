"""The default run: the noise in motion, the mounting and the clocks come from the log."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.replay import TURN_ON
from imuwb.simulation import MotionNoise, Receiver, drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, RandomWalk, Sum, WhiteNoise
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters

from .made import Shown, sensor, stated

LATE = 0.2  #: s


@pytest.fixture(scope="module")
def noisy(toml):
    log = drive(
        sensor(), mixed_route(200, 3), 1, rate=50.0, receiver=Receiver(latency=LATE),
        motion_noise=MotionNoise((2e-3, 2e-2), when="always"),
    )  # fmt: skip
    return outage.run([log], Parameters(error_model=toml, durations="10", settling=40.0))


@pytest.mark.slow
def test_the_default_filters_and_what_is_found(noisy):
    assert [f.name for f in noisy.filters] == ["15AV", "full", "motion"]
    assert {"motion-noise", "motion-remedy", "clocks", "reference"} <= set(ids(noisy.notes))
    assert noisy.motion.factors["gyro_x"].lower > 3
    assert noisy.clocks.delay.value == pytest.approx(LATE, abs=0.05)
    nees = {name: own.nees_per_dof for name, own in noisy.summary[0].models.items()}
    assert nees["motion"] < 1.6 < nees["full"]
    assert noisy.summary[0].choice.chosen == "motion"


@pytest.mark.slow
def test_the_model_in_motion_is_saved(noisy):
    (n,) = (t.N for t in outage.error_model(noisy).axes["gyro_x"].processes.terms if isinstance(t, WhiteNoise))
    assert n == pytest.approx(np.hypot(2e-3, 2e-4), rel=0.35)


@pytest.mark.slow
def test_the_noise_is_drawn_beside_the_benchs(noisy):
    shown = Shown()
    outage.draw(noisy, shown)
    assert "Noise in motion" in shown.tabs
    table = next(t for t in shown.tables if "motion" in t.title)
    assert [row[0] for row in table.rows[:6]] == [f"{s}_{a} N" for s in ("gyro", "accel") for a in "xyz"]
    assert len(table.rows) == 10


def test_without_such_a_filter_there_is_no_model_to_save(log, toml):
    with pytest.raises(UsageError, match="--save-model"):
        outage.error_model(outage.run([log], stated(error_model=toml, models="full", at="150:10")))


def test_a_bench_record_without_slow_noise_gives_a_random_walk_at_its_limit(log, tmp_path):
    axes = {
        a: AxisModel(Sum((WhiteNoise(2e-3 if a[0] == "a" else 2e-4),)), limits={"K": 1e-4 if a[0] == "a" else 1e-6})
        for a in sensor().axes
    }
    path = tmp_path / "white.toml"
    path.write_text(ImuErrorModel("white", axes).to_toml(), "utf-8")
    found = outage.run([log], stated(error_model=path, models="full", at="150:10"))
    assert "unidentified-carried" in ids(found.notes)
    terms = {type(t) for t in found.replay.runs["full"].solution.model.error_model.axes["gyro_x"].processes.terms}
    assert terms == {WhiteNoise, RandomWalk, Constant}
    assert TURN_ON[0] > 0
    paper = outage.run([log], stated(error_model=path, models="paper", at="150:10"))
    assert "unidentified-carried" not in ids(paper.notes)
    assert [f.name for f in paper.filters][-1] == "full"


def test_options_that_a_given_filter_overrides_are_named(log, toml, tmp_path):
    first = outage.run([log], stated(error_model=toml, models="none", at="150:10"))
    path = tmp_path / "f.toml"
    path.write_text(first.filters[0].document, "utf-8")
    found = outage.run([log], Parameters(filter=path, models="none", at="150:10", gnss_floor="1,0.1", straight=0.2))
    (note,) = (note for note in found.notes if "filter-settings" in ids([note]))
    assert "--gnss-floor" in note
    assert "--straight" in note
    assert "--mounting" not in note

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.analysis import Curve, Figure, Series, Table
from imuwb.errors import ImuwbError
from imuwb.log import SECOND
from imuwb.review.document import plain
from imuwb.review.envelope import envelope
from imuwb.review.loglog import LogLog
from imuwb.review.recording import RecordingReview


@settings(deadline=None)
@given(st.integers(1, 30_000), st.integers(0, 2**32 - 1))
def test_an_envelope_keeps_every_extreme(n, seed):
    values = np.random.default_rng(seed).standard_normal((n, 2))
    time, drawn = envelope(np.arange(n, dtype=np.int64) * 1000, values, spans=100)
    assert time.size <= 300
    assert (np.diff(time) > 0).all()
    np.testing.assert_array_equal(np.nanmax(drawn, axis=0), values.max(axis=0))
    np.testing.assert_array_equal(np.nanmin(drawn, axis=0), values.min(axis=0))


def test_a_gap_is_a_break_in_the_line():
    time = np.concatenate([np.arange(10), np.arange(10) + 1000]) * SECOND
    _, drawn = envelope(time, np.ones((20, 1)))
    assert np.flatnonzero(np.isnan(drawn[:, 0])).tolist() == [10]


def figure(x, y, **more):
    return Figure("f", "x", "y", (Curve("c", np.asarray(x), np.asarray(y), (1, 2, 3), **more),))


def test_figures_place_decades_evenly_and_upwards():
    drawing = LogLog(figure([0.01, 1.0, 100.0], [1.0, 10.0, 100.0]))
    (x0, y0), (x1, y1), (x2, y2) = (drawing.place(x, y) for x, y in ((0.01, 1), (1, 10), (100, 100)))
    assert x1 - x0 == pytest.approx(x2 - x1)
    assert y0 - y1 == pytest.approx(y1 - y2)
    assert y2 < y1 < y0


@pytest.mark.parametrize("y", [[0.0, -1.0], [np.nan, np.inf], [5.0, 5.0]])
def test_figures_survive_what_has_no_logarithm(y, tmp_path):
    review = RecordingReview(tmp_path / "r.rrd")
    review.figure(figure([1.0, 2.0], y, lower=np.array(y), upper=np.array(y)))
    assert review.close().stat().st_size > 0


def test_a_recording_holds_what_was_shown_and_its_blueprint(tmp_path):
    from rerun.chunk import RrdReader

    shown = []
    review = RecordingReview(tmp_path / "r.rrd", show=shown.append)
    review.tab("Mine")
    review.figure(figure([1.0, 10.0], [1.0, 2.0]))
    time = np.arange(5000, dtype=np.int64) * SECOND
    review.series(Series("s", "m", time, np.ones((5000, 3)), ("a", "b", "c"), epoch="unix"))
    review.table(Table("T", ("a", "b"), (("1 m", "x|y"),)))
    review.track("gnss", np.array([[0.8, 0.1, 0.0], [0.80001, 0.10001, 0.0]]), (1, 2, 3))
    review.note("look here")
    assert not (tmp_path / "r.rrd").exists()
    path = review.close()
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()}
    for end in ("/mine/figure_0/grid", "/mine/series_0", "/mine/text_0", "/mine/text_1"):
        assert end in entities, entities
    assert any(name.startswith("/mine/track") for name in entities)
    assert [type(item).__name__ for item in shown] == ["Table", "str"]
    assert [p.name for p in tmp_path.iterdir()] == ["r.rrd"]


def test_a_discarded_review_leaves_nothing(tmp_path):
    review = RecordingReview(tmp_path / "r.rrd")
    review.note("x")
    review.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_said(tmp_path):
    with pytest.raises(ImuwbError, match="cannot be written"):
        RecordingReview(tmp_path / "no" / "r.rrd")


def test_json_has_no_nan_and_keeps_names():
    found = plain({"a": np.array([1.0, np.nan]), "b": np.float64("inf"), "c": (1, None), "d": np.int64(3)})
    assert json.dumps(found, allow_nan=False) == '{"a": [1.0, null], "b": null, "c": [1, null], "d": 3}'

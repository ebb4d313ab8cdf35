import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.analysis import Curve, Figure, Mark, Series, Table, Vertical
from imuwb.errors import ImuwbError
from imuwb.log import SECOND
from imuwb.review.document import plain
from imuwb.review.envelope import envelope
from imuwb.review.frame import Frame
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
    drawing = Frame(figure([0.01, 1.0, 100.0], [1.0, 10.0, 100.0]))
    (x0, y0), (x1, y1), (x2, y2) = (drawing.place(x, y) for x, y in ((0.01, 1), (1, 10), (100, 100)))
    assert x1 - x0 == pytest.approx(x2 - x1)
    assert y0 - y1 == pytest.approx(y1 - y2)
    assert y2 < y1 < y0


def test_linear_figures_place_steps_evenly():
    drawing = Frame(
        Figure("f", "x", "y", figure([0.0, 1.0, 2.0], [-5.0, 0.0, 5.0]).curves, x_scale="linear", y_scale="linear")
    )
    (x0, y0), (x1, y1), (x2, y2) = (drawing.place(x, y) for x, y in ((0, -5), (1, 0), (2, 5)))
    assert x1 - x0 == pytest.approx(x2 - x1)
    assert y0 - y1 == pytest.approx(y1 - y2)
    assert y2 < y1 < y0


def test_faint_curves_do_not_stretch_the_axes():
    faint = Curve("far", np.array([1.0, 10.0]), np.array([1e-9, 1e9]), (1, 2, 3), style="faint")
    alone = Frame(figure([1.0, 10.0], [1.0, 2.0]))
    both = Frame(Figure("f", "x", "y", (*figure([1.0, 10.0], [1.0, 2.0]).curves, faint)))
    assert both.y == alone.y
    assert Frame(Figure("f", "x", "y", (faint,))).y.high > 8


def test_a_curve_is_cut_at_the_frame(tmp_path):
    from rerun.chunk import RrdReader

    y = np.array([0.0, 10.0, 0.0, 0.5, -3.0])
    curve = Curve("c", np.arange(5.0), y, (1, 2, 3), style="curve")
    drawn = Figure("f", "x", "y", (curve,), x_scale="linear", y_scale="linear", y_limits=(0.0, 1.0))
    review = RecordingReview(tmp_path / "r.rrd")
    review.figure(drawn)
    path = review.close()
    (chunk,) = (c for c in RrdReader(str(path)).stream() if str(c.entity_path).endswith("/curves/00_c"))
    batch = chunk.to_record_batch()
    column = next(n for n in batch.schema.names if "strips" in n)
    strips = batch.column(column)[0].as_py()
    assert len(strips) == 2  # up and out; back in, down, and out again
    low, high = Frame(drawn).place(0, 1)[1], Frame(drawn).place(0, 0)[1]
    points = [p for s in strips for p in s]
    assert min(p[1] for p in points) == pytest.approx(low, abs=1e-3)
    assert max(p[1] for p in points) == pytest.approx(high, abs=1e-3)
    assert strips[0][-1] == pytest.approx(Frame(drawn).place(0.1, 1), abs=1e-3)
    assert strips[1][-1] == pytest.approx(Frame(drawn).place(3 + 0.5 / 3.5, 0), abs=1e-3)


@pytest.mark.parametrize("style", ["line", "curve", "points", "fit", "faint"])
def test_styles_have_lines_points_or_both(style, tmp_path):
    from rerun.chunk import RrdReader

    review = RecordingReview(tmp_path / "r.rrd")
    review.figure(figure([1.0, 10.0], [1.0, 2.0], style=style))
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(review.close())).stream()}
    assert ("/result/figure_0/curves/00_c" in entities) == (style != "points")
    assert ("/result/figure_0/curves/00_c/points" in entities) == (style in ("line", "points"))


def test_verticals_and_marks_outside_the_frame_are_left_out(tmp_path):
    from rerun.chunk import RrdReader

    for at, there in ((2.0, True), (200.0, False), (-1.0, False)):
        review = RecordingReview(tmp_path / "r.rrd")
        curves = figure([1.0, 10.0], [1.0, 2.0]).curves
        review.figure(
            Figure("f", "x", "y", curves, (Mark(at, 1.5, "m", (1, 2, 3)),), verticals=(Vertical(at, "here"),))
        )
        entities = {str(chunk.entity_path) for chunk in RrdReader(str(review.close())).stream()}
        assert ("/result/figure_0/verticals/lines" in entities) == there
        assert ("/result/figure_0/marks/points" in entities) == there


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

import numpy as np
import pytest

from imuwb.analysis import Series
from imuwb.log import SECOND
from imuwb.review.recording.charts import _Drawn, _placed, charts
from imuwb.review.scene.clock import Clock
from imuwb.review.scene.timelines import Timelines, Window
from imuwb.scene import Span

TIME = np.arange(5, dtype=np.int64) * SECOND
SPAN = Span(int(TIME[1]), int(TIME[2]), "span")


def series(title, *, columns=1, step=1, spans=()):
    values = np.arange(5.0 * columns).reshape(5, columns)
    names = tuple(f"{title}{k}" for k in range(columns))
    return Series(title, "m", TIME * step, values, names, ((1, 2, 3),) * columns, spans=spans)


def views(logged, given, *, plain=True):
    return [view for view, _ in charts(given, logged, Timelines(Clock()), "/t", beside=False, plain=plain)]


def test_single_quantities_at_the_same_times_are_one_entity(logged):
    given = [series("a"), series("b"), series("c", step=2), series("d", columns=2), series("e"), series("f")]
    found = views(logged, given)
    assert [view.origin for view in found] == [f"/t/series_{k}" for k in (0, 0, 2, 3, 4, 4)]
    lines = {path: len(style.names.as_arrow_array()) for path, (style,) in logged.items()}
    assert lines == {"/t/series_0": 2, "/t/series_2": 1, "/t/series_3": 2, "/t/series_4": 2}


def test_each_chart_of_an_entity_hides_the_lines_of_the_others(logged):
    shown = [
        view.visualizer_overrides["/t/series_0"][0].visible_series.as_arrow_array().to_pylist()
        for view in views(logged, [series(name) for name in "abc"])
    ]
    assert np.array(shown).tolist() == np.eye(3, dtype=bool).tolist()


@pytest.mark.parametrize(("spans", "plain"), [((SPAN,), True), ((), False)])
def test_charts_with_shading_have_entities_of_their_own(spans, plain, logged):
    found = views(logged, [series("a", spans=spans), series("b")], plain=plain)
    assert [view.origin for view in found] == ["/t/series_0", "/t/series_1"]


def test_a_legend_that_no_corner_takes_has_room_above_the_lines():
    time = np.arange(100, dtype=np.int64) * SECOND
    lines = np.stack([np.zeros(100), np.ones(100)], axis=1)
    series = Series("speed", "m/s", time, lines, ("a", "b"))
    timelines = Timelines(Clock())
    assert _placed(_Drawn(series, time, lines), timelines, (0.0, 1.0), growing=True) == ("LeftTop", (0.0, 1.0))
    corner, (low, high) = _placed(_Drawn(series, time, lines), timelines, None, growing=False)
    assert (corner, low) == ("LeftTop", 0.0)
    assert high == pytest.approx(2.5)
    timelines.window(Window("outage", 10 * SECOND + 1, 10 * SECOND + 2, 10 * SECOND + 3))  # between two rows
    assert _placed(_Drawn(series, time, lines), timelines, None, growing=False) == ("LeftTop", None)

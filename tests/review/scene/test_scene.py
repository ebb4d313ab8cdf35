"""Scenes, spans, events and bars: in a recording, by the other calls of a review, and on a page."""

from collections import defaultdict
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from imuwb.analysis import Answer, Bar, Bars, Review, Series, Table
from imuwb.geodesy import quaternion_of_rotation, rotation_of_euler
from imuwb.geodesy.tangent_plane import position_of
from imuwb.log import SECOND
from imuwb.review.answers.panel import Origin
from imuwb.review.drawn.calls import Drawn, Track
from imuwb.review.drawn.still import still
from imuwb.review.page.pictures import picture
from imuwb.review.page.report import report_of
from imuwb.review.page.report_document import report_from, text_of
from imuwb.review.page.themes import PAGE
from imuwb.review.scene.clock import Clock
from imuwb.review.scene.shading import Chart, shade
from imuwb.review.scene.stage import Ground, _of_enu, _rings
from imuwb.review.scene.theatre import Theatre
from imuwb.review.scene.timelines import Timelines, Window
from imuwb.scene import Belief, Caption, Episode, Event, Points, Pose, Scene, Span

ORIGIN = np.array([0.8, 0.1, 300.0])
RED, BLUE = (200, 0, 0), (0, 0, 200)


def places(north, east, down=0.0):
    return position_of(np.column_stack(np.broadcast_arrays(np.asarray(north, float), east, down)), ORIGIN)


def scene(*names, begin=20):
    """Return 100 s to the north at 10 m/s, with an episode of 10 s for each name, 30 s apart."""
    time = np.arange(100, dtype=np.int64) * SECOND
    level = np.tile([1.0, 0.0, 0.0, 0.0], (100, 1))
    body = Pose("reference", time, places(10.0 * np.arange(100), 0.0), level)
    episodes = []
    for number, name in enumerate(names):
        first = begin + 30 * number
        own = time[first : first + 11]
        covariance = np.tile(np.diag([4.0, 1.0]), (11, 1, 1))
        beliefs = tuple(
            Belief(f, own, places(10.0 * np.arange(first, first + 11), e * np.arange(11)), covariance, c)
            for f, e, c in (("full", 1.0, RED), ("none", 3.0, BLUE))
        )
        episodes.append(Episode(name, int(own[0]), int(own[-1]), beliefs, (Caption("text"),) * 11, Caption("about")))
    points = (Points("fixed", body.position[::5], RED),)
    return Scene("Drive", body, tuple(episodes), points, before=5.0, after=2.0)


def rows(path):
    """Return {entity: [{timeline: time in s, component: value}, ...]} of a recording."""
    found = defaultdict(list)
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        for row in batch.to_pylist():
            found[str(chunk.entity_path)].append({k: v for k, v in row.items() if v is not None})
    return found


def seconds(row, timeline):
    return row[timeline].total_seconds() if timeline in row else None


@pytest.fixture
def shown(review):
    review = review.review
    review.tab("Other")
    time = np.arange(100, dtype=np.int64) * SECOND
    series = Series("speed", "m/s", time, np.arange(100.0)[:, None], ("v",))
    review.series(series)
    review.tab("Drive")
    review.scene(scene("worst outage", ""))
    review.series(replace(series, title="error"))
    review.span(Span(20 * SECOND, 30 * SECOND, "outage"))
    review.event(Event(25 * SECOND, "imu", "a gap", "fault"))
    return rows(review.close())


def test_each_row_is_sent_once_with_its_time_on_every_timeline(shown):
    for path in ("/other/series_0", "/drive/series_0"):
        moving = [row for row in shown[path] if "Scalars:scalars" in row]
        assert sorted(row["Scalars:scalars"][0] for row in moving) == list(range(100))
        inside = {seconds(row, "worst outage"): row["Scalars:scalars"] for row in moving if "worst outage" in row}
        assert inside == {float(t - 20): [float(t)] for t in range(15, 33)}
        assert all("time_since_start" in row for row in moving)


def test_the_camera_follows_the_body(shown):
    translations = {seconds(r, "time_since_start"): r for r in shown["/drive/scene/follow"] if len(r) > 2}
    assert translations[50.0]["Transform3D:translation"][0] == pytest.approx([0.0, 500.0, 0.0], abs=0.01)


def test_tracks_appear_with_their_episode_and_vanish(shown):
    grown = {seconds(r, "time_since_start"): r for r in shown["/drive/scene/now"]}
    (first, second) = grown[25.0]["LineStrips3D:strips"]
    assert first[-1][:2] == pytest.approx([5.0, 250.0], abs=0.1)
    assert second[-1][:2] == pytest.approx([15.0, 250.0], abs=0.1)
    assert grown[30.5]["LineStrips3D:strips"] == []
    assert {seconds(r, "worst outage") for r in shown["/drive/scene/now"]} == {None, *map(float, range(11)), 10.5}
    labels = {seconds(r, "time_since_start"): r.get("Points3D:labels") for r in shown["/drive/scene/now"]}
    assert labels[25.0] == ["full: 5.0 m off", "none: 15 m off"]


def test_an_event_is_a_line_of_a_list_and_of_the_charts(shown):
    (line,) = shown["/drive/events"]
    assert (line["TextLog:text"], line["TextLog:level"]) == (["imu: a gap"], ["ERROR"])
    assert (seconds(line, "worst outage"), seconds(line, "time_since_start")) == (5.0, 25.0)
    names = next(r["SeriesLines:names"] for r in shown["/drive/series_0/spans"] if "SeriesLines:names" in r)
    assert names == ["outage", "outage", "fault"]
    assert "/other/series_0/spans" not in shown


@pytest.mark.parametrize(("heading", "forward"), [(0, (0, 1, 0)), (90, (1, 0, 0)), (180, (0, -1, 0))])
def test_the_body_points_where_it_heads(heading, forward):
    quaternion = quaternion_of_rotation(rotation_of_euler(np.array([0.0, 0.0, np.radians(heading)])))
    x, y, z, w = _of_enu(np.atleast_2d(quaternion))[0]
    turned = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
    assert turned == pytest.approx(forward, abs=1e-12)


@pytest.mark.parametrize("turn", [0.0, 30.0, 80.0, 150.0])
def test_a_ring_lies_along_its_covariance(turn):
    a = np.radians(turn)  # of the long axis, from north to east
    axes = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    covariance = axes @ np.diag([9.0, 1.0]) @ axes.T
    belief = Belief("full", np.zeros(1, np.int64), ORIGIN[None], covariance[None], RED)
    parts = _rings([belief], [np.zeros((1, 3))], 0)
    for ring, sizes, (_, _, s, c) in zip((1.0, 3.0), parts["half_sizes"], parts["quaternions"], strict=True):
        assert sorted(sizes) == pytest.approx([0.0, ring, 3 * ring])
        along = np.argmax(sizes[:2]) * np.pi / 2 + 2 * np.arctan2(s, c)  # of the long axis, from east to north
        assert np.sin(along - (np.pi / 2 - a)) == pytest.approx(0.0, abs=1e-9)


def test_a_span_is_shaded_only_within_its_ends():
    chart = Chart("c", np.arange(100, dtype=np.int64) * SECOND, np.arange(100.0)[:, None])
    spans = [Span(20 * SECOND, 40 * SECOND, "outage")]
    kept = []

    class Kept(Timelines):
        def rows(self, *given):
            kept.append((given[1], given[3]))

    class Recording:
        def log(self, _path, archetype, **_):
            assert archetype.names.as_arrow_array().to_pylist() == ["outage"] * 2

    timelines = Kept(Clock())
    timelines.window(Window("worst", 10 * SECOND, 20 * SECOND, 45 * SECOND))
    shade(chart, spans, [Event(5, "imu", "only a note")], Recording(), timelines)
    assert [on for _, on in kept] == [("",), ("worst",)]
    for time, _ in kept:
        assert 20 * SECOND < time.min() < 22 * SECOND
        assert 38 * SECOND < time.max() < 40 * SECOND


def test_tracks_are_at_the_height_of_the_body():
    own = scene("worst outage")
    up = replace(own.body, position=places(10.0 * np.arange(100), 0.0, -50.0))
    ground = Ground.of(replace(own, body=up))
    assert ground.level(own.episodes[0].beliefs[0])[:, 2] == pytest.approx(0.0, abs=0.1)


def test_what_a_scene_cannot_show_is_an_error(review):
    with pytest.raises(ValueError, match="overlap"):
        replace(scene("a", "b"), episodes=(*scene("a").episodes, *scene("b", begin=25).episodes))
    with pytest.raises(ValueError, match="name of its own"):
        scene("a", "a")
    own = scene("a").episodes[0]
    with pytest.raises(ValueError, match="3 captions; there must be 11"):
        replace(own, captions=(Caption("x"),) * 3)
    with pytest.raises(ValueError, match="must end after"):
        replace(own, end=own.begin)
    with pytest.raises(ValueError, match="10, 11 rows"):
        replace(own.beliefs[0], position=own.beliefs[0].position[:10])
    review.review.tab("Drive")
    review.review.scene(scene("a"))
    with pytest.raises(ValueError, match="a second scene"):
        review.review.scene(scene("b"))
    review.review.discard()


class Older(Review):
    """A review that knows the older calls alone."""

    recording = None

    def __init__(self) -> None:
        self.items = []

    def track(self, name, *_):
        self.items.append(("track", name))

    def note(self, text):
        self.items.append(("note", text))

    def table(self, table):
        self.items.append(("table", table.rows))


def test_a_review_of_older_calls_shows_them_too():
    review = Older()
    review.scene(scene("worst outage", ""))
    review.span(Span(0, 1, "outage"))
    review.event(Event(0, "imu", "a gap", "fault"))
    review.bars(Bars("Drift", "m", (Bar("full", 2.0, RED, 1.0, 3.0), Bar("none", 4.0, BLUE))))
    assert review.items == [
        ("track", "reference"), ("track", "full, worst outage"), ("track", "none, worst outage"),
        ("note", "fault: imu: a gap"), ("table", (("full", "2 [1, 3] m"), ("none", "4 m"))),
    ]  # fmt: skip


def test_bars_are_as_long_as_their_values(review):
    review.review.bars(Bars("Drift", "m", (Bar("full", 2.0, RED, 1.0, 3.0), Bar("none", 4.0, BLUE))))
    assert [type(item) for item in review.shown] == [Table]
    found = rows(review.review.close())
    *_, full, none, interval = found["/result/bars_0"][0]["LineStrips2D:strips"]
    ends = [strip[1][0] - strip[0][0] for strip in (full, none)]
    assert ends[1] == pytest.approx(2 * ends[0])
    low, high = (x for x, _ in interval)
    assert (low, high) == pytest.approx((ends[0] / 2, 1.5 * ends[0]))


def test_on_a_page_a_scene_is_maps_and_a_span_is_shading():
    series = Series("error", "m", np.arange(3, dtype=np.int64), np.ones((3, 1)), ("e",))
    span = Span(0, 2, "outage")
    bars = Bars("Drift", "m", (Bar("full", 2.0, RED),))
    items = [scene("worst outage", ""), series, span, Event(7, "imu", "a gap", "fault"), bars]
    shown = still([*(Drawn("Drive", item) for item in items), Drawn("Other", series)])
    tracks = [one.item for one in shown if isinstance(one.item, Track)]
    whole, *others = dict.fromkeys(track.picture for track in tracks)
    assert (whole, others) == ("The whole track, with episodes", ["Worst outage, 10 s"])
    alone = {t.name: t for t in tracks if t.picture == others[0]}
    assert list(alone) == ["reference", "full", "none", "3 sigma of full at the end"]
    ring = Ground.of(scene()).enu(alone["3 sigma of full at the end"].position)
    assert np.ptp(ring, axis=0)[:2] == pytest.approx([6.0, 12.0], rel=0.01)  # 3 sigma: 3 m east, 6 m north
    drawn = [(one.tab, one.item.spans) for one in shown if isinstance(one.item, Series)]
    assert drawn == [("Drive", (span,)), ("Other", ())]
    assert [one.item.title for one in shown if isinstance(one.item, Table)] == ["Drift", "Events"]


def test_a_page_draws_shaded_series_and_keeps_them(tmp_path):
    time = np.arange(30, dtype=np.int64) * SECOND
    spans = (Span(5 * SECOND, 9 * SECOND, "outage"), Span(20 * SECOND, 25 * SECOND, "outage"))
    values = np.ones((30, 3)) * np.arange(3)
    series = Series("error", "m", time, values, ("e", "sigma", "sigma"), (RED,) * 3, "log", spans)
    shown = picture(series, PAGE, "p-", apart=True)
    assert [name for _, name in shown.legend] == ["outage", "e", "sigma"]
    track = Track("gnss", places(np.arange(3.0), 0.0), RED, picture="Worst outage")
    log = SimpleNamespace(provenance=SimpleNamespace(path="a.csv", format="csv", hash="", selection=""))
    drawn = [Drawn("Drive", series), Drawn("Drive", track)]
    report = report_of(Answer("1 h"), Origin("outage", ("a.csv",)), drawn, [log], "f00d", "1.0")
    again = report_from(text_of(report), tmp_path)
    assert again.drawn[0].item.spans == spans
    assert again.drawn[1].item.picture == "Worst outage"


def test_an_estimator_that_is_missing_in_an_episode_keeps_its_colour(review):
    own = scene("worst outage", "best outage")
    first, second = own.episodes
    alone = replace(own, episodes=(first, replace(second, beliefs=second.beliefs[1:])))
    review.review.tab("Drive")
    review.review.scene(alone)
    found = rows(review.review.close())
    grown = {seconds(r, "time_since_start"): r for r in found["/drive/scene/now"]}
    assert [len(strip) > 0 for strip in grown[25.0]["LineStrips3D:strips"]] == [True, True]
    assert [len(strip) > 0 for strip in grown[55.0]["LineStrips3D:strips"]] == [False, True]
    static = grown[None]["LineStrips3D:colors"]
    assert [(c >> 24, c >> 8 & 255) for c in static] == [(200, 0), (0, 200)]


def test_no_chart_beside_a_scene_is_lower_than_its_legend():
    views = [rrb.TimeSeriesView(origin=name, name=name * 8) for name in "abcde"]
    theatre = Theatre(rrb.Spatial3DView(), [rrb.TextDocumentView()])
    (main,) = theatre.layout("Drive", views, (5, 3, 3, 4, 4)).contents
    charts = main.contents[1]
    assert [list(row.contents) if isinstance(row, rrb.Horizontal) else [row] for row in charts.contents] == [
        views[:1], views[1:3], views[3:4], views[4:],
    ]  # fmt: skip
    assert charts.row_shares[2] > 4 * 23 + 70
    assert sum(charts.row_shares) <= 810  # of a screen of 1440 x 900

import numpy as np
import pytest

from imuwb.review.figures.track import Maps, Tracks, local_plane, ruler_length, thinned

DEGREE = 111_194.9  #: m, of a great circle


def test_east_is_right_and_north_is_up():
    origin = np.array([np.radians(60.0), 0.1, 0.0])
    position = origin + np.radians([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    np.testing.assert_allclose(
        local_plane(position, origin), [[0, 0], [0, -DEGREE], [DEGREE / 2, 0]], rtol=1e-5, atol=1e-6
    )


@pytest.mark.parametrize(("count", "left"), [(19_999, 19_999), (20_000, 10_000), (100_001, 10_001)])
def test_a_long_track_is_thinned(count, left):
    assert len(thinned(np.zeros((count, 2)))) == left


@pytest.mark.parametrize(
    ("span", "length"),
    [(1.0, 0.5), (3.0, 1.0), (4.0, 2.0), (9.0, 2.0), (10.0, 5.0), (29.0, 5.0), (30.0, 10.0), (1000.0, 500.0)],
)
def test_a_ruler_is_round_and_shorter_than_half_the_extent(span, length):
    assert ruler_length(span) == pytest.approx(length)


def test_tracks_share_a_picture_whose_view_is_returned_once():
    tracks = Tracks("t")
    metre = 1 / 6_371_000.0
    first = np.array([[0.0, 0.0, 0.0], [0.0, 100 * metre, 0.0]])
    view = tracks.add("/gnss/fix", first, (1, 2, 3), "")
    bounds = view.properties["VisualBounds2D"].range.as_arrow_array().to_pylist()[0]
    assert (bounds["x_range"], bounds["y_range"]) == (pytest.approx([-15, 115]), pytest.approx([-15, 23]))
    assert tracks.add("other", first + np.array([10 * metre, 0.0, 0.0]), (1, 2, 3), "end") is None
    strips = {part.name: part.places for part in tracks.drawing.lines}
    assert strips["/gnss/fix"] == [[[0, 0], [pytest.approx(100, rel=1e-6), 0]]]
    assert strips["other"][0][0] == [0, pytest.approx(-10, rel=1e-6)]
    assert strips["scale"] == [[(0, 8), (50, 8)]]
    texts = {part.name: list(zip(part.texts, part.places, strict=True)) for part in tracks.drawing.texts}
    assert texts["texts"] == [("50 m", [(25, 12)]), ("start", [(0, 0)])]
    assert texts["other"] == [("end", [pytest.approx((100, -10))])]
    assert "/gnss/fix" not in texts


def test_tracks_on_a_map_share_a_view(logged):
    maps = Maps("m")
    position = np.radians([[47.0, 8.0, 0.0], [48.0, 9.0, 0.0]])
    assert maps.add(logged, "a", position, (1, 2, 3)) is not None
    assert maps.add(logged, "b", position, (1, 2, 3)) is None
    assert logged["m/1_b"][0].line_strings.as_arrow_array().to_pylist() == [
        [pytest.approx([47, 8]), pytest.approx([48, 9])]
    ]

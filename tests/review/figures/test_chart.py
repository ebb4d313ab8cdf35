from itertools import pairwise

import numpy as np
import pytest

from imuwb.analysis import Curve, Figure, Mark, Vertical
from imuwb.colors import GRID, SUBGRID
from imuwb.review.figures import legend
from imuwb.review.figures.frame import Frame as WholeFrame
from imuwb.review.figures.sizes import text_width

WIDTH, HEIGHT = 1000.0, 500.0


def Frame(figure):  # noqa: N802 - of one figure
    return WholeFrame((figure,), WIDTH, HEIGHT)


def test_figures_place_decades_evenly_and_upwards(line):
    frame = Frame(line([0.01, 1.0, 100.0], [1.0, 10.0, 100.0]))
    (x0, y0), (x1, y1), (x2, y2) = (frame.place(x, y) for x, y in ((0.01, 1), (1, 10), (100, 100)))
    assert x1 - x0 == pytest.approx(x2 - x1)
    assert y0 - y1 == pytest.approx(y1 - y2)
    assert y2 < y1 < y0


def test_linear_figures_place_steps_evenly(line):
    frame = Frame(line([0.0, 1.0, 2.0], [-5.0, 0.0, 5.0], kind="linear"))
    (x0, y0), (x1, y1), (x2, y2) = (frame.place(x, y) for x, y in ((0, -5), (1, 0), (2, 5)))
    assert x1 - x0 == pytest.approx(x2 - x1)
    assert y0 - y1 == pytest.approx(y1 - y2)
    assert y2 < y1 < y0


def test_faint_curves_do_not_stretch_the_axes(line):
    faint = Curve("far", np.array([1.0, 10.0]), np.array([1e-9, 1e9]), (1, 2, 3), style="faint")
    alone = Frame(line([1.0, 10.0], [1.0, 2.0]))
    both = Frame(Figure("f", "x", "y", (*line([1.0, 10.0], [1.0, 2.0]).curves, faint)))
    assert both.y == alone.y
    assert Frame(Figure("f", "x", "y", (faint,))).y.high > 8


def test_a_curve_is_cut_at_the_frame(line, drawn):
    figure = line(np.arange(5.0), [0.0, 10.0, 0.0, 0.5, -3.0], kind="linear", limits=(0.0, 1.0), style="curve")
    paths = drawn(figure)
    strips, (width, height) = paths.strips("curves/00_c"), paths.strips("grid")[-1][2]
    assert len(strips) == 2  # up and out of the frame; then in, down, and out again
    place = WholeFrame((figure,), width, height).place
    points = [p for s in strips for p in s]
    assert min(p[1] for p in points) == pytest.approx(place(0, 1)[1], abs=1e-3)
    assert max(p[1] for p in points) == pytest.approx(place(0, 0)[1], abs=1e-3)
    assert strips[0][-1] == pytest.approx(place(0.1, 1), abs=1e-3)
    assert strips[1][-1] == pytest.approx(place(3 + 0.5 / 3.5, 0), abs=1e-3)


def test_a_value_that_cannot_be_shown_parts_a_curve(line):
    figure = line([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 0.0, 2.0])
    strips = Frame(figure).strips(figure.curves[0].x, figure.curves[0].y)
    assert [len(strip) for strip in strips] == [2, 1]


@pytest.mark.parametrize("style", ["line", "curve", "points", "fit", "faint", "bar"])
def test_styles_have_lines_points_or_both(style, line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], style=style))
    assert ("curves/00_c" in paths.lines) == (style != "points")
    assert ("curves/00_c" in paths.points) == (style in ("line", "points"))


def test_a_bar_goes_from_zero_to_its_value(line, drawn):
    figure = line([1.0, 2.0], [3.0, 1.0], kind="linear", limits=(0.0, 4.0), style="bar")
    paths = drawn(figure)
    width, height = paths.strips("grid")[-1][2]
    place = WholeFrame((figure,), width, height).place
    bars = paths.strips("curves/00_c")
    for bar, (x, y) in zip(bars, ((1.0, 3.0), (2.0, 1.0)), strict=True):
        assert bar[0] == pytest.approx(place(x, 0.0), abs=1e-3)
        assert bar[1] == pytest.approx(place(x, y), abs=1e-3)


def test_fits_and_faint_curves_are_thinner_and_paler(line, drawn):
    def look(style):
        paths = drawn(line([1.0, 10.0], [1.0, 2.0], style=style))
        return paths.radii("curves/00_c")[0], paths.colors("curves/00_c")[0][3]

    order = [look(style) for style in ("faint", "fit", "curve", "line")]
    assert [thickness for thickness, _ in order] == sorted({thickness for thickness, _ in order})
    assert [alpha for _, alpha in order] == [110, 220, 255, 255]


@pytest.mark.parametrize(("at", "inside"), [(2.0, True), (200.0, False), (-1.0, False)])
def test_verticals_and_marks_outside_the_frame_are_left_out(at, inside, line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], marks=[Mark(at, 1.5, "m", (1, 2, 3))], verticals=[Vertical(at, "v")]))
    assert ("verticals" in paths.lines) == inside
    assert ("marks" in paths.points) == inside


def test_a_vertical_is_dashed_from_top_to_bottom(line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], verticals=[Vertical(2.0, "v")]))
    strips, height = paths.strips("verticals"), paths.strips("grid")[-1][2][1]
    ends = [(a[1], b[1]) for a, b in strips]
    assert ends[0] == (0, 7)
    assert all(low - high == 7 for (_, high), (low, _) in pairwise(ends))
    assert height - 14 <= ends[-1][0] < height


@pytest.fixture
def boxes():
    """Return the boxes of all texts of a figure, as the viewer draws them: (text, left, top, right, bottom)."""

    def of(paths):
        texts = zip(paths.labels(), paths.places(), strict=True)
        return [(t, x - text_width(t) / 2, y + 11 - 7, x + text_width(t) / 2, y + 11 + 7) for t, (x, y) in texts]

    return of


CROWDED = {
    "marks": [Mark(2.0 + i / 9, 1.5, f"B {i}", (9, i % 2, 9), "31.4 deg/h") for i in range(9)],
    "verticals": [Vertical(2.0 + i / 10, f"line at {i} Hz") for i in range(9)],
}


@pytest.mark.parametrize("size", [(720, 385), (720, 780), (360, 385), (1440, 400)])
@pytest.mark.parametrize("crowd", [{}, CROWDED])
@pytest.mark.parametrize("kind", ["log", "linear"])
def test_no_text_hides_a_curve_or_another_text(size, crowd, kind, line, drawn, boxes):
    figure = line([1.0, 1e4], [1.0, 2e4], kind=kind, **crowd)
    paths = drawn(figure, size)
    (left, right), (top, bottom) = paths.view
    assert (right - left, bottom - top) == pytest.approx(size, rel=0.3)
    frame = paths.strips("grid")[-1]
    width, height = frame[2]
    texts = boxes(paths)
    for text, x0, y0, x1, y1 in texts:
        assert left - 1 <= x0 <= x1 <= right + 1, text
        assert top <= y0 <= y1 <= bottom, text
        assert x0 >= width or x1 <= 0 or y0 >= height or y1 <= 0, text
    for i, (text, x0, y0, x1, y1) in enumerate(texts):
        for other, a0, b0, a1, b1 in texts[:i]:
            assert x0 >= a1 or a0 >= x1 or y0 >= b1 or b0 >= y1, (text, other)


def test_the_legend_has_the_values_of_marks_after_the_curves(line, drawn):
    marks = [Mark(1.0, 1.0, "N x", (1, 2, 3), "2.4 deg/√h"), Mark(3.0, 2.0, "N y", (4, 5, 6))]
    labels = drawn(line([1.0, 10.0], [1.0, 20.0], marks=marks)).labels()
    assert labels[-3:] == ["c", "N x 2.4 deg/√h", "N y"]
    assert "1" not in labels


def test_marks_of_one_colour_have_numbers(line, drawn):
    marks = [Mark(2.0, 1.5, "here", (1, 2, 3)), Mark(2.0, 1.5, "there", (1, 2, 3))]
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], marks=marks))
    assert {"1", "2", "1 here", "2 there"} <= set(paths.labels())
    one, two = (paths.places()[paths.labels().index(n)] for n in "12")
    assert one[1] - two[1] >= 14  # the second is higher


def test_a_legend_that_is_too_long_says_how_much_is_missing(line, drawn):
    marks = [Mark(1.0 + i, 1.0, f"m{i}", (i, 2, 3)) for i in range(60)]
    labels = drawn(line([1.0, 100.0], [1.0, 2.0], marks=marks), (720, 385)).labels()
    count = sum(label.startswith("m") for label in labels)
    assert labels[-1] == f"and {60 - count} more"


def test_figures_of_a_group_share_their_axes_and_the_first_has_the_legend(line, drawn):
    first, second = (line([0.0, 1.0], [0.0, high], kind="linear") for high in (1.0, 100.0))
    group = (first, second)
    one, two = (drawn(figure, (360, 385), group) for figure in group)
    assert "c" in one.labels()
    assert "c" not in two.labels()
    ticks = [{t for t in paths.labels() if t[0].isdigit()} for paths in (one, two)]
    assert ticks[0] == ticks[1] >= {"0", "100"}


def test_the_legend_of_a_group_is_whole_and_each_figure_names_its_own_marks(line, drawn):
    marks = [Mark(0.1 * i, 1.0, f"sensor {i}", (1, 2, 3), "0.25 deg/h") for i in range(5)]
    first, second = (line([0.0, 1.0], [0.0, 1.0], kind="linear", marks=own) for own in (marks[:3], marks[3:]))
    group = (first, second)
    one, two = (drawn(figure, (360, 385), group) for figure in group)
    assert {"1 sensor 0 0.25 deg/h", "3 sensor 2 0.25 deg/h", "c"} <= set(one.labels())
    assert {"1 sensor 3 0.25 deg/h", "2 sensor 4 0.25 deg/h"} <= set(two.labels())
    assert not {"c", "1 sensor 0 0.25 deg/h"} & set(two.labels())


@pytest.mark.parametrize("count", [0, 1, 7, 60])
def test_a_legend_above_a_frame_is_wrapped_and_says_what_is_missing(count):
    rows = [legend.Entry(f"sensor {i} out of family", (1, 2, 3), "mark") for i in range(count)]
    assert len(legend.wrapped([*rows[:9], legend.Entry("long" * 30, (1, 2, 3), "mark")], 500.0)) <= 4
    lines = legend.wrapped(rows, 500.0)
    placed = [entry for line in lines for _, entry in line]
    assert len(lines) <= 4
    for line in lines:
        ends = [at + legend.SAMPLE + 3 * legend.GAP + text_width(entry.text) for at, entry in line]
        assert all(end <= at + 1e-9 for end, (at, _) in zip(ends, line[1:], strict=False))
        assert ends[-1] <= 500.0
    shown = [entry for entry in placed if entry.style]
    assert shown == rows[: len(shown)]
    assert [entry.text for entry in placed if not entry.style] == (
        [f"and {count - len(shown)} more"] if len(shown) < count else []
    )
    assert (len(shown) == count) is (count < 10)


@pytest.mark.parametrize("turned", [False, True])
def test_sigma_is_drawn_over_the_errors(turned, line, drawn):
    curves = [line([1.0, 10.0], [1.0, 2.0], style=style).curves[0] for style in ("faint", "curve")]
    figure = Figure("f", "x", "y", tuple(curves[::-1] if turned else curves))
    order = [name for name in drawn(figure).order if name.startswith("curves")]
    assert order == (["curves/01_c", "curves/00_c"] if turned else ["curves/00_c", "curves/01_c"])


def test_a_band_fills_the_space_between_its_ends(line, drawn):
    figure = line([0.0, 10.0], [1.0, 1.0], kind="linear", style="band", lower=np.array([1.0, 3.0]), upper=np.array([4.0, 4.0]))  # fmt: skip
    paths = drawn(figure)
    columns = paths.strips("curves/00_c")
    width, height = paths.strips("grid")[-1][2]
    x = [c[0][0] for c in columns]
    assert np.diff(x) == pytest.approx(-2 * paths.radii("curves/00_c")[0], rel=1e-4)
    assert columns[0][0][1] > columns[-1][0][1]  # the lower end rises
    assert columns[0][1][1] == pytest.approx(columns[-1][1][1])
    assert 0 <= min(x) <= max(x) <= width
    assert height > 0


def test_labelled_grid_lines_are_brighter(line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 10.0]))
    colors = [color[:3] for color in paths.colors("grid")]
    labels = [label for label in paths.labels() if label.startswith("10")]
    assert colors.count(GRID) == len(labels) == 4
    assert colors.count(SUBGRID) == len(colors) - 4 - 1


@pytest.mark.parametrize(
    ("low", "high", "ends"),
    [(2.0, 4.0, (2.0, 4.0)), (-1.0, 4.0, (0.0, 4.0)), (2.0, 20.0, (2.0, 10.0)), (11.0, 12.0, None), (-2.0, -1.0, None),
     (np.nan, 4.0, None), (2.0, np.inf, None)],
)  # fmt: skip
def test_an_interval_is_cut_at_the_frame(low, high, ends, line):
    frame = Frame(line([0.0, 1.0], [0.0, 10.0], kind="linear", limits=(0.0, 10.0)))
    assert frame.bar(0.5, low, high) == (None if ends is None else [frame.place(0.5, y) for y in ends])
    assert frame.bar(7.0, 1.0, 2.0) is None


def test_an_interval_from_zero_begins_at_the_bottom_of_a_logarithmic_frame(line):
    frame = Frame(line([1.0, 10.0], [1.0, 10.0]))
    (_, bottom), (_, top) = frame.bar(2.0, 0.0, 5.0)
    assert (bottom, top) == (HEIGHT, frame.place(2.0, 5.0)[1])


@pytest.mark.parametrize("y", [[0.0, -1.0], [np.nan, np.inf], [5.0, 5.0]])
def test_figures_survive_values_that_have_no_logarithm(y, line, drawn):
    assert "grid" in drawn(line([1.0, 2.0], y, lower=np.array(y), upper=np.array(y))).lines

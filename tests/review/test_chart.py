from itertools import pairwise

import numpy as np
import pytest

from imuwb.analysis import Curve, Figure, Mark, Vertical
from imuwb.colors import GRID, INK, SUBGRID
from imuwb.review.frame import HEIGHT, WIDTH, Frame


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
    strips = drawn(figure).strips("f/curves/00_c")
    assert len(strips) == 2  # up and out of the frame; then in, down, and out again
    place = Frame(figure).place
    points = [p for s in strips for p in s]
    assert min(p[1] for p in points) == pytest.approx(place(0, 1)[1], abs=1e-3)
    assert max(p[1] for p in points) == pytest.approx(place(0, 0)[1], abs=1e-3)
    assert strips[0][-1] == pytest.approx(place(0.1, 1), abs=1e-3)
    assert strips[1][-1] == pytest.approx(place(3 + 0.5 / 3.5, 0), abs=1e-3)


def test_a_value_that_cannot_be_shown_parts_a_curve(line):
    figure = line([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 0.0, 2.0])
    strips = Frame(figure).strips(figure.curves[0].x, figure.curves[0].y)
    assert [len(strip) for strip in strips] == [2, 1]


@pytest.mark.parametrize("style", ["line", "curve", "points", "fit", "faint"])
def test_styles_have_lines_points_or_both(style, line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], style=style))
    assert ("f/curves/00_c" in paths) == (style != "points")
    assert ("f/curves/00_c/points" in paths) == (style in ("line", "points"))


def test_fits_and_faint_curves_are_thinner_and_paler(line, drawn):
    def look(style):
        paths = drawn(line([1.0, 10.0], [1.0, 2.0], style=style))
        return paths.radii("f/curves/00_c")[0], paths.colors("f/curves/00_c")[0][3]

    order = [look(style) for style in ("faint", "fit", "curve", "line")]
    assert [thickness for thickness, _ in order] == sorted({thickness for thickness, _ in order})
    assert [alpha for _, alpha in order] == [110, 220, 255, 255]


@pytest.mark.parametrize(("at", "inside"), [(2.0, True), (200.0, False), (-1.0, False)])
def test_verticals_and_marks_outside_the_frame_are_left_out(at, inside, line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 2.0], marks=[Mark(at, 1.5, "m", (1, 2, 3))], verticals=[Vertical(at, "v")]))
    assert ("f/verticals/lines" in paths) == inside
    assert ("f/marks/points" in paths) == inside


def test_a_vertical_is_dashed_from_top_to_bottom(line, drawn):
    strips = drawn(line([1.0, 10.0], [1.0, 2.0], verticals=[Vertical(2.0, "v")])).strips("f/verticals/lines")
    ends = [(a[1], b[1]) for a, b in strips]
    assert ends[0] == (0, 7)
    assert all(low - high == 7 for (_, high), (low, _) in pairwise(ends))
    assert HEIGHT - 14 <= ends[-1][0] < HEIGHT


def test_texts_of_neighbouring_verticals_stand_at_four_heights(line, drawn):
    verticals = [Vertical(2.0 + i / 10, f"v{i}") for i in range(5)]
    heights = [y for _, y in drawn(line([1.0, 10.0], [1.0, 2.0], verticals=verticals)).places("f/verticals/texts")]
    assert len(set(heights)) == 4
    assert heights[0] == heights[4]


def test_the_label_of_a_mark_is_above_its_point(line, drawn):
    figure = line([0.0, 100.0], [0.0, 10.0], marks=[Mark(50.0, 5.0, "m", (1, 2, 3))], kind="linear")
    place = Frame(figure).place(50.0, 5.0)
    assert drawn(figure).places("f/marks/texts") == [[place[0], place[1] - 26 - 16]]  # the viewer draws it 16 lower


def test_labels_of_marks_that_hide_each_other_stand_side_by_side(line, drawn):
    def texts(*xs):
        marks = [Mark(x, 5.0, "m", (1, 2, 3)) for x in xs]
        return [
            x for x, _ in drawn(line([0.0, 100.0], [0.0, 10.0], marks=marks, kind="linear")).places("f/marks/texts")
        ]

    scale = WIDTH / 108  # 4 % of the range are free on both sides
    near, far = texts(50.0, 50.0 + 41 / scale), texts(50.0, 50.0 + 43 / scale)
    assert near[1] - near[0] == pytest.approx(41 + 42, abs=0.1)
    assert far[1] - far[0] == pytest.approx(43, abs=0.1)


@pytest.mark.parametrize(("ys", "right"), [([1.0, 1.0, 10.0], False), ([10.0, 1.0, 1.0], True)])
def test_the_legend_is_where_no_curve_is(ys, right, line, drawn):
    (x, y) = drawn(line([0.0, 50.0, 100.0], ys, kind="linear")).places("f/legend/texts")[0]
    assert (x > WIDTH / 2) == right
    assert y < HEIGHT / 4


def test_the_legend_has_room_for_its_longest_name_and_lists_fits_last(drawn):
    x, name = np.array([1.0, 2.0]), "a name of thirty letters......"
    curves = [
        Curve(label, x, x, (1, 2, 3), style=style) for label, style in (("fit", "fit"), (name, "line"), ("", "line"))
    ]
    paths = drawn(Figure("f", "x", "y", tuple(curves)))
    assert paths.labels("f/legend/texts") == [name, "fit"]
    assert paths.colors("f/legend/lines")[0][:3] == (1, 2, 3)
    assert paths.colors("f/legend/lines")[1][:3] == INK
    (begin, end), center = paths.strips("f/legend/lines")[0], paths.places("f/legend/texts")[0][0]
    assert end[0] - begin[0] == 45
    assert abs(center - end[0]) >= 30 * 15 / 2


def test_labelled_grid_lines_are_brighter(line, drawn):
    paths = drawn(line([1.0, 10.0], [1.0, 10.0]))
    colors = [color[:3] for color in paths.colors("f/grid")]
    labels = [label for label in paths.labels("f/texts") if label.startswith("10")]
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
    assert "f/grid" in drawn(line([1.0, 2.0], y, lower=np.array(y), upper=np.array(y)))

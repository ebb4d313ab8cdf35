import pytest

from imuwb.review.figures.drawing import Drawing


def components(archetype, *names):
    return [getattr(archetype, name).as_arrow_array().to_pylist() for name in names]


def test_a_drawing_is_two_entities_and_a_higher_order_is_drawn_over_a_lower(logged):
    sheet = Drawing()
    sheet.line("over", [[(0, 0), (1, 1)]], [(1, 0, 0)], 2.0, 5)
    sheet.area("under", [[(2, 2), (3, 3)]], [(2, 0, 0)], 4.0, 1)
    sheet.line("over too", [[(4, 4), (5, 5)]], [(3, 0, 0)], [0.5], 5)
    sheet.point("mark", [(6, 6)], [(4, 0, 0)], 3.0, 9)
    sheet.point("point", [(7, 7)], [(5, 0, 0)], 1.0, 2)
    sheet.text("names", [((8, 8), "eight")], (6, 0, 0))
    sheet.log(logged, "f")
    assert list(logged) == ["f", "f/texts"]
    lines, points = logged["f"]
    strips, radii, order = components(lines, "strips", "radii", "draw_order")
    assert [strip[0][0] for strip in strips] == [2, 0, 4]  # the viewer draws a later one over an earlier one
    assert radii == [4.0, -2.0, -0.5]  # negative: in points of the screen
    places, over = components(points, "positions", "draw_order")
    assert places == [[7, 7], [6, 6]]
    assert over > order
    (labels,) = components(logged["f/texts"][0], "labels")
    assert labels == ["eight"]


@pytest.mark.parametrize("count", [0, 1])
def test_a_drawing_without_lines_or_texts_has_no_entity_for_them(count, logged):
    sheet = Drawing()
    sheet.line("none", [], [], 1.0)
    sheet.text("texts", [((0, 0), "a")] * count, (1, 2, 3))
    sheet.log(logged, "f")
    assert list(logged) == ["f/texts"] * count

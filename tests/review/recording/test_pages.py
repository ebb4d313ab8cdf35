"""The pages of a tab: nothing is below the fold of a small screen, tables are as wide as their views, figures have room."""

import numpy as np
import pytest
import rerun.blueprint as rrb
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.analysis import Curve, Figure, Table
from imuwb.review.figures.sizes import AREA, TABS_BAR, broken_text, fitted, table_height, table_width, text_width
from imuwb.review.recording.pages import LEAST_FIGURE, Notes, pages

words = st.text("abcdefghij klmnop", min_size=1, max_size=200)


@pytest.fixture
def figure():
    return lambda group="": Figure("f", "x", "y", (Curve("c", np.ones(2), np.ones(2), (1, 2, 3)),), group=group)


def table(rows, cell="2.40 [2.38, 2.43] deg/√h", columns=4, *, wide=False):
    return Table("T", ("heading",) * columns, ((cell,) * columns,) * rows, "a caption", wide)


@pytest.mark.parametrize("figures", [0, 1, 2, 4, 7])
@pytest.mark.parametrize("tables", [(), (3,), (6, 20), (12, 12, 12, 2)])
@pytest.mark.parametrize("series", [0, 2, 4, 9])
def test_every_page_fits_a_small_screen_and_fills_it(figures, tables, series, figure):
    views = [rrb.TimeSeriesView(origin=f"{i}", name=f"s{i}") for i in range(series)]
    parts = pages([figure()] * figures, views, [table(rows) for rows in tables], ["a note"] if tables else [])
    items = [cell.item for page in parts for row in page.rows for cell in row.cells]
    assert len(items) == figures + len(tables) + series + bool(tables)
    height = AREA[1] - (TABS_BAR if len(parts) > 1 else 0)
    for page in parts:
        assert sum(row.least for row in page.rows) == pytest.approx(height)
        for row in page.rows:
            assert sum(cell.width for cell in row.cells) == pytest.approx(AREA[0])
            for cell in row.cells:
                if isinstance(cell.item, Figure):
                    assert row.least >= LEAST_FIGURE
                if isinstance(cell.item, Table):
                    assert row.least >= table_height(cell.item, cell.width)


def test_a_figure_and_its_small_table_share_a_page_and_long_tables_have_their_own(figure):
    short, long = table(6), table(26)
    parts = pages([figure(), figure()], [], [short, long], [])
    assert [page.name for page in parts] == ["Figures", "T"]
    assert [type(cell.item).__name__ for row in parts[0].rows for cell in row.cells] == ["Figure", "Figure", "Table"]


def test_a_table_that_is_higher_than_a_page_goes_on_on_the_next(figure):
    parts = pages([], [], [table(70, columns=6)], [])
    assert [page.name for page in parts] == ["T", "T (2)", "T (3)"]
    tables = [page.rows[0].cells[0].item for page in parts]
    assert sum(len(part.rows) for part in tables) == 70
    assert [part.caption for part in tables] == ["", "", "a caption"]
    assert len(pages([], [], [table(900, columns=6)], [])) == 4


def test_narrow_tables_are_side_by_side_and_notes_follow_the_first(figure):
    (page,) = pages([], [], [table(3, "1", 2), table(3, "1", 2)], ["a note"])
    assert [type(cell.item) for cell in page.rows[0].cells] == [Table, Notes, Table]
    (page,) = pages([], [], [table(3, "1", 2, wide=True), table(3, "1", 2)], [])
    assert len(page.rows) == 2


@pytest.mark.parametrize(("count", "shape"), [(1, [1]), (3, [3]), (4, [4]), (5, [3, 2]), (6, [3, 3]), (7, [4, 3]), (8, [4, 4])])  # fmt: skip
def test_figures_of_a_group_are_small_and_side_by_side(count, shape, figure):
    figures = [figure("errors") for _ in range(count)]
    (page,) = pages(figures, [], [], [])
    assert [len(row.cells) for row in page.rows] == shape
    assert all(cell.group == tuple(figures) for row in page.rows for cell in row.cells)
    assert len({cell.width for row in page.rows for cell in row.cells}) == 1 or count == 5


def test_six_series_are_in_two_columns_the_first_half_on_the_left():
    views = [rrb.TimeSeriesView(origin=f"{i}", name=f"s{i}") for i in range(6)]
    (page,) = pages([], views, [], [])
    assert [[cell.item.name for cell in row.cells] for row in page.rows] == [["s0", "s3"], ["s1", "s4"], ["s2", "s5"]]


@settings(deadline=None)
@given(words, st.floats(60, 900))
def test_a_broken_text_keeps_its_words(text, width):
    lines = broken_text(text, width)
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(text_width(line) <= width for line in lines)


@settings(deadline=None)
@given(st.lists(st.tuples(words, words, words), min_size=1, max_size=4), st.floats(400, 1440))
def test_a_fitted_table_is_no_wider_than_its_view_and_keeps_its_text(rows, width):
    whole = Table("T", ("a", "b", "c"), tuple(rows))
    narrow = fitted(whole, width)
    assert table_width(narrow) <= width + 1
    for i in range(3):
        kept = "".join("".join(row[i] for row in narrow.rows).split())
        assert kept == "".join("".join(row[i] for row in rows).split())

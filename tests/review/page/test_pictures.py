"""Pictures: nothing is lost that a reader would see, odd input is drawn, and files are small."""

import re

import numpy as np
import pytest

from imuwb.analysis import Curve, Figure, Mark, Series, Vertical
from imuwb.colors import BLUE, INK, PALE, PALETTE, RED
from imuwb.review.drawn.calls import Track
from imuwb.review.page.canvas import render
from imuwb.review.page.pictures import described, picture
from imuwb.review.page.small import small, with_classes
from imuwb.review.page.themes import DARK, LIGHT, PAGE, PAPER, contrast, readable
from imuwb.review.page.ticks import number
from imuwb.scene import Span


def line(x, y, scale="linear", **more):
    return Figure(
        "f",
        "x [1]",
        "y [1]",
        (Curve("a", np.asarray(x, float), np.asarray(y, float), BLUE, **more),),
        x_scale=scale,
        y_scale=scale,
    )


def texts(figure):
    return re.findall(r"<text[^>]*>([^<]*)", picture(figure, PAGE, "f-").svg)


def test_tick_labels_and_titles_are_never_rounded():
    small_values = np.linspace(0, 0.004, 5)
    assert "0.004" in texts(line(small_values, small_values))
    assert "x 1.23456" in texts(Figure("t", "x 1.23456", "y", (), x_scale="linear"))


@pytest.mark.parametrize(
    ("value", "text"), [(0.01, "0.01"), (5.0, "5"), (1000, "1000"), (1e5, "10⁵"), (2e-4, "2·10⁻⁴"), (1e-12, "10⁻¹²")]
)
def test_numbers_of_logarithmic_axes(value, text):
    assert number(value) == text


@pytest.mark.parametrize("ends", [(1.0, 1.02), (1.0, 3.0), (0.3, 40), (1e-9, 1e9)])
def test_a_logarithmic_axis_of_any_length_has_two_ticks_or_more(ends):
    shown = texts(
        Figure("t", "x", "y", (Curve("", np.array(ends), np.ones(2), BLUE),), x_limits=ends, y_limits=(0.5, 2.0))
    )
    across = [text for text in shown if text.replace("·", "")[:1].isdigit()]
    assert 4 <= len(across) <= 22


def test_a_curve_of_many_markers_is_one_path():
    svg = picture(line(range(300), range(300), style="points"), PAGE, "f-").svg
    assert "<use" not in svg
    dots = max(re.findall(r'd="([^"]*)"', svg), key=len)
    assert dots.count("M") == 300


def test_relative_paths_do_not_drift():
    x = np.linspace(0, 1, 97)
    svg = picture(line(x, np.sin(7 * x), style="curve"), PAGE, "f-").svg
    long = max(re.findall(r'd="([^"]*)"', svg), key=len)
    steps = [float(n) for n in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", long)]
    raw = re.findall(r'<path d="(M[^"]*)"', render(line(x, np.sin(7 * x), style="curve"), PAGE, "svg").decode())
    last = [float(n) for n in re.findall(r"-?[\d.]+", max(raw, key=len))[-2:]]
    assert sum(steps[::2]) == pytest.approx(last[0], abs=0.06)
    assert sum(steps[1::2]) == pytest.approx(last[1], abs=0.06)


def test_styles_that_drawings_share_are_stated_once():
    css, drawings = with_classes(['<a style="x: 1"/><b style="y: 2"/>', '<c style="x: 1"/>'])
    assert css.splitlines() == [".s0{x: 1}", ".s1{y: 2}"]
    assert drawings == ('<a class="s0"/><b class="s1"/>', '<c class="s0"/>')


def test_a_file_of_matplotlib_becomes_less_than_a_third():
    figure = line(range(1, 40), range(1, 40), "log", lower=np.arange(0.9, 39), upper=np.arange(1.1, 40))
    raw = render(figure, PAGE, "svg").decode()
    assert len(small(raw, "f-", "title", "words")) < len(raw) / 3


@pytest.mark.parametrize("background", [LIGHT, DARK])
def test_every_colour_can_be_told_from_the_background(background):
    for color in (*PALETTE, INK, PALE):
        assert contrast(readable(color, background), background) >= 3
    assert readable(RED, LIGHT) == RED  # it was readable before


def test_odd_input_is_drawn_and_described():
    nothing = np.array([np.nan])
    odd = (
        Figure("none", "x", "y", (Curve("a", nothing, nothing, BLUE), Curve("b", np.empty(0), np.empty(0), RED))),
        Figure("empty", "x", "y", ()),
        line([1.0, 2.0], [-1.0, -2.0], "log"),
        Figure("$x_1$ _name", "$x$", "y $\\frac$", (Curve("_hidden $a$", np.ones(2), np.ones(2), BLUE),)),
        Series("s", "m", np.zeros(1, np.int64), np.zeros((1, 1)), ("a",)),
        Series("s", "m", np.arange(3), np.full((3, 1), np.nan), ("_a",)),
        [Track("t", np.zeros((1, 3)), BLUE)],
    )
    for item in odd:
        assert "<svg" in picture(item, PAGE, "p-").svg
        assert described(item)
    shown = texts(odd[3])
    assert [text.lstrip("\N{ZERO WIDTH SPACE}") for text in shown if "$" in text] == [
        "$x$",
        "y $\\frac$",
        "_hidden $a$",
    ]


def test_a_legend_that_is_apart_has_each_line_mark_and_band():
    x = np.linspace(0, 1, 5)
    curves = (Curve("a $b$", x, x, BLUE), Curve("band", x, x, RED, x, x + 1, style="band"), Curve("", x, x, RED))
    figure = Figure(
        "f", "x [s]", "y [m]", curves, (Mark(0.5, 1.0, "top", RED),), "linear", "linear", (Vertical(0.2, "here"),)
    )
    shown = picture(figure, PAGE, "f-", apart=True)
    assert [label for _, label in shown.legend] == ["a $b$", "band", "here", "top: 1 m at 0.5 s"]
    assert "band" not in re.sub("<desc.*?</desc>", "", shown.svg)
    span = Span(2 * 10**9, 3 * 10**9, "outage", RED)
    series = Series("s", "m", np.arange(5) * 10**9, np.arange(5.0)[:, None], ("a",), spans=(span,))
    assert {label for _, label in picture(series, PAGE, "s-", apart=True).legend} == {"a", "outage"}


@pytest.mark.parametrize(("form", "head"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_a_figure_for_a_paper_is_the_same_file_each_time(form, head, figure):
    first = render(figure(30), PAPER, form)
    assert first.startswith(head)
    assert first == render(figure(30), PAPER, form)

"""The page: whole, without links to others, safe for any text of a log, and readable without a viewer."""

import re
import shutil
import subprocess
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.analysis import Curve, Figure, Mark, Series, Table, Vertical
from imuwb.colors import BLUE, INK, RED
from imuwb.review.drawn import Drawn, Track
from imuwb.review.page.html import page
from imuwb.review.page.svg import POINTS, figure_picture, series_picture, track_picture

CHROMIUM = shutil.which("chromium")
HOSTILE = '<script>alert(1)</script> & "quoted" \x1b[31m'


def figure(points=500):
    x = np.geomspace(0.01, 1000, points)
    curve = Curve("gyro x", x, 1 / np.sqrt(x), BLUE, 0.9 / np.sqrt(x), 1.1 / np.sqrt(x))
    return Figure(
        "Allan deviation",
        "time [s]",
        "deviation [deg/h]",
        (curve,),
        (Mark(1.0, 1.0, "N x", RED),),
        verticals=(Vertical(10, "here"),),
    )


def drawn(text="a note"):
    series = Series(
        "rate", "deg/s", np.arange(10**5) * 10**7, np.random.default_rng(0).normal(0, 1, (10**5, 2)), ("x", "y")
    )
    track = Track(
        "gnss", np.column_stack([np.linspace(0.8, 0.8001, 50), np.linspace(0.1, 0.1002, 50), np.zeros(50)]), INK
    )
    table = Table("Noise", ("axis", "N"), ((text, "2.40 [2.38, 2.43] deg/√h"), ("gyro y", "2.00")), "a caption")
    return [
        Drawn("Overview", series),
        Drawn("Allan", figure()),
        Drawn("Allan", table),
        Drawn("Allan", text),
        Drawn("Track", track),
    ]


def made(text="a note"):
    log = SimpleNamespace(provenance=SimpleNamespace(path=text, format="csv", hash="sha256:1"))
    return page(f"Noise: {text}", ("NOISE  x", text), drawn(text), [log], f"imuwb noise '{text}'", "1.0", "run")


class Elements(HTMLParser):
    def __init__(self, text) -> None:
        super().__init__()
        self.tags, self.ids, self.open = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.ids += [value for name, value in attributes if name == "id"]


def test_a_page_needs_no_other_file_and_its_ids_are_unique():
    text = made()
    assert "default-src 'none'" in text
    addresses = set(re.findall(r"https?://[^\s\"'<]+", text))
    assert addresses <= {"http://www.w3.org/1999/xlink", "http://www.w3.org/2000/svg"}
    ids = Elements(text).ids
    assert len(ids) == len(set(ids))
    for used in re.findall(r"(?:href=\"#|url\(#)([\w.-]+)", text):
        assert used in ids
    assert len(text) < 400_000


def test_the_parts_of_the_answer_come_before_the_overview():
    text = made()
    assert text.index(">Allan</summary>") < text.index(">Track</summary>") < text.index(">Overview</summary>")
    assert text.index("NOISE  x") < text.index("<svg")
    for said in (
        "gyro x",
        "N x: 1 at 1",
        "here",
        "deviation [deg/h]",
        "2.40 [2.38, 2.43] deg/√h",
        "a caption",
        "sha256:1",
        "imuwb noise",
    ):
        assert said in text
    assert text.count("Allan deviation</figcaption>") == 1  # not again in its part


def test_texts_of_a_log_are_texts():
    text = made(HOSTILE)
    assert "<script>alert" not in text
    assert text.count("<script>") == 1
    assert "&lt;script&gt;alert(1)" in text


def test_tick_labels_and_values_are_never_rounded():
    small = Figure(
        "small",
        "x [1]",
        "y [1]",
        (Curve("a", np.linspace(0, 0.004, 5), np.linspace(0, 0.004, 5), BLUE),),
        x_scale="linear",
        y_scale="linear",
    )
    assert "0.004" in figure_picture(small, 0).svg
    assert "1.23456" in figure_picture(Figure("1.23456", "x 1.23456", "y", small.curves), 0).svg


def test_a_long_curve_is_thinned_and_keeps_its_peak():
    x = np.arange(1.0, 100_001.0)
    y = np.ones(x.size)
    y[70_000] = 50.0
    svg = figure_picture(
        Figure("peak", "x", "y", (Curve("a", x, y, BLUE, style="curve"),), y_limits=(0.5, 60.0)), 0
    ).svg
    flat = figure_picture(
        Figure("flat", "x", "y", (Curve("a", x, np.ones(x.size), BLUE, style="curve"),), y_limits=(0.5, 60.0)), 0
    ).svg
    assert len(svg) < 20_000 + 20 * POINTS
    assert svg != flat


def test_odd_input_is_drawn():
    nothing = Figure(
        "none",
        "x",
        "y",
        (Curve("a", np.array([np.nan]), np.array([np.nan]), BLUE), Curve("b", np.empty(0), np.empty(0), RED)),
    )
    assert "<svg" in figure_picture(nothing, 0).svg
    assert "<svg" in figure_picture(Figure("empty", "x", "y", ()), 0).svg
    assert "<svg" in series_picture(Series("s", "m", np.zeros(1, np.int64), np.zeros((1, 1)), ("a",)), 1).svg
    assert "<svg" in track_picture([Track("t", np.zeros((1, 3)), BLUE)], 2).svg


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium on this machine")
def test_a_browser_shows_it_without_a_complaint(tmp_path):
    (tmp_path / "page.html").write_text(made(), "utf-8")
    done = subprocess.run(
        [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run",
         f"--user-data-dir={tmp_path / 'profile'}", "--enable-logging=stderr", "--dump-dom", f"file://{tmp_path}/page.html"],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert "CONSOLE" not in done.stderr
    assert "2.40 [2.38, 2.43]" in done.stdout

"""The page: whole, without links to others, safe for any text of a log, and readable without a viewer."""

import re
from html.parser import HTMLParser

from imuwb.review.page.html import fragment, page, printed, svg_of

HOSTILE = '<script>alert(1)</script> & "quoted" {{ 7 * 7 }} \x1b[31m $x_1$'


class Elements(HTMLParser):
    def __init__(self, text) -> None:
        super().__init__()
        self.tags, self.ids = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.ids += [value for name, value in attributes if name == "id"]

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


def test_a_page_needs_no_other_file_and_its_ids_are_unique(report):
    text = page([report(), report()])
    assert "default-src 'none'" in text
    assert not re.findall(r"https?://", text)
    elements = Elements(text)
    assert len(elements.ids) == len(set(elements.ids))
    for used in re.findall(r"(?:href=\"#|url\(#|labelledby=\"|describedby=\")([\w.-]+)", text):
        assert used in elements.ids


def test_the_answer_comes_first_then_its_figure_and_the_overview_is_last(report):
    text = page([report()])
    order = (
        "1 h still",
        "2.40 [2.38, 2.43]",
        "imuwb psd static.csv",
        "<svg",
        "Allan</h3>",
        "Track</h3>",
        "Overview</h3>",
        "sha256:1",
        "Run f00d",
    )
    places = [text.index(part) for part in order]
    assert places == sorted(places)
    for said in (
        "gyro x",
        "N x: 1 deg/h at 1 s",
        "here",
        "deviation [deg/h]",
        "9.00 m/s/√h",
        "imuwb noise static.csv",
        "95 % intervals",
    ):
        assert said in text
    assert (
        text.count("Allan deviation</figcaption>") == 2
    )  # the answer's figure stands once, the one of the other tab once


def test_what_a_screen_reader_and_a_keyboard_need_is_there(report):
    elements = Elements(page([report()]))
    assert elements.all("html")[0]["lang"] == "en"
    assert len(elements.all("caption")) == len(elements.all("table")) == 2
    assert all(heading["scope"] in ("col", "row") for heading in elements.all("th"))
    pictures = [svg for svg in elements.all("svg") if "aria-hidden" not in svg]
    assert len(pictures) == len(elements.all("figure")) == len(elements.all("figcaption")) == 4
    assert all(svg["role"] == "img" and svg["aria-labelledby"] and svg["aria-describedby"] for svg in pictures)
    assert elements.all("a")[0] == {"class": "skip", "href": "#parts"}


def test_texts_of_a_log_are_texts(report):
    for text in (page([report(HOSTILE)]), printed([report(HOSTILE)]), fragment(report(HOSTILE))):
        assert "<script>alert" not in text
        assert "&lt;script&gt;alert(1)" in text
        assert "{{ 7 * 7 }}" in text
    assert page([report(HOSTILE)]).count("<script>") == 1


def test_a_page_of_several_runs_lists_them_and_states_what_holds_for_all(report):
    text = page([report(), report(analysis="outage", name="drive.csv")], "Two", ("they are of two logs",))
    assert "<title>Two</title>" in text
    for said in ('href="#run-1">Outage: drive.csv', 'id="run-1-title">Outage: drive.csv', "they are of two logs"):
        assert said in text


def test_paper_has_no_folds_no_scripts_and_no_variables_in_figures(report):
    elements, text = Elements(printed([report()])), printed([report()])
    assert not {"details", "script", "button"} & {tag for tag, _ in elements.tags}
    assert all("var(" not in svg for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL))


def test_a_fragment_and_a_figure_stand_alone(report, figure):
    text = fragment(report())
    assert "currentColor" in text
    assert not re.search(r"<path[^>]*class", text)
    assert "2.40 [2.38, 2.43]" in text
    assert svg_of(figure()).startswith("<svg")

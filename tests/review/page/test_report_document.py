"""A report that a recording keeps is the same report again; what was changed by hand is refused."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.analysis import Answer
from imuwb.errors import UnreadableLogError
from imuwb.review.answers.panel import Origin
from imuwb.review.drawn.calls import Drawn
from imuwb.review.page.html import page
from imuwb.review.page.report import report_of
from imuwb.review.page.report_document import _numbers, report_from, text_of


def test_what_is_kept_makes_the_same_page(report):
    once = report_from(text_of(report()), "r.rrd")
    again = report_from(text_of(once), "r.rrd")
    assert page([once]) == page([again])
    assert once.answer.next == report().answer.next


def test_values_keep_four_digits_and_positions_a_centimetre(report):
    first, again = report(), report_from(text_of(report()), "r.rrd")
    for one, two in zip(first.drawn, again.drawn, strict=True):
        assert one.tab == two.tab
    rate, rate_again = first.drawn[0].item, again.drawn[0].item
    assert np.allclose(rate.values, rate_again.values, rtol=5e-4)
    assert (rate.epoch, rate.names, rate.unit) == (rate_again.epoch, rate_again.names, rate_again.unit)
    assert np.abs(rate.time - rate_again.time).max() <= np.ptp(rate.time) / 2000
    track, track_again = first.drawn[3].item.position, again.drawn[3].item.position
    assert np.abs(track - track_again)[:, :2].max() * 6.4e6 < 0.01


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c.pop("drawn"), lambda c: c["drawn"][1].update(kind="other"), lambda c: c["figure"].update(x_scale="none"),
        lambda c: c["figure"]["curves"][0].update(color="red;}"), lambda c: c["figure"]["curves"][0].update(style="x"),
        lambda c: c["figure"].update(curves=0), lambda c: c["figure"].update(x_limits=[1]), lambda c: c.update(sources=[{"file": "x"}]),
        lambda c: c["answer"].update(next=[["one"]]), lambda c: c.update(drawn=None),
    ],
)  # fmt: skip
def test_a_text_that_was_changed_is_refused(change, report):
    content = json.loads(text_of(report()))
    change(content)
    with pytest.raises(UnreadableLogError, match=r"r\.rrd: the page in this recording is damaged"):
        report_from(json.dumps(content), "r.rrd")


def test_a_text_of_another_version_is_named(report):
    text = text_of(report()).replace('"schema":1', '"schema":2', 1)
    with pytest.raises(UnreadableLogError, match="schema 2; this imuwb reads 1"):
        report_from(text, "r.rrd")


def test_a_small_change_of_a_large_value_is_kept():
    around = 9.8066123 + 1e-5 * np.arange(5)
    kept = json.loads(json.dumps(_numbers(around)))
    assert np.abs(np.asarray(kept) - around).max() < 2e-8
    assert _numbers(np.array([np.nan, 1.0, np.inf])) == [None, 1, None]


def test_the_figure_of_the_answer_is_not_shown_again(figure):
    log = SimpleNamespace(provenance=SimpleNamespace(path="a.csv", format="csv", hash="1", selection=""))
    drawn = [Drawn("one", figure()), Drawn("two", figure(30)), Drawn("three", "a note")]
    made = report_of(Answer("all", figure=figure()), Origin("noise", ("a.csv",)), drawn, [log], "run", "1.0")
    assert [one.tab for one in made.drawn] == ["two", "three"]
    assert made.command == "imuwb noise a.csv"

from dataclasses import replace

import pytest

from imuwb.replay import Consistency
from imuwb.review.panel import HEIGHT, Origin, panel
from imuwb_plugins import outage
from imuwb_plugins.outage.answer import believed, sigma_text


def test_the_best_filter_comes_first_with_its_drift(few):
    answer = outage.answer(few)
    (own,) = few.summary
    assert answer.headings == ("filter", "10 s without GNSS", "its sigma is")
    best = (
        own.choice.chosen if own.choice is not None else min(own.models, key=lambda name: own.models[name].median_end)
    )
    assert answer.rows[0][0] == best
    assert {row[0] for row in answer.rows} == set(own.models)
    assert best in answer.sentences[0]
    assert "7 outages" in answer.about
    lines = panel(answer, Origin("outage", ("drive.mcap",), "", ("drive.rrd",)))
    assert len(lines) <= HEIGHT


@pytest.mark.parametrize(
    ("nees", "text", "right"),
    [(1.0, "right", True), (4.0, "2.0 times too small", False), (0.25, "2.0 times too large", False)],
)
def test_a_sigma_is_believed_within_the_interval_of_chance(few, nees, text, right):
    own = next(iter(few.summary[0].models.values()))
    made = replace(own, consistency=(Consistency(10.0, nees, 0.5, 1.6, 0.9, nees**0.5),))
    assert (sigma_text(made), believed(made)) == (text, right)
    assert sigma_text(replace(made, effective_count=4)) == "not to be judged"
    assert believed(replace(made, consistency=())) is None


def test_a_filter_that_cannot_run_is_a_row(few):
    assert ("odd", "cannot run") in outage.answer(replace(few, failed={"odd": "too many states"})).rows

from dataclasses import replace

import pytest

from imuwb.log import AXES
from imuwb.notes import Note
from imuwb.replay import Consistency, MotionNoise
from imuwb.review.answers.panel import HEIGHT, Origin, panel
from imuwb.statistics import Estimate
from imuwb_plugins import outage
from imuwb_plugins.outage.answer import believed, sigma_text
from imuwb_plugins.outage.drives import Drives
from imuwb_plugins.outage.notes import motion_notes


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
    assert (sigma_text(replace(made, consistency=())), believed(replace(made, consistency=()))) == ("not stated", None)


def test_a_filter_that_cannot_run_is_a_row(few):
    answer = outage.answer(replace(few, failed={"odd": "too many states"}))
    assert ("odd", "cannot run") in answer.rows
    assert any("too many states" in sentence for sentence in answer.sentences)


def test_of_several_drives_each_that_a_filter_cannot_run_in_is_named(few):
    drives = {
        "north": replace(few, failed={"odd": "too many states"}),
        "south": replace(few, failed={"odd": "too many states", "kf": "no solution"}),
        "west": replace(few, failed={"odd": "another sensor"}),
    }
    answer = outage.answer(
        Drives(few.summary, drives, (), (Note("drive-left-out", "east is left out: no fixes"),), {}, {})
    )
    assert answer.rows[-2:] == (("odd", "cannot run"), ("kf", "cannot run in south"))
    assert "odd cannot run in north and south: too many states." in answer.sentences
    assert "odd cannot run in west: another sensor." in answer.sentences
    assert "kf cannot run in south: no solution." in answer.sentences
    assert "east is left out: no fixes." in answer.sentences


def with_summary(few, **changed):
    """Return a result in which all filters have these figures."""
    (own,) = few.summary
    return replace(few, summary=(replace(own, models={name: replace(s, **changed) for name, s in own.models.items()}),))


def test_too_few_outages_give_no_interval_no_quantile_and_no_step_that_needs_more(few):
    nan = float("nan")
    answer = outage.answer(with_summary(few, count=1, effective_count=1, median_end_interval=(nan, nan)))
    shown = " ".join([answer.about, *answer.sentences, *(cell for row in answer.rows for cell in row)])
    assert "nan" not in shown
    assert "1 outages" not in shown
    assert "1 in 20" not in shown
    assert not any("--tune" in step.command for step in answer.next)


@pytest.mark.parametrize(("lower", "said"), [(3e-4, True), (0.0, False)])
def test_noise_in_motion_is_stated_only_where_its_interval_shows_it(few, lower, said):
    added = Estimate(1e-3, lower, 2e-3, unit="rad/s/√Hz")
    factors = {axis: Estimate(5.0, 2.0 if said else 1.0, 9.0) for axis in AXES}
    motion = MotionNoise(
        (added, added), (added, added), (added, added), dict.fromkeys(AXES, 2e-4), factors, 0.0, 0.0, 0.0, 100, 5
    )
    sentences = " ".join(outage.answer(replace(few, motion=motion)).sentences)
    assert ("gyros are 5 times" in sentences) == said
    assert (motion.noisier("gyro") is not None) == said
    assert bool([note for note in motion_notes(motion) if note.id == "motion-noise"]) == said

"""The options of the start: a stated heading, its sigma, and the speed that gives a heading."""

import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb_plugins import outage

from .made import stated


def run(log, toml, **options):
    return outage.run([log], stated(error_model=toml, models="none", at="150:10", **options))


def test_a_stated_heading_is_that_of_the_start(log, toml):
    truth = log.references[0].attitude[0, 2] * 57.29577951308232
    found = run(log, toml, heading=f"{truth:.3f}", heading_sigma=2.0)
    assert "heading-stated" in ids(found.notes)
    (start,) = (note for note in found.notes if ids((note,))[0].startswith("alignment"))
    assert "sigma 2 deg" in start


def test_a_fast_drive_needs_no_word_on_its_heading(log, toml):
    assert not {"heading-stated", "heading-searched", "heading-of-course"} & set(ids(run(log, toml).notes))


def test_a_higher_speed_starts_later(log, toml):
    def start(**options):
        return next(note for note in run(log, toml, **options).notes if ids((note,))[0].startswith("alignment"))

    assert start() != start(start_speed=9.0)


def test_a_sigma_without_a_heading_is_refused(log, toml):
    with pytest.raises(UsageError, match="--heading DEG"):
        run(log, toml, heading_sigma=2.0)

"""Progress is reported in shares of the whole, never backwards, and only while a function listens."""

import pytest

from imuwb.progress import tracked, watched


def test_items_are_the_same_whether_watched_or_not():
    assert list(tracked(iter("abc"), 3)) == ["a", "b", "c"]
    with watched(lambda _: None):
        assert list(tracked(iter("abc"), 3)) == ["a", "b", "c"]


def test_inner_work_is_a_part_of_its_item():
    seen = []
    with watched(seen.append):
        for _ in tracked(range(2), 2):
            for _ in tracked(range(4), 4):
                pass
    assert seen == pytest.approx([1 / 8, 2 / 8, 3 / 8, 4 / 8, 4 / 8, 5 / 8, 6 / 8, 7 / 8, 1, 1])


def test_nothing_is_reported_after_the_watch():
    seen = []
    with watched(seen.append):
        pass
    list(tracked(range(3), 3))
    assert seen == []


def test_an_error_inside_leaves_the_outer_watch_in_place():
    seen = []
    with watched(seen.append):
        for _ in tracked(range(2), 2):
            try:
                for _ in tracked(range(2), 2):
                    int("no number")
            except ValueError:
                pass
    assert seen[-1] == 1
    assert seen == sorted(seen)

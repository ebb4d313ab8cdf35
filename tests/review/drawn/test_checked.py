"""Mistakes of a plugin's draw and run: each is an error that names the place and the remedy."""

import numpy as np
import pytest

from imuwb.analysis import Curve, Figure, Series, Table
from imuwb.review.answers.document import document, plain
from imuwb.review.drawn.calls import Track
from imuwb.review.drawn.checked import check

X = np.arange(4.0)
RED = (200, 0, 0)


def figure(*curves):
    return Figure("Jerk", "share [1]", "jerk [m/s³]", curves)


@pytest.mark.parametrize(
    ("item", "words"),
    [
        (figure(Curve("z", X, X[:3], RED)), "figure 'Jerk', curve 'z': x has 4 points and y has 3"),
        (figure(Curve("z", X, X, RED), Curve("", X, X, RED, upper=X[:2])), "curve 2: x has 4 points and upper has 2"),
        (figure(Curve("z", X, X[:, None], RED)), r"y has the shape \(4, 1\)"),
        (Series("Rate", "deg/s", X.astype(int), X[:3, None], ("x",)), "time has 4 rows"),
        (Series("Rate", "deg/s", X.astype(int), X, ("x",)), r"values \(n, k\)"),
        (Series("Rate", "deg/s", X.astype(int), X[:, None], ("x", "y")), "1 columns and names has 2"),
        (Table("Jerk", ("share", "exceeds"), (("50 %", 3.2),)), "row 1, column 'exceeds': 3.2 is of the type float; a cell is a text"),
        (Table("Jerk", ("share",), (("50 %", "3 m"),)), "2 cells, and there are 1 headings"),
        (Track("gnss", np.zeros((3, 2)), RED), r"give \(n, 3\)"),
        (3, "the note 3 is no text"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_named(item, words):
    with pytest.raises(ValueError, match=words):
        check(item)


def test_what_can_be_drawn_passes():
    for item in (
        figure(Curve("z", X, X, RED, X, X)), Series("Rate", "deg/s", X.astype(int), X[:, None], ("x",)),
        Table("Jerk", ("share", "exceeds"), (("50 %",),)), Track("gnss", np.zeros((0, 3)), RED), "a note",
    ):  # fmt: skip
        check(item)


@pytest.mark.parametrize(
    ("value", "place"),
    [({"a": [1, lambda: 1]}, r"result\['a'\]\[1\]"), ({"b": object()}, r"result\['b'\]"), ((x for x in ()), "result"), (int, "result")],
)  # fmt: skip
def test_a_result_that_json_cannot_hold_is_named_with_its_field(value, place):
    with pytest.raises(ValueError, match=rf"^{place} is of the type \w+, which JSON cannot hold; make it"):
        document("jerk", "1", {}, value, (), ())


def test_a_value_with_a_text_of_its_own_is_that_text(tmp_path):
    assert plain({"path": tmp_path, "unit": np.datetime64("2024-01-01")}) == {
        "path": str(tmp_path),
        "unit": "2024-01-01",
    }

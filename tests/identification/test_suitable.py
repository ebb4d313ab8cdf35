import numpy as np
import pytest

from imuwb.identification.suitable import longest_part, unsuitable


@pytest.mark.parametrize(
    ("breaks", "expected"), [([], (0, 100)), ([10], (10, 100)), ([10, 30, 90], (30, 90)), ([60, 70], (0, 60))]
)
def test_the_longest_part(breaks, expected):
    part = longest_part(np.zeros(100), breaks)
    assert (part.start, part.stop) == expected


def test_of_parts_as_long_the_first_is_taken():
    assert longest_part(np.zeros(100), [50]) == slice(0, 50)


def test_a_usable_series_has_nothing_against_it():
    assert unsuitable(np.arange(64.0), 64) is None


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (np.arange(63.0), "63 samples; it takes 64"),
        (np.full(64, 9.81), "constant"),
        (np.append(np.zeros(63), -2e12), "2e[+]12"),
    ],
)
def test_what_is_against_a_series(values, reason):
    import re

    assert re.search(reason, unsuitable(values, 64))

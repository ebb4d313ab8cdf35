import re

import numpy as np
import pytest

from imuwb.identification.record.suitable import unsuitable


def test_a_usable_series_has_nothing_against_it():
    assert unsuitable(np.arange(64.0), 64) is None


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (np.arange(63.0), "63 samples; .* 64"),
        (np.full(64, 9.81), "constant"),
        (np.append(np.zeros(63), -2e12), "2e[+]12"),
    ],
)
def test_what_is_against_a_series(values, reason):
    assert re.search(reason, unsuitable(values, 64))

from dataclasses import replace

import numpy as np
import pytest

from imuwb.identification import allan
from imuwb.identification.allan_variance.problem import Problem
from imuwb.identification.allan_variance.term_selection import first_time, select
from imuwb.stochastic import WhiteNoise


def bent(factor):
    """Return the exact Allan curve of white noise, nine octaves, the first of which a filter has lowered."""
    curve = allan(np.random.default_rng(0).standard_normal(512), 1.0)
    deviation = np.sqrt(WhiteNoise(1.0).allan_variance(curve.averaging_time, 1.0))
    deviation[0] *= factor
    return Problem.of(replace(curve, deviation=deviation), np.arange(9), ())


@pytest.fixture(scope="module")
def cuts():
    """Return (chi-square, times left out) for ever lower first octaves."""
    problems = [bent(factor) for factor in np.linspace(1, 0.7, 46)]
    return [(p.misfit(select(p, 0.95)[0])[0], first_time(p)) for p in problems]


@pytest.mark.slow
def test_a_time_is_left_out_if_that_reduces_chi_square_by_twice_15(cuts):
    kept, left = ([first for chi2, first in cuts if low < chi2 < high] for low, high in ((24, 29), (33, 60)))
    assert len(kept) >= 2
    assert not any(kept)
    assert len(left) >= 2
    assert set(left) == {1}


def test_an_exact_curve_is_explained_with_all_its_times(cuts):
    chi2, first = cuts[0]
    assert chi2 < 1e-9
    assert first == 0

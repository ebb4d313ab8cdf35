import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.log import SECOND
from imuwb.review.drawn.envelope import SPANS, envelope


@settings(deadline=None)
@given(st.integers(1, 30_000), st.integers(0, 2**32 - 1))
def test_an_envelope_keeps_every_extreme(n, seed):
    values = np.random.default_rng(seed).standard_normal((n, 2))
    time, shown = envelope(np.arange(n, dtype=np.int64) * 1000, values, spans=100)
    assert time.size <= 300
    assert (np.diff(time) > 0).all()
    np.testing.assert_array_equal(np.nanmax(shown, axis=0), values.max(axis=0))
    np.testing.assert_array_equal(np.nanmin(shown, axis=0), values.min(axis=0))


def test_two_rows_a_span_stay_as_they_are():
    time, values = np.arange(2 * SPANS + 1) * SECOND, np.arange(2.0 * SPANS + 1)[:, None]
    assert SPANS == 700
    assert envelope(time[:-1], values[:-1])[1].tolist() == values[:-1].tolist()
    assert len(envelope(time, values)[0]) < len(time)


@pytest.mark.parametrize(
    ("step", "gap", "broken"), [(1.0, 10.5, True), (1.0, 9.5, False), (0.01, 1.1, True), (0.01, 0.9, False)]
)
def test_a_gap_of_ten_steps_and_one_second_is_a_break_in_the_line(step, gap, broken):
    seconds = np.concatenate([np.arange(10) * step, 9 * step + gap + np.arange(10) * step])
    time, shown = envelope((seconds * SECOND).astype(np.int64), np.ones((20, 1)))
    assert np.flatnonzero(np.isnan(shown[:, 0])).tolist() == [10] * broken
    assert (np.diff(time) > 0).all()

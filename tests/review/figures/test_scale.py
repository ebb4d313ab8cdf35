import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from imuwb.review.figures.scale import Scale

sizes = st.floats(-1e9, 1e9, allow_subnormal=False)


@given(st.lists(sizes, min_size=1, max_size=20))
def test_a_linear_axis_contains_all_values_in_order(values):
    scale = Scale.around("linear", [np.array(values)], None)
    places = [scale.position(v) for v in sorted(values)]
    assert places == sorted(places)
    assert -1e-9 <= places[0] <= places[-1] <= 1 + 1e-9


@given(st.lists(st.floats(1e-12, 1e12), min_size=1, max_size=20))
def test_a_logarithmic_axis_contains_all_values_and_at_least_a_decade(values):
    scale = Scale.around("log", [np.array(values)], None)
    assert scale.high - scale.low >= 1 - 1e-9
    places = [scale.position(v) for v in sorted(values)]
    assert places == sorted(places)
    assert places[0] > 0
    assert places[-1] < 1


@pytest.mark.parametrize("logs", [1, 2, 3, 8, 40])
def test_an_axis_that_counts_has_whole_numbers_only(logs):
    ticks = Scale.around("whole", [], (0.5, logs + 0.5)).ticks()
    assert [t.label for t in ticks] == [str(int(t.label)) for t in ticks]
    assert 1 <= int(ticks[0].label) <= int(ticks[-1].label) <= logs


@given(st.floats(-1e3, 1e3), st.floats(1, 1e5))
def test_linear_ticks_are_round_and_evenly_spaced_and_their_labels_are_true(low, span):
    scale = Scale.around("linear", [], (low, low + span))
    ticks = scale.ticks()
    assert 3 <= len(ticks) <= 11
    steps = np.diff([t.at for t in ticks])
    np.testing.assert_allclose(steps, steps[0], rtol=1e-6)
    step = steps[0] * span
    mantissa = step / 10 ** math.floor(math.log10(step) + 1e-9)
    assert min(abs(mantissa - m) for m in (1, 2, 5, 10)) < 1e-6
    for tick in ticks:
        assert 0 - 1e-9 <= tick.at <= 1 + 1e-9
        assert float(tick.label) == pytest.approx(low + tick.at * span, rel=5.1e-3, abs=1e-6 * span)


@pytest.mark.parametrize(
    ("limits", "labels"),
    [((0, 10), ["0", "2", "4", "6", "8", "10"]), ((-1, 1), ["-1.0", "-0.5", "0.0", "0.5", "1.0"]),
     ((0, 0.3), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"])],
)  # fmt: skip
def test_linear_labels(limits, labels):
    assert [t.label for t in Scale.around("linear", [], limits).ticks()] == labels


@pytest.mark.parametrize(
    ("limits", "labels"),
    [
        ((0.4, 3.0), ["0.5", "1", "2"]),
        ((30.0, 700.0), ["50", "100", "200", "500"]),
        ((4e-6, 3e-5), ["5·10⁻⁶", "10⁻⁵", "2·10⁻⁵"]),
        ((1.0, 10.0), ["10⁰", "10¹"]),
    ],
)
def test_an_axis_of_one_decade_has_more_labels_than_one(limits, labels):
    assert [t.label for t in Scale.around("log", [], limits).ticks() if t.label] == labels


def test_decades_are_labelled_and_their_digits_are_not():
    ticks = Scale.around("log", [], (0.1, 100)).ticks()
    assert [t.label for t in ticks if t.label] == ["10⁻¹", "10⁰", "10¹", "10²"]
    assert [t.at for t in ticks if t.label] == pytest.approx([0, 1 / 3, 2 / 3, 1])
    assert len(ticks) == 28
    assert ticks[1].at == pytest.approx(math.log10(2) / 3)


def test_positions():
    log, linear = Scale.around("log", [], (1, 100)), Scale.around("linear", [], (-2, 2))
    assert [log.position(v) for v in (1, 10, 100)] == pytest.approx([0, 0.5, 1])
    assert [linear.position(v) for v in (-2, 0, 3)] == pytest.approx([0, 0.5, 1.25])


def test_values_without_a_position():
    log, linear = Scale("log", 0, 1), Scale("linear", 0, 1)
    assert [log.shows(v) for v in (1.0, 0.0, -1.0, math.nan, math.inf)] == [True, False, False, False, False]
    assert [linear.shows(v) for v in (1.0, 0.0, -1.0, math.nan, math.inf)] == [True, True, True, False, False]


@pytest.mark.parametrize("kind", ["log", "linear"])
@pytest.mark.parametrize(
    "parts", [[], [None], [np.array([])], [np.array([np.nan, np.inf])], [np.array([3.0])], [np.zeros(2)]]
)
def test_an_axis_always_has_an_extent(kind, parts):
    scale = Scale.around(kind, parts, None)
    assert scale.high > scale.low
    assert scale.ticks()


@pytest.mark.parametrize(
    ("kind", "values", "ends"),
    [
        ("linear", [0.0, 100.0], (-4.0, 104.0)),
        ("linear", [-50.0, -50.0], (-55.0, -45.0)),
        ("linear", [0.0], (-1.0, 1.0)),
        ("log", [1.0, 1000.0], (-1 / 3, 10 / 3)),
        ("log", [1.7, 60.0], (0.0, 2.0)),
        ("log", [2.0, 3.0], (-1 / 6, 5 / 6)),
        ("log", [10 ** (1.3 / 3), 10 ** (4.7 / 3)], (1 / 3, 5 / 3)),
    ],
)
def test_an_axis_has_some_air_on_both_sides(kind, values, ends):
    scale = Scale.around(kind, [np.array(values)], None)
    assert (scale.low, scale.high) == pytest.approx(ends)


def test_limits_are_kept_as_they_are():
    assert Scale.around("linear", [np.array([7.0])], (1.0, 2.0)) == Scale("linear", 1.0, 2.0)
    assert Scale.around("log", [np.array([7.0])], (0.1, 100.0)) == Scale("log", -1.0, 2.0)


@pytest.mark.parametrize(("span", "count"), [(9.0, 10), (9.1, 5), (1.0, 6), (2.5, 6), (45.0, 10)])
def test_a_linear_axis_has_at_most_nine_steps(span, count):
    assert len(Scale("linear", 0.0, span).ticks()) == count


@pytest.mark.parametrize(("value", "inside"), [(0.0, True), (10.0, True), (10.0 + 1e-9, True), (10.1, False), (-0.1, False), (math.nan, False)])  # fmt: skip
def test_rounding_puts_no_value_outside(value, inside):
    assert Scale("linear", 0.0, 10.0).contains(value) == inside


@pytest.mark.parametrize(
    ("low", "span", "label"), [(0.0, 6e-4, "0.0001"), (0.0, 6e-5, "1e-05"), (9e5, 60.0, "900010"), (2e6, 60.0, "2.00001e+06"), (0.0, 6e-6, "1e-06"), (2e6, 6.0, "2000001"), (999_990.0, 6.0, "999991")]
)  # fmt: skip
def test_labels_of_small_and_large_values(low, span, label):
    assert label in [tick.label for tick in Scale("linear", low, low + span).ticks()]

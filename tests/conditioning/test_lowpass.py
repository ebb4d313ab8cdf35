import itertools

import numpy as np
import pytest

from imuwb.conditioning import design_lowpass


def delay_of(lowpass, f):
    """Return how late a slow sine comes, by its phase."""
    t = np.arange(int(40 / f * lowpass.rate)) / lowpass.rate
    sine = np.sin(2 * np.pi * f * t)[:, None]
    out = lowpass.apply(sine)[:, 0]
    late = t[-out.size :]
    periods = int(late.size / lowpass.rate * f)
    rows = slice(late.size - round(periods / f * lowpass.rate), None)
    phase = np.angle(np.sum(out[rows] * np.exp(-2j * np.pi * f * late[rows]))) + np.pi / 2
    return -phase / (2 * np.pi * f)


@pytest.mark.parametrize(
    ("rate", "part", "order"), list(itertools.product([50.0, 1000.0], [0.05, 0.2, 0.45], [1, 2, 4]))
)
def test_a_butterworth_is_3_db_down_at_its_cutoff(rate, part, order):
    lowpass = design_lowpass(rate, part * rate, order=order)
    gain = np.abs(lowpass.response(np.array([1e-5 * rate, part * rate])))
    assert gain == pytest.approx([1, 0.5**0.5], rel=1e-4)
    assert lowpass.delay > 0


def test_a_higher_order_falls_faster():
    gains = [abs(design_lowpass(100.0, 10.0, order=k).response(np.array([30.0]))[0]) for k in (1, 2, 4, 8)]
    assert gains == sorted(gains, reverse=True)


@pytest.mark.parametrize(
    ("kind", "order"), [("butterworth", 1), ("butterworth", 2), ("butterworth", 4), ("moving-average", 2)]
)
def test_the_declared_delay_is_the_measured_one(kind, order):
    lowpass = design_lowpass(100.0, 8.0, kind, order)
    assert delay_of(lowpass, 0.1) == pytest.approx(lowpass.delay, rel=2e-3)


def test_the_3dm_gx3_25s_filter_is_15_samples_wide():
    lowpass = design_lowpass(1000.0, 29.5, "moving-average")
    assert lowpass.width == 15
    assert lowpass.delay == pytest.approx(0.007)
    assert abs(lowpass.response(np.array([29.5]))[0]) == pytest.approx(0.5**0.5, rel=0.01)
    x = np.random.default_rng(0).standard_normal((200, 3))
    out = lowpass.apply(x)
    assert out.shape == (186, 3)
    np.testing.assert_allclose(out[50], x[50:65].mean(axis=0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("kind", "cutoff"), [("butterworth", 3.0), ("butterworth", 20.0), ("moving-average", 3.0)])
def test_what_is_left_has_settled_and_no_more_is_left_out(kind, cutoff):
    lowpass = design_lowpass(50.0, cutoff, kind)
    step = np.zeros((3 * lowpass.settling + 10, 1))
    step[1:] = 1
    out = lowpass.apply(step)
    assert out.shape[0] == step.shape[0] - lowpass.settling
    np.testing.assert_allclose(out[1:], 1, rtol=0, atol=1.1e-6)
    level = np.full((lowpass.settling + 20, 3), [9.8, -1.0, 0.0])
    np.testing.assert_allclose(lowpass.apply(level), level[:20], rtol=0, atol=1e-9)


def test_no_output_knows_of_later_samples():
    lowpass = design_lowpass(100.0, 10.0)
    x = np.random.default_rng(1).standard_normal((400, 2))
    changed = x.copy()
    changed[300:] += 5
    was, now = lowpass.apply(x), lowpass.apply(changed)
    np.testing.assert_array_equal(was[: 300 - lowpass.settling], now[: 300 - lowpass.settling])
    assert (was[300 - lowpass.settling] != now[300 - lowpass.settling]).all()


def test_a_moving_average_of_one_sample_is_refused():
    with pytest.raises(ValueError, match="at most 29.5 Hz"):
        design_lowpass(100.0, 45.0, "moving-average")


def test_a_moving_average_says_where_its_3_db_really_lie():
    lowpass = design_lowpass(100.0, 20.0, "moving-average")
    assert lowpass.width == 2
    assert lowpass.cutoff == pytest.approx(22.1, abs=0.1)


@pytest.mark.parametrize("cutoff", [0, -1, 50, 50.1, float("nan"), float("inf")])
@pytest.mark.parametrize("kind", ["butterworth", "moving-average"])
def test_a_cutoff_beyond_nyquist_is_told(cutoff, kind):
    with pytest.raises(ValueError, match="below half the rate, 50 Hz"):
        design_lowpass(100.0, cutoff, kind)


@pytest.mark.parametrize("order", [0, 9])
def test_an_order_that_cannot_be_is_told(order):
    with pytest.raises(ValueError, match=f"order is {order}; it must be 1 to 8"):
        design_lowpass(100.0, 10.0, order=order)


def test_it_has_settled_where_the_slowest_mode_has_a_ten_millionth_left():
    pole = (1 - np.tan(np.pi * 0.1)) / (1 + np.tan(np.pi * 0.1))  # of first order, by the bilinear transform
    settling = design_lowpass(100.0, 10.0, order=1).settling - 1  # and one sample for each order
    assert pole**settling <= 1e-7 < pole ** (settling - 1)

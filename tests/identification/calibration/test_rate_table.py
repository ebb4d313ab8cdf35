import numpy as np
import pytest
from scipy import stats

from imuwb.identification.calibration import Means, RateRun, TableConditions, matched, rate_table, turned_axis
from imuwb.identification.calibration.rate_table import _earth_across, _joined
from imuwb.stochastic import AxisModel, ImuErrorModel, shown

G, RANGE, SIGMA = 9.81, np.radians(250), 1e-6
RATES = np.radians([10.0, 50.0, 100.0])
BOTH = np.concatenate([[0], RATES, [0], -RATES, [0]])


def make(leak):
    rng = np.random.default_rng(2)
    axes = {
        f"gyro_{k}": AxisModel(
            bias=float(rng.normal(0, 0.3)), scale_factor=float(rng.normal(0, 0.02)), scale_factor_nonlinear=0.002, range=RANGE,
            cross_coupling=tuple(0.01 * rng.standard_normal(2)), g_sensitivity=tuple(leak * rng.standard_normal(3)),
        )
        for k in "xyz"
    }  # fmt: skip
    return ImuErrorModel("made", axes)


def run(model, axis, rates=BOTH, *, offset=0.0, gain=1.0, up=1.0, name="run", sigma=SIGMA, rng=None):
    direction = np.eye(3)[axis]
    force = np.broadcast_to(up * G * direction, (rates.size, 3))
    value = gain * shown(model, (np.outer(rates, direction), force), None)[0] + offset
    if rng is not None:
        value = value + sigma * rng.standard_normal(value.shape)
    means = Means(value, np.full(value.shape, sigma**2), np.full(3, 3.0 * rates.size), (False, False, False))
    return RateRun(name, axis, rates, np.full(rates.size, 20.0), means, up)


def free(**options):
    return TableConditions(latitude=0.0, full_range=RANGE, **options)


def test_three_runs_give_all_of_it():
    model = make(0.0)
    found = rate_table([run(model, axis) for axis in range(3)], free())
    for k, c in zip("xyz", found.axes, strict=True):
        true = model.axes[f"gyro_{k}"]
        assert c.bias.value == pytest.approx(true.bias, rel=1e-9)
        assert c.scale_factor.value == pytest.approx(true.scale_factor, rel=1e-9)
        assert c.scale_factor_nonlinear.value == pytest.approx(0.002, rel=1e-9)
        assert [e.value for e in c.cross_coupling] == pytest.approx(list(true.cross_coupling), rel=1e-9)
    assert all(np.abs(r.residual).max() < 1e-12 for r in found.runs)


def test_one_run_gives_its_axis_and_couplings_into_the_others():
    found = rate_table([run(make(0.0), 2)], free())
    x, y, z = found.axes
    assert z.scale_factor is not None
    assert (x.scale_factor, y.scale_factor) == (None, None)
    assert [e is not None for e in x.cross_coupling] == [False, True]
    assert [e is not None for e in z.cross_coupling] == [False, False]


def test_one_rate_leaves_the_non_linear_part_out():
    model, rates = make(0.0), np.array([0.0, 1.0, -1.0, 0.0])
    found = rate_table([run(model, 0, rates)], free()).axes[0]
    assert found.scale_factor_nonlinear is None
    true = model.axes["gyro_x"]
    assert found.scale_factor.value == pytest.approx(true.scale_factor + 0.002 / RANGE, rel=1e-9)


def test_g_sensitivity_is_in_the_bias_and_in_its_interval():
    """Of three offsets, t with two degrees of freedom."""
    model = make(1e-3)
    found = rate_table([run(model, axis) for axis in range(3)], free())
    true = model.axes["gyro_x"]
    offsets = true.bias + G * np.array(true.g_sensitivity)
    assert found.axes[0].bias.value == pytest.approx(offsets.mean())
    half = stats.t.ppf(0.975, 2) * offsets.std(ddof=1) / 3**0.5
    assert found.axes[0].bias.upper - found.axes[0].bias.value == pytest.approx(half)
    assert [r.offset[0].value for r in found.runs] == pytest.approx(list(offsets))


def test_the_mounting_is_in_the_cross_couplings_interval_alone():
    model = make(0.0)
    plain = rate_table([run(model, 0)], free()).axes
    tilted = rate_table([run(model, 0)], free(misplacement=0.001)).axes
    assert plain[1].cross_coupling[0].sigma < 1e-5
    assert tilted[1].cross_coupling[0].sigma == pytest.approx(0.001, rel=1e-3)
    assert tilted[0].scale_factor == plain[0].scale_factor


def test_the_earths_rate_is_taken_off_by_the_way_that_is_up():
    earth = 7.292115e-5 * np.sin(0.8)
    model = make(0.0)
    for up in (1.0, -1.0):
        seen = run(model, 2, offset=np.array([0, 0, up * earth * (1 + model.axes["gyro_z"].scale_factor)]), up=up)
        found = rate_table([seen], TableConditions(0.8, full_range=RANGE, forces_known=True)).axes[2]
        assert found.bias.value == pytest.approx(model.axes["gyro_z"].bias, abs=0.03 * earth)
        unknown = rate_table([seen], TableConditions(None, full_range=RANGE)).axes[2]
        assert unknown.bias.sigma == pytest.approx(7.292115e-5 * 0.5**0.5, rel=0.01)


def test_intervals_hold():
    rng, model = np.random.default_rng(7), make(0.0)
    inside = []
    for _ in range(200):
        found = rate_table([run(model, 0, sigma=1e-5, rng=rng)], free()).axes[0]
        true = model.axes["gyro_x"]
        pairs = (
            (found.scale_factor, true.scale_factor),
            (found.scale_factor_nonlinear, 0.002),
            (found.bias, true.bias),
        )
        inside += [e.lower <= t <= e.upper for e, t in pairs]
    assert 0.93 <= np.mean(inside) <= 0.99


def test_steps_of_one_rate_leave_it_open():
    with pytest.raises(ValueError, match="1 different rates"):
        rate_table([run(make(0.0), 0, np.ones(3))], free())


def levels(rates, gain=1.0, offset=0.0, axis=1):
    values = 0.001 * np.random.default_rng(0).standard_normal((rates.size, 3))
    values[:, axis] += gain * rates + offset
    return values


@pytest.mark.parametrize(
    "rates",
    [
        BOTH,
        np.random.default_rng(1).permutation(np.repeat(BOTH, 2)),
        np.concatenate([RATES, -RATES]),
        np.concatenate([[0], RATES]),
        np.concatenate([-RATES, [0]]),
        RATES,
    ],
)
@pytest.mark.parametrize(("gain", "offset"), [(1.0, 0.0), (1.03, -0.35), (0.97, 0.35)])
def test_steps_are_matched_whatever_their_order_and_offset(rates, gain, offset):
    found = matched(levels(rates, gain, offset), RATES.tolist(), "run", raw=False)
    assert found.axis == 1
    np.testing.assert_allclose(found.rate, rates)


def test_counts_are_matched_by_their_order():
    found = matched(levels(BOTH, 7500.0, 32768.0), RATES.tolist(), "run", raw=True)
    np.testing.assert_allclose(found.rate, BOTH)
    with pytest.raises(ValueError, match="match the given rates"):
        matched(levels(BOTH, 7500.0, 32768.0), RATES.tolist(), "run", raw=False)


@pytest.mark.parametrize("degrees", [[10.0, 50.0], [10.0, 50.0, 90.0], [10.0, 20.0, 50.0, 100.0], []])
def test_other_rates_are_not_matched(degrees):
    with pytest.raises(ValueError, match="run: the steps of gyro y do not match the given rates"):
        matched(levels(BOTH), np.radians(degrees).tolist(), "run", raw=False)


def test_two_axes_that_turn_are_refused():
    values = levels(BOTH, axis=0) + levels(BOTH, axis=2)
    with pytest.raises(ValueError, match="gyro . and gyro . both turn"):
        turned_axis(values, "run")


@pytest.mark.parametrize(("apart", "variance"), [(2.2, 0.5), (3.2, 0.5 * 3.2**2 / 2)])
def test_runs_that_disagree_widen_their_common_interval(apart, variance):
    """At 5 %, chi-square of one degree allows 3.84, the square of 2.77 standard deviations of a difference."""
    assert _joined([(0.0, 1.0, 1e6), (apart, 1.0, 1e6)], 0.95).sigma == pytest.approx(variance**0.5)


def test_the_earths_horizontal_rate_turns_with_the_table():
    means = Means(np.zeros((2, 3)), np.ones((2, 3)), np.ones(3), (False, False, False))
    still_and_turning = RateRun("run", 0, np.array([0.0, 1.0]), np.full(2, 20.0), means, 1.0)
    found = _earth_across(still_and_turning, free())
    np.testing.assert_allclose(found, 7.292115e-5**2 / 2 * np.array([1.0, 0.01]))


def test_a_mounting_error_counts_with_the_gain():
    tilted = rate_table([run(make(0.0), 0, gain=100.0), run(make(0.0), 1, gain=100.0)], free(misplacement=0.001)).axes
    assert tilted[1].cross_coupling[0].sigma == pytest.approx(0.1, rel=0.1)


def test_equal_offsets_are_no_better_than_their_noise():
    found = rate_table([run(make(0.0), axis, sigma=1e-3) for axis in range(3)], free()).axes[0]
    assert found.bias.sigma == pytest.approx(1e-3 / 9**0.5 / 3**0.5, rel=0.01)  # of nine steps and three runs


@pytest.mark.parametrize(("share", "allowed"), [(0.25, True), (0.35, False)])
def test_another_axis_may_show_three_tenths_of_the_rate(share, allowed):
    mean = np.outer(BOTH, [share, 1.0, 0.0])
    if allowed:
        assert turned_axis(mean, "run") == 1
        return
    with pytest.raises(ValueError, match="gyro y and gyro x both turn"):
        turned_axis(mean, "run")


@pytest.mark.parametrize(
    ("off", "gain", "allowed"),
    [
        (0.008, 1.0, True),
        (0.015, 1.0, False),
        (0.0, 1.9, True),
        (0.0, 2.1, False),
        (0.0, 0.55, True),
        (0.0, 0.45, False),
    ],
)
def test_steps_may_miss_the_line_by_a_hundredth_and_the_gain_one_by_a_factor_of_two(off, gain, allowed):
    steps = np.outer(gain * BOTH, [0.0, 1.0, 0.0])
    steps[3, 1] += 2 * off * np.ptp(BOTH)  # of which the line takes up half
    if allowed:
        assert matched(steps, RATES.tolist(), "run", raw=False).axis == 1
        return
    with pytest.raises(ValueError, match="match the given rates"):
        matched(steps, RATES.tolist(), "run", raw=False)

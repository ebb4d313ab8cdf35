"""Shaping filters against the processes they stand for, and the tables of spans against brute force."""

import numpy as np
import pytest
from scipy import signal

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.shaping import FLICKER_BAND, lattice, shaping
from imuwb.navigation.workspace import MOST_STATES
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Sum,
    WhiteNoise,
)

from . import drives

DT = 0.01
SETS = [
    [0.9999],
    [-0.5],
    [0.9999, 0.9],
    [0.999 * np.exp(0.02j), 0.999 * np.exp(-0.02j)],
    [0.9999, 0.9998, 0.2],
    [0.9999, 0.995 * np.exp(0.3j), 0.995 * np.exp(-0.3j), -0.7],
]


def of(*terms):
    return shaping(Sum(terms), DT)


def autocovariance(one, lags):
    """Return the output's autocovariance from its own start: c A^k P0 c."""
    found, at = [], one.P0 @ one.c
    for _ in range(lags):
        found.append(one.c @ at)
        at = one.A @ at
    return np.array(found)


def allan(covariance, m):
    """Return the Allan variance of m samples, by sums of an autocovariance."""
    k = np.arange(1, 2 * m)
    sums = {n: n * covariance[0] + 2 * ((n - k[: n - 1]) * covariance[1:n]).sum() for n in (m, 2 * m)}
    return (4 * sums[m] - sums[2 * m]) / (2 * m**2)


# Processes


@pytest.mark.parametrize(("sigma", "correlation"), [(0.3, 0.05), (2e-3, 4.56), (1.0, 3000.0)])
def test_gauss_markov_has_its_autocovariance(sigma, correlation):
    one, k = of(GaussMarkov(sigma, correlation)), np.arange(500)
    assert autocovariance(one, 500) == pytest.approx(sigma**2 * np.exp(-k * DT / correlation), rel=1e-12)
    assert pytest.approx(one.P0, rel=1e-12) == one.A @ one.P0 @ one.A.T + one.Q
    assert one.white == 0


def test_gauss_markov_has_its_allan_deviation_where_it_peaks():
    one = of(GaussMarkov(1.0, 2.0))
    peak = np.sqrt(allan(autocovariance(one, 800), round(1.893 * 2.0 / DT)))
    assert peak == pytest.approx(0.6174, rel=1e-3)  # numerics.md


def test_a_random_walk_spreads_with_time():
    one = of(RandomWalk(0.02))
    assert not one.P0.any()
    a, q = one.over(700)
    assert a[0, 0] == 1
    assert one.c @ q @ one.c == pytest.approx(0.02**2 * 7.0, rel=1e-12)


def test_a_constant_and_a_ramp_go_on_without_noise():
    one = of(Constant(0.1), RateRamp(-0.02))
    assert one.order == 3
    assert not one.Q.any()
    a, q = one.over(1000)
    assert not q.any()
    assert one.c @ a @ one.P0 @ a.T @ one.c == pytest.approx(0.1**2 + (0.02 * 10) ** 2, rel=1e-12)


def test_a_sinusoid_oscillates():
    one, k = of(Sinusoid(0.4, 1.3)), np.arange(300)
    expected = 0.4**2 / 2 * np.cos(2 * np.pi * 1.3 * k * DT)
    assert autocovariance(one, 300) == pytest.approx(expected, abs=1e-12)


def test_white_noise_is_a_density_and_quantization_is_left_out_by_name():
    one = of(WhiteNoise(2e-4), WhiteNoise(1e-4), Quantization(1e-5))
    assert one.order == 0
    assert one.white == pytest.approx(5e-8, rel=1e-12)
    assert one.left_out == ("quantization",)
    assert of(Autoregressive((), 0.3, DT)).white == pytest.approx(0.3**2 * DT)


def test_flicker_is_flat_where_outages_are():
    one = of(FlickerNoise(0.01))
    assert one.order == 3
    assert FLICKER_BAND[1] * DT < 0.5
    lags = autocovariance(one, 40_000)
    for tau in (5, 10, 30, 60, 100, 200):
        assert np.sqrt(allan(lags, round(tau / DT))) == pytest.approx(0.664 * 0.01, rel=0.3)


# Autoregressive sets


@pytest.mark.parametrize("poles", SETS, ids=str)
def test_a_lattice_is_the_autoregressive_process(poles):
    alpha = np.real(np.poly(poles))[1:]
    one = lattice(Autoregressive(tuple(alpha), 0.7, DT))
    assert one.order == len(poles)
    # Orthonormal: the stationary covariance is the identity, and stays it.
    assert np.array_equal(one.P0, np.eye(one.order))
    assert pytest.approx(np.eye(one.order), abs=1e-10) == one.A @ one.A.T + one.Q
    # What one impulse leaves: of the difference equation itself, and of these states.
    impulse = signal.lfilter([0.7], [1.0, *alpha], np.eye(1, 3000)[0])
    (g,) = [v[:, -1] * np.sqrt(w[-1]) for w, v in [np.linalg.eigh(one.Q)]]
    answer, at = [], g
    for _ in range(3000):
        answer.append(one.c @ at)
        at = one.A @ at
    answer = np.array(answer) * np.sign(answer[0])
    assert answer == pytest.approx(impulse, abs=1e-6 * np.abs(impulse).max())
    long = signal.lfilter([0.7], [1.0, *alpha], np.eye(1, 300_000)[0])
    expected = np.array([long[: long.size - k] @ long[k:] for k in range(0, 200, 10)])
    assert autocovariance(one, 200)[::10] == pytest.approx(expected, rel=3e-5, abs=1e-9 * expected[0])


@pytest.mark.parametrize(
    ("alpha", "pole"), [((-1.044,), "1.044"), ((1.0,), "1 "), ((-2.0, 0.99), r"1\.1"), ((0.0, 1.21), r"1\.1")]
)
def test_an_unstable_set_is_refused_by_its_pole(alpha, pole):
    with pytest.raises(ValueError, match=rf"pole of magnitude {pole.strip()}(?![\d.])"):
        shaping(Sum((Autoregressive(alpha, 1.0, DT),)), DT)


def test_a_set_of_another_step_is_refused():
    axes = {a: AxisModel(Sum((Autoregressive((-0.9,), 1.0, 0.02),))) for a in AXES}
    with pytest.raises(UsageError, match=r"mine, gyro_x: .* 0\.02 s.* 0\.01 s"):
        FilterModel("mine", ImuErrorModel("m", axes)).tables(DT)


# Readings


def test_printed_differs_as_the_papers_do():
    processes = Sum((WhiteNoise(2e-4), GaussMarkov(0.01, 4.56)))
    right, *printed = (shaping(processes, DT, r) for r in ("corrected", "printed variances", "printed densities"))
    assert right.A[0, 0] == pytest.approx(np.exp(-DT / 4.56), rel=1e-15)
    for own, factor in zip(printed, (1.0, DT), strict=True):
        assert own.white == pytest.approx(right.white / factor)
        assert own.A[0, 0] == pytest.approx(1 - DT / 4.56, rel=1e-15)
        np.testing.assert_allclose(own.Q, right.Q * factor)
        assert np.array_equal(own.P0, right.P0)


@pytest.mark.parametrize("alpha", [(-1.0,), (-2.564, 2.131, -0.567)])
def test_a_pole_at_1_is_the_sum_of_a_stable_process(alpha):
    """The variance after k steps is that of the sum, from the impulse response; of order 1 it is a random walk."""
    own = of(Autoregressive(alpha, 0.3, DT))
    if alpha == (-1.0,):
        walk = of(RandomWalk(0.3 / DT**0.5))
        for part in ("A", "Q", "c", "P0"):
            np.testing.assert_allclose(getattr(own, part), getattr(walk, part))
        return
    x, q = np.zeros((own.order, own.order)), np.zeros(6)
    for k in range(6):
        x = own.A @ x @ own.A.T + own.Q
        q[k] = own.c @ x @ own.c
    response = np.zeros(6)
    for k in range(6):
        response[k] = (k == 0) * 0.3 - sum(a * response[k - j] for j, a in enumerate(alpha, 1) if j <= k)
    start = own.c @ own.A @ own.P0 @ own.A.T @ own.c  # of the stable part: its steps begin stationary
    assert start > 0
    noise = np.cumsum(response**2)
    np.testing.assert_allclose(q, noise, rtol=1e-6)


# Tables


@pytest.mark.parametrize("samples", [0, 1, 7, 200])
def test_many_samples_are_the_product_of_single_ones(samples):
    one = of(GaussMarkov(0.1, 3.0), RandomWalk(0.3), Autoregressive(drives.ALPHA["accel_y"][0], 1.0, DT))
    a, q = one.over(samples)
    powers = [np.linalg.matrix_power(one.A, k) for k in range(samples + 1)]
    assert a == pytest.approx(powers[-1], rel=1e-9, abs=1e-12)
    expected = sum((p @ one.Q @ p.T for p in powers[:samples]), np.zeros_like(one.Q))
    assert q == pytest.approx(expected, rel=1e-9, abs=1e-12 * max(np.abs(expected).max(), 1e-300))


@pytest.mark.parametrize("scales", [(0.0, 0.0), (0.0, 2e-3), (1e-3, 2e-3)])
def test_tables_of_spans_are_sums_over_their_samples(scales):
    model = FilterModel("m", drives.mixed().error_model, scale_factor=scales, settings=Settings(every=12))
    tables, start = model.tables(DT)
    shapes = model.shapings(DT)
    for axis, one in enumerate(shapes):
        low = int(tables.first[axis]) - 9
        place, p = slice(low, low + one.order), one.order
        assert start[place, place] == pytest.approx(one.P0)
        assert tables.white[0, axis] == pytest.approx(drives.WHITE[axis] ** 2)
        assert tables.step[0, place] == pytest.approx(one.c)
        assert not tables.scale[place].any()
        for m in range(13):
            # All states of a span at once: x(k) = A^k x(0) + sum of A^(k-j) w(j).
            powers = [np.linalg.matrix_power(one.A, k) for k in range(m + 1)]
            lower = np.zeros((m * p, m * p))
            for k in range(m):
                for j in range(k + 1):
                    lower[k * p : (k + 1) * p, j * p : (j + 1) * p] = powers[k - j]
            spread = lower @ np.kron(np.eye(m), one.Q) @ lower.T
            summed = np.tile(one.c, m)
            last = np.eye(m * p)[-p:] if m and p else np.zeros((p, m * p))
            close = {"rel": 1e-9, "abs": 1e-20}
            assert tables.transition[0, m, axis, :p, :p] == pytest.approx(powers[m], rel=1e-9, abs=1e-12)
            assert tables.noise[0, m, axis, :p, :p] == pytest.approx(last @ spread @ last.T, **close)
            assert tables.cross[0, m, place] == pytest.approx(last @ spread @ summed, **close)
            assert tables.inside[0, m, axis] == pytest.approx(summed @ spread @ summed, **close)
            output = sum((one.c @ a for a in powers[1:]), np.zeros(p))
            assert tables.output[0, m, place] == pytest.approx(output / max(m, 1), rel=1e-9, abs=1e-15)
        if scales[axis > 2]:
            assert tables.scale[low + p]
            assert tables.step[0, low + p] == 1
            assert (tables.output[0, :, low + p] == 1).all()
            assert (tables.transition[0, :, axis, p, p] == 1).all()
            assert start[low + p, low + p] == scales[axis > 2] ** 2
    assert tables.first[6] == 9 + 12 + 3 * (scales[0] > 0) + 3 * (scales[1] > 0)
    assert len(model.states(DT)) == tables.first[6]


def test_a_regime_has_the_temperatures_own_processes():
    axes = {
        a: AxisModel(
            thermal=((0.0, Sum((WhiteNoise(1e-3), Constant(1.0)))), (40.0, Sum((WhiteNoise(3e-3), Constant(2.0)))))
        )
        for a in AXES
    }
    tables, start = FilterModel("warm", ImuErrorModel("warm", axes)).tables(DT, (10.0, 40.0))
    assert tables.white[:, 0] == pytest.approx([1.5e-3**2, 3e-3**2])
    assert start[0, 0] == pytest.approx(1.25**2)


def test_what_no_filter_has_room_for_is_refused():
    many = AxisModel(Sum(tuple(GaussMarkov(1.0, float(t)) for t in range(1, 8))))
    with pytest.raises(UsageError, match=f"wide: 51 states; .* {MOST_STATES}"):
        FilterModel("wide", ImuErrorModel("wide", dict.fromkeys(AXES, many))).tables(DT)
    with pytest.raises(UsageError, match="short: .* accel_z"):
        FilterModel("short", ImuErrorModel("five", dict.fromkeys(AXES[:5], many))).tables(DT)

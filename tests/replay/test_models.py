"""The filters by name: their states counted, their parameters by hand, and what is refused."""

import math
import tomllib
from dataclasses import fields, replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from imuwb.conditioning import denoise
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.navigation import FilterModel
from imuwb.navigation.shaping import Reading, shaping
from imuwb.replay import NAMES, model_named, scaled
from imuwb.replay.models import TURN_ON, flat_of
from imuwb.replay.noise.denoised_ar import LEVELS, ORDERS, expected, fitted
from imuwb.simulation import preset
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

TABLES = Path(__file__).resolve().parents[3] / "shared" / "papers" / "tables.toml"
READINGS = get_args(Reading)
STATES = {"none": 9, "15AV": 15, "18AV": 18, "18AVWD": 18, "15AR": 15, "27AR": 27}
N, B, K, DT = (3e-4, 2e-3), (1e-4, 1e-3), (1e-6, 3e-5), 0.01
FLAT = math.sqrt(2 * math.log(2) / math.pi)  # 0.664


def terms(axis, *more):
    k = int(axis[0] == "a")
    return Sum((WhiteNoise(N[k]), FlickerNoise(B[k]), RandomWalk(K[k]), *more))


AR = tuple(Autoregressive(alpha, 3e-6, DT) for alpha in ((-0.99,), (-2.5, 2.1, -0.59)))


def base(*more, apart=AR):
    axes = {a: AxisModel(terms(a, *more), autoregressive=apart) for a in AXES}
    return FilterModel("b", ImuErrorModel("sensor", axes))


def only(model, kind, axis="accel_x"):
    found = [t for t in model.error_model.axes[axis].processes.terms if isinstance(t, kind)]
    assert len(found) == 1
    return found[0]


def kinds(model, axis):
    return [type(t) for t in model.error_model.axes[axis].processes.terms]


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name", list(STATES))
def test_states_are_as_many_as_the_name_says(name, reading):
    model = model_named(name, base(), reading=reading, interval=DT)
    states = model.states(DT)
    assert len(states) == STATES[name]
    assert len(set(states)) == len(states)
    assert (model.name, model.reading) == (name, reading)
    assert set(STATES) | {"full"} == set(NAMES)


def test_full_carries_flicker_as_three_states_walks_and_turn_on():
    assert len(model_named("full", base(), interval=DT).states(DT)) == 9 + 6 * (3 + 1 + 1)
    assert len(model_named("full", replace(base(), scale_factor=(0.01, 0.02)), interval=DT).states(DT)) == 9 + 6 * 6


def test_full_on_the_published_sensor_has_a_gauss_markov_state_an_axis():
    of = FilterModel("b", preset("3dm-gx3-25-gm"))
    assert [len(model_named(n, of, interval=DT).states(DT)) for n in ("none", "15AV", "18AV", "18AVWD")] == [
        9,
        15,
        18,
        18,
    ]
    assert len(model_named("full", of, interval=DT).states(DT)) == 9 + 6 + 3 + 6


def test_terms_of_each_filter():
    of = {n: model_named(n, base(), interval=DT) for n in NAMES}
    for axis in AXES:
        walk = [RandomWalk] if axis[0] == "a" else []
        assert kinds(of["none"], axis) == [WhiteNoise]
        assert kinds(of["15AV"], axis) == [WhiteNoise, GaussMarkov]
        assert kinds(of["18AV"], axis) == kinds(of["18AVWD"], axis) == [WhiteNoise, GaussMarkov, *walk]
        assert kinds(of["15AR"], axis) == kinds(of["27AR"], axis) == [WhiteNoise, Autoregressive]
        assert kinds(of["full"], axis) == [WhiteNoise, FlickerNoise, RandomWalk, Constant]
        assert (
            len(only(of["15AR"], Autoregressive, axis).alpha),
            len(only(of["27AR"], Autoregressive, axis).alpha),
        ) == (1, 3)
    assert [n for n in NAMES if not of[n].causal] == ["18AVWD"]
    assert of["18AVWD"].wavelet_scale == "none"
    assert of["18AVWD"].wavelet_levels == (7, 7, 7, 7, 6, 6)  # gyros first; table 7 has accelerometers first: 7, 6, 6


@pytest.mark.parametrize("reading", READINGS[1:])
@pytest.mark.parametrize("axis", ["gyro_y", "accel_z"])
def test_a_gauss_markov_process_as_printed_is_the_flat_level(axis, reading):
    """Eq. 29 and table 5."""
    found = only(model_named("18AV", base(), reading=reading, interval=DT), GaussMarkov, axis)
    k = int(axis[0] == "a")
    assert found.sigma == pytest.approx(FLAT * B[k])
    assert found.Tc == pytest.approx(flat_of(terms(axis)).centre)


@pytest.mark.parametrize("axis", ["gyro_y", "accel_z"])
def test_a_corrected_gauss_markov_process_peaks_at_the_flat_level(axis):
    found = only(model_named("18AV", base(), interval=DT), GaussMarkov, axis)
    x = np.geomspace(0.01, 100, 20_001)  # averaging time over Tc; IEEE 952, eq. C.12
    deviation = np.sqrt(2 / x * (1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * x)))
    top = int(np.argmax(deviation))
    assert found.sigma * deviation[top] == pytest.approx(FLAT * B[int(axis[0] == "a")], rel=1e-3)
    flat = flat_of(terms(axis))
    assert found.Tc * x[top] == pytest.approx(math.sqrt(flat.begin * flat.end), rel=2e-3)


def test_the_flat_part_is_where_the_curve_is_low():
    tau = np.geomspace(1, 2000, 4001)
    for axis in ("gyro_x", "accel_x"):
        k = int(axis[0] == "a")
        adev = np.sqrt(N[k] ** 2 / tau + FLAT**2 * B[k] ** 2 + K[k] ** 2 * tau / 3)
        flat = tau[adev <= 1.05 * adev.min()]
        found = flat_of(terms(axis))
        assert (found.begin, found.end) == pytest.approx((flat[0], flat[-1]), rel=0.03)


def test_white_noise_of_eq_27():
    """A sample's variance N²/dt enters times dt², so N² is the density; read as a density, it enters times dt."""
    of = Sum(terms("gyro_x").terms[:1])
    density = {reading: shaping(of, DT, reading).white for reading in READINGS}
    assert density["corrected"] == density["printed variances"] == pytest.approx(N[0] ** 2)
    assert density["printed densities"] == pytest.approx(N[0] ** 2 / DT)


def test_gauss_markov_and_walk_of_eq_28_to_30():
    process = GaussMarkov(0.01, 20.0)
    readings = (
        ("corrected", math.exp(-DT / 20), 1.0),
        ("printed variances", 1 - DT / 20, 1.0),
        ("printed densities", 1 - DT / 20, DT),
    )
    for reading, decay, factor in readings:
        one = shaping(Sum((process,)), DT, reading)
        assert one.A[0, 0] == pytest.approx(decay, rel=1e-12)
        assert one.Q[0, 0] == pytest.approx(factor * 0.01**2 * (1 - math.exp(-2 * DT / 20)), rel=1e-9)  # eq. 28
        assert one.c[0] ** 2 * one.P0[0, 0] == pytest.approx(0.01**2)
        walk = shaping(Sum((RandomWalk(3e-5),)), DT, reading)
        assert walk.A[0, 0] == 1
        assert walk.Q[0, 0] == pytest.approx(factor * 3e-5**2 * DT)  # eq. 30
        ar = shaping(Sum((Autoregressive((-0.9,), 2e-4, DT),)), DT, reading)
        assert ar.c[0] ** 2 * ar.Q[0, 0] == pytest.approx(factor * 2e-4**2)  # eq. 36


def test_a_models_own_gauss_markov_process_is_taken():
    own = GaussMarkov(7e-4, 77.0)
    model = replace(base(), error_model=ImuErrorModel("s", {a: AxisModel(terms(a, own)) for a in AXES}))
    for reading in READINGS:
        assert only(model_named("15AV", model, reading=reading, interval=DT), GaussMarkov) == own


def test_a_model_without_flicker_has_no_bias_state():
    white = FilterModel("b", ImuErrorModel("s", {a: AxisModel(Sum((WhiteNoise(1e-3),))) for a in AXES}))
    assert len(model_named("15AV", white, interval=DT).states(DT)) == 9


def test_turn_on_biases():
    assert pytest.approx((math.radians(0.2), 0.1)) == TURN_ON
    plain = {n: model_named(n, base(), interval=DT) for n in ("none", "18AV", "full")}
    assert Constant not in kinds(plain["none"], "gyro_x") + kinds(plain["18AV"], "gyro_x")
    assert only(plain["full"], Constant, "gyro_x").sigma == pytest.approx(math.radians(0.2))
    assert only(plain["full"], Constant, "accel_y").sigma == pytest.approx(0.1)
    asked = {n: model_named(n, base(), interval=DT, turn_on=(0.01, 0.0)) for n in ("none", "18AV", "full")}
    assert Constant not in kinds(asked["none"], "gyro_x")
    assert only(asked["18AV"], Constant, "gyro_x").sigma == 0.01
    assert Constant not in kinds(asked["18AV"], "accel_x")
    assert Constant not in kinds(asked["full"], "accel_x")


def test_stated_turn_on_biases_are_carried_by_all_but_none():
    stated = base(Constant(0.05))
    for name, more in (("none", 0), ("15AV", 6), ("18AV", 6)):
        model = model_named(name, stated, interval=DT, turn_on=(9.0, 9.0))
        assert len(model.states(DT)) == STATES[name] + more
        if more:
            assert only(model, Constant).sigma == 0.05
    assert kinds(model_named("full", stated, interval=DT), "gyro_x").count(Constant) == 1


def test_an_ar_process_of_the_model_is_taken():
    own = Autoregressive((-1.5, 0.51, 0.05), 3e-6, DT)
    model = base(own, apart=())
    assert only(model_named("27AR", model, interval=DT), Autoregressive) == own
    assert only(model_named("15AR", model, interval=DT), Autoregressive) != own  # of another order
    assert (
        only(model_named("27AR", base(own), interval=DT), Autoregressive) == AR[1]
    )  # what is kept for the filters comes first
    assert kinds(model_named("full", base(), interval=DT), "gyro_x") == [WhiteNoise, FlickerNoise, RandomWalk, Constant]


def test_a_clock_that_is_slightly_off_keeps_the_process():
    found = only(model_named("27AR", base(), interval=DT * 1.003), Autoregressive)
    assert found == replace(AR[1], dt=DT * 1.003)
    with pytest.raises(UsageError, match=r"27AR, gyro_x: .* 0\.01 s.* 0\.02 s"):
        model_named("27AR", base(), interval=0.02).states(0.02)


@pytest.mark.parametrize("axis", ["gyro_z", "accel_y"])
def test_an_ar_process_of_static_samples_is_burgs_of_a_low_pass(axis):
    """No detail is kept. Of order one Burg's coefficient has a closed form: sums of products of neighbours."""
    samples = terms(axis).sample(20_000, DT, np.random.default_rng(4))
    clean = denoise(samples, LEVELS[axis], "db4", "all").values
    clean = clean - clean.mean()
    k = -2 * (clean[1:] @ clean[:-1]) / (clean[1:] @ clean[1:] + clean[:-1] @ clean[:-1])
    found = fitted(samples, axis, DT)
    assert tuple(len(process.alpha) for process in found) == ORDERS
    assert found[0].alpha[0] == pytest.approx(k, abs=1e-9)
    assert found[0].beta0 ** 2 == pytest.approx(clean.var() * (1 - k * k), rel=1e-6)


def test_the_expected_processes_are_those_of_drawn_records():
    """Four records of 44 min scatter by 3 % each; the expectation is that of 7 h, which changes the coefficients a little."""
    drawn = [fitted(terms("accel_y").sample(1 << 18, DT, np.random.default_rng(k)), "accel_y", DT) for k in range(4)]
    for place, mean in enumerate(expected(terms("accel_y"), 6, DT)):
        powers = [own[place].beta0 ** 2 for own in drawn]
        assert mean.beta0**2 == pytest.approx(np.mean(powers), rel=0.03)
        alphas = np.mean([own[place].alpha for own in drawn], axis=0)
        assert mean.alpha == pytest.approx(alphas, rel=0.02)


def test_without_kept_processes_they_follow_from_the_model():
    found = only(model_named("15AR", base(apart=()), interval=DT), Autoregressive, "gyro_x")
    assert found == expected(terms("gyro_x"), 7, DT)[0]


@pytest.mark.parametrize("column", range(6))
def test_table_2_as_printed_has_a_pole_at_1_or_is_refused(column):
    if not TABLES.is_file():
        pytest.skip(f"{TABLES} is not there: the papers' figures are not part of the repository")
    with TABLES.open("rb") as file:
        printed = tomllib.load(file)["quinchia2013"]["table2_ar_after_wavelet_lod6"]
    alpha, driving = printed["ar3_alpha"][column], math.sqrt(printed["ar3_beta0_sq"][column])
    if column == 0:
        with pytest.raises(ValueError, match="not stable: it has a pole of magnitude 1.04"):
            Autoregressive(tuple(alpha), driving, DT)
        return
    assert Autoregressive(tuple(alpha), driving, DT).steps is not None  # 1 is a root: the coefficients add up to 0


def test_thermal_points_become_the_filters_own():
    axes = {
        a: AxisModel(
            terms(a), thermal=((0.0, terms(a)), (40.0, Sum((WhiteNoise(9e-3), FlickerNoise(5e-3), RandomWalk(1e-9)))))
        )
        for a in AXES
    }
    of = replace(base(), error_model=ImuErrorModel("s", axes))
    cold, hot = (p for _, p in model_named("15AV", of, interval=DT).error_model.axes["accel_x"].thermal)
    assert [type(t) for t in cold.terms] == [WhiteNoise, GaussMarkov]
    assert hot.terms[0].N == 9e-3
    assert hot.terms[1].sigma == pytest.approx(FLAT * 5e-3 / 0.6174)
    assert model_named("full", of, interval=DT).error_model.axes["accel_x"].thermal[1][0] == 40.0
    (_, bare), _ = model_named("none", of, interval=DT).error_model.axes["gyro_x"].thermal
    assert [type(t) for t in bare.terms] == [WhiteNoise]


def test_wrong_names_and_missing_axes():
    with pytest.raises(UsageError, match=r"no filter '18av'; .* none, 15AV, 18AV, 18AVWD, 15AR, 27AR, full"):
        model_named("18av", base(), interval=DT)
    some = FilterModel("b", ImuErrorModel("half", {a: AxisModel(terms(a)) for a in AXES[:4]}))
    with pytest.raises(UsageError, match="the error model 'half' has no axis accel_y, accel_z"):
        model_named("none", some, interval=DT)


def test_what_full_cannot_carry_is_named():
    ramp = model_named("full", base(Quantization(1e-6)), interval=DT)
    assert "gyro_x: quantization" in ramp.left_out(DT)
    for process in (RateRamp(1e-6), Sinusoid(1e-4, 2.0)):
        model = model_named("full", base(process), interval=DT)
        assert len(model.states(DT)) > 9 + 6 * 5 or model.left_out(DT)


def test_scaled_multiplies_amplitudes_alone():
    every = Sum((
        WhiteNoise(1e-3), FlickerNoise(2e-3), RandomWalk(3e-5), GaussMarkov(4e-3, 50.0), Autoregressive((-0.9,), 5e-4, DT),
        RateRamp(6e-6), Sinusoid(7e-4, 2.0), Quantization(8e-6), Constant(0.09),
    ))  # fmt: skip
    model = ImuErrorModel("s", {a: AxisModel(every, thermal=((20.0, every),)) for a in AXES})
    found = scaled(model, (2.0, 3.0), (5.0, 7.0))
    for axis, white, slow in (("gyro_z", 2.0, 5.0), ("accel_x", 3.0, 7.0)):
        want = Sum((
            WhiteNoise(1e-3 * white), FlickerNoise(2e-3 * slow), RandomWalk(3e-5 * slow), GaussMarkov(4e-3 * slow, 50.0),
            Autoregressive((-0.9,), 5e-4 * slow, DT), RateRamp(6e-6 * slow), Sinusoid(7e-4 * slow, 2.0), Quantization(8e-6),
            Constant(0.09),
        ))  # fmt: skip
        for got in (found.axes[axis].processes, found.axes[axis].thermal[0][1]):
            for one, other in zip(got.terms, want.terms, strict=True):
                assert type(one) is type(other)
                assert vars_of(one) == pytest.approx(vars_of(other), rel=1e-12)
    assert scaled(model, (1.0, 1.0)).axes["gyro_x"].processes == every


def vars_of(process):
    values = [getattr(process, f.name) for f in fields(process)]
    return [v[0] if isinstance(v, tuple) else v for v in values if not isinstance(v, str)]


def test_scaling_white_noise_scales_the_allan_deviation():
    model = ImuErrorModel("s", {a: AxisModel(Sum((WhiteNoise(1e-3),))) for a in AXES})
    tau = np.array([0.1, 1.0, 10.0])
    before, after = (m.axes["gyro_y"].processes.allan_variance(tau, DT) for m in (model, scaled(model, (3.0, 1.0))))
    assert np.sqrt(after / before) == pytest.approx(3.0)

"""The filters by name: their states counted, their parameters by hand, and what is refused."""

import math
import tomllib
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from imuwb.conditioning import denoise
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.navigation import FilterModel
from imuwb.navigation.shaping import shaping
from imuwb.replay import NAMES, model_named, scaled
from imuwb.replay.models import STATIC, TURN_ON, flat_middle
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
STATES = {"none": 9, "15AV": 15, "18AV": 18, "18AVWD": 18, "15AR": 15, "27AR": 27}
N, B, K, DT = (3e-4, 2e-3), (1e-4, 1e-3), (1e-6, 3e-5), 0.01
FLAT = math.sqrt(2 * math.log(2) / math.pi)  # 0.664


def terms(axis, *more):
    k = int(axis[0] == "a")
    return Sum((WhiteNoise(N[k]), FlickerNoise(B[k]), RandomWalk(K[k]), *more))


@pytest.fixture(scope="module")
def short():
    """Return static samples of all axes: what an AR process is fitted to need not be half an hour."""
    rng = np.random.default_rng(4)
    return {axis: terms(axis).sample(20_000, DT, rng) for axis in AXES}


def base(*more):
    return FilterModel("b", ImuErrorModel("sensor", {a: AxisModel(terms(a, *more)) for a in AXES}))


def only(model, kind, axis="accel_x"):
    found = [t for t in model.error_model.axes[axis].processes.terms if isinstance(t, kind)]
    assert len(found) == 1
    return found[0]


def kinds(model, axis):
    return [type(t) for t in model.error_model.axes[axis].processes.terms]


@pytest.mark.parametrize("reading", ["corrected", "as printed"])
@pytest.mark.parametrize("name", list(STATES))
def test_states_are_as_many_as_the_name_says(name, reading, short):
    model = model_named(name, base(), reading=reading, interval=DT, static=short)
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


def test_terms_of_each_filter(short):
    of = {n: model_named(n, base(), interval=DT, static=short) for n in NAMES}
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
    assert of["18AVWD"].wavelet_levels == (7, 7, 7, 7, 6, 6)  # gyros first; table 7 has accelerometers first: 7, 6, 6


@pytest.mark.parametrize("axis", ["gyro_y", "accel_z"])
def test_a_gauss_markov_process_as_printed_is_the_flat_level(axis):
    """Eq. 29 and table 5."""
    found = only(model_named("18AV", base(), reading="as printed", interval=DT), GaussMarkov, axis)
    k = int(axis[0] == "a")
    assert found.sigma == pytest.approx(FLAT * B[k])
    assert found.Tc == pytest.approx(flat_middle(terms(axis)))


@pytest.mark.parametrize("axis", ["gyro_y", "accel_z"])
def test_a_corrected_gauss_markov_process_peaks_at_the_flat_level(axis):
    found = only(model_named("18AV", base(), interval=DT), GaussMarkov, axis)
    x = np.geomspace(0.01, 100, 20_001)  # averaging time over Tc; IEEE 952, eq. C.12
    deviation = np.sqrt(2 / x * (1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * x)))
    top = int(np.argmax(deviation))
    assert found.sigma * deviation[top] == pytest.approx(FLAT * B[int(axis[0] == "a")], rel=1e-3)
    assert found.Tc * x[top] == pytest.approx(flat_middle(terms(axis)), rel=2e-3)


def test_the_flat_part_is_where_the_curve_is_low():
    tau = np.geomspace(1, 2000, 4001)
    for axis in ("gyro_x", "accel_x"):
        k = int(axis[0] == "a")
        adev = np.sqrt(N[k] ** 2 / tau + FLAT**2 * B[k] ** 2 + K[k] ** 2 * tau / 3)
        flat = tau[adev <= 1.05 * adev.min()]
        assert flat_middle(terms(axis)) == pytest.approx(math.sqrt(flat[0] * flat[-1]), rel=0.02)


def test_white_noise_of_eq_27():
    """Corrected, N² is the density; as printed it is N²/dt, a sample's variance."""
    of = terms("gyro_x")
    assert shaping(Sum(of.terms[:1]), DT).white == pytest.approx(N[0] ** 2)
    assert shaping(Sum(of.terms[:1]), DT, "as printed").white == pytest.approx(N[0] ** 2 / DT)


def test_gauss_markov_and_walk_of_eq_28_to_30():
    process = GaussMarkov(0.01, 20.0)
    for reading, decay in (("corrected", math.exp(-DT / 20)), ("as printed", 1 - DT / 20)):
        one = shaping(Sum((process,)), DT, reading)
        assert one.A[0, 0] == pytest.approx(decay, rel=1e-12)
        assert one.Q[0, 0] == pytest.approx(0.01**2 * (1 - math.exp(-2 * DT / 20)), rel=1e-9)  # eq. 28
        assert one.c[0] ** 2 * one.P0[0, 0] == pytest.approx(0.01**2)
    walk = shaping(Sum((RandomWalk(3e-5),)), DT)
    assert walk.A[0, 0] == 1
    assert walk.Q[0, 0] == pytest.approx(3e-5**2 * DT)  # eq. 30


def test_a_models_own_gauss_markov_process_is_taken():
    own = GaussMarkov(7e-4, 77.0)
    model = replace(base(), error_model=ImuErrorModel("s", {a: AxisModel(terms(a, own)) for a in AXES}))
    for reading in ("corrected", "as printed"):
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


def test_an_ar_process_of_the_model_is_taken(short):
    own = Autoregressive((-1.5, 0.51, 0.05), 3e-6, DT)
    model = base(own)
    assert only(model_named("27AR", model, interval=DT, static=short), Autoregressive) == own
    assert only(model_named("15AR", model, interval=DT, static=short), Autoregressive) != own  # of another order


def test_an_ar_process_of_static_samples_is_burgs(short):
    """Of order one Burg's coefficient has a closed form: sums of products of neighbours."""
    clean = denoise(short["gyro_z"], 7, "db4").values
    found = only(model_named("15AR", base(), interval=DT, static=short), Autoregressive, "gyro_z")
    for series in (clean - clean.mean(), clean):
        k = -2 * (series[1:] @ series[:-1]) / (series[1:] @ series[1:] + series[:-1] @ series[:-1])
        if found.alpha[0] == pytest.approx(k, abs=1e-9):
            return
    pytest.fail(f"{found.alpha} is not {k}")


def test_without_static_samples_the_model_is_simulated_the_same_each_time():
    assert STATIC == 1800
    one, other = (model_named("15AR", base(), interval=0.1) for _ in range(2))
    assert one.error_model.axes == other.error_model.axes


@pytest.mark.parametrize("column", range(6))
def test_table_2_as_printed_is_refused_by_its_pole(column):
    if not TABLES.is_file():
        pytest.skip(f"{TABLES} is not there: the papers' figures are not part of the repository")
    with TABLES.open("rb") as file:
        printed = tomllib.load(file)["quinchia2013"]["table2_ar_after_wavelet_lod6"]
    alpha, driving = printed["ar3_alpha"][column], math.sqrt(printed["ar3_beta0_sq"][column])
    if column:  # 1 is a root: the sum of the polynomial's coefficients is 0
        assert 1 + sum(alpha) == pytest.approx(0, abs=1e-12)
    with pytest.raises(ValueError, match="not stable: it has a pole of magnitude 1.04" if column == 0 else "a pole of"):
        Autoregressive(tuple(alpha), driving, DT)


def test_an_ar_model_of_another_rate_is_refused(short):
    model = model_named("15AR", base(Autoregressive((-0.9,), 1e-4, DT)), interval=0.02, static=short)
    with pytest.raises(UsageError, match=r"15AR, gyro_x: .* 0\.01 s.* 0\.02 s"):
        model.states(0.02)


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

import json
import math

import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.explain import explain
from imuwb.estimators.export import Options, export, model_rate, with_motion
from imuwb.estimators.model_json import as_json
from imuwb.estimators.sensor import Factors, with_limits
from imuwb.estimators.temperature import constant
from imuwb.estimators.tool import tools
from imuwb.simulation import preset
from imuwb.stochastic import (
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Sum,
    WhiteNoise,
)

GYRO = (lambda s: WhiteNoise(1e-3 * s), lambda s: RandomWalk(2e-5 * s))
ACCEL = (lambda s: WhiteNoise(2e-2 * s), lambda s: RandomWalk(4e-4 * s))
#: the four numbers of each tool for N 1.6e-4 and 2.1e-3, K 1.2e-6 and 3e-4 at 200 Hz, computed by hand
BY_HAND = {
    "kalibr": {"gyroscope_noise_density": 1.6e-4, "accelerometer_random_walk": 3e-4, "update_rate": 200},
    "vins": {"gyr_n": 0.0032, "acc_n": 0.042, "gyr_w": 1.69706e-5, "acc_w": 4.24264e-3},
    "orb-slam3": {"IMU.NoiseGyro": 1.6e-4, "IMU.AccWalk": 3e-4, "IMU.Frequency": 200},
    "fast-lio": {"gyr_cov": 5.12e-6, "acc_cov": 8.82e-4, "b_gyr_cov": 2.88e-10, "b_acc_cov": 1.8e-5},
    "ros": {"angular_velocity_covariance": 5.12e-6, "linear_acceleration_covariance": 8.82e-4},
    "gtsam": {"setGyroscopeCovariance": 2.56e-8, "setAccelerometerCovariance": 4.41e-6, "setBiasOmegaCovariance": 1.44e-12, "setBiasAccCovariance": 9e-8},
    "kf-gins": {"arw": 0.550039, "vrw": 0.126, "corrtime": 1},
    "psins": {"web": 0.550039, "wdb": 214.717, "sqrtR0G": 14.8511, "sqrtR0A": 1840.43},
    "px4": {"EKF2_GYR_NOISE": 1.6e-3, "EKF2_ACC_NOISE": 0.021, "EKF2_GYR_B_NOISE": 1.2e-5, "EKF2_ACC_B_NOISE": 3e-3},
    "ardupilot": {"EK3_GYRO_P_NSE": 1.6e-4 / math.sqrt(0.0125), "EK3_ABIAS_P_NSE": 3e-4 / math.sqrt(0.0125)},
    "airsim": {"AngularRandomWalk": 0.550039, "VelocityRandomWalk": 2.1e-3 / 9.80665e-3},
}  # fmt: skip


@pytest.mark.parametrize("tool", list(BY_HAND))
def test_values_are_those_computed_by_hand(tool, made):
    model = made(
        (lambda _: WhiteNoise(1.6e-4), lambda _: RandomWalk(1.2e-6)),
        (lambda _: WhiteNoise(2.1e-3), lambda _: RandomWalk(3e-4)),
    )
    values = export(model, tool).values
    assert {key: values[key][0] for key in BY_HAND[tool]} == pytest.approx(BY_HAND[tool], rel=1e-5)


@pytest.mark.parametrize("tool", list(tools()))
def test_a_file_names_tool_facts_model_and_what_it_could_not_say(tool, made):
    made_file = export(made((*GYRO, lambda s: Constant(1e-3 * s), lambda _: Sinusoid(1e-4, 2.0)), ACCEL), tool)
    text = made_file.text
    for said in (tools()[tool].title, tools()[tool].source, "a.mcap sha256:1"):
        assert said in text
    assert any("sinusoid" in note and "m in 60 s" in note for note in made_file.notes)
    assert any("no place for bias at turn-on" in note for note in made_file.notes) == (
        "turn_on" not in tools()[tool].terms
    )
    assert all(value > 0 for key, values in made_file.values.items() for value in values if "covariance" not in key)


def test_the_rate_is_that_of_the_model_unless_stated(made):
    model = made(GYRO, ACCEL, rate=20)
    assert model_rate(model) == 20
    assert export(model, "ros").values["angular_velocity_covariance"][0] == pytest.approx(1e-6 * 20)
    assert export(model, "ros", Options(rate=50)).values["angular_velocity_covariance"][0] == pytest.approx(1e-6 * 50)
    with pytest.raises(MissingDataError, match="--rate"):
        export(made(GYRO, ACCEL, rate=None), "vins")
    two = ImuErrorModel("m", model.axes, {"rate": "gyro 100 Hz, accel 50 Hz"})
    assert model_rate(two) is None


def test_one_value_for_three_axes_is_that_of_the_worst_and_uneven_axes_are_said(made):
    found = export(made(GYRO, ACCEL), "kalibr")
    assert found.values["gyroscope_noise_density"] == pytest.approx((1.2e-3,))
    assert not any("times the smallest" in note for note in found.notes)
    assert any("2 times the smallest" in note for note in export(made(GYRO, ACCEL, growth=0.5), "kalibr").notes)


def test_what_is_not_known_is_a_comment_or_its_limit(made):
    axes = {name: AxisModel(Sum((WhiteNoise(1e-3),)), limits={"K": 2e-6, "B": 1e-7}) for name in made(GYRO, ACCEL).axes}
    model = ImuErrorModel("m", axes, {"rate": "100 Hz"})
    left = export(model, "kalibr")
    assert "gyroscope_random_walk" not in left.values
    assert "# gyroscope_random_walk: NOT KNOWN" in left.text
    assert any("gyro K" in note and "not known" in note for note in left.notes)
    limited = export(model, "kalibr", Options(limits=True))
    assert limited.values["gyroscope_random_walk"] == pytest.approx((2e-6,))
    assert any("upper limit of K" in note for note in limited.notes)
    json.loads(export(model, "airsim").text)  # an unknown value leaves valid JSON


@pytest.mark.parametrize("tool", list(tools()))
def test_a_published_sensor_of_white_noise_alone_is_exported_and_nothing_is_invented(tool):
    found = export(preset("mpu-6050"), tool, Options(rate=100))
    assert not {"K", "sigma", "drive", "own_K"} & {
        field.term for field in tools()[tool].fields if any(key in found.values for key in field.keys)
    }


@pytest.mark.parametrize("tool", list(tools()))
def test_without_white_noise_there_is_no_file(tool, made):
    with pytest.raises(MissingDataError, match="gyro"):
        export(made((lambda s: RandomWalk(1e-5 * s),), ACCEL), tool)


def test_flicker_is_matched_over_the_horizon_with_the_error_stated(made):
    model = made((GYRO[0], lambda s: FlickerNoise(1e-4 * s)), ACCEL)
    short, long = (export(model, "kalibr", Options(horizon=h)).values["gyroscope_random_walk"][0] for h in (60, 600))
    assert long < short
    notes = export(model, "kalibr").notes
    assert any(note.startswith("gyro: a random walk stands") and "position 1.00" in note for note in notes)
    assert not any(note.startswith("accel: a random walk stands") for note in notes)


def test_values_outside_the_tools_range_are_held_and_said(made):
    found = export(made((lambda _: WhiteNoise(1e-6), GYRO[1]), ACCEL), "px4")
    assert found.values["EKF2_GYR_NOISE"] == (0.0001,)
    assert any("EKF2_GYR_NOISE: 1e-05" in note for note in found.notes)


def test_noise_in_motion_comes_from_factors_or_from_a_drives_model(made):
    bench, road = made(GYRO, ACCEL), made((lambda s: WhiteNoise(2.3e-2 * s), GYRO[1]), ACCEL)
    louder = export(bench, "kalibr", Options(motion=Factors.of_text("gyro=23")))
    assert louder.values["gyroscope_noise_density"] == pytest.approx((1.2e-3 * 23,))
    assert "23 times" in louder.text
    model, sentence = with_motion(bench, road)
    assert model.axes == road.axes
    assert "gyro 23.00" in sentence
    assumed = made((lambda s: WhiteNoise(2.3e-2 * s), GYRO[1], lambda _: Constant(9.0)), ACCEL)
    known = made((*GYRO, lambda _: Constant(0.1)), ACCEL)
    for own, sigma in ((bench, None), (known, 0.1)):  # a replay assumes biases at turn-on that the bench does not know
        terms = with_motion(own, assumed)[0].axes["gyro_x"].processes.terms
        assert next((t.sigma for t in terms if isinstance(t, Constant)), None) == sigma
    with pytest.raises(MissingDataError, match="--save-model"):
        with_motion(bench, bench)
    for wrong in ("gyro=0", "wheel=3", "gyro", "gyro=x", "gyro=1e308"):
        with pytest.raises(UsageError, match="--in-motion"):
            Factors.of_text(wrong)


def test_a_model_by_temperature_is_written_at_one_with_a_table_in_the_comments():
    axes = {
        f"{sensor}_{axis}": AxisModel(
            Sum((WhiteNoise(2e-3),)),
            thermal=((10.0, Sum((WhiteNoise(1e-3),))), (50.0, Sum((WhiteNoise(3e-3),)))),
            thermal_bias=((10.0, 0.1), (50.0, 0.5)),
        )
        for sensor in ("gyro", "accel")
        for axis in "xyz"
    }
    model = ImuErrorModel("m", axes)
    cold = export(model, "kalibr", Options(celsius=20.0))
    assert cold.values["gyroscope_noise_density"] == pytest.approx((axes["gyro_x"].at(20.0).terms[0].N,))
    assert "# the tool has no place for temperature: the model at 20 °C is written" in cold.text
    assert "# at 50 °C: gyro bias 0.5, 0.5, 0.5 rad/s; gyro N 0.003, 0.003, 0.003 rad/s/√Hz; accel bias" in cold.text
    plain = export(model, "kalibr")
    assert plain.values["gyroscope_noise_density"] == (2e-3,)
    assert "--celsius T" in plain.text
    assert constant(model, 20.0)[0].axes["gyro_x"].bias == pytest.approx(0.2)
    for wrong, celsius in ((model, 60.0), (ImuErrorModel("m", {"gyro_x": AxisModel()}), 20.0)):
        with pytest.raises(MissingDataError, match="temperature|10 to 50"):
            constant(wrong, celsius)


def test_a_gauss_markov_process_is_written_as_it_is_where_there_is_room(made):
    model = made((GYRO[0], lambda s: GaussMarkov(3e-4 * s, 1800.0)), (ACCEL[0], lambda s: GaussMarkov(5e-3 * s, 900.0)))
    found = export(model, "kf-gins", Options(scale_factor=1e-4)).values
    assert [v * math.pi / 180 / 3600 for v in found["gbstd"]] == pytest.approx([3e-4, 3.3e-4, 3.6e-4])
    assert found["corrtime"] == pytest.approx((0.5,))
    assert found["gsstd"] == pytest.approx((100.0,) * 3)


@pytest.mark.parametrize(
    ("options", "named"), [({"rate": 0}, "rate is 0"), ({"horizon": math.inf}, "horizon"), ({"step": -1}, "step")]
)
def test_wrong_options_are_named(options, named):
    with pytest.raises(UsageError, match=named):
        Options(**options)


def test_an_unknown_tool_is_named_with_the_known_ones(made):
    with pytest.raises(UsageError, match=r"matlab2.*kalibr, openvins"):
        export(made(GYRO, ACCEL), "matlab2")


def test_json_is_the_whole_model():
    whole = ImuErrorModel("m", {
        "gyro_x": AxisModel(Sum((WhiteNoise(1e-3), Constant(2e-3))), {"0.N": (0.9e-3, 1.1e-3)}, {"K": 1e-5})
    }, {"log": "a"})  # fmt: skip
    found = json.loads(as_json(whole))
    assert found["axes"]["gyro_x"] == {
        "processes": [{"process": "white_noise", "N": 1e-3}, {"process": "constant", "sigma": 2e-3}],
        "intervals": {"0.N": [0.9e-3, 1.1e-3]},
        "limits": {"K": 1e-5},
    }


def test_an_explanation_names_each_value_and_measures_the_shortcuts(made):
    found = explain(made(GYRO, ACCEL), "vins")
    assert [row[0] for row in found.rows] == ["acc_n", "gyr_n", "acc_w", "gyr_w"]
    assert "200 Hz only" in found.sentences[0]
    wrong = [abs(math.log(s.ratio)) for s in found.shortcuts]
    assert wrong == sorted(wrong, reverse=True)
    shortcuts = {(s.habit.split()[0], s.sensor): s.ratio for s in found.shortcuts}
    assert shortcuts["everything", "gyro"] == pytest.approx(10)
    assert shortcuts["the", "gyro"] < 0.2  # the numbers of kalibr as they are
    assert 1 < shortcuts["a", "gyro"] < math.sqrt(2)


def test_what_is_left_out_moves_the_position_by_its_closed_form_on_the_worst_axis(made):
    terms = (GYRO[0], lambda s: Constant(1e-4 * s), lambda s: RateRamp(1e-7 * s))
    notes = export(made(terms, ACCEL), "kalibr").notes
    g, t = 9.80665, 60.0
    constant, ramp = 1.2 * 1e-4 * g * t**3 / 6, 1.2 * 1e-7 * g * t**4 / 24
    assert any("turn-on" in note and f"by {constant:.2g} m in 60 s" in note for note in notes)
    assert any("rate ramp" in note and f"by {ramp:.2g} m in 60 s" in note for note in notes)


def test_a_limit_is_not_added_to_a_slow_error_that_is_known():
    axis = AxisModel(Sum((WhiteNoise(1e-3), FlickerNoise(1e-5))), limits={"K": 1e-2})
    model, notes = with_limits(ImuErrorModel("m", {"gyro_x": axis}))
    assert (model.axes["gyro_x"].processes, notes) == (axis.processes, ())


def test_intervals_are_those_of_another_temperature_and_are_left_out():
    points = tuple((t, Sum((WhiteNoise(1e-3 + 1e-5 * t),))) for t in (0.0, 40.0))
    axis = AxisModel(Sum((WhiteNoise(1e-3),)), {"0.N": (0.9e-3, 1.1e-3)}, thermal=points)
    assert constant(ImuErrorModel("m", {"gyro_x": axis}), 20.0)[0].axes["gyro_x"].intervals == {}

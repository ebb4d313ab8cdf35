import json
import math
import re

import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.simulation import preset
from imuwb.stochastic import AxisModel, Constant, FlickerNoise, GaussMarkov, ImuErrorModel, RandomWalk, Sum, WhiteNoise
from imuwb.stochastic.exports import export

DEGREE = math.pi / 180


def model(gyro=(), accel=(), **axes):
    """Return a model whose gyro and accel axes have terms that grow from x to z by 10 %."""
    made = {}
    for sensor, terms in (("gyro", gyro), ("accel", accel)):
        for k, axis in enumerate("xyz"):
            if terms:
                made[f"{sensor}_{axis}"] = AxisModel(Sum(tuple(term(1 + 0.1 * k) for term in terms)))
    return ImuErrorModel("mine", {**made, **axes}, {"log": "a.mcap sha256:1"})


GYRO = (lambda s: WhiteNoise(1e-3 * s), lambda s: RandomWalk(2e-5 * s), lambda s: GaussMarkov(3e-4 * s, 1800.0))
ACCEL = (lambda s: WhiteNoise(2e-2 * s), lambda s: RandomWalk(4e-4 * s), lambda s: GaussMarkov(5e-3 * s, 1800.0))


def read(text):
    """Return {key: number or list} of the lines ``key: value  # comment`` of a text."""
    found = {}
    for line in text.splitlines():
        if (match := re.fullmatch(r"\s*(\w+):?\s+(\[.*\]|[-+.\deE]+)\s*(#.*)?", line)) is not None:
            found[match[1]] = json.loads(match[2]) if match[2][0] == "[" else float(match[2])
    return found


def comments(text):
    return [line for line in text.splitlines() if line.startswith("#")]


def test_kalibr_takes_si_of_the_worst_axis():
    walks = model(GYRO[:2], ACCEL[:2])
    text = export(walks, "kalibr", rate=200)
    found = read(text)
    assert found == pytest.approx({
        "gyroscope_noise_density": 1.2e-3, "gyroscope_random_walk": 2.4e-5, "accelerometer_noise_density": 2.4e-2,
        "accelerometer_random_walk": 4.8e-4, "update_rate": 200,
    })  # fmt: skip
    assert "a.mcap sha256:1" in comments(text)[1]


def test_kalibr_takes_a_gauss_markov_bias_as_its_walk_at_first_and_says_so():
    text = export(model((GYRO[0], GYRO[2]), (ACCEL[0], ACCEL[2])), "kalibr")
    assert read(text)["gyroscope_random_walk"] == pytest.approx(3.6e-4 * (2 / 1800) ** 0.5)
    assert any("gyro" in c and "Gauss-Markov" in c for c in comments(text))


def test_walks_add_by_squares():
    text = export(model(GYRO, ACCEL), "kalibr")
    assert read(text)["accelerometer_random_walk"] == pytest.approx(
        1.2 * math.hypot(4e-4, 5e-3 * (2 / 1800) ** 0.5), rel=1e-9
    )


@pytest.mark.parametrize("horizon", [60.0, 300.0])
def test_flicker_becomes_the_walk_that_has_its_deviation_at_the_horizon_and_that_is_said(horizon):
    flicker = model((GYRO[0], lambda s: FlickerNoise(1e-4 * s)), ACCEL)
    text = export(flicker, "kalibr", horizon=horizon)
    k = read(text)["gyroscope_random_walk"]
    walk, level = RandomWalk(k).K ** 2 * horizon / 3, (2 * math.log(2) / math.pi) * 1.2e-4**2
    assert walk == pytest.approx(level)
    assert any("gyro" in c and f"{horizon:g} s" in c and "no random walk" in c for c in comments(text))
    assert not any("accel" in c and "no random walk" in c for c in comments(text))


def test_uneven_axes_are_said():
    axes = {"gyro_z": AxisModel(Sum((WhiteNoise(5e-3), RandomWalk(2e-5))))}
    text = export(model(GYRO[:2], ACCEL[:2], **axes), "kalibr")
    assert read(text)["gyroscope_noise_density"] == 5e-3
    assert any("gyro N" in c and "5 times the smallest" in c for c in comments(text))
    lacking = {"gyro_z": AxisModel(Sum((RandomWalk(2e-5),)))}
    assert any("1 of 3 axes have none" in c for c in comments(export(model(GYRO[:2], ACCEL[:2], **lacking), "kalibr")))


def test_ros_covariances_are_those_of_a_sample_on_the_diagonal():
    found = read(export(model(GYRO[:1], ACCEL[:1]), "ros", rate=50))
    for key, n in (("angular_velocity_covariance", 1e-3), ("linear_acceleration_covariance", 2e-2)):
        matrix = found[key]
        assert len(matrix) == 9
        assert matrix[::4] == pytest.approx([(n * s) ** 2 * 50 for s in (1, 1.1, 1.2)])
        assert [v for i, v in enumerate(matrix) if i % 4] == [0] * 6
    assert found["orientation_covariance"] == [-1, 0, 0, 0, 0, 0, 0, 0, 0]


def test_kf_gins_has_its_own_units_for_each_axis():
    text = export(model(GYRO, ACCEL), "kf-gins")
    found = read(text)
    scale = (1, 1.1, 1.2)
    assert [v * DEGREE / 60 for v in found["arw"]] == pytest.approx([1e-3 * s for s in scale], rel=1e-7)
    assert [v / 60 for v in found["vrw"]] == pytest.approx([2e-2 * s for s in scale], rel=1e-7)
    assert [v * DEGREE / 3600 for v in found["gbstd"]] == pytest.approx([3e-4 * s for s in scale], rel=1e-7)
    assert [v * 1e-5 for v in found["abstd"]] == pytest.approx([5e-3 * s for s in scale], rel=1e-7)
    assert found["corrtime"] * 3600 == pytest.approx(1800)
    for key, unit in (
        ("arw", "deg/sqrt(hr)"),
        ("vrw", "m/s/sqrt(hr)"),
        ("gbstd", "deg/hr"),
        ("abstd", "mGal"),
        ("corrtime", "hr"),
    ):
        assert re.search(rf"^  {key}: .*# {re.escape(unit)}$", text, re.MULTILINE)


def test_kf_gins_takes_flicker_by_the_peak_of_a_gauss_markov_process():
    flicker = (lambda s: WhiteNoise(1e-3 * s), lambda s: FlickerNoise(1e-4 * s))
    text = export(model(flicker, ACCEL), "kf-gins", horizon=100)
    sigma = read(text)["gbstd"][0] * DEGREE / 3600
    import numpy as np

    tau = np.geomspace(0.1, 10, 4000)
    peak = GaussMarkov(sigma, 1.0).allan_variance(tau, 1e-3).max()
    assert peak == pytest.approx(2 * math.log(2) / math.pi * 1e-4**2, rel=1e-3)
    assert read(text)["corrtime"] * 3600 == pytest.approx(1800)  # that of the accelerometers, which is known
    assert any("gyro" in c and "1.076 B" in c for c in comments(text))
    both = export(model(flicker, (ACCEL[0], lambda s: FlickerNoise(1e-3 * s))), "kf-gins", horizon=100)
    assert read(both)["corrtime"] * 3600 == pytest.approx(100)


def test_px4_takes_sizes_at_the_filters_step():
    found = read(export(model(GYRO[:2], ACCEL[:2]), "px4"))
    root = 0.01**0.5
    assert found["EKF2_GYR_NOISE"] * root == pytest.approx(1.2e-3, rel=1e-5)
    assert found["EKF2_ACC_NOISE"] * root == pytest.approx(2.4e-2, rel=1e-5)
    assert found["EKF2_GYR_B_NOISE"] * root == pytest.approx(2.4e-5, rel=1e-5)
    assert found["EKF2_ACC_B_NOISE"] * root == pytest.approx(4.8e-4, rel=1e-5)


def test_px4_is_kept_within_its_limits_and_that_is_said():
    small, large = (lambda s: WhiteNoise(1e-6 * s), GYRO[1]), (ACCEL[0], lambda s: RandomWalk(0.1 * s))
    text = export(model(small, large), "px4")
    found = read(text)
    assert (found["EKF2_GYR_NOISE"], found["EKF2_ACC_B_NOISE"]) == (0.0001, 0.01)
    said = [c for c in comments(text) if "is written" in c and "EKF2" in c]
    assert [c.split()[1] for c in said] == ["EKF2_GYR_NOISE:", "EKF2_ACC_B_NOISE:"]
    assert "1.2e-05 rad/s" in said[0]


def test_json_is_the_whole_model():
    whole = ImuErrorModel("m", {
        "gyro_x": AxisModel(Sum((WhiteNoise(1e-3), Constant(2e-3))), {"0.N": (0.9e-3, 1.1e-3)}, {"K": 1e-5})
    }, {"log": "a"})  # fmt: skip
    found = json.loads(export(whole, "json"))
    assert found["axes"]["gyro_x"] == {
        "processes": [{"process": "white_noise", "N": 1e-3}, {"process": "constant", "sigma": 2e-3}],
        "intervals": {"0.N": [0.9e-3, 1.1e-3]},
        "limits": {"K": 1e-5},
    }
    assert found["provenance"] == {"log": "a"}


@pytest.mark.parametrize("tool", ["kalibr", "ros", "kf-gins", "px4"])
@pytest.mark.parametrize(("gyro", "accel"), [((), ACCEL), (GYRO, ()), (GYRO[1:], ACCEL), (GYRO, ACCEL[1:])])
def test_what_is_missing_is_refused(tool, gyro, accel):
    with pytest.raises(MissingDataError, match=r"gyro|accel"):
        export(model(gyro, accel), tool)


@pytest.mark.parametrize("tool", ["kalibr", "kf-gins", "px4"])
def test_a_bias_that_no_one_knows_is_never_written_as_0(tool):
    with pytest.raises(MissingDataError, match="gyro"):
        export(model(GYRO[:1], ACCEL), tool)


def test_ros_writes_no_covariance_of_0():
    lacking = {"gyro_y": AxisModel(Sum((RandomWalk(2e-5),)))}
    with pytest.raises(MissingDataError, match="unknown"):
        export(model(GYRO, ACCEL, **lacking), "ros")


@pytest.mark.parametrize(
    ("tool", "options", "named"),
    [("matlab", {}, "kalibr, ros, kf-gins, px4, json"), ("ros", {"rate": 0}, "rate is 0 Hz"),
     ("ros", {"rate": math.nan}, "rate is nan"), ("kalibr", {"horizon": -1}, "horizon -1 s"), ("px4", {"horizon": math.inf}, "positive")],
)  # fmt: skip
def test_wrong_usage_is_named(tool, options, named):
    with pytest.raises(UsageError, match=named):
        export(model(GYRO, ACCEL), tool, **options)


@pytest.mark.parametrize("tool", ["kalibr", "ros", "kf-gins", "px4", "json"])
def test_published_sensors_can_be_exported_and_name_their_source(tool):
    assert "Quinchia" in export(preset("3dm-gx3-25-gm"), tool)


@pytest.mark.parametrize(("ratio", "noted"), [(1.45, False), (1.55, True)])
def test_axes_that_differ_by_more_than_half_are_noted(ratio, noted):
    axes = {
        f"{s}_{a}": AxisModel(Sum((WhiteNoise(1e-3 * (ratio if a == "z" else 1)), RandomWalk(1e-5))))
        for s in ("gyro", "accel")
        for a in "xyz"
    }
    assert any("times the smallest" in c for c in comments(export(ImuErrorModel("m", axes), "kalibr"))) == noted

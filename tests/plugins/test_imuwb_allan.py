from dataclasses import replace

import numpy as np
import pytest

import imuwb_allan
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.simulation import preset, static


@pytest.fixture(scope="module")
def log():
    return static(preset("3dm-gx3-25"), 1200, 50, 4)


def run(log, **options):
    return imuwb_allan.run([log], imuwb_allan.Parameters(**options))


def test_finds_the_sensor_that_was_simulated(log):
    truth = preset("3dm-gx3-25")
    result = run(log)
    for axis, found in result.axes.items():
        white = truth.axes[axis].processes.terms[0].N
        assert found.coefficients["N"].value == pytest.approx(white, rel=0.03)
        assert found.fit.probability > 1e-6
    model = imuwb_allan.error_model(result)
    assert set(model.axes) == set(truth.axes)
    assert log.provenance.hash in model.provenance["log"]


def test_the_longer_grid_gives_the_same_fit(log):
    octave, dense = run(log), run(log, averaging_times="log:40")
    assert len(dense.axes["gyro_x"].averaging_time) > len(octave.axes["gyro_x"].averaging_time)
    assert octave.axes["gyro_x"].coefficients == dense.axes["gyro_x"].coefficients


def test_a_gap_is_told_and_not_bridged(log):
    imu = log.imus[0]
    keep = np.r_[0:20_000, 30_000 : len(imu.angular_rate)]
    cut = replace(
        imu,
        angular_rate=Triad(imu.angular_rate.time[keep], imu.angular_rate.value[keep]),
        specific_force=Triad(imu.specific_force.time[keep], imu.specific_force.value[keep]),
    )
    result = run(replace(log, imus=(cut,)))
    assert any("1 gaps, 200 s" in note for note in result.notes)
    assert result.axes["gyro_x"].averaging_time[-1] <= 300
    assert result.axes["gyro_x"].coefficients["N"].value == pytest.approx(7.04e-4, rel=0.03)


def test_triads_may_have_clocks_of_their_own(log):
    imu = log.imus[0]
    slow = Triad(imu.specific_force.time[::2], imu.specific_force.value[::2])
    result = run(replace(log, imus=(replace(imu, specific_force=slow),)))
    assert result.rate_hz["gyro"] == pytest.approx(50)
    assert result.rate_hz["accel"] == pytest.approx(25)
    assert result.axes["accel_x"].averaging_time[0] == pytest.approx(0.04)


def test_one_triad_is_enough(log):
    result = run(replace(log, imus=(replace(log.imus[0], specific_force=None),)))
    assert list(result.axes) == ["gyro_x", "gyro_y", "gyro_z"]


def test_a_shock_is_told_with_the_quiet_part(log):
    imu = log.imus[0]
    value = imu.specific_force.value.copy()
    value[10_000:10_100] += 3.0
    result = run(replace(log, imus=(replace(imu, specific_force=Triad(imu.specific_force.time, value)),)))
    assert any("shock" in note and "--start 2" in note for note in result.notes)


def test_several_imus_are_told(log):
    other = replace(log.imus[0], name="/imu/other")
    assert any("2 IMUs" in note and "--imu" in note for note in run(replace(log, imus=(log.imus[0], other))).notes)


def test_too_few_samples_and_no_imu_are_missing_data():
    time = np.arange(10) * SECOND
    imu = ImuStream("imu", Triad(time, np.random.default_rng(0).standard_normal((10, 3))), None)
    where = Provenance("x.csv", "csv", "sha256:", 0)
    with pytest.raises(MissingDataError, match="10 samples"):
        run(Log(where, imus=(imu,)))
    with pytest.raises(MissingDataError, match="no IMU"):
        run(Log(where))


@pytest.mark.parametrize(
    "wrong", [{"level": 1.0}, {"level": 0.2}, {"averaging_times": "often"}, {"averaging_times": "-1,2"}]
)
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match=r"must be|write octave"):
        imuwb_allan.Parameters(**wrong)

"""Faults of inertial channels: each is found where it is, and clean records have none."""

import numpy as np
import pytest

from imuwb.health import check

from .records import N, T, changed, coarse, faults, log_of, motion, setting, still


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_still_noise_has_no_fault(seed):
    # No line but one in a hundred axes is the search's own promise; nothing else may be found.
    assert [f for f in faults(*still(seed, flicker=1.0)) if not f.what.startswith("line")] == []


@pytest.mark.slow
def test_of_white_noise_hardly_an_axis_shows_a_line():
    assert sum(len(faults(*still(seed, flicker=1.0), "line")) for seed in range(20)) <= 4


@pytest.mark.parametrize("seed", range(20))
def test_a_smooth_motion_has_no_fault(seed):
    gyro, accel = still(seed)
    moved = motion(seed)
    moved *= np.clip((T - 20) / 2, 0, 1)[:, None] ** 3  # at rest at first
    assert faults(gyro + 0.5 * moved[:, :3], accel + 2 * moved[:, 3:]) == []


@pytest.mark.parametrize("seed", range(20))
def test_a_motion_without_a_rest_has_nothing_but_notes(seed):
    gyro, accel = still(seed)
    moved = motion(seed)
    found = faults(gyro + 0.5 * moved[:, :3], accel + 2 * moved[:, 3:])
    assert {f.severity for f in found} <= {"note"}


def test_a_coarse_channel_that_sticks_is_found():
    gyro, accel = coarse(0.005)
    gyro[1000:1500, 0] = gyro[1000, 0]
    gyro[3000:3300, 0] = gyro[3000, 0]
    (stuck,) = faults(gyro, accel, "stuck")
    assert (stuck.stream, stuck.severity, stuck.count) == ("/imu gyro_x", "fault", 2)
    assert stuck.start == pytest.approx(10, abs=0.05)
    assert stuck.length == pytest.approx(5, abs=0.06)


@pytest.mark.parametrize("value", [None, 0.0], ids=["stuck", "zeroed"])
def test_a_fine_channel_that_sticks_is_found(value):
    (stuck,) = faults(*changed(gyro_x=setting((1000, 1500, value))), "stuck")
    assert (stuck.severity, stuck.count) == ("fault", 1)
    assert stuck.start == pytest.approx(10, abs=0.02)
    assert stuck.length == pytest.approx(5, abs=0.02)


def test_a_coarse_channel_that_is_zeroed_is_found():
    gyro, accel = coarse(0.005)
    gyro[1000:1500] = 0
    found = faults(gyro, accel, "stuck")
    assert [f.stream for f in found] == ["/imu gyro_x", "/imu gyro_y", "/imu gyro_z"]


def test_equal_samples_on_both_sides_of_a_gap_are_not_stuck():
    gyro, accel = coarse(0.005)
    keep = np.ones(N, bool)
    keep[1001:1500] = False
    gyro[1000] = gyro[1500] = 0.005
    assert faults(gyro, accel, "stuck", keep=keep) == []
    gyro[1000:1501] = 0.005
    assert len(faults(gyro, accel, "stuck")) == 3  # without the gap they are


def test_short_runs_of_equal_samples_are_usual():
    gyro, accel = coarse(0.05)  # hardly ever changes
    assert faults(gyro, accel, "stuck") == []


@pytest.mark.parametrize(("value", "what"), [(0.0, "not connected"), (0.1, "5.73 deg/s")])
def test_a_channel_that_never_changes_is_a_fault(value, what):
    found = faults(*changed(gyro_y=setting((0, N, value))))
    (constant,) = (f for f in found if f.stream == "/imu gyro_y")
    assert (constant.kind, constant.severity, constant.count) == ("constant", "fault", N)
    assert what in constant.what


def test_saturation_is_found_at_both_ends():
    high, low = faults(*changed(gyro_x=setting((1000, 1010, 4.36), (3000, 3005, -4.36))), "saturated")
    assert (high.what.split()[-2], high.count, high.start) == ("249.8", 10, 10.0)
    assert (low.what.split()[-2], low.count, low.start) == ("-249.8", 5, 30.0)
    assert {high.severity, low.severity} == {"fault"}


def test_saturated_samples_of_several_places_are_added():
    (accel,) = faults(*changed(accel_x=setting((1000, 1004, 39.2266), (2000, 2006, 39.2266))), "saturated")
    assert (accel.stream, accel.what.split()[-2:], accel.count) == ("/imu accel_x", ["4000", "mg"], 10)


def test_two_samples_at_the_end_are_not_saturated():
    assert faults(*changed(gyro_x=setting((1000, 1002, 4.36))), "saturated") == []


def test_a_motion_that_clips_is_saturated():
    gyro, accel = still()
    gyro[:, 0] += 6 * motion(0)[:, 0]
    found = faults(gyro.clip(-4.36, 4.36), accel, "saturated")
    assert [f.stream for f in found] == ["/imu gyro_x"] * 2


def rounded_peaks(*at, step=0.001):
    """Return a smooth motion whose largest values are tops that are flat to a step of the sensor."""
    gyro, accel = still()
    gyro[:, 0] = 0.5 * motion(0)[:, 0]
    for k, row in enumerate(at):
        bump = 3.0 - 0.3 * step * (np.arange(N) - row) ** 2
        gyro[:, 0] = np.where(bump > 2.5, bump + 1e-9 * k, gyro[:, 0])
    gyro[:, 0] = np.round(gyro[:, 0] / step) * step
    return gyro, accel


def test_the_rounded_top_of_a_smooth_motion_is_not_saturated():
    gyro, accel = rounded_peaks(3000)
    top = np.flatnonzero(gyro[:, 0] == gyro[:, 0].max())
    assert top.size >= 3
    assert faults(gyro, accel, "saturated") == []


def test_several_tops_at_the_same_value_are_saturated():
    (fault,) = faults(*rounded_peaks(1000, 3000, 5000), "saturated")
    assert fault.stream == "/imu gyro_x"


def test_the_smallest_step_is_told():
    gyro, accel = still()
    gyro[:, 2] = np.round(gyro[:, 2] / 0.002) * 0.002
    (lsb,) = faults(gyro, accel, "step")
    assert (lsb.stream, lsb.severity) == ("/imu gyro_z", "note")
    assert f"{np.degrees(0.002):.4g} deg/s" in lsb.what
    scatter = np.std(np.diff(gyro[:, 2])) / 2**0.5
    assert f"{np.degrees(scatter):.4g} deg/s" in lsb.consequence


def test_a_channel_whose_noise_is_below_a_step_is_quantization_limited():
    gyro, accel = coarse(0.02)
    found = faults(gyro, accel, "step")
    assert {f.severity for f in found} == {"warning"}
    assert all("quantization-limited" in f.consequence for f in found)
    assert len(found) == 3


def test_a_line_of_a_still_record_is_named_with_its_amplitude():
    gyro, accel = still()
    gyro[:, 1] += 0.005 * np.sin(2 * np.pi * 13 * T)
    (line,) = faults(gyro, accel, "line")
    assert (line.stream, line.severity) == ("/imu gyro_y", "note")
    frequency, amplitude = (float(x.split()[0]) for x in line.what.removeprefix("line at ").split(", amplitude "))
    assert frequency == pytest.approx(13, abs=0.1)
    assert amplitude == pytest.approx(np.degrees(0.005), rel=0.15)


def test_lines_are_not_looked_for_where_the_imu_moves_or_nobody_asks():
    gyro, accel = still()
    gyro[:, 1] += 0.005 * np.sin(2 * np.pi * 13 * T)
    assert not [f for f in check(log_of(gyro, accel), lines=False).faults if f.kind == "line"]
    gyro[3000:] += 0.3 * np.sin(2 * np.pi * T[3000:])[:, None]
    assert faults(gyro, accel, "line") == []


@pytest.mark.slow
def test_the_adis_tells_its_step_and_the_line_at_0_56_hz(shared):
    from imuwb.readers import ReadOptions, read

    path = shared / "static" / "adis16405_imu1.csv.gz"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    columns = ("gx", "gy", "gz", "ax", "ay", "az")
    found = check(read(path, ReadOptions(rate=100, columns=columns, units={"gyro": "deg/s", "accel": "g"}))).faults
    steps = {f.stream.split()[-1]: f for f in found if f.kind == "step"}
    assert {name: f.what for name, f in steps.items()} == {
        **dict.fromkeys(("gyro_x", "gyro_y", "gyro_z"), "smallest step (LSB) 0.05 deg/s"),
        **dict.fromkeys(("accel_x", "accel_y", "accel_z"), "smallest step (LSB) 3.33 mg"),
    }
    assert [name for name, f in steps.items() if f.severity == "warning"] == ["accel_y"]
    lines = {f.stream.split()[-1] for f in found if f.kind == "line" and " 0.56" in f.what}
    assert lines == {"gyro_x", "accel_x", "accel_y", "accel_z"}
    assert not [f for f in found if f.severity == "fault"]


def heavy(share, size, seed=0):
    """Return a still record with a share of the samples of gyro x that are off by some sigmas."""
    gyro, accel = still(seed)
    rng = np.random.default_rng(100 + seed)
    far = rng.random(N) < share
    gyro[far, 0] += 0.01 * size * rng.choice([-1, 1], far.sum())
    return gyro, accel, int(far.sum())


@pytest.mark.parametrize("seed", range(5))
def test_heavy_tails_are_named_with_share_and_count(seed):
    gyro, accel, count = heavy(0.09, 12, seed)
    (found,) = faults(gyro, accel, "tails")
    assert (found.stream, found.severity, found.count) == ("/imu gyro_x", "warning", pytest.approx(count, abs=2))
    assert f"{100 * count / N:.2g} %" in found.what
    raised = float(found.consequence.split(" by ")[1].split(" %")[0]) / 100
    assert raised == pytest.approx(0.09 * 12**2, rel=0.15)


def test_a_few_far_samples_are_a_note():
    assert [f.severity for f in faults(*heavy(0.005, 8)[:2], "tails")] == ["note"]


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_coarse_noise_have_no_tails(seed):
    assert faults(*still(seed), "tails") == []
    assert faults(*coarse(0.02, seed), "tails") == []


def test_a_motion_has_no_tails():
    gyro, accel = still()
    gyro[3000:3600] += motion(0)[3000:3600, :3]
    assert faults(gyro, accel, "tails") == []


@pytest.mark.parametrize("level", [0.0, 0.005, -9.8, 300.0])
@pytest.mark.parametrize("scale", [1.0, np.pi / 180, 9.80665])
@pytest.mark.parametrize("sigma", [1e-3, 3e-6])
def test_the_step_of_single_precision_is_not_that_of_the_sensor(level, scale, sigma):
    gyro, accel = still()
    values = (level + sigma * np.random.default_rng(5).standard_normal(N)).astype(np.float32)
    gyro[:, 0] = np.float64(values) * scale
    assert faults(gyro, accel, "step") == []
    assert faults(gyro[:600], accel[:600], "step") == []


@pytest.mark.parametrize("level", [0.0, -9.8])
def test_the_step_of_a_sensor_is_found_in_numbers_of_single_precision(level):
    gyro, accel = still()
    lsb = 9.80665 / 4096
    values = np.float32(np.rint((level + 0.02 * np.random.default_rng(5).standard_normal(N)) / lsb)) * np.float32(lsb)
    accel[:, 0] = np.float64(values)
    (found,) = faults(gyro, accel, "step")
    assert float(found.what.split()[-2]) == pytest.approx(1000 / 4096, rel=1e-3)

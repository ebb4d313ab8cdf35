"""Faults of inertial channels: each is found where it is, and clean records have none."""

import numpy as np
import pytest

from imuwb.health import check
from imuwb.log import ImuStream, Log, Provenance, Scalars, Triad

N, RATE = 6000, 100.0
T = np.arange(N) / RATE
G = 9.80665


def log_of(gyro, accel, keep=None, temperature=None):
    time = np.rint(np.arange(len(gyro)) * 1e9 / RATE).astype(np.int64)
    keep = np.ones(time.size, bool) if keep is None else keep
    imu = ImuStream("/imu", Triad(time[keep], gyro[keep]), Triad(time[keep], accel[keep]), temperature)
    return Log(Provenance("made.csv", "csv", "", 0), (imu,))


def still(seed=0, n=N, flicker=0.0):
    """Return white noise, and flicker noise with it, of a gyro and of an accelerometer that feels gravity."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((n, 6))
    if flicker:
        spectrum = np.fft.rfft(rng.standard_normal((n, 6)), axis=0)
        noise += flicker * np.fft.irfft(spectrum / np.sqrt(np.maximum(np.arange(len(spectrum)), 1))[:, None], n, axis=0)
    return 0.01 * noise[:, :3], 0.02 * noise[:, 3:] + [0, 0, -G]


def motion(seed):
    """Return a smooth motion without a period: what lies between 0.5 and 2 Hz of white noise, of size 1."""
    noise = np.fft.rfft(np.random.default_rng(1000 + seed).standard_normal((N, 6)), axis=0)
    f = np.fft.rfftfreq(N, 1 / RATE)
    noise[(f < 0.5) | (f > 2)] = 0
    moved = np.fft.irfft(noise, N, axis=0)
    return moved / moved.std(axis=0)


def faults(gyro, accel, what="", **given):
    return [f for f in check(log_of(gyro, accel, **given)).faults if what in f.what]


def changed(**columns):
    """Return a still record of which a gyro_x, or another axis, was changed by a function."""
    gyro, accel = still()
    for name, change in columns.items():
        change((gyro if name.startswith("gyro") else accel)[:, "xyz".index(name[-1])])
    return gyro, accel


def setting(*spans):
    def change(values):
        for begin, end, value in spans:
            values[begin:end] = values[begin] if value is None else value

    return change


def coarse(step, seed=0):
    gyro, accel = still(seed)
    return np.round(gyro / step) * step, accel


@pytest.mark.parametrize("seed", range(20))
def test_still_noise_has_no_fault(seed):
    # No line but one in a hundred axes is the search's own promise; nothing else may be found.
    assert [f for f in faults(*still(seed, flicker=1.0)) if not f.what.startswith("line at")] == []


def test_of_white_noise_hardly_an_axis_shows_a_line():
    assert sum(len(faults(*still(seed, flicker=1.0), "line at")) for seed in range(20)) <= 4


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
    assert stuck.consequence == "leave these spans out"


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


@pytest.mark.parametrize(("value", "what"), [(0.0, "all zero: not connected"), (0.1, "stuck at 5.73 deg/s")])
def test_a_channel_that_never_changes_is_a_fault(value, what):
    found = faults(*changed(gyro_y=setting((0, N, value))))
    (constant,) = (f for f in found if f.stream == "/imu gyro_y")
    assert (constant.what, constant.severity, constant.count) == (what, "fault", N)
    assert constant.consequence == "there is nothing to analyse"


def test_saturation_is_found_at_both_ends():
    high, low = faults(*changed(gyro_x=setting((1000, 1010, 4.36), (3000, 3005, -4.36))), "saturated")
    assert (high.what, high.count, high.start) == ("saturated at 249.8 deg/s", 10, 10.0)
    assert (low.what, low.count, low.start) == ("saturated at -249.8 deg/s", 5, 30.0)
    assert {high.severity, low.severity} == {"fault"}
    assert "is lost" in high.consequence


def test_saturated_samples_of_several_places_are_added():
    (accel,) = faults(*changed(accel_x=setting((1000, 1004, 39.2266), (2000, 2006, 39.2266))), "saturated")
    assert (accel.stream, accel.what, accel.count) == ("/imu accel_x", "saturated at 4000 mg", 10)


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
    (lsb,) = faults(gyro, accel, "LSB")
    assert (lsb.stream, lsb.severity) == ("/imu gyro_z", "note")
    assert lsb.what == f"smallest step (LSB) {np.degrees(0.002):.4g} deg/s"
    scatter = np.std(np.diff(gyro[:, 2])) / 2**0.5
    assert lsb.consequence == f"from sample to sample it changes by {np.degrees(scatter):.4g} deg/s"


def test_a_channel_whose_noise_is_below_a_step_is_quantization_limited():
    gyro, accel = coarse(0.02)
    found = faults(gyro, accel, "LSB")
    assert {f.severity for f in found} == {"warning"}
    assert all(f.consequence.endswith("quantization-limited") for f in found)
    assert len(found) == 3


def test_lone_samples_are_counted_with_the_first_and_the_largest():
    def strike(values):
        values[1000] += 2.0
        values[2000] -= 3.0

    gyro, accel = changed(gyro_y=strike)
    (lone,) = faults(gyro, accel, "lone samples")
    assert (lone.stream, lone.severity, lone.count, lone.start) == ("/imu gyro_y", "warning", 2, 10.0)
    size = min(abs(gyro[2000, 1] - gyro[1999, 1]), abs(gyro[2000, 1] - gyro[2001, 1]))
    assert lone.what.endswith(f"by up to {np.degrees(size):.4g} deg/s")
    assert lone.consequence == "each shows in every averaging time"


def test_another_level_behind_a_gap_is_not_lone():
    gyro, accel = still()
    gyro[1100:, 0] += 1
    keep = np.ones(N, bool)
    keep[1000:1100] = False
    assert faults(gyro, accel, "lone", keep=keep) == []


@pytest.mark.parametrize("beside", [999, 1100])
def test_samples_beside_a_gap_are_not_lone(beside):
    gyro, accel = still()
    gyro[beside, 0] += 3
    keep = np.ones(N, bool)
    keep[1000:1100] = False
    assert faults(gyro, accel, "lone", keep=keep) == []
    assert len(faults(gyro, accel, "lone")) == 1  # without the gap it is


def test_a_step_of_a_coarse_sensor_is_no_lone_sample():
    gyro, accel = still()
    gyro[:, 0] = 0.0
    gyro[[500, 1500], 0] = 0.02  # one step, while it hardly ever changes
    gyro[2500:, 0] = -0.02
    assert faults(gyro, accel, "lone") == []
    gyro[3500, 0] = 0.12
    assert [f.count for f in faults(gyro, accel, "lone")] == [1]


def test_samples_are_not_lone_while_the_imu_moves():
    gyro, accel = still()
    moved = motion(3)
    moved[:2000] = 0
    gyro += 0.1 * moved[:, :3]
    gyro[4000, 1] += 5.0
    assert faults(gyro, accel + moved[:, 3:], "lone") == []
    gyro[1000, 1] += 5.0
    assert [f.count for f in faults(gyro, accel + moved[:, 3:], "lone")] == [1]


def test_many_lone_samples_are_no_motion():
    gyro, accel = still()
    gyro[500::500, 1] += 2.0
    found = check(log_of(gyro, accel))
    assert [f.count for f in found.faults if "lone" in f.what] == [11]
    assert [s.moving for s in found.segments] == [False]


def test_slow_samples_are_not_judged_to_be_lone():
    gyro, accel = still()
    gyro[1000, 0] += 3
    time = np.arange(N) * (10**9 // 10)
    imu = ImuStream("/imu", Triad(time, gyro), Triad(time, accel))
    found = check(Log(Provenance("made.csv", "csv", "", 0), (imu,)), lines=False).faults
    assert not [f for f in found if "lone" in f.what]


@pytest.mark.parametrize(("rows", "rate"), [(900, 100.0), (600, 2.0)], ids=["short", "slow"])
def test_what_is_too_short_or_too_slow_is_neither_still_nor_moving(rows, rate):
    gyro, accel = still()
    time = np.rint(np.arange(rows) * 1e9 / rate).astype(np.int64)
    imu = ImuStream("/imu", Triad(time, gyro[:rows] + 0.4), Triad(time, accel[:rows] + 5))
    found = check(Log(Provenance("made.csv", "csv", "", 0), (imu,)))
    assert (found.segments, found.segments_of) == ((), "/imu")
    assert not [f for f in found.faults if "while still" in f.what]


def test_shaking_is_no_series_of_lone_samples():
    gyro, accel = still()
    gyro[1000:1200] += 5 * np.random.default_rng(9).standard_normal((200, 3))
    assert faults(gyro, accel, "lone") == []


def test_a_step_has_no_lone_samples():
    gyro, accel = still()
    gyro[3000:, 0] += 1
    assert faults(gyro, accel, "lone") == []


def test_a_line_of_a_still_record_is_named_with_its_amplitude():
    gyro, accel = still()
    gyro[:, 1] += 0.005 * np.sin(2 * np.pi * 13 * T)
    (line,) = faults(gyro, accel, "line at")
    assert (line.stream, line.severity) == ("/imu gyro_y", "note")
    frequency, amplitude = (float(x.split()[0]) for x in line.what.removeprefix("line at ").split(", amplitude "))
    assert frequency == pytest.approx(13, abs=0.1)
    assert amplitude == pytest.approx(np.degrees(0.005), rel=0.15)


def test_lines_are_not_looked_for_where_the_imu_moves_or_nobody_asks():
    gyro, accel = still()
    gyro[:, 1] += 0.005 * np.sin(2 * np.pi * 13 * T)
    assert not [f for f in check(log_of(gyro, accel), lines=False).faults if "line" in f.what]
    gyro[3000:] += 0.3 * np.sin(2 * np.pi * T[3000:])[:, None]
    assert faults(gyro, accel, "line") == []


@pytest.mark.parametrize(
    ("gravity", "severity", "follows"),
    [(9.3, "warning", "off by -52 mg: a bias or a scale factor to be calibrated"), (3.4, "fault", "units or scale")],
)
def test_a_gravity_that_cannot_be_is_told(gravity, severity, follows):
    gyro, accel = still()
    (fault,) = faults(gyro, accel + np.array([0, 0, G - gravity]))
    assert (fault.stream, fault.severity) == ("/imu accelerometers", severity)
    assert fault.what == f"gravity is {gravity} m/s² while still"
    assert fault.consequence.startswith(follows)
    assert (fault.start, fault.length) == (0, pytest.approx(59.99))


@pytest.mark.parametrize("gravity", [9.78, 9.832])
def test_the_gravity_of_equator_and_pole_is_none(gravity):
    gyro, accel = still()
    assert faults(gyro, accel + np.array([0, 0, G - gravity])) == []


def test_a_tilted_imu_feels_one_gravity_too():
    gyro, accel = still()
    assert faults(gyro, accel - [0, 0, -G] + G * np.array([0.6, 0, -0.8])) == []


def test_a_gyro_bias_of_minus_0_4_is_told():
    gyro, accel = still()
    (bias,) = faults(gyro - [0, 0.4, 0], accel)
    assert (bias.stream, bias.severity) == ("/imu gyros", "warning")
    assert bias.what == "turns by -22.9 deg/s while still"


def test_gravity_is_judged_where_the_imu_is_still():
    gyro, accel = still()
    moving = motion(3)
    moving[:4000] = 0
    accel[4000:, 2] += 5
    assert faults(gyro + moving[:, :3], accel + 3 * moving[:, 3:], "gravity") == []
    (fault,) = faults(gyro + moving[:, :3], accel + 3 * moving[:, 3:] + [0, 0, 0.5], "gravity")
    assert fault.length == pytest.approx(40, abs=2)


def warmth(minutes, values=25.0):
    time = np.arange(0, int(minutes * 60) + 1) * 10**9
    return Scalars("/imu/temperature", time, np.broadcast_to(values, time.shape).copy())


def test_a_temperature_that_stays_for_more_than_ten_minutes_is_noted():
    (note,) = faults(*still(), temperature=warmth(10.5))
    assert (note.severity, note.what) == ("note", "temperature stays at 25 °C for 10 min")
    assert "nothing can be said of temperature" in note.consequence


def test_a_temperature_that_changes_or_is_short_is_not():
    assert faults(*still(), temperature=warmth(9.5)) == []
    warm = warmth(10.5).value.copy()
    warm[-1] += 0.1
    assert faults(*still(), temperature=warmth(10.5, warm)) == []


def test_a_still_record_is_one_segment():
    (segment,) = check(log_of(*still())).segments
    assert (segment.start, segment.end, segment.moving) == (0, pytest.approx(59.99), False)


def test_segments_tell_when_the_imu_moves():
    gyro, accel = still()
    moving = motion(5)
    moving[:2000] = moving[4000:] = 0
    parts = check(log_of(gyro + moving[:, :3], accel + 3 * moving[:, 3:])).segments
    assert [p.moving for p in parts] == [False, True, False]
    assert [p.start for p in parts[1:]] == [p.end for p in parts[:-1]]
    assert (parts[1].start, parts[1].end) == (pytest.approx(20, abs=1.1), pytest.approx(40, abs=1.1))


def test_the_adis_tells_its_step_and_the_line_at_0_56_hz(shared):
    from imuwb.readers import ReadOptions, read

    path = shared / "static" / "adis16405_imu1.csv.gz"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    columns = ("gx", "gy", "gz", "ax", "ay", "az")
    found = check(read(path, ReadOptions(rate=100, columns=columns, units={"gyro": "deg/s", "accel": "g"}))).faults
    steps = {f.stream.split()[-1]: f for f in found if "LSB" in f.what}
    assert {name: f.what for name, f in steps.items()} == {
        **dict.fromkeys(("gyro_x", "gyro_y", "gyro_z"), "smallest step (LSB) 0.05 deg/s"),
        **dict.fromkeys(("accel_x", "accel_y", "accel_z"), "smallest step (LSB) 3.33 mg"),
    }
    assert [name for name, f in steps.items() if f.severity == "warning"] == ["accel_y"]
    lines = {f.stream.split()[-1] for f in found if f.what.startswith("line at 0.56")}
    assert lines == {"gyro_x", "accel_x", "accel_y", "accel_z"}
    assert not [f for f in found if f.severity == "fault"]

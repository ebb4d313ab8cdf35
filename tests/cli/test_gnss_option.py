"""``--gnss``: the receiver's file beside the IMU's, RTKLIB or CSV."""

import json
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb import read

START = datetime(2024, 5, 1, 12, 0, 0, tzinfo=UTC)
SINCE_1970 = START.timestamp()
AXES = "gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"
RTKLIB = (
    "%  GPST  latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio"
)


@pytest.fixture
def imu_csv(tmp_path):
    """Write 60 s of a still IMU, since 1970 or since the log's start."""

    def make(zero=SINCE_1970):
        rng = np.random.default_rng(2)
        values = 0.01 * rng.standard_normal((6000, 6)) - [0, 0, 0, 0, 0, 9.8]
        rows = [f"{zero + 0.01 * i:.2f}," + ",".join(f"{x:.6f}" for x in row) for i, row in enumerate(values)]
        path = tmp_path / "imu.csv"
        path.write_text("\n".join([f"time_s,{AXES}", *rows, ""]), "utf-8")
        return path

    return make


@pytest.fixture
def rtklib(tmp_path):
    path = tmp_path / "fixes.pos"
    lines = [RTKLIB]
    for i in range(60):
        gps = START + timedelta(seconds=18 + i)
        lines.append(f"{gps:%Y/%m/%d %H:%M:%S}.000 {47 + 1e-5 * i:.7f} 8.5000000 400.0 1 12 .01 .01 .02 0 0 0 0 99")
    path.write_text("\n".join([*lines, ""]), "utf-8")
    return path


@pytest.fixture
def fixes_csv(tmp_path):
    path = tmp_path / "fixes.csv"
    rows = [f"{START.timestamp() + i:.3f},{47 + 1e-5 * i:.7f},8.5,400" for i in range(60)]
    path.write_text("\n".join(["time_s,latitude_deg,longitude_deg,height_m", *rows, ""]), "utf-8")
    return path


@pytest.mark.parametrize("kind", ["rtklib", "fixes_csv"])
def test_the_receiver_s_file_is_joined(imuwb, imu_csv, tmp_path, request, kind):
    fixes = request.getfixturevalue(kind)
    done = imuwb("convert", imu_csv(), "--gnss", fixes, "-o", "both.mcap", "--full")
    assert done.code == 0, done.err
    log = read(tmp_path / "both.mcap")
    assert len(log.imus[0].angular_rate) == 6000
    (gnss,) = log.gnss
    assert (gnss.time - gnss.time[0]).tolist() == [i * 10**9 for i in range(60)]
    assert gnss.time[0] == int(START.timestamp()) * 10**9
    assert np.degrees(gnss.position[:, 0]) == pytest.approx(47 + 1e-5 * np.arange(60), abs=1e-9)
    assert fixes.name in done.err
    assert "unix time" not in done.err


def document(imuwb, *arguments):
    done = imuwb("health", *arguments, "-o", "health.rrd", "--json", "-")
    assert done.code == 0, done.err
    return json.loads(done.out)


def test_health_looks_at_both(imuwb, imu_csv, rtklib):
    found = document(imuwb, imu_csv(), "--gnss", rtklib)
    assert [(s["name"], s["verdict"]) for s in found["result"]["streams"]] == [("imu", "good"), ("gnss", "good")]
    assert any("fixes.pos (sha256:" in note and "joined" in note for note in found["notes"])
    assert not [n for n in found["notes"] if "unix time" in n]


def test_different_clocks_are_noted_and_a_fault(imuwb, imu_csv, rtklib):
    found = document(imuwb, imu_csv(0.0), "--gnss", rtklib)
    assert any("unix time" in note and "log time" in note for note in found["notes"])
    worst = found["result"]["faults"][0]
    assert (worst["stream"], worst["severity"]) == ("gnss", "fault")
    assert "two clocks" in worst["what"]


def test_a_span_cuts_the_fixes_as_well(imuwb, imu_csv, rtklib, tmp_path):
    done = imuwb("convert", imu_csv(), "--gnss", rtklib, "-o", "part.mcap", "--start", "10", "--end", "20")
    assert done.code == 0, done.err
    log = read(tmp_path / "part.mcap")
    assert (len(log.imus[0].angular_rate), len(log.gnss[0])) == (1000, 10)


def test_a_span_of_two_clocks_is_refused(imuwb, imu_csv, rtklib, tmp_path):
    done = imuwb("convert", imu_csv(0.0), "--gnss", rtklib, "-o", "part.mcap", "--start", "10")
    assert done.code == 2
    assert "(log, unix)" in done.err
    assert not (tmp_path / "part.mcap").exists()


def test_a_receiver_s_file_that_is_not_there_is_named(imuwb, imu_csv):
    done = imuwb("health", imu_csv(), "--gnss", "gone.pos")
    assert done.code == 4
    assert "gone.pos" in done.err


def test_options_of_the_imu_s_text_are_not_the_receiver_s(imuwb, imu_csv, fixes_csv, tmp_path):
    path = imu_csv()
    bare = path.with_name("bare.csv")
    bare.write_text("\n".join([*path.read_text("utf-8").splitlines()[1:], ""]), "utf-8")
    columns = "time_s,gx,gy,gz,ax,ay,az"
    done = imuwb("convert", bare, "--columns", columns, "--units", "gyro=deg/s,accel=m/s2", "--gnss", fixes_csv,
                 "-o", "both.mcap")  # fmt: skip
    assert done.code == 0, done.err
    log = read(tmp_path / "both.mcap")
    assert len(log.gnss[0]) == 60
    assert log.imus[0].angular_rate.value.std() == pytest.approx(np.radians(0.01), rel=0.05)


def test_a_file_without_a_receiver_is_refused(imuwb, imu_csv, tmp_path):
    path = imu_csv()
    (tmp_path / "other.csv").write_bytes(path.read_bytes())
    done = imuwb("health", path, "--gnss", "other.csv")
    assert done.code == 3
    assert "other.csv: " in done.err
    assert "receiver, reference or speed" in done.err
    assert not list(tmp_path.glob("*.rrd"))


def test_a_receiver_of_another_day_is_noted(imuwb, imu_csv, rtklib):
    found = document(imuwb, imu_csv(SINCE_1970 + 86_400), "--gnss", rtklib)
    assert any("times" in note and "belong together" in note for note in found["notes"])


def test_a_note_that_both_files_have_is_shown_once(imuwb, imu_csv, fixes_csv):
    found = document(imuwb, imu_csv(), "--gnss", fixes_csv)
    assert len([n for n in found["notes"] if "taken as UTC" in n]) == 1


@pytest.mark.parametrize("shift", ["start", f"-{START.timestamp() - 100:.1f}"])
def test_a_clock_that_does_not_meet_the_imu_s_is_shifted(imuwb, imu_csv, rtklib, tmp_path, shift):
    done = imuwb("convert", imu_csv(100.0), "--gnss", rtklib, "--gnss-shift", shift, "-o", "both.mcap")
    assert done.code == 0, done.err
    assert read(tmp_path / "both.mcap").gnss[0].time[0] == 100 * 10**9
    assert "unix time" not in done.err


@pytest.mark.parametrize("shift", ["soon", "nan", "inf", "1e10", ""])
def test_a_shift_is_a_number_or_start(imuwb, imu_csv, rtklib, shift):
    done = imuwb("health", imu_csv(), "--gnss", rtklib, "--gnss-shift", shift)
    assert done.code == 2
    assert "--gnss-shift" in done.err


def test_a_shift_needs_a_receiver(imuwb, imu_csv):
    done = imuwb("health", imu_csv(), "--gnss-shift", "1")
    assert done.code == 3
    assert "no receiver" in done.err

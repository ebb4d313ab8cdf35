"""Every recording beside the repository is read, or refused for its reason; ``shared_data.toml`` says what is in each."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from imuwb import errors
from imuwb.readers import ReadOptions, read
from imuwb.summary import summarize

FOLDERS = ("tlog", "dataflash", "ulog", "mcap", "mcap/native", "drive", "static")
TABLE = tomllib.loads(Path(__file__).with_name("shared_data.toml").read_text("utf-8"))["file"]
HUSKY = (
    "husky_test1_json.mcap", "husky_test1_protobuf.mcap", "husky_test1_ros1msg_lz4.mcap",
    "husky_test1_ros2cdr_unchunked.mcap", "husky_test1_ros2cdr_zstd.mcap", "robot_localization_test1.bag",
)  # fmt: skip
SECOND = 10**9


def options_of(entry):
    return ReadOptions(**entry.get("options", {}))


def name_of(entry):
    return entry["path"] + (" with options" if "options" in entry else "")


@pytest.mark.slow
@pytest.mark.parametrize("entry", [entry for entry in TABLE if "refused" not in entry], ids=name_of)
def test_a_recording_holds_what_the_table_says(shared, entry):
    log = read(shared / entry["path"], options_of(entry))
    summary = summarize(log)
    assert summary.format == entry["format"]
    found = [(s.name, s.kind, s.count, float(f"{s.rate_hz:.3g}"), len(s.gaps)) for s in summary.streams]
    assert found == [tuple(row[:5]) for row in entry["streams"]]
    repairs = [{repair.what.id: repair.count for repair in s.repairs} for s in summary.streams]
    assert repairs == [row[5] if len(row) > 5 else {} for row in entry["streams"]]
    for note, (name, *pieces) in zip(summary.notes, entry.get("notes", ()), strict=True):
        assert note.id == name
        assert all(piece in note for piece in pieces)


@pytest.mark.parametrize("entry", [entry for entry in TABLE if "refused" in entry], ids=name_of)
def test_a_file_that_states_too_little_or_is_no_log_is_refused(shared, entry):
    kind, *pieces = entry["refused"]
    with pytest.raises(getattr(errors, kind)) as caught:
        read(shared / entry["path"])
    assert type(caught.value).__name__ == kind
    for piece in (entry["path"], *pieces):
        assert piece in str(caught.value)


def test_no_recording_is_missing_in_the_table(shared):
    there = {str(path.relative_to(shared)) for name in FOLDERS for path in (shared / name).iterdir() if path.is_file()}
    assert there == {entry["path"] for entry in TABLE}


@pytest.mark.slow
def test_six_files_of_one_run_are_one_log(shared):
    first, *others = (read(shared / "mcap" / name) for name in HUSKY)
    (imu,), (gnss,) = first.imus, first.gnss
    assert np.median(imu.specific_force.value, axis=0)[1] == pytest.approx(-9.8, abs=0.3)  # gravity on y, of FLU
    assert np.ptp(imu.angular_rate.time) == pytest.approx(395.3 * SECOND, abs=0.1 * SECOND)
    for log in others:
        (other,), (fixes,) = log.imus, log.gnss
        for mine, theirs in (
            (imu.angular_rate.time, other.angular_rate.time), (imu.angular_rate.value, other.angular_rate.value),
            (imu.specific_force.time, other.specific_force.time), (imu.specific_force.value, other.specific_force.value),
            (gnss.time, fixes.time), (gnss.position, fixes.position),
        ):  # fmt: skip
            np.testing.assert_array_equal(mine, theirs)


def test_a_flight_with_four_reboots_runs_on(shared):
    path = shared / "tlog" / "pymavlink_flight.tlog"
    own, recorded = read(path), read(path, ReadOptions(time_source="log"))
    assert sum(note.id == "reboots" and ": 4 " in note for note in own.notes) == 1
    for log, within in ((own, 3), (recorded, 0.5)):
        streams = [*(triad for imu in log.imus for triad in (imu.angular_rate, imu.specific_force)), *log.gnss]
        for stream in (*streams, *log.references):
            assert (np.diff(stream.time) > 0).all()
            assert np.ptp(stream.time) == pytest.approx(2435 * SECOND, abs=within * SECOND)
            assert not [repair for imu in log.imus for repair in imu.origin.repairs]


def test_a_flight_controllers_three_imus_and_its_receiver(shared):
    log = read(shared / "dataflash" / "mavparser_00000081.BIN")
    rates = {stream.name: stream.rate_hz for stream in summarize(log).streams if stream.kind in ("imu", "gnss")}
    assert rates["GPS.0"] == pytest.approx(5, rel=1e-3)
    imus = [imu for imu in log.imus if imu.name.startswith("IMU.")]
    assert [imu.name for imu in imus] == ["IMU.0", "IMU.1", "IMU.2"]
    for imu in imus:
        assert rates[imu.name] == pytest.approx(25, rel=1e-3)
        assert len(imu.temperature) == len(imu.angular_rate) == len(imu.specific_force)
        assert ((imu.temperature.value > 20) & (imu.temperature.value < 80)).all()
        assert np.linalg.norm(np.median(imu.specific_force.value, axis=0)) == pytest.approx(9.8, abs=0.5)


def test_the_drive_s_imu_and_receiver_are_on_one_clock(shared):
    (imu,) = read(shared / "drive" / "derived_imu_si_gpst.csv.gz").imus
    (gnss,) = read(shared / "drive" / "gnss_1934_sf.pos").gnss
    # The receiver is switched on some seconds before the IMU and off after it; GPS time would be 18 s ahead.
    assert abs(int(imu.angular_rate.time[0]) - int(gnss.time[0])) < 5 * SECOND
    assert abs(int(imu.angular_rate.time[-1]) - int(gnss.time[-1])) < 5 * SECOND

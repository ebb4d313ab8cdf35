"""Several text files as one log: a file and its partner, a folder, a zip file."""

import zipfile

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import ReadOptions, read, reader_of

ROWS = 300
RNG = np.random.default_rng(5)
RATES = np.round(RNG.normal(0, 0.01, (ROWS, 3)), 6)
FORCES = np.round(RNG.normal((0, 0, 9.8), 0.02, (ROWS, 3)), 6)
START = 1_752_154_081 * 10**9
TIMES = START + np.arange(ROWS) * 10_000_000
LATE = 4_000_000
FLU = np.array([1, -1, -1])


def sensor_logger(values, late=0):
    """Return a file of Sensor Logger: ns since 1970, and the axes from z to x."""
    rows = (
        f"{t + late},{(t + late - START) / 1e9:.4f},{z},{y},{x}" for t, (x, y, z) in zip(TIMES, values, strict=True)
    )
    return "\n".join(["time,seconds_elapsed,z,y,x", *rows, ""])


def phyphox(name, unit, values, late=0):
    """Return a file of phyphox: seconds from the start, quoted names with units, and the absolute value."""
    header = ",".join(f'"{x}"' for x in ("Time (s)", *(f"{name} {a} ({unit})" for a in "xyz"), f"Absolute ({unit})"))
    rows = (
        ",".join(f"{x:.9E}" for x in ((t + late - START) / 1e9, *v, np.linalg.norm(v)))
        for t, v in zip(TIMES, values, strict=True)
    )
    return "\n".join([header, *rows, ""])


def plain(values, late=0):
    rows = (f"{(t + late - START) / 1e9:.3f},{x},{y},{z}" for t, (x, y, z) in zip(TIMES, values, strict=True))
    return "\n".join(["time_s,x,y,z", *rows, ""])


RECORDS = {
    "sensor logger": {
        "Gyroscope.csv": sensor_logger(RATES, LATE), "TotalAcceleration.csv": sensor_logger(FORCES),
        "Accelerometer.csv": sensor_logger(FORCES - [0, 0, 9.8]), "Metadata.csv": "device,platform\nx,android\n",
    },
    "phyphox": {
        "Gyroscope.csv": phyphox("Gyroscope", "rad/s", RATES, LATE), "Accelerometer.csv": phyphox("Acceleration", "m/s^2", FORCES),
        "Linear Accelerometer.csv": phyphox("Linear Acceleration", "m/s^2", FORCES - [0, 0, 9.8]),
    },
    "plain": {"run7_gyro.csv": plain(RATES, LATE), "run7_accel.csv": plain(FORCES), "run8_gyro.csv": plain(RATES + 1)},
}  # fmt: skip
UNITS = {"gyro": "rad/s", "accel": "m/s²"}


@pytest.mark.parametrize("mark", [" (1)", " - Copy", "_2", "-3", " copy"])
def test_a_copy_of_a_file_has_the_shape_of_the_file(tmp_path, mark):
    for name in ("Gyroscope", "TotalAcceleration"):
        (tmp_path / f"{name}{mark}.csv").write_text(RECORDS["sensor logger"][f"{name}.csv"])
    (imu,) = read(tmp_path / f"Gyroscope{mark}.csv").imus
    np.testing.assert_allclose(np.abs(imu.angular_rate.value), np.abs(RATES))
    np.testing.assert_allclose(np.abs(imu.specific_force.value), np.abs(FORCES))


def written(folder, files):
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    return folder


def assert_joined(log, start=0):
    (imu,) = log.imus
    np.testing.assert_allclose(np.abs(imu.angular_rate.value), np.abs(RATES), rtol=1e-12)
    np.testing.assert_allclose(np.abs(imu.specific_force.value), np.abs(FORCES), rtol=1e-12)
    assert imu.angular_rate.time[0] - imu.specific_force.time[0] == LATE
    assert np.array_equal(np.diff(imu.specific_force.time), np.diff(TIMES))
    assert imu.origin.units.count("/s") == 2


@pytest.mark.parametrize("record", RECORDS)
def test_a_file_of_one_sensor_is_joined_with_its_partner(tmp_path, record):
    folder = written(tmp_path / "log", RECORDS[record])
    names = {"plain": ("run7_gyro.csv", "run7_accel.csv")}.get(record, list(RECORDS[record])[:2])
    for name in names:
        log = read(folder / name, ReadOptions(units=UNITS))
        assert_joined(log)
        assert [note.id for note in log.notes].count("partner") == 1


@pytest.mark.parametrize("record", ["sensor logger", "phyphox"])
@pytest.mark.parametrize("packed", [False, True])
def test_a_folder_or_a_zip_file_of_sensors_is_one_log(tmp_path, record, packed):
    place = written(tmp_path / "log", {**RECORDS[record], "notes.txt": "nothing of use\n"})
    if packed:
        place = tmp_path / "log.zip"
        with zipfile.ZipFile(place, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in RECORDS[record].items():
                archive.writestr(f"2025-07-10/{name}", text)
    assert reader_of(place).format == "csv"
    log = read(place)
    assert_joined(log)
    assert any(note.id == "unused" and "ccelerometer.csv" in note for note in log.notes)
    assert str(tmp_path / "log") in log.provenance.path


def test_uncalibrated_sensors_are_an_imu_of_their_own(tmp_path):
    files = RECORDS["sensor logger"] | {"GyroscopeUncalibrated.csv": sensor_logger(RATES + 0.5)}
    log = read(written(tmp_path / "log", files))
    assert [bool(imu.specific_force) for imu in log.imus].count(True) == 1
    whole, other = sorted(log.imus, key=lambda imu: imu.specific_force is None)
    np.testing.assert_allclose(np.abs(whole.angular_rate.value), np.abs(RATES), rtol=1e-12)
    assert "uncalibrated" in other.name.lower()


def test_a_file_of_another_day_is_no_partner(tmp_path):
    files = {"Gyroscope.csv": sensor_logger(RATES, 86_400 * 10**9), "TotalAcceleration.csv": sensor_logger(FORCES)}
    log = read(written(tmp_path / "log", files) / "Gyroscope.csv")
    assert log.imus[0].specific_force is None
    assert [note.id for note in log.notes].count("partner_left_out") == 1


def test_a_folder_of_other_files_is_no_log(tmp_path):
    folder = written(tmp_path / "log", {"drive1.csv": plain(RATES), "drive2.csv": plain(RATES)})
    with pytest.raises(UnreadableLogError, match="directory"):
        read(folder)


def test_files_of_two_records_are_two_imus(tmp_path):
    files = {"run1_gyro.csv": plain(RATES), "run2_accel.csv": plain(FORCES)}
    log = read(written(tmp_path / "log", files), ReadOptions(units=UNITS))
    assert len(log.imus) == 2


@pytest.mark.parametrize("packed", [False, True])
def test_a_file_of_an_unknown_shape_has_the_frame_of_its_partner(tmp_path, packed):
    files = {"Gyroscope.csv": phyphox("Gyroscope", "rad/s", RATES), "Accelerometer.csv": plain(FORCES)}
    folder = written(tmp_path / "log", files)
    for place in (folder,) if packed else (folder / "Gyroscope.csv", folder / "Accelerometer.csv"):
        log = read(place, ReadOptions(units=UNITS))
        (imu,) = log.imus
        np.testing.assert_allclose(imu.angular_rate.value, RATES * FLU, rtol=1e-12)
        np.testing.assert_allclose(imu.specific_force.value, FORCES * FLU, rtol=1e-12)
        assert [note.id for note in log.notes].count("frame_shared") == 1


class TestZipFiles:
    def zipped(self, path, members, **options):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, **options) as archive:
            for name, text in members:
                archive.writestr(name, text)
        return path

    def test_no_name_leaves_the_folder(self, tmp_path):
        members = [("../../Gyroscope.csv", sensor_logger(RATES)), ("/etc/TotalAcceleration.csv", sensor_logger(FORCES))]
        inner = tmp_path / "a" / "b"
        inner.mkdir(parents=True)
        log = read(self.zipped(inner / "log.zip", members))
        assert len(log.imus[0].specific_force) == ROWS
        assert [path.name for path in tmp_path.rglob("*.csv")] == []

    def test_more_than_the_limit_is_refused(self, tmp_path, monkeypatch):
        monkeypatch.setattr("imuwb.readers.text.zipped.LARGEST", 1 << 20)
        path = self.zipped(tmp_path / "log.zip", [("Gyroscope.csv", sensor_logger(RATES) + "0" * (2 << 20))])
        with pytest.raises(UnreadableLogError, match=r"log\.zip"):
            read(path)

    @pytest.mark.parametrize("at", [0.3, 0.6, 0.97])
    def test_a_damaged_zip_file_is_named(self, tmp_path, at):
        path = self.zipped(tmp_path / "log.zip", [("Gyroscope.csv", sensor_logger(RATES))])
        content = bytearray(path.read_bytes())
        path.write_bytes(content[: int(at * len(content))])
        with pytest.raises(UnreadableLogError, match=r"log\.zip"):
            read(path)

    def test_an_error_of_a_member_names_the_zip_file(self, tmp_path):
        path = self.zipped(tmp_path / "log.zip", [("gyro.csv", plain(RATES))])
        with pytest.raises(Exception, match=r"log\.zip.*gyro\.csv.*--units gyro"):
            read(path)

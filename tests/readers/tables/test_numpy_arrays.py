"""NumPy's arrays and archives, and the folders of comma2k19; no pickle is opened."""

import gzip
import io
import zipfile

import numpy as np
import pytest

from imuwb.errors import ImuwbError, UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read, reader_of

N, M = 500, 40
RNG = np.random.default_rng(8)
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
TIME = 46_408.58 + 0.01 * np.arange(N)
NAMES = ("time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2")


def assert_imu(imu, rtol=1e-15):
    np.testing.assert_allclose(imu.angular_rate.value, RATE, rtol=rtol, atol=1e-17)
    np.testing.assert_allclose(imu.specific_force.value, FORCE, rtol=rtol, atol=1e-17)
    assert np.abs(imu.angular_rate.time / 1e9 - TIME).max() < 1e-8


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_an_archive_of_named_arrays(tmp_path, save):
    path = tmp_path / "log.bin"
    with path.open("wb") as file:
        save(file, time_s=TIME, gyro_deg_s=np.degrees(RATE), accel_m_s2=FORCE, speed_m_s=np.ones(3))
    log = read(path)
    assert log.provenance.format == "numpy"
    assert_imu(log.imus[0], rtol=1e-14)
    assert any(note.id == "unused" and "speed_m_s" in note for note in log.notes)


@pytest.mark.parametrize("kind", ["f2", "f4", "longdouble", ">f8", "i8", "?"])
def test_numbers_of_any_type(tmp_path, kind):
    path = tmp_path / "log.npz"
    np.savez(path, time_s=TIME, gyro_rad_s=np.ones((N, 3), kind))
    (imu,) = read(path).imus
    assert imu.angular_rate.value.tolist() == [[1, 1, 1]] * N


@pytest.mark.parametrize("kind", ["<f8", ">f8"])
def test_an_array_with_named_fields(tmp_path, kind):
    path = tmp_path / "log.npy"
    table = np.zeros(N, [(name, kind) for name in NAMES])
    for name, column in zip(NAMES, np.column_stack([TIME, RATE, FORCE]).T, strict=True):
        table[name] = column
    np.save(path, table)
    assert_imu(read(path).imus[0])


def test_a_matrix_needs_names(tmp_path):
    path = tmp_path / "log.npy"
    np.save(path, np.column_stack([TIME, RATE, FORCE, RATE]))
    with pytest.raises(UsageError, match="--columns"):
        read(path)
    assert_imu(read(path, ReadOptions(columns=(*NAMES, "-", "-", "-"))).imus[0])


def test_a_matrix_of_increments_is_known(tmp_path):
    path = tmp_path / "log.npy"
    np.save(path, np.column_stack([TIME, RATE * 0.01, FORCE * 0.01]))
    assert_imu(read(path).imus[0], rtol=1e-6)


def test_pickles_stay_closed(tmp_path):
    path = tmp_path / "log.npy"
    np.save(path, np.array([{"gyro": 1}, "x"], dtype=object), allow_pickle=True)
    with pytest.raises(UnreadableLogError, match="Python objects"):
        read(path)
    np.savez(tmp_path / "log.npz", time_s=TIME, gyro=np.array([{}], dtype=object))
    with pytest.raises(UnreadableLogError, match="Python objects"):
        read(tmp_path / "log.npz")


def test_absurd_counts_are_refused(tmp_path):
    path = tmp_path / "log.npy"
    np.save(path, TIME)
    data = path.read_bytes()
    path.write_bytes(data.replace(b"(500,)", b"(5" + b"0" * 15 + b",)", 1).replace(b" " * 13 + b"\n", b"\n", 1))
    with pytest.raises(UnreadableLogError, match="than the file has"):
        read(path)
    inner = io.BytesIO(path.read_bytes())
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("time_s.npy", inner.getvalue())
    with pytest.raises(UnreadableLogError, match="than the file has"):
        read(tmp_path / "log.npz")


def test_a_packed_array_is_refused(tmp_path):
    np.save(tmp_path / "log.npy", TIME)
    path = tmp_path / "log.npy.gz"
    path.write_bytes(gzip.compress((tmp_path / "log.npy").read_bytes()))
    with pytest.raises(UnreadableLogError, match="unpack it first"):
        read(path)


@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_damage_ends_in_rows_or_in_an_error(tmp_path, suffix):
    path = tmp_path / f"log{suffix}"
    if suffix == ".npy":
        np.save(path, np.column_stack([TIME, RATE * 0.01, FORCE * 0.01])[:60])
    else:
        np.savez_compressed(path, time_s=TIME[:60], gyro_rad_s=RATE[:60], accel_m_s2=FORCE[:60])
    data, rng, outcomes = path.read_bytes(), np.random.default_rng(2), set()
    for number in range(40):
        changed = bytearray(data)
        if number % 3 == 0:
            changed = changed[: int(rng.integers(10, len(data)))]
        else:
            for bit in rng.integers(48, 8 * len(data), 1 + 30 * (number % 3 - 1)).tolist():
                changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        try:
            read(path)
        except ImuwbError as error:
            outcomes.add("refused" if str(path) in str(error) or "column" in str(error) else str(error))
        else:
            outcomes.add("read")
    assert outcomes <= {"read", "refused"}
    assert "refused" in outcomes


# Folders of comma2k19


def put(folder, time, value):
    folder.mkdir(parents=True)
    for name, array in (("t", time), ("value", value)):
        with (folder / name).open("wb") as file:
            np.save(file, array)


@pytest.fixture
def drive(tmp_path):
    top = tmp_path / "40" / "processed_log"
    put(top / "IMU" / "accelerometer", TIME, FORCE)
    put(top / "IMU" / "gyro", TIME, RATE)
    put(top / "IMU" / "gyro_bias", TIME, RATE)
    put(top / "IMU" / "gyro_uncalibrated", TIME, RATE + 0.01)
    fixes = np.column_stack([
        np.full(M, 37.5), np.full(M, -122.5), np.full(M, 20.0), 1.533e12 + 100 * np.arange(M), np.full(M, 30.0), np.full(M, 90.0),
    ])  # fmt: skip
    put(top / "GNSS" / "live_gnss_ublox", TIME[:M] + 0.005, fixes)
    put(top / "CAN" / "speed", TIME, np.full((N, 1), 20.5))
    return tmp_path / "40"


@pytest.mark.parametrize("inside", [".", "processed_log"])
def test_a_folder_of_sensors(drive, inside):
    log = read(drive / inside)
    assert log.provenance.format == "numpy"
    assert [imu.name for imu in log.imus] == ["imu", "gyro_uncalibrated"]
    assert_imu(log.imus[0])
    np.testing.assert_allclose(log.imus[1].angular_rate.value, RATE + 0.01, rtol=1e-15)
    (gnss,) = log.gnss
    np.testing.assert_allclose(gnss.position, [[np.radians(37.5), np.radians(-122.5), 30]] * M, rtol=1e-15)
    np.testing.assert_allclose(gnss.velocity[:, :2], [[0, 20]] * M, atol=1e-14)
    assert np.abs(gnss.time / 1e9 - TIME[:M] - 0.005).max() < 1e-8
    assert log.speeds[0].value.tolist() == [20.5] * N
    assert {log.imus[0].origin.epoch, gnss.origin.epoch} == {"boot"}
    assert any(note.id == "unused" and "gyro_bias" in note for note in log.notes)
    assert "arrival_time" in ids(log.notes)


def test_one_sensor_by_its_folder_or_its_array(drive):
    gyro = drive / "processed_log" / "IMU" / "gyro"
    for path in (gyro, gyro / "value", gyro / "t"):
        (imu,) = read(path).imus
        np.testing.assert_allclose(imu.angular_rate.value, RATE, rtol=1e-15)
        assert imu.specific_force is None


def test_other_folders_are_no_log(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "t").write_bytes(b"")
    with pytest.raises(ImuwbError, match="directory"):
        reader_of(tmp_path)


@pytest.mark.parametrize("damage", ["short", "narrow", "texts", "cut"])
def test_a_damaged_sensor(drive, damage):
    accel = drive / "processed_log" / "IMU" / "accelerometer"
    changed = {"short": FORCE[:-100], "narrow": FORCE[:, :2], "texts": np.array(["a"] * N), "cut": FORCE}[damage]
    with (accel / "value").open("wb") as file:
        np.save(file, changed)
    if damage == "cut":
        data = (accel / "value").read_bytes()
        (accel / "value").write_bytes(data[: len(data) // 2])
    if damage == "short":
        assert len(read(drive).imus[0].specific_force) == N - 100
    else:
        with pytest.raises(UnreadableLogError, match="accelerometer"):
            read(drive)

"""HDF5 files of other programs than MATLAB: groups, attributes of units, compound rows, and damage."""

import numpy as np
import pytest

from imuwb.errors import ImuwbError, UnreadableLogError
from imuwb.readers import ReadOptions, read

h5py = pytest.importorskip("h5py")

N = 400
RNG = np.random.default_rng(8)
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
TIME = 5000.0 + 0.01 * np.arange(N)


@pytest.fixture
def written(tmp_path):
    def write(fill, **options):
        path = tmp_path / "log.h5"
        with h5py.File(path, "w") as file:
            fill(file)
        log = read(path, ReadOptions(**options))
        assert log.provenance.format == "hdf5"
        return log

    return write


def assert_imu(log, rtol=1e-15):
    (imu,) = log.imus
    np.testing.assert_allclose(imu.angular_rate.value, RATE, rtol=rtol, atol=1e-17)
    np.testing.assert_allclose(imu.specific_force.value, FORCE, rtol=rtol, atol=1e-17)
    assert np.abs(imu.angular_rate.time / 1e9 - TIME).max() < 1e-8


def test_a_group_with_units_in_attributes(written):
    def fill(file):
        group = file.create_group("synced")
        for name, values, unit in (
            ("time", TIME, "s"),
            ("gyro", np.degrees(RATE), "deg/s"),
            ("accel", FORCE, b"m/s^2"),
        ):
            group.create_dataset(name, data=values, compression="gzip").attrs["units"] = unit
        file["note"] = "text"

    log = written(fill)
    assert_imu(log, rtol=1e-14)
    assert any(note.id == "unused" and "note" in note for note in log.notes)


def test_units_by_option(written):
    def fill(file):
        file["time"], file["gyro"], file["acc"] = TIME, RATE, FORCE

    assert_imu(written(fill, units={"time": "s", "gyro": "rad/s", "accel": "m/s²"}))


def test_compound_rows(written):
    names = ("time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2")

    def fill(file):
        table = np.zeros(N, [*((name, "<f8") for name in names), ("label", "S4")])
        for name, column in zip(names, np.column_stack([TIME, RATE, FORCE]).T, strict=True):
            table[name] = column
        file["imu"] = table

    assert_imu(written(fill))


def test_other_arrays_are_named(written):
    with pytest.raises(UnreadableLogError, match="voltage"):
        written(lambda file: file.create_dataset("voltage", data=np.arange(50.0)))


def test_a_count_beyond_the_file_is_refused(written):
    def fill(file):
        file.create_dataset("gyro_rad_s", shape=(10**12, 3), dtype="f8", chunks=(1000, 3), compression="gzip")

    with pytest.raises(UnreadableLogError, match=r"log\.h5"):
        written(fill)


def test_damage_ends_in_rows_or_in_an_error(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["time_s"], file["gyro_rad_s"], file["accel_m_s2"] = TIME[:40], RATE[:40], FORCE[:40]
    data, rng, outcomes = path.read_bytes(), np.random.default_rng(2), set()
    for number in range(12):
        changed = bytearray(data)
        if number % 3 == 0:
            changed = changed[: int(rng.integers(10, len(data)))]
        else:
            for bit in rng.integers(64, 8 * len(data), 1 + 30 * (number % 3 - 1)).tolist():
                changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        try:
            read(path)
        except ImuwbError as error:
            outcomes.add("refused" if str(path) in str(error) or "column" in str(error) else str(error))
        else:
            outcomes.add("read")
    assert outcomes == {"read", "refused"}

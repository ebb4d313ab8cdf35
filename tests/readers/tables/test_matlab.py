"""MATLAB files of both kinds: structures of NaveGo, matrices of PSINS, arrays with names, and damage."""

import numpy as np
import pytest
from scipy.io import savemat

from imuwb.errors import ImuwbError, UnreadableLogError, UsageError
from imuwb.readers import ReadOptions, read

h5py = pytest.importorskip("h5py")

N, M = 600, 40
RNG = np.random.default_rng(8)
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
TIME = 138_001.005 + 0.01 * np.arange(N)
FIXES = 138_001.0 + 0.2 * np.arange(M)
PLACE = np.radians([47.5, 8.5, 0]) + RNG.normal(0, 1e-6, (M, 3)) + (0, 0, 500)
VELOCITY = RNG.normal(0, 3, (M, 3))
IMU = {"t": TIME[:, None], "fb": FORCE, "wb": RATE, "freq": 100.0, "vrw": np.full((1, 3), 0.1)}
GNSS = {
    "t": FIXES[:, None],
    "lat": PLACE[:, :1],
    "lon": PLACE[:, 1:2],
    "h": PLACE[:, 2:],
    "vel": VELOCITY,
    "stdm": np.array([[1.0, 2.0, 3.0]]),
    "stdv": np.full((M, 3), 0.1),
    "freq": 5.0,
}
REF = GNSS | {"roll": np.zeros((M, 1)), "pitch": np.full((M, 1), 0.1), "yaw": np.linspace(0, 1, M)[:, None]}


def version_7_3(path, tree):
    """Write what MATLAB writes: columns first, structures as groups, 512 bytes of text before the HDF5 file."""

    def put(group, values):
        for name, value in values.items():
            if isinstance(value, dict):
                put(group.create_group(name), value)
            else:
                group.create_dataset(name, data=np.atleast_2d(np.asarray(value, np.float64)).T, chunks=None)

    with h5py.File(path, "w", userblock_size=512) as file:
        put(file, tree)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon".ljust(124) + b"\x00\x02IM")


@pytest.fixture(params=["5", "7.3"])
def log_of(request, tmp_path):
    def log(tree, **options):
        path = tmp_path / "log.mat"
        if request.param == "5":
            savemat(path, tree, do_compression=True)
        else:
            version_7_3(path, tree)
        found = read(path, ReadOptions(**options))
        assert found.provenance.format == "matlab"
        return found

    return log


def assert_imu(imu, rows=slice(None), rtol=1e-15, time=TIME):
    np.testing.assert_allclose(imu.angular_rate.value, RATE[rows], rtol=rtol, atol=1e-17)
    np.testing.assert_allclose(imu.specific_force.value, FORCE[rows], rtol=rtol, atol=1e-17)
    assert np.abs(imu.angular_rate.time / 1e9 - time[rows]).max() < 1e-7


def test_structures_of_navego(log_of):
    log = log_of({"imu1": IMU, "gnss": GNSS, "ref": REF})
    assert_imu(log.imus[0])
    assert log.imus[0].name == "imu1"
    np.testing.assert_allclose(log.gnss[0].position, PLACE, rtol=1e-15)
    np.testing.assert_allclose(log.gnss[0].velocity, VELOCITY, rtol=1e-15)
    assert log.gnss[0].position_sigma.tolist() == [[1, 2, 3]] * M
    assert log.gnss[0].velocity_sigma.tolist() == [[0.1] * 3] * M
    np.testing.assert_allclose(log.references[0].attitude[:, 2], np.linspace(0, 1, M), atol=1e-15)
    assert log.imus[0].origin.epoch == "log"
    assert any(note.id == "unused" and "imu1.vrw" in note for note in log.notes)


def test_degrees_in_navegos_fields_are_seen(log_of):
    log = log_of({"gnss": GNSS | {"lat": np.degrees(PLACE[:, :1]), "lon": np.degrees(PLACE[:, 1:2])}})
    np.testing.assert_allclose(log.gnss[0].position, PLACE, rtol=1e-14)


def test_arrays_with_names_and_units(log_of):
    log = log_of(
        {
            "time_s": TIME,
            "gyro_deg_s": np.degrees(RATE),
            "accel_m_s2": FORCE.T,
            "temperature_degC": np.full(N, 30.0),
            "note": 3.0,
        }
    )
    assert_imu(log.imus[0], rtol=1e-14)
    assert log.imus[0].temperature.value.tolist() == [30.0] * N


def test_structures_without_a_time_belong_to_the_one_around(log_of):
    log = log_of(
        {"data": {"time_s": TIME, "imu": {"gyro": RATE, "acc": FORCE}}}, units={"gyro": "rad/s", "accel": "m/s²"}
    )
    assert_imu(log.imus[0])


def test_units_are_asked_for(log_of):
    with pytest.raises(UsageError, match="gyro"):
        log_of({"time_s": TIME, "gyro": RATE})


def test_a_matrix_of_psins(log_of):
    steps = np.diff(TIME, prepend=TIME[0] - 0.01)[:, None]
    right_forward_up = [1, 0, 2], np.array([1, 1, -1])
    rates, forces = (values[:, right_forward_up[0]] * right_forward_up[1] * steps for values in (RATE, FORCE))
    (imu,) = log_of({"imu": np.hstack([rates, forces, TIME[:, None]])}).imus
    assert_imu(imu, rtol=1e-6)


def test_a_matrix_of_kf_gins(log_of):
    log = log_of({"data": np.hstack([TIME[:, None], RATE * 0.01, FORCE * 0.01])})
    assert_imu(log.imus[0], rtol=1e-6)


def test_a_matrix_of_unknown_columns_needs_names(log_of):
    matrix = {"data": np.hstack([np.arange(N)[:, None] * 0.01, RATE, FORCE, RATE])}
    with pytest.raises(UsageError, match="--columns"):
        log_of(matrix)
    names = (
        "time_s",
        "gyro_x_rad_s",
        "gyro_y_rad_s",
        "gyro_z_rad_s",
        "accel_x_m_s2",
        "accel_y_m_s2",
        "accel_z_m_s2",
        "-",
        "-",
        "-",
    )
    log = log_of(matrix, columns=names)
    np.testing.assert_allclose(log.imus[0].specific_force.value, FORCE, rtol=1e-15)


def test_rows_that_are_no_numbers_are_counted(log_of):
    rate = RATE.copy()
    rate[[5, 9]] = np.nan
    (imu,) = log_of({"imu": IMU | {"wb": rate}}).imus
    assert len(imu.angular_rate) == N - 2
    assert sum(repair.count for repair in imu.origin.repairs) == 2


def test_other_arrays_are_named(log_of):
    with pytest.raises(UnreadableLogError, match="voltage"):
        log_of({"voltage": np.arange(N) * 1.0})


def test_objects_are_named(tmp_path):
    path = tmp_path / "log.mat"
    version_7_3(path, {"imu": IMU, "TT": np.arange(6.0)})
    with h5py.File(path, "r+") as file:
        file["TT"].attrs["MATLAB_object_decode"] = 3
    log = read(path)
    assert any(note.id == "unused" and "TT" in note for note in log.notes)
    assert_imu(log.imus[0])


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_damage_ends_in_rows_or_in_an_error(tmp_path, version):
    path = tmp_path / "log.mat"
    tree = {"imu": IMU, "gnss": GNSS}
    if version == "5":
        savemat(path, tree)
    else:
        version_7_3(path, tree)
    data, rng, outcomes = path.read_bytes(), np.random.default_rng(2), set()
    for number in range(24 if version == "5" else 12):
        changed = bytearray(data)
        if number % 3 == 0:
            changed = changed[: int(rng.integers(30, len(data)))]
        else:
            for bit in rng.integers(1000, 8 * len(data), 1 + 30 * (number % 3 - 1)).tolist():
                changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        try:
            log = read(path)
        except ImuwbError as error:
            outcomes.add("refused" if str(path) in str(error) or "column" in str(error) else str(error))
        else:
            outcomes.add("read")
            assert all(np.isfinite(imu.angular_rate.value).all() for imu in log.imus if imu.angular_rate is not None)
    assert outcomes == {"read", "refused"}


def test_absurd_sizes_are_refused(tmp_path):
    path = tmp_path / "log.mat"
    savemat(path, {"x": np.arange(1000.0)})
    data = path.read_bytes()
    at = data.index((1000).to_bytes(4, "little"), 128)
    path.write_bytes(data[:at] + (2**31 - 1).to_bytes(4, "little") + data[at + 4 :])
    with pytest.raises(UnreadableLogError, match=r"log\.mat"):
        read(path)


@pytest.mark.parametrize("length", [19, 60, 125])
def test_a_file_that_ends_within_its_header_is_refused(tmp_path, length):
    path = tmp_path / "log.mat"
    savemat(path, {"imu": IMU})
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(UnreadableLogError, match="MATLAB"):
        read(path)

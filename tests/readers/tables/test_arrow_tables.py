"""Parquet and Arrow files: columns with units in names and metadata, times of every type, and damage."""

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import feather, parquet

from imuwb.errors import ImuwbError, UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.units import STANDARD_GRAVITY
from tests.readers.repairs import repairs

T = 1_714_564_800_123_456_789  #: ns since 1970
RNG = np.random.default_rng(3)
N = 100
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
TIME = T + np.arange(N) * 10_000_000
WRITERS = {"parquet": parquet.write_table, "feather": feather.write_feather}


@pytest.fixture(params=WRITERS)
def log_of(request, tmp_path):
    def log(columns, metadata=None, writer_options=None, **options):
        fields = [
            pa.field(n, c.type, metadata={"unit": metadata[n]} if metadata and n in metadata else None)
            for n, c in columns.items()
        ]
        path = tmp_path / "table.bin"
        table = pa.Table.from_arrays(list(columns.values()), schema=pa.schema(fields))
        WRITERS[request.param](table, path, **(writer_options or {}).get(request.param, {}))
        found = read(path, ReadOptions(**options))
        assert found.provenance.format == request.param
        return found

    return log


def imu(rate="rad_s", force="m_s2", rate_scale=1.0, force_scale=1.0):
    columns = {f"gyro_{axis}_{rate}": pa.array(RATE[:, i] * rate_scale) for i, axis in enumerate("xyz")}
    return columns | {f"accel_{axis}_{force}": pa.array(FORCE[:, i] * force_scale) for i, axis in enumerate("xyz")}


def assert_imu(log, time=TIME, rtol=1e-15):
    (found,) = log.imus
    np.testing.assert_allclose(found.angular_rate.value, RATE[: len(time)], rtol=rtol, atol=1e-17)
    np.testing.assert_allclose(found.specific_force.value, FORCE[: len(time)], rtol=rtol, atol=1e-17)
    np.testing.assert_array_equal(found.angular_rate.time, time)
    return found


def test_units_in_names(log_of):
    degrees = imu("deg_s", "g", 180 / np.pi, 1 / STANDARD_GRAVITY)
    found = assert_imu(log_of({"timestamp_ns": pa.array(TIME), **degrees}), rtol=1e-14)
    assert found.origin.epoch == "unix"
    assert found.origin.units == "deg/s, g"


def test_units_in_metadata(log_of):
    names = [f"{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]
    columns = {"t": pa.array(TIME)} | dict(zip(names, imu(rate_scale=180 / np.pi).values(), strict=True))
    metadata = {"t": "ns"} | {name: "deg/s" if name.startswith("gyro") else "m/s^2" for name in names}
    assert_imu(log_of(columns, metadata), rtol=1e-14)
    with pytest.raises(UsageError, match=r"gyro"):
        log_of(columns, {"t": "ns"})
    assert_imu(log_of(columns, {"t": "ns"}, units={"gyro": "deg/s", "accel": "m/s²"}), rtol=1e-14)


@pytest.mark.parametrize(
    ("name", "stamps", "exact"),
    [
        ("time", pa.array(TIME, pa.timestamp("ns", "UTC")), 1),
        ("time", pa.array(TIME, pa.timestamp("ns", "Asia/Tokyo")), 1),
        ("recorded", pa.array(TIME, pa.timestamp("ns")), 1),
        ("__index_level_0__", pa.array(TIME // 1000, pa.timestamp("us")), 1000),
        ("time_us", pa.array(TIME // 1000), 1000),
        ("time_us", pa.array((TIME // 1000).astype(np.uint64)), 1000),
        ("time_s", pa.array(TIME / 1e9), 240),
        ("utc", pa.array([str(np.datetime64(int(t), "ns")) + "Z" for t in TIME]), 1),
    ],
    ids=["zone", "tokyo", "naive", "index", "us", "unsigned", "doubles", "texts"],
)
def test_times(log_of, name, stamps, exact):
    (found,) = log_of({name: stamps, **imu()}).imus
    assert np.abs(found.angular_rate.time - TIME).max() < exact
    assert found.origin.epoch == "unix"


def test_durations_count_from_the_start(log_of):
    found = assert_imu(log_of({"time": pa.array(TIME - T, pa.duration("ns")), **imu()}), TIME - T)
    assert found.origin.epoch == "log"


def test_structures_and_lists_of_three(log_of):
    parts = [pa.array(FORCE[:, i]) for i in range(3)]
    columns = {
        "stamp": pa.array(TIME),
        "gyro": pa.FixedSizeListArray.from_arrays(pa.array(RATE.ravel()), 3),
        "accel": pa.StructArray.from_arrays(parts, ["x", "y", "z"]),
    }
    assert_imu(log_of(columns, {"stamp": "ns", "gyro": "rad/s", "accel": "m/s²"}))


def test_codes_floats_and_missing_cells(log_of):
    columns = imu()
    values = RATE[:, 0].copy()
    columns["gyro_x_rad_s"] = pa.array(values, mask=np.arange(N) == 7)
    columns["temperature_degC"] = pa.array(np.full(N, 21.5, np.float32)).dictionary_encode()
    log = log_of({"time_ns": pa.array(TIME), **columns})
    assert log.imus[0].temperature.value.tolist() == [21.5] * N
    assert 7 not in np.searchsorted(TIME, log.imus[0].angular_rate.time) or np.isnan(
        log.imus[0].angular_rate.value[7, 0]
    )


def test_a_receiver_and_what_is_not_used(log_of):
    columns = {
        "time": pa.array(TIME, pa.timestamp("ns", "UTC")), "latitude": pa.array(np.full(N, 47.5)), "longitude": pa.array(np.full(N, 8.5)),
        "height": pa.array(np.full(N, 488, np.int32)), "label": pa.array(["a"] * N), "blob": pa.array([b"x"] * N),
    }  # fmt: skip
    log = log_of(columns, {"latitude": "deg", "longitude": "deg", "height": "m"})
    np.testing.assert_allclose(log.gnss[0].position, [[np.radians(47.5), np.radians(8.5), 488]] * N, rtol=1e-15)
    assert any(note.id == "unused" and "label" in note for note in log.notes)
    assert any(note.id == "unused" and "blob" in note for note in log.notes)


def test_rows_in_many_pieces(log_of, monkeypatch):
    monkeypatch.setattr("imuwb.readers.tables.arrow_tables.ROWS", 7)
    assert_imu(
        log_of(
            {"time_ns": pa.array(TIME), **imu()},
            writer_options={"parquet": {"row_group_size": 30}, "feather": {"chunksize": 30}},
        )
    )


@pytest.mark.parametrize(
    ("column", "names", "later"),
    [("frame_id", ("left", "right"), 0), ("imu_id", (3, 7), 3_000_000), ("whose", ("foot", "shank"), 3_000_000)],
)
def test_a_column_that_names_sensors_parts_them(log_of, column, names, later):
    both = {name: pa.array(np.repeat(cells.to_numpy(), 2) + np.tile([0, 0.5], N)) for name, cells in imu().items()}
    time = (np.repeat(TIME, 2) + np.tile([0, later], N)).astype(np.int64)
    log = log_of({"timestamp_ns": pa.array(time), column: pa.array(list(names) * N), **both})
    assert len(log.imus) == 2
    for k, found in enumerate(log.imus):
        np.testing.assert_array_equal(found.angular_rate.time, TIME + k * later)
        np.testing.assert_allclose(found.angular_rate.value, RATE + 0.5 * k, atol=1e-15)
        assert repairs(found) == {}


def test_text_and_no_rows_are_refused(log_of):
    with pytest.raises(ImuwbError, match=r"table\.bin"):
        log_of({"time_ns": pa.array([], pa.int64()), "gyro_x_rad_s": pa.array([], pa.float64())})
    with pytest.raises(ImuwbError, match=r"table\.bin"):
        log_of({"time_ns": pa.array(["a"] * N), **imu()})


def test_numbers_in_the_wrong_unit_are_refused(log_of):
    with pytest.raises(UnreadableLogError, match="g"):
        log_of({"time_ns": pa.array(TIME), **imu(force_scale=1 / STANDARD_GRAVITY)})


@pytest.mark.parametrize("suffix", WRITERS)
def test_damage_ends_in_rows_or_in_an_error(tmp_path, suffix):
    table = pa.table({"time_ns": pa.array(TIME), **imu()})
    path = tmp_path / "table.bin"
    WRITERS[suffix](table, path)
    data, rng = path.read_bytes(), np.random.default_rng(1)
    outcomes = set()
    for number in range(60):
        changed = bytearray(data)
        if number % 3 == 0:
            changed = changed[: int(rng.integers(8, len(data)))]
        else:
            for bit in rng.integers(64, 8 * len(data), 1 + 20 * (number % 3 - 1)).tolist():
                changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        try:
            log = read(path)
        except ImuwbError as error:
            outcomes.add("refused" if str(path) in str(error) or "column" in str(error) else str(error))
        else:
            outcomes.add("read")
            assert sum(len(i.angular_rate or ()) for i in log.imus) <= N
    assert outcomes <= {"read", "refused"}
    assert "refused" in outcomes


def test_a_stream_of_arrow(tmp_path):
    path, table = tmp_path / "log.arrows", pa.table({"time_ns": pa.array(TIME), **imu()})
    with pa.OSFile(str(path), "wb") as file, pa.ipc.new_stream(file, table.schema) as writer:
        writer.write_table(table, max_chunksize=30)
    assert_imu(read(path))
    path.write_bytes(path.read_bytes()[:-1000])
    assert 30 <= len(read(path).imus[0].angular_rate) < N


def test_a_cut_feather_file_gives_the_pieces_before_the_cut(tmp_path):
    path = tmp_path / "cut.feather"
    feather.write_feather(
        pa.table({"time_ns": pa.array(TIME), **imu()}), path, chunksize=10, compression="uncompressed"
    )
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    log = read(path)
    found = log.imus[0]
    assert 20 < len(found.angular_rate) < 60
    np.testing.assert_array_equal(found.angular_rate.value, RATE[: len(found.angular_rate)])
    assert "table_cut" in (*ids(log.notes), *repairs(found))

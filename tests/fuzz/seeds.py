"""The smallest sound logs of every format; each damaged log of the fuzz tests begins as one of them."""

import gzip
import io
import json
import zipfile
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType

from tests.conftest import IMU_2, Topic, imu_message, write_mcap
from tests.readers import binary_corpus
from tests.readers.containers import bag_writer, db3_writer
from tests.readers.flight import dataflash_writer, ulog_writer
from tests.readers.receivers import ubx_writer

T = 1_714_564_800 * 10**9  #: ns
ROWS = 24


def values(i: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return rate and specific force of a row, which no other row has."""
    return (0.1 + i / 1000, -0.2 - i / 3000, 0.3), (0.5, 0.25 + i / 5000, 9.75 + i / 100)


def messages(code: int | None = 1) -> list[tuple[int, bytes]]:
    """Return times and messages of an IMU in ROS."""
    return [(T + i * 10**7, imu_message(T + i * 10**7, *values(i), code=code)) for i in range(ROWS)]


def write(folder: Path) -> dict[str, bytes]:
    """Write all logs in a folder; return {name: content}."""
    for name, compression, chunked in (
        ("zstd.mcap", CompressionType.ZSTD, True), ("lz4.mcap", CompressionType.LZ4, True), ("plain.mcap", CompressionType.NONE, False),
    ):  # fmt: skip
        write_mcap(folder / name, Topic(messages()), compression=compression, use_chunking=chunked, chunk_size=2000)
    bodies = [
        json.dumps({"angular_velocity": dict(zip("xyz", rate, strict=True)), "linear_acceleration": dict(zip("xyz", force, strict=True))})
        for rate, force in map(values, range(ROWS))
    ]  # fmt: skip
    timed = [(T + i * 10**7, body.encode()) for i, body in enumerate(bodies)]
    write_mcap(
        folder / "json.mcap", Topic(timed, schema="x", definition="{}", schema_encoding="jsonschema", encoding="json")
    )
    for compression in ("none", "lz4"):
        rows = [(time, payload) for time, payload in messages(None)]
        bag_writer.write_bag(folder / f"{compression}.bag", bag_writer.Topic(rows), compression=compression, chunk=2000)
    db3_writer.write_db3(
        folder / "log.db3", {"/imu": ("sensor_msgs/msg/Imu", messages())}, db3_writer.NEW, [("sensor_msgs/msg/Imu", "ros2msg", IMU_2)], page=512
    )  # fmt: skip
    (folder / "flight.ulg").write_bytes(_ulog())
    (folder / "flight.bin").write_bytes(dataflash_writer.binary(dataflash_writer.flight(ROWS)))
    (folder / "flight.log").write_bytes(dataflash_writer.text(dataflash_writer.flight(ROWS)))
    _telemetry(folder)
    _text(folder)
    binary_corpus.N, binary_corpus.TIME = 40, 345_600.0 + np.arange(40) / 100
    binary_corpus.write(folder)
    epochs = (
        ubx_writer.pvt(ubx_writer.utc(i), nano=77, place=(473_977_420 + i, 85_455_940, 488_000)) for i in range(ROWS)
    )
    (folder / "log.ubx").write_bytes(b"".join(epochs))  # each row is of one frame
    arrays = {"t [s]": binary_corpus.TIME, "gyro [rad/s]": np.ones((40, 3)) / 9, "accel [m/s²]": np.ones((40, 3)) * 5.7}
    np.savez_compressed(folder / "log.npz", **arrays)
    _hdf5(folder)
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def _ulog() -> bytes:
    w = ulog_writer
    parts = w.HEADER, w.flags(), w.combined(ROWS), w.topic("vehicle_gps_position", 2, w.GPS, w.fixes(5))
    return b"".join(parts)


def _telemetry(folder: Path) -> None:
    try:
        from tests.readers.flight import mavlink_writer
    except BaseException:  # noqa: BLE001 - pymavlink is not installed
        return
    records = [*mavlink_writer.numbered(ROWS), *mavlink_writer.fixes(4), mavlink_writer.heartbeat()]
    (folder / "flight.tlog").write_bytes(b"".join(records))


def _text(folder: Path) -> None:
    names = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n"
    lines = [f"{1000 + i / 100:.2f}," + ",".join(f"{x:.6f}" for triad in values(i) for x in triad) for i in range(ROWS)]
    whole = (names + "\n".join(lines) + "\n").encode()
    (folder / "imu.csv").write_bytes(whole)
    (folder / "imu.csv.gz").write_bytes(gzip.compress(whole, 1, mtime=0))
    import zstandard

    (folder / "packed.csv").write_bytes(zstandard.ZstdCompressor().compress(whole))
    (folder / "stated.csv").write_bytes(whole.replace(names.encode(), b""))
    (folder / "stated.toml").write_bytes(
        'rate = 100.0\ncolumns = ["time", "gx", "gy", "gz", "ax", "ay", "az"]\n'
        'units = { time = "s", gyro = "rad/s", accel = "m/s²" }\nframe = "FRD"\nepoch = "boot"\n'.encode()
    )
    solution = ["%  GPST  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)"]
    solution += [
        f"2024/05/01 12:00:{i:02d}.000   47.{300000000 + i}    8.500000000   450.{i:04d}   1  10   0.0100   0.0100   0.0200"
        for i in range(ROWS)
    ]
    (folder / "fixes.pos").write_text("\n".join(solution) + "\n", "utf-8")
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        header = b"time,seconds_elapsed,z,y,x\n"
        for name, place in (("Gyroscope.csv", 0), ("TotalAcceleration.csv", 1)):
            rows = [
                f"{T + i * 10**7},{i / 100:.2f}," + ",".join(f"{x:.5f}" for x in values(i)[place][::-1])
                for i in range(ROWS)
            ]
            packed.writestr(name, header + "\n".join(rows).encode() + b"\n")
    (folder / "phone.zip").write_bytes(archive.getvalue())


def _hdf5(folder: Path) -> None:
    import h5py

    with h5py.File(folder / "log.h5", "w") as file:
        parts = {
            "t": (binary_corpus.TIME, "s"),
            "gyro": (np.ones((40, 3)) / 9, "rad/s"),
            "accel": (np.ones((40, 3)) * 5.7, "m/s²"),
        }
        for name, (array, measure) in parts.items():
            file[name] = array
            file[name].attrs["unit"] = measure

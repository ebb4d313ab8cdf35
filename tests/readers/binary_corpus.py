"""Small logs of receivers and tables for the tests of damage."""

import numpy as np
import pyarrow as pa
from pyarrow import feather, parquet

from imuwb.geodesy import ned_scale

from .receivers import novatel_writer as novatel
from .receivers import ubx_writer as ubx

NAMES = (
    "log.ubx",
    "log.nmea",
    "log.parquet",
    "log.feather",
    "log.mat",
    "log.npy",
    "kf.bin",
    "raw.imr",
    "sbet.out",
    "log.gps",
)
N = 200
TIME = 345_600.0 + np.arange(N) / 100


def write(folder):
    """Write one log of each name that can be written here."""
    when = [ubx.utc(i) for i in range(60)]
    (folder / "log.ubx").write_bytes(b"".join(ubx.fine(t) + ubx.covariance(t) + ubx.pvt(t, nano=77) for t in when))
    body = "{:%H%M%S}.{:02d},4723.8645,N,00832.7356,E"
    sentences = []
    for t in when:
        clock = f"{t:%H%M%S}.{t.microsecond // 10_000:02d}"
        sentences.append(ubx.sentence(f"GNGGA,{body.format(t, t.microsecond // 10_000)},4,12,0.7,440.5,M,47.5,M,,"))
        sentences.append(ubx.sentence(f"GNRMC,{clock},A,4723.8645,N,00832.7356,E,10.0,90.0,{t:%d%m%y},,,A"))
    (folder / "log.nmea").write_bytes(b"".join(sentences))
    rng = np.random.default_rng(1)
    rate, force = rng.normal(0, 0.1, (N, 3)), rng.normal(0, 0.1, (N, 3)) - (0, 0, 9.8)
    _tables(folder, rate, force)
    (folder / "kf.bin").write_bytes(np.column_stack([TIME, rate / 100, force / 100]).astype("<f8").tobytes())
    _imr(folder / "raw.imr", rate, force)
    _sbet(folder / "sbet.out")
    messages = [novatel.rawimusx(491_674 + i / 125, (1000, -i, 3000), (100, i, -329_000_000)) for i in range(N)]
    try:
        import novatel_edie
    except ImportError:
        return
    assert novatel_edie
    (folder / "log.gps").write_bytes(b"".join(messages))


def _tables(folder, rate, force):
    from scipy.io import savemat

    names = [f"{sensor}_{axis}_{unit}" for sensor, unit in (("gyro", "rad_s"), ("accel", "m_s2")) for axis in "xyz"]
    table = pa.table({"time_s": TIME} | dict(zip(names, np.hstack([rate, force]).T, strict=True)))
    parquet.write_table(table, folder / "log.parquet", row_group_size=50)
    feather.write_feather(table, folder / "log.feather", chunksize=50)
    savemat(folder / "log.mat", {"imu": {"t": TIME, "wb": rate, "fb": force}})
    np.save(folder / "log.npy", np.column_stack([TIME, rate / 100, force / 100]))


def _imr(path, rate, force):
    import struct

    head = b"$IMURAW\0\0" + struct.pack("<diidddiid32s", 8.8, 1, 1, 100.0, 1e-6, 1e-6, 2, 2, 0.0, b"test")
    row = np.zeros(N, np.dtype([("time", "<f8"), ("counts", "<i4", 6)]))
    row["time"], row["counts"] = TIME, np.hstack([np.degrees(rate), force]) * 1e4
    path.write_bytes(head.ljust(512, b"\0") + row.tobytes())


def _sbet(path):
    heading = np.linspace(0, 1, N)
    velocity = np.column_stack([10 * np.cos(heading), 10 * np.sin(heading), np.zeros(N)])
    scale = ned_scale(np.full(N, 0.8), np.full(N, 500.0))
    place = np.array([0.8, 0.1, 500.0]) + np.cumsum(velocity / 100 / scale, axis=0)
    path.write_bytes(
        np.column_stack([TIME, place, velocity, np.zeros((N, 2)), heading, np.zeros((N, 7))]).astype("<f8").tobytes()
    )

"""The first bytes of files of many formats: a reader must claim its own only.

Each is made here from the format's own description, as the reader of imuwb knows it; none is copied from a file.
"""

import json
import struct
from collections.abc import Iterator
from functools import cache, reduce
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from imuwb.testing.logs import still
from imuwb.writers import write

#: formats of other kinds, which no reader of logs may claim: name -> first bytes
FOREIGN = {
    "an empty file": b"",
    "zeros": bytes(4096),
    "a picture (PNG)": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(64),
    "a document (PDF)": b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n<< /Type /Catalog >>\nendobj\n",
    "a program (ELF)": b"\x7fELF\x02\x01\x01" + bytes(64),
    "a page (HTML)": b"<!DOCTYPE html>\n<html><head><title>log</title></head><body>1,2,3,4,5,6,7</body></html>\n",
    "a recording of Rerun": b"RRF2\0\1\2\3" + bytes(64),
    "random bytes": np.random.default_rng(1).bytes(65536),
    "prose": b"The sensor was still for two hours. Then it was turned.\n" * 20,
}


@cache
def heads() -> dict[str, tuple[str, bytes]]:
    """Return {name: (the format's reader, first bytes of a file)}; of what is no log, the reader is empty."""
    return {**dict(_made()), **{name: ("", head) for name, head in FOREIGN.items()}}


def _made() -> Iterator[tuple[str, tuple[str, bytes]]]:
    with TemporaryDirectory() as folder:
        for reader, file in (("mcap", "log.mcap"), ("csv", "log.csv")):
            path = Path(folder) / file
            write(still(), path)
            yield f"a log that imuwb writes as {reader.upper()}", (reader, path.read_bytes()[:65536])
    yield "a bag of ROS 1", ("bag", b"#ROSBAG V2.0\n" + _bag_header())
    yield (
        "a bag of ROS 2 (SQLite)",
        (
            "db3",
            b"SQLite format 3\0"
            + bytes((16, 0, 1, 1, 0, 64, 32, 32))
            + b"CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL)".rjust(4072, b"\0"),
        ),
    )
    yield "a log of PX4 (ULog)", ("ulog", b"ULog\x01\x12\x35\x01" + bytes(8))
    yield (
        "a log of ArduPilot (DataFlash)",
        ("dataflash", b"\xa3\x95\x80\x80\x59FMT\0BBnNZ\0" + b"Type,Length,Name,Format,Columns".ljust(64 + 11, b"\0")),
    )
    yield "a table of Parquet", ("parquet", b"PAR1\x15\x04\x15" + bytes(64) + b"PAR1")
    yield "a table of Feather", ("feather", b"ARROW1\0\0" + bytes(64))
    yield "a file of HDF5", ("hdf5", b"\x89HDF\r\n\x1a\n" + bytes(64))
    yield (
        "a file of MATLAB",
        ("matlab", b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x01IM" + bytes(64)),
    )
    yield (
        "an array of NumPy",
        ("numpy", b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9, 7), }".ljust(128)),
    )
    yield "a measurement (MDF)", ("mdf", b"MDF     4.10    imuwb   " + bytes(64))
    yield "sentences of NMEA", ("nmea", b"".join(map(_sentence, _SENTENCES)) * 8)
    yield "messages of u-blox (UBX)", ("ubx", b"".join(_ubx(i) for i in range(8)))


def _bag_header() -> bytes:
    fields = (b"op=\x03", b"index_pos=" + bytes(8), b"conn_count=" + bytes(4), b"chunk_count=" + bytes(4))
    header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", 4000) + b" " * 4000


_SENTENCES = (
    "GPGGA,120000.00,4723.9900,N,00833.3300,E,1,10,0.9,450.0,M,48.0,M,,",
    "GPRMC,120000.00,A,4723.9900,N,00833.3300,E,0.10,90.00,010524,,,A",
)


def _sentence(text: str) -> bytes:
    return f"${text}*{reduce(lambda a, b: a ^ b, text.encode()):02X}\r\n".encode()


def _ubx(number: int) -> bytes:
    """Return a NAV-PVT message."""
    payload = struct.pack("<IHBBBBBB", 345_600_000 + 1000 * number, 2024, 5, 1, 12, 0, number, 0x37) + bytes(80)
    body = struct.pack("<BBH", 0x01, 0x07, len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 255
        b = (b + a) & 255
    return b"\xb5\x62" + body + bytes((a, b))


def texts() -> dict[str, bytes]:
    """Return first bytes of logs of text in the shapes of several tools; the reader of CSV takes any text with digits."""
    row = ",".join(f"{0.01 * i:.4f}" for i in range(6))
    rows = [[round(0.01 * k, 2), 0.001, 0.002, 0.003, 0.1, 0.2, -9.8] for k in range(40)]
    return {
        "a table of text": (
            "time_s,gx,gy,gz,ax,ay,az\n" + "".join(f"{k * 0.01:.2f},{row}\n" for k in range(40))
        ).encode(),
        "numbers without a header": "".join(f"{' '.join(map(str, line))}\n" for line in rows).encode(),
        "JSON, a row on each line": "".join(
            json.dumps({"t": line[0], "gyro": line[1:4], "accel": line[4:]}) + "\n" for line in rows
        ).encode(),
    }

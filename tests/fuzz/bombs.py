"""Small logs that state much: each takes a reader that trusts it without end, or all memory. They are made when a test needs them."""

import gzip
import io
import sqlite3
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import zstandard

from tests.conftest import Topic, write_mcap
from tests.readers.containers import db3_writer

_MAGIC = b"\x89MCAP0\r\n"
_TOPICS = (
    db3_writer.OLD.partition("CREATE TABLE messages")[0] + "INSERT INTO topics VALUES(1, '/imu', 'a/A', 'cdr', '');"
)
LONG = 60 << 20  #: bytes of a line without end


def _record(kind: int, content: bytes) -> bytes:
    return bytes([kind]) + struct.pack("<Q", len(content)) + content


def _chunks(path: Path, content: bytes, size: int, count: int) -> Path:
    """Write an MCAP of chunks that unpack to a repetition of some bytes."""
    whole = content * (size // len(content))
    packed, check = zstandard.compress(whole), zlib.crc32(whole)
    head = (
        struct.pack("<QQQI", 0, 0, len(whole), check) + struct.pack("<I", 4) + b"zstd" + struct.pack("<Q", len(packed))
    )
    path.write_bytes(
        _MAGIC
        + _record(1, bytes(8))
        + count * _record(6, head + packed)
        + _record(15, bytes(4))
        + _record(2, bytes(20))
        + _MAGIC
    )
    return path


def one_message(path: Path, definition: str, payload: bytes, encoding: str = "cdr", language: str = "ros2msg") -> Path:
    """Write an MCAP with one message of a type."""
    return write_mcap(
        path,
        Topic([(10**18, payload)], schema="a/A", definition=definition, schema_encoding=language, encoding=encoding),
    )


def nested_types(folder: Path) -> Path:
    """Types of ROS that nest 64 times at each of eight levels, and are empty."""
    levels = [f"MSG: a/L{i}\na/L{i + 1}[64] x\n" for i in range(8)]
    text = ("=" * 80 + "\n").join(("a/L0[64] x\n", *levels, "MSG: a/L8\n"))
    return one_message(folder / "types.mcap", text, b"\0\1\0\0" + bytes(64))


def many_strings(folder: Path) -> Path:
    """A message of thousands of strings before its numbers."""
    text = "".join(f"string s{i}\n" for i in range(3000)) + "float64 temperature\n"
    return one_message(folder / "strings.mcap", text, b"\0\1\0\0" + bytes(12_008))


def itself(folder: Path) -> Path:
    """A type of protobuf that contains itself ten times."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet

    files = FileDescriptorSet()
    file = files.file.add(name="a.proto", package="a", syntax="proto3")
    kind = file.message_type.add(name="A")
    for i in range(10):
        kind.field.add(name=f"x{i}", number=i + 1, type=11, label=1, type_name=".a.A")
    topic = Topic(
        [(10**18, b"")],
        schema="a.A",
        definition=files.SerializeToString(),
        schema_encoding="protobuf",
        encoding="protobuf",
    )
    return write_mcap(folder / "itself.mcap", topic)


def comments_without_end(folder: Path) -> Path:
    """Definitions in IDL whose comments and texts do not end: each is searched to the end of the text."""
    text = "module a { module msg { struct A { double x; }; }; };" + "/*" * 100_000 + '"\\"' * 100_000
    return one_message(folder / "idl.mcap", text, b"\0\1\0\0" + bytes(8), language="ros2idl")


def nested_formats(folder: Path) -> Path:
    """Formats of PX4 that nest 9999 times each, and are empty."""
    from tests.readers.flight import ulog_writer as w

    formats = [w.defined(f"m{i}", f"m{i + 1}[9999] x;") for i in range(8)]
    parts = (
        w.HEADER,
        w.flags(),
        *formats,
        w.defined("m8", ""),
        w.defined("sensor_combined", "m0[9999] x;"),
        w.added("sensor_combined", 1),
    )
    (folder / "nested.ulg").write_bytes(b"".join((*parts, w.message("D", struct.pack("<H", 1) + bytes(40)))))
    return folder / "nested.ulg"


def endless_view(folder: Path) -> Path:
    """A recording in SQLite whose messages are a view without end."""
    return _database(folder / "endless.db3", "CREATE VIEW messages AS WITH RECURSIVE r(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM r) "
                     "SELECT i AS id, 1 AS topic_id, i AS timestamp, zeroblob(100) AS data FROM r")  # fmt: skip


def computed_column(folder: Path) -> Path:
    """A recording in SQLite whose messages are computed from nothing."""
    return _database(folder / "computed.db3", "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
                     "data BLOB GENERATED ALWAYS AS (zeroblob(60000000)))")  # fmt: skip


def long_defaults(folder: Path) -> Path:
    """A recording in SQLite whose rows of some bytes have a value of a megabyte by default."""
    path = folder / "defaults.db3"
    base = sqlite3.connect(path)
    base.executescript(
        _TOPICS + " CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER);"
        "INSERT INTO messages WITH RECURSIVE r(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM r WHERE i < 3000) SELECT i, 1, i FROM r;"
        f"ALTER TABLE messages ADD COLUMN data BLOB DEFAULT x'{'00' * 400_000}';"
    )
    base.commit()
    base.close()
    return path


def _database(path: Path, messages: str) -> Path:
    base = sqlite3.connect(path)
    base.executescript(_TOPICS + messages)
    base.commit()
    base.close()
    return path


def large_chunks(folder: Path) -> Path:
    """Chunks of MCAP that unpack to much more than their file."""
    return _chunks(folder / "chunks.mcap", bytes(1 << 20), 300 << 20, 4)


def empty_records(folder: Path) -> Path:
    """Chunks of MCAP that are full of records without content."""
    return _chunks(
        folder / "records.mcap", _record(3, b"") + _record(4, b"") + _record(99, b"") + _record(12, b""), 30 << 20, 3
    )


def packed_messages(folder: Path) -> Path:
    """Messages that are packed one by one, and unpack to 60 MB each."""
    payload = zstandard.ZstdCompressor().compress(bytes(60 << 20))
    topic = Topic([(10**18 + i, payload) for i in range(20)])
    return write_mcap(folder / "packed.mcap", topic)


def many_topics(folder: Path) -> Path:
    """Topics of one message each."""
    from tests.fuzz.seeds import messages

    (time, payload), *_ = messages()
    return write_mcap(folder / "topics.mcap", *(Topic([(time, payload)], topic=f"/imu{i}") for i in range(6000)))


def line_without_end(folder: Path) -> Path:
    """A text of one long line, packed."""
    (folder / "line.csv.gz").write_bytes(gzip.compress(b"time,gyro_x\n" + b"1" * LONG, 1, mtime=0))
    return folder / "line.csv.gz"


def records_in_a_line(folder: Path) -> Path:
    """A DataFlash log as text of one long line, packed."""
    text = b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nIMU, 1" + b",1" * (LONG // 2)
    (folder / "line.log.gz").write_bytes(gzip.compress(text, 1, mtime=0))
    return folder / "line.log.gz"


def zeros_in_zstd(folder: Path) -> Path:
    """A CSV of zeros in a frame of Zstandard."""
    row = b"1,0,0,0,0,0,9.8\n"
    text = b"time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n" + row * (600 << 16)
    (folder / "zeros.csv").write_bytes(zstandard.ZstdCompressor().compress(text))
    return folder / "zeros.csv"


def arrays_of_nothing(folder: Path) -> Path:
    """An archive of NumPy whose arrays are zeros."""
    with zipfile.ZipFile(folder / "zeros.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        content = io.BytesIO()
        np.save(content, np.zeros((1 << 22, 3)))
        for i in range(8):
            archive.writestr(f"gyro{i}.npy", content.getvalue())
    return folder / "zeros.npz"


def columns_of_nothing(folder: Path) -> Path:
    """A file of Apache Arrow whose packed columns unpack to a gigabyte."""
    import pyarrow as pa
    from pyarrow import feather

    zeros = pa.array(np.zeros(1 << 24))
    names = (
        "time_s",
        *(f"{kind}_{axis}_{unit}" for kind, unit in (("gyro", "rad_s"), ("accel", "m_s2")) for axis in "xyz"),
    )
    feather.write_feather(
        pa.table(dict.fromkeys(names, zeros)), folder / "zeros.feather", compression="zstd", chunksize=1 << 24
    )
    return folder / "zeros.feather"


def a_text_again_and_again(folder: Path) -> Path:
    """A file of Apache Arrow that names a text of a megabyte in each row."""
    import pyarrow as pa
    from pyarrow import feather

    rows = 20_000
    text = pa.DictionaryArray.from_arrays(np.zeros(rows, np.int32), pa.array(["x" * (1 << 20)], pa.large_string()))
    columns = {name: np.arange(rows) / 100 for name in ("time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s")}
    feather.write_feather(pa.table({**columns, "name": text}), folder / "texts.feather", compression="zstd")
    return folder / "texts.feather"


def groups_in_themselves(folder: Path) -> Path:
    """An HDF5 file whose group holds itself ten times, and a link to another file."""
    import h5py

    with h5py.File(folder / "itself.h5", "w") as file:
        for i in range(10):
            file[f"g{i}"] = file["/"]
        file["elsewhere"] = h5py.ExternalLink("/etc/passwd", "/")
    return folder / "itself.h5"


BOMBS: dict[str, Callable[[Path], Path]] = {
    make.__name__: make
    for make in (
        nested_types, many_strings, itself, comments_without_end, nested_formats, endless_view, computed_column, long_defaults, large_chunks,
        packed_messages, many_topics, line_without_end, records_in_a_line, arrays_of_nothing, groups_in_themselves,
        columns_of_nothing, a_text_again_and_again,
    )
}  # fmt: skip
#: that take some seconds
LARGE: dict[str, Callable[[Path], Path]] = {make.__name__: make for make in (empty_records, zeros_in_zstd)}

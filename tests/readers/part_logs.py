"""Logs for tests of parts: the same messages of two IMUs and a receiver in every container, in order or with faults of the clock."""

import sqlite3
from contextlib import closing
from dataclasses import dataclass, fields, is_dataclass, replace

import numpy as np
from mcap.writer import CompressionType, Writer

from imuwb.errors import ImuwbError
from imuwb.readers import read
from imuwb.selection import Part, select
from tests.readers.containers.bag_writer import MAGIC, bag_header, chunk, chunk_info, connection, message

T = 1_714_564_800 * 10**9
MS = 10**6
LENGTH = 80  #: s
FAULTS = ("none", "late", "repeated", "gap", "set back", "jump", "lost")
SCHEMAS = {"imu": "sensor_msgs/msg/Imu", "fix": "sensor_msgs/msg/NavSatFix"}


@dataclass(frozen=True)
class Sample:
    """A message: its topic, the time of recording and its own stamp, and a number that all its values show."""

    topic: str
    recorded: int
    stamp: int
    number: int


def samples(fault="none", seed=0):
    """Return the messages of two IMUs (10 and 5 Hz, the second begins late) and a receiver in the order of recording."""
    rng = np.random.default_rng(seed)
    made = []
    for topic, step, begin in (("/a", 100, 0.5), ("/b", 200, 30), ("/fix", 1000, 0)):
        for i in range(int(begin * 1000 / step), LENGTH * 1000 // step):
            stamp = T + i * step * MS
            made.append(Sample(topic, stamp + 7 * MS + int(rng.integers(3 * MS)), stamp, i))
    made.sort(key=lambda sample: sample.recorded)
    if fault == "lost":
        return [sample for sample in made if rng.random() > 0.02]
    first = [sample for sample in made if sample.topic == "/a"]
    stamps = _STAMPS.get(fault, lambda imu: [sample.stamp for sample in imu])(first)
    spoilt = {id(sample): stamp for sample, stamp in zip(first, stamps, strict=True)}
    found = [replace(sample, stamp=spoilt.get(id(sample), sample.stamp)) for sample in made]
    return [sample for sample in found if sample.stamp]


def _changed(rows, change):
    """Return a function from messages to their stamps, of which some rows are changed."""

    def stamps(imu):
        found = np.array([sample.stamp for sample in imu])
        place = rows(len(imu))
        found[place] = change(found, place)
        return found.tolist()

    return stamps


#: fault -> the stamps of an IMU's messages; 0: the message is lost
_STAMPS = {
    "late": _changed(lambda _: np.s_[5::50], lambda time, rows: time[rows] - 320 * MS),
    "repeated": _changed(lambda n: np.arange(7, n, 50), lambda time, rows: time[rows - 1]),
    "gap": _changed(lambda n: np.s_[n // 2 - 100 : n // 2], lambda time, rows: time[rows] * 0),
    "set back": _changed(lambda n: np.s_[n // 4 :], lambda time, rows: time[rows] - 20_000 * MS),
    "jump": _changed(lambda n: np.s_[n // 2 : n // 2 + 1], lambda time, rows: time[rows] + 500_000 * MS),
}


def bursts(seed=0):
    """Return the messages of one IMU at 100 Hz whose stamps are those of arrival, seven at a time."""
    rng = np.random.default_rng(seed)
    times = [T + i * 10 * MS for i in range(6000)]
    arrived = [times[min(i // 7 * 7 + 6, 5999)] + (i // 7 * 7919 % 5) * MS + i % 7 * 1000 for i in range(6000)]
    return [Sample("/a", stamp + int(rng.integers(MS)), stamp, i) for i, stamp in enumerate(arrived)]


def payload(ros, sample, code=1):
    """Return a message on the wire."""
    if sample.topic == "/fix":
        seconds, nanoseconds = divmod(sample.stamp, 10**9)
        sequence = [("I", 7)] if code is None else []
        items = [
            *sequence, ("i", seconds), ("I", nanoseconds), ("str", "g"), ("b", 0), ("H", 1),
            ("d", (47.0 + sample.number * 1e-6, 8.5, 400.0)), ("d", tuple(np.eye(3).ravel())), ("B", 2),
        ]  # fmt: skip
        return ros.encode(items, code)
    return ros.imu(sample.stamp, (sample.number * 1e-4, 0.25, -0.5), (0.125, -0.25, 9.8), code=code)


def as_mcap(path, ros, made, chunk_size=8192, **options):
    """Write an MCAP file with small chunks."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk_size, compression=CompressionType.ZSTD, **options)
        writer.start("", "test")
        channels = {}
        for sample in made:
            if sample.topic not in channels:
                kind, text = ("fix", ros.fix_2) if sample.topic == "/fix" else ("imu", ros.imu_2)
                schema = writer.register_schema(SCHEMAS[kind], "ros2msg", text.encode())
                channels[sample.topic] = writer.register_channel(sample.topic, "cdr", schema)
            writer.add_message(channels[sample.topic], sample.recorded, payload(ros, sample), sample.recorded)
        writer.finish()
    return path


def as_loose_mcap(path, ros, made):
    """Write an MCAP file without chunks."""
    return as_mcap(path, ros, made, use_chunking=False)


def as_db3(path, ros, made):
    """Write a database as rosbag2 does."""
    with closing(sqlite3.connect(path)) as base:
        base.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT "
            "NULL, offered_qos_profiles TEXT NOT NULL); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
            "timestamp INTEGER NOT NULL, data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
        )
        numbers = {"/a": 1, "/b": 2, "/fix": 3}
        for topic, number in numbers.items():
            kind = SCHEMAS["fix" if topic == "/fix" else "imu"]
            base.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (number, topic, kind))
        rows = [(numbers[s.topic], s.recorded, payload(ros, s)) for s in made]
        base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows)
        base.commit()
    return path


def as_bag(path, ros, made):
    """Write a bag of the IMUs, in chunks of 50 messages."""
    numbers = {"/a": 0, "/b": 1}
    records = [message(numbers[s.topic], s.recorded, payload(ros, s, None)) for s in made if s.topic in numbers]
    chunks = (chunk(b"".join(records[i : i + 50]), "lz4") for i in range(0, len(records), 50))
    declared = (connection(number, ros.imu_1, topic) for topic, number in numbers.items())
    path.write_bytes(b"".join((MAGIC, *declared, *chunks)))
    return path


def as_indexed_bag(path, ros, made):
    """Write a bag of the IMUs with an index, in chunks of 20 messages."""
    numbers = {"/a": 0, "/b": 1}
    written = [s for s in made if s.topic in numbers]
    declared = b"".join(connection(number, ros.imu_1, topic) for topic, number in numbers.items())
    groups = [written[i : i + 20] for i in range(0, len(written), 20)]
    content, infos, at = b"", b"", len(MAGIC) + len(bag_header(0, 2, 0))
    for group in groups:
        infos += chunk_info(at + len(content), [(numbers[s.topic], s.recorded) for s in group])
        content += chunk(b"".join(message(numbers[s.topic], s.recorded, payload(ros, s, None)) for s in group), "lz4")
    path.write_bytes(MAGIC + bag_header(at + len(content), 2, len(groups)) + content + declared + infos)
    return path


def as_csv(path, ros, made):
    """Write the first IMU and the receiver as text; a row without a fix has empty cells."""
    lines = [
        "time [ns],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],lat [deg],lon [deg]"
    ]
    for s in made:
        if s.topic == "/a":
            fix = f"{47 + s.number * 1e-6:.6f},8.5" if s.number % 10 == 0 else ","
            lines.append(f"{s.stamp},{s.number * 1e-4:.4f},0.25,-0.5,0.125,-0.25,-9.8,{fix}")
    path.write_text("\n".join(lines) + "\n")
    return path


def parts_of(log, count, seed=0):
    """Yield random parts of a log, some of them without a row, or of an IMU that is not there."""
    rng = np.random.default_rng(seed)
    times = [t.time for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
    length = (max(int(time[-1]) for time in times) - log.zero) / 1e9
    names = [None, *(imu.name for imu in log.imus), "nobody"]
    for _ in range(count):
        start, end = sorted(rng.uniform(-0.05, 1.1, 2) * length)
        texts = [f"{max(limit, 0):.4f}" if rng.random() > 0.3 else None for limit in (start, end)]
        yield Part(names[rng.integers(len(names))], *texts)


def assert_alike(path, part, whole, options=None):
    """Compare a part with the whole log that is cut afterwards: the same streams, or the same error."""
    expected = _outcome(lambda: select(whole, part.imu, part.start, part.end))
    found = _outcome(lambda: read(path, options, part=part))
    if isinstance(expected, str) or isinstance(found, str):
        assert found == expected
        return None
    _same(found, expected, f"{part}")
    return found


def _outcome(work):
    try:
        return work()
    except ImuwbError as error:
        return f"{type(error).__name__}: {error}"


def _same(one, other, where):
    """Compare all values of two logs, apart from notes and the repairs of rows outside the part."""
    assert type(one) is type(other), where
    if isinstance(one, np.ndarray):
        if where.endswith("attitude"):  # a heading that goes on over whole turns may begin in another turn
            np.testing.assert_allclose(np.angle(np.exp(1j * (one - other))), 0, atol=1e-12, err_msg=where)
        else:
            np.testing.assert_array_equal(one, other, err_msg=where)
    elif is_dataclass(one):
        for name in (f.name for f in fields(one) if f.name not in ("notes", "origin", "provenance")):
            _same(getattr(one, name), getattr(other, name), f"{where}.{name}")
    elif isinstance(one, tuple):
        assert len(one) == len(other), where
        for i, (a, b) in enumerate(zip(one, other, strict=True)):
            _same(a, b, f"{where}[{i}]")
    else:
        assert one == other, where

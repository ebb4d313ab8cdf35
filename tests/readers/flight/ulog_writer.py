"""PX4's logs for tests, message by message, and read back with pyulog."""

import struct

import numpy as np
import pytest

MAGIC = b"ULog\x01\x12\x35\x01"
TYPES = {
    "int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i", "uint32_t": "I", "int64_t": "q",
    "uint64_t": "Q", "float": "f", "double": "d", "bool": "?", "char": "B",
}  # fmt: skip
HEADER = MAGIC + struct.pack("<Q", 1_000_000)
START = 1_000_000  #: µs
UTC = 1_714_564_800 * 10**6  #: µs, at power-up
COMBINED = (
    "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
    "float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;"
)
GYRO = ACCEL = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float temperature;float x;float y;float z;"
)
FIFO = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float dt;float scale;int16_t[32] x;int16_t[32] y;"
    "int16_t[32] z;uint8_t samples;uint8_t[3] _padding0;"
)
GPS = (
    "uint64_t timestamp;uint64_t time_utc_usec;int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;"
    "float s_variance_m_s;float eph;float epv;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;"
    "bool vel_ned_valid;uint8_t[6] _padding0;"
)
GPS_DEG = GPS.replace("int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;", (
    "double latitude_deg;double longitude_deg;double altitude_msl_m;double altitude_ellipsoid_m;"
))  # fmt: skip
LOCAL = (
    "uint64_t timestamp;uint64_t timestamp_sample;double ref_lat;double ref_lon;float ref_alt;float x;float y;float z;"
    "float vx;float vy;float vz;bool xy_global;"
)
GLOBAL = "uint64_t timestamp;uint64_t timestamp_sample;double lat;double lon;float alt;"
ATTITUDE = "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;"


def message(kind, content):
    """Return a message."""
    return struct.pack("<HB", len(content), ord(kind)) + content


def flags(*offsets):
    """Return the message that says where data was appended, if anywhere."""
    places = (*offsets, 0, 0, 0)[:3]
    return message("B", bytes(8) + bytes([bool(offsets), *[0] * 7]) + struct.pack("<3Q", *places))


def defined(name, text):
    """Return the definition of a topic."""
    return message("F", f"{name}:{text}".encode())


def added(name, number, instance=0):
    """Return what gives a topic's instance its number."""
    return message("A", struct.pack("<BH", instance, number) + name.encode())


def fields(text):
    """Return (type, count, name) of a flat definition's fields."""
    found = []
    for field in filter(None, text.split(";")):
        kind, name = field.split(" ")
        kind, _, count = kind.partition("[")
        found.append((kind, int(count.rstrip("]") or 0), name))
    return found


def data(number, text, **values):
    """Return a message of a topic; fields that are not given are 0, padding at the end is not written."""
    kept = fields(text)
    while kept[-1][2].startswith("_padding"):
        kept.pop()
    body = struct.pack("<H", number)
    for kind, count, name in kept:
        value = values.get(name, 0)
        numbers = list(value) if np.ndim(value) else [value] * max(count, 1)
        numbers += [0] * (count - len(numbers))
        body += struct.pack(f"<{max(count, 1)}{TYPES[kind]}", *numbers)
    return message("D", body)


def dropout(milliseconds):
    """Return what says that nothing was written for so long."""
    return message("O", struct.pack("<H", milliseconds))


def topic(name, number, text, rows, instance=0):
    """Return the definition of a topic, and a message for each row of values."""
    begins = defined(name, text) + added(name, number, instance)
    return begins + b"".join(data(number, text, **row) for row in rows)


def combined(count, number=1, first=0):
    """Return sensor_combined at 200 Hz; its rate about x counts, and the accelerometer is 2 ms late."""
    rows = [
        {"timestamp": START + 5000 * i, "gyro_rad": (i / 1000, 0.01, -0.02), "accelerometer_m_s2": (0.1, i / 100, -9.8),
         "accelerometer_timestamp_relative": 2000}
        for i in range(first, first + count)
    ]  # fmt: skip
    return topic("sensor_combined", number, COMBINED, rows)


def fixes(count, **changes):
    """Return the rows of a receiver at 5 Hz with integers of 1e-7 deg."""
    return [
        {"timestamp": START + 200_000 * i, "time_utc_usec": UTC + START + 200_000 * i, "lat": 473000000 + 100 * i,
         "lon": 85000000, "alt": 400000, "alt_ellipsoid": 447500, "s_variance_m_s": 0.25, "eph": 0.5, "epv": 0.75,
         "vel_n_m_s": 1.5, "vel_e_m_s": -2.5, "vel_d_m_s": 0.25, "fix_type": 3, "vel_ned_valid": True, **changes}
        for i in range(count)
    ]  # fmt: skip


def flight():
    """Return a whole log: an IMU, a receiver and the solution."""
    solution = [{"timestamp": START + 100_000 * i, "ref_lat": 47.3, "ref_lon": 8.5, "ref_alt": 450.0, "x": float(i),
                 "vx": 2.0, "xy_global": True} for i in range(10)]  # fmt: skip
    turned = [{"timestamp": START + 100_000 * i, "q": (1, 0, 0, 0)} for i in range(10)]
    return b"".join(
        (
            HEADER, flags(), combined(200), topic("vehicle_gps_position", 2, GPS, fixes(5)),
            topic("vehicle_local_position", 3, LOCAL, solution), topic("vehicle_attitude", 4, ATTITUDE, turned),
        )
    )  # fmt: skip


def heard(path, names=None):
    """Return {(name, instance): {field: values}} of all that pyulog finds, arrays as (n, count), and its log."""
    pyulog = pytest.importorskip("pyulog", reason="pyulog, which reads PX4's logs, is not installed")
    told = pyulog.ULog(str(path), None if names is None else list(names))
    found = {}
    for one in told.data_list:
        columns = found.setdefault((one.name, one.multi_id), {})
        for name, values in one.data.items():
            base, _, rest = name.partition("[")
            if rest.endswith("]") and rest[:-1].isdigit():
                columns.setdefault(base, []).append(values)
            else:
                columns[name] = values
    return {
        key: {name: np.stack(values, 1) if isinstance(values, list) else values for name, values in columns.items()}
        for key, columns in found.items()
    }, told


def local_rows(count=20, **changes):
    """Return rows of a local position with its reference point."""
    return [
        {"timestamp": START + 100_000 * i, "timestamp_sample": START + 100_000 * i, "ref_lat": 47.3,
         "ref_lon": 8.5, "ref_alt": 450.0, "x": 10.0 * i, "y": -20.0, "z": -3.0, "vx": 100.0, "vy": i, "vz": -1.0,
         "xy_global": True, **changes} for i in range(count)
    ]  # fmt: skip

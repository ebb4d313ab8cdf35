"""Many frames of MAVLink 2 at once, as a recorder writes them, for the benchmark of reading telemetry."""

from __future__ import annotations

import os

import numpy as np

START = 1_714_564_800 * 10**6  #: µs
#: messages of a tenth of a second: name, field of the time, unit of that field (µs)
FRAMES = (
    ("HEARTBEAT", None, 0), ("ATTITUDE", "time_boot_ms", 1000), ("RAW_IMU", "time_usec", 1), ("SCALED_IMU2", "time_boot_ms", 1000),
    ("SCALED_IMU3", "time_boot_ms", 1000), ("GPS_RAW_INT", "time_usec", 1), ("GLOBAL_POSITION_INT", "time_boot_ms", 1000),
    ("SYSTEM_TIME", "time_boot_ms", 1000), ("VFR_HUD", None, 0), ("NAV_CONTROLLER_OUTPUT", None, 0),
)  # fmt: skip
FIXED = {"lat": 473_977_420, "lon": 85_455_940, "alt": 488_000, "fix_type": 3, "zacc": -1000, "time_unix_usec": START}
TRIADS = ("gyro", "acc")


def mavlink_dialect():
    """Return pymavlink's dialect of protocol version 2."""
    os.environ["MAVLINK20"] = "1"
    from pymavlink.dialects.v20 import ardupilotmega

    return ardupilotmega


def frames_of(name, clock, unit, boot, rng):
    """Return (n, bytes) records of one kind of message."""
    dialect = mavlink_dialect()
    kind = dialect.mavlink_map[getattr(dialect, f"MAVLINK_MSG_ID_{name}")]
    # MAVLink does not send trailing zeros of a payload: a last byte above zero makes all frames of a kind equally long.
    sizes, last = _sizes(kind), kind.ordered_fieldnames[-1]
    values = {field: FIXED.get(field, 0) for field in kind.fieldnames}
    values[last] = 1 << 8 * (sizes[-1] - 1)
    packed = kind(*values.values()).pack(dialect.MAVLink(None, srcSystem=1, srcComponent=1))
    records = np.empty((boot.size, 8 + len(packed)), np.uint8)
    records[:, 8:] = np.frombuffer(packed, np.uint8)
    records[:, :8] = (START + boot).astype(">u8").view(np.uint8).reshape(-1, 8)
    at, places = 8 + 10, {}
    for field, size in zip(kind.ordered_fieldnames, sizes, strict=True):
        places[field] = slice(at, at + size)
        at += size

    def put(field, numbers, dtype):
        place = places[field]
        records[:, place] = numbers.astype(dtype).view(np.uint8).reshape(boot.size, -1)[:, : place.stop - place.start]

    if clock is not None:
        put(clock, boot // unit, "<u8" if clock == "time_usec" else "<u4")
    if "time_unix_usec" in places:
        put("time_unix_usec", START + boot, "<u8")
    for axis in "xyz":
        for sensor in TRIADS:
            if f"{axis}{sensor}" in places:
                put(f"{axis}{sensor}", rng.integers(-1000, 1000, boot.size), "<i2")
    if "lat" in places:
        put("lat", FIXED["lat"] + rng.integers(-1000, 1000, boot.size), "<i4")
    records[:, -2:] = _checksums(records[:, 9:-2], kind.crc_extra).view(np.uint8).reshape(-1, 2)
    return records


def _sizes(kind):
    """Return the number of bytes of each field of a message, in the order of sending."""
    sizes = {"char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4, "float": 4}
    kinds = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    return [sizes.get(kinds[name], 8) * max(lengths[name], 1) for name in kind.ordered_fieldnames]


def _checksums(content, extra):
    """Return MAVLink's checksum of each row, (n,) uint16."""
    table = np.arange(256, dtype=np.uint16)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ 0x8408, table >> 1).astype(np.uint16)
    crc = np.full(content.shape[0], 0xFFFF, np.uint16)
    for column in (*content.T, np.full(content.shape[0], extra, np.uint8)):
        crc = (crc >> 8) ^ table[(crc ^ column) & 0xFF]
    return crc.astype("<u2")

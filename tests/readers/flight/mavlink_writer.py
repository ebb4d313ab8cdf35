"""Telemetry logs for tests: written with pymavlink, and read back with it."""

import struct
from pathlib import Path

import pytest

REASON = "pymavlink, which writes and reads telemetry logs, is not installed"
mavlink = pytest.importorskip("pymavlink.dialects.v20.ardupilotmega", reason=REASON)
mavlink_1 = pytest.importorskip("pymavlink.dialects.v10.ardupilotmega", reason=REASON)  #: knows no extensions

T = 1_714_564_800 * 10**6  #: µs, of the recorder


def frame(name, *, version=2, system=1, component=1, signed=False, **fields):
    """Return a message as it goes over the air, made by pymavlink; fields that are not given are 0."""
    dialect = mavlink_1 if version == 1 else mavlink
    kind = dialect.mavlink_map[getattr(dialect, f"MAVLINK_MSG_ID_{name}")]
    mav = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
    if signed:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = bytes(range(32)), True, 7
    return kind(*(fields.get(field, 0) for field in kind.fieldnames)).pack(mav)


def record(stamp, data):
    """Return a frame as a recorder writes it down, at a time in µs."""
    return struct.pack(">Q", stamp) + data


def heartbeat(stamp=T, **options):
    """Return a record of a message without measurements."""
    return record(stamp, frame("HEARTBEAT", **{"custom_mode": 7, "mavlink_version": 3, **options}))


def numbered(count, first=0, **options):
    """Return records of SCALED_IMU whose rate about x counts, in mrad/s, ten a second."""
    return [
        record(T + 100_000 * i, frame("SCALED_IMU", time_boot_ms=5000 + 100 * i, xgyro=i + 1, zacc=-1000, **options))
        for i in range(first, first + count)
    ]


def spoilt(data, at=-3):
    """Return a record or frame with one bit changed, by default in the last byte of its payload."""
    damaged = bytearray(data)
    damaged[at] ^= 0x10
    return bytes(damaged)


def heard(path):
    """Yield (recorder's µs, message) of all that pymavlink decodes."""
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    with Path(path).open("rb") as file:
        while len(stamp := file.read(8)) == 8:
            told = None
            while told is None and (data := file.read(mav.bytes_needed())):
                told = mav.parse_char(data)
            if told is not None and told.get_type() != "BAD_DATA":
                yield struct.unpack(">Q", stamp)[0], told


START = T * 1000
STEP = 100_000  #: µs between messages
BOOT = 5000  #: ms since power-up at the start
FIX = {"lat": 473_977_420, "lon": 85_455_940, "alt": 488_000, "fix_type": 3, "vel": 65_535, "cog": 65_535}
IMU_COUNTS = ("SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", "RAW_IMU")


def at(i, name, *, clock=True, **fields):
    """Return the record of a message that is the i-th, its clock set to that."""
    if clock and name in (*IMU_COUNTS[:3], "ATTITUDE", "GLOBAL_POSITION_INT"):
        fields = {"time_boot_ms": BOOT + 100 * i, **fields}
    elif clock:
        fields = {"time_usec": 1000 * BOOT + STEP * i, **fields}
    return record(T + STEP * i, frame(name, **fields))


def system_time(unix, i=0, **options):
    return record(T + STEP * i, frame("SYSTEM_TIME", time_unix_usec=unix, time_boot_ms=BOOT + 100 * i, **options))


def fixes(count=4, first=0, name="GPS_RAW_INT", **fields):
    return [at(i, name, **{**FIX, **fields}) for i in range(first, first + count)]


def since_start(stream):
    """Return a stream's times in steps from the start."""
    return ((stream.time - START) / (1000 * STEP)).tolist()


def solution(i, **fields):
    return at(i, "GLOBAL_POSITION_INT", **{"lat": 473_977_420, "lon": -85_455_940, "alt": 488_500, **fields})


def content(log):
    """Return the content of a log, to be compared."""
    triads = [part for imu in log.imus for part in (imu.angular_rate, imu.specific_force)]
    others = [*log.gnss, *log.references]
    arrays = [*(t.value for t in triads), *(o.position for o in others), *(s.time for s in (*triads, *others))]
    return [array.tobytes() for array in arrays], [s.origin for s in (*log.imus, *others)], log.notes

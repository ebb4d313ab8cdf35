"""NovAtel's binary logs for tests: frames with long and short headers, packed from their documented fields."""

import struct
import zlib

WEEK = 2209
BESTPOS, INSPVAS, RAWIMUS, RAWIMUSX, CORRIMUDATAS, VERSION = 42, 508, 325, 1462, 813, 37


def checked(frame):
    """Return a frame with its checksum: that of zip, begun with 0 and not inverted at the end."""
    return frame + struct.pack("<I", zlib.crc32(frame, 0xFFFFFFFF) ^ 0xFFFFFFFF)


def short(number, seconds, body):
    return checked(b"\xaa\x44\x13" + struct.pack("<BHHI", len(body), number, WEEK, round(seconds * 1000)) + body)


def full(number, seconds, body):
    head = struct.pack(
        "<BHBBHHBBHIIHH", 28, number, 0, 0x20, len(body), 0, 0, 180, WEEK, round(seconds * 1000), 0, 0, 0
    )
    return checked(b"\xaa\x44\x12" + head + body)


def rawimusx(seconds, gyro, accel, *, kind=41, week=WEEK):
    """Return counts of x, y and z as RAWIMUSX orders them: z, -y, x, accelerations first."""
    (gx, gy, gz), (ax, ay, az) = gyro, accel
    return short(RAWIMUSX, seconds, struct.pack("<BBHdI6i", 4, kind, week, seconds, 0, az, -ay, ax, gz, -gy, gx))


def rawimus(seconds, gyro, accel):
    (gx, gy, gz), (ax, ay, az) = gyro, accel
    return short(RAWIMUS, seconds, struct.pack("<Idi6i", WEEK, seconds, 0, az, -ay, ax, gz, -gy, gx))


def inspvas(seconds, place, velocity, attitude):
    return short(INSPVAS, seconds, struct.pack("<I10dI", WEEK, seconds, *place, *velocity, *attitude, 3))


def bestpos(seconds, place, undulation, sigmas, *, status=0):
    body = struct.pack("<II3dfI3f4sff8B", status, 50, *place, undulation, 61, *sigmas, b"0000", 1.0, 0.0, *(9,) * 8)
    return full(BESTPOS, seconds, body)

"""The payloads of UBX messages: offsets, types and names of the fields that are used.

Source: u-blox F9 HPS 1.30 interface description (UBX-22010984). Numbers are little-endian.
"""

from dataclasses import dataclass

from imuwb.readers.bytes.gather import Field

PVT, HIGH_PRECISION, COVARIANCE, VELOCITY, POSITION, STATUS = 0x0107, 0x0114, 0x0136, 0x0112, 0x0102, 0x0103
SOLUTION, TIME_GPS, TIME_UTC, RAW_SIGNALS = 0x0106, 0x0120, 0x0121, 0x0215
MEASURED, RAW = 0x1002, 0x1003


@dataclass(frozen=True, slots=True)
class Layout:
    """A message of fixed fields; its payload may be longer."""

    name: str
    length: int  #: bytes that the fields need
    fields: tuple[Field, ...]


def _layout(name: str, length: int, text: str) -> Layout:
    """Return a layout from a text of ``name:type@offset``, with ``*count`` for several numbers."""
    fields: list[Field] = []
    for word in text.split():
        field, _, rest = word.partition(":")
        kind, _, place = rest.partition("@")
        place, _, count = place.partition("*")
        fields.append(Field(field, f"<{kind}", int(count or 0), int(place)))
    return Layout(name, length, tuple(fields))


_DATE = "year:u2@{} month:u1@{} day:u1@{} hour:u1@{} minute:u1@{} second:u1@{} valid:u1@{}"
LAYOUTS = {
    PVT: _layout(
        "NAV-PVT", 84,
        "tow:u4@0 " + _DATE.format(4, 6, 7, 8, 9, 10, 11) + " nano:i4@16 fix:u1@20 flags:u1@21 longitude:i4@24 latitude:i4@28 "
        "height:i4@32 horizontal:u4@40 vertical:u4@44 velocity:i4@48*3 speed_sigma:u4@68 flags3:u1@78",
    ),
    HIGH_PRECISION: _layout(
        "NAV-HPPOSLLH", 36,
        "flags:u1@3 tow:u4@4 longitude:i4@8 latitude:i4@12 height:i4@16 fine_longitude:i1@24 fine_latitude:i1@25 "
        "fine_height:i1@26 horizontal:u4@28 vertical:u4@32",
    ),
    COVARIANCE: _layout("NAV-COV", 64, "tow:u4@0 position_valid:u1@5 velocity_valid:u1@6 position:f4@16*6 velocity:f4@40*6"),
    VELOCITY: _layout("NAV-VELNED", 36, "tow:u4@0 velocity:i4@4*3 speed_sigma:u4@28"),
    POSITION: _layout(
        "NAV-POSLLH", 28, "tow:u4@0 longitude:i4@4 latitude:i4@8 height:i4@12 horizontal:u4@20 vertical:u4@24"
    ),
    SOLUTION: _layout("NAV-SOL", 52, "tow:u4@0 rest:i4@4 week:i2@8 fix:u1@10 flags:u1@11"),
    STATUS: _layout("NAV-STATUS", 16, "tow:u4@0 fix:u1@4 flags:u1@5"),
    TIME_GPS: _layout("NAV-TIMEGPS", 16, "tow:u4@0 rest:i4@4 week:i2@8 valid:u1@11"),
    TIME_UTC: _layout("NAV-TIMEUTC", 20, "tow:u4@0 nano:i4@8 " + _DATE.format(12, 14, 15, 16, 17, 18, 19)),
    RAW_SIGNALS: _layout("RXM-RAWX", 16, "seconds:f8@0 week:u2@8"),
}  # fmt: skip
#: messages of a sensor: bytes before the first measurement, and bytes of a measurement
SENSORS = {MEASURED: (8, 4), RAW: (4, 8)}

_CLASSES = {
    0x01: "NAV", 0x02: "RXM", 0x04: "INF", 0x05: "ACK", 0x06: "CFG", 0x09: "UPD", 0x0A: "MON", 0x0B: "AID", 0x0D: "TIM", 0x10: "ESF",
    0x13: "MGA", 0x21: "LOG", 0x27: "SEC", 0x28: "HNR", 0x29: "NAV2",
}  # fmt: skip
_NAMES = {
    0x0101: "POSECEF", 0x0104: "DOP", 0x0105: "ATT", 0x0111: "VELECEF", 0x0113: "HPPOSECEF", 0x0122: "CLOCK",
    0x0126: "TIMELS", 0x0130: "SVINFO", 0x0132: "SBAS", 0x0134: "ORB", 0x0135: "SAT", 0x0139: "GEOFENCE", 0x013B: "SVIN",
    0x013C: "RELPOSNED", 0x013D: "EELL", 0x0143: "SIG", 0x0160: "AOPSTATUS", 0x0161: "EOE", 0x0210: "RAW", 0x0211: "SFRB",
    0x0213: "SFRBX", 0x0214: "MEASX", 0x0232: "RTCM", 0x0A04: "VER", 0x0A09: "HW", 0x0A38: "RF", 0x0D01: "TP", 0x0D03: "TM2",
    0x1010: "STATUS", 0x1014: "ALG", 0x1015: "INS", 0x2800: "PVT", 0x2802: "INS",
}  # fmt: skip


def name_of(kind: int) -> str:
    """Return a message's name, such as NAV-SAT; an unknown number as 2 hexadecimal digits."""
    if kind in LAYOUTS:
        return LAYOUTS[kind].name
    if kind in SENSORS:
        return "ESF-MEAS" if kind == MEASURED else "ESF-RAW"
    return f"{_CLASSES.get(kind >> 8, f'{kind >> 8:02X}')}-{_NAMES.get(kind, f'{kind & 255:02X}')}"

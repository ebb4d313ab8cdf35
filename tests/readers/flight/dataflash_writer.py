"""ArduPilot's logs for tests: the same rows as bytes or as text, and read back with pymavlink."""

import struct
from dataclasses import dataclass

import numpy as np
import pytest

HEAD = b"\xa3\x95"
STRUCT = {
    "a": "32h", "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "f": "f", "d": "d", "g": "e", "n": "4s",
    "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "M": "B", "q": "q", "Q": "Q",
}  # fmt: skip
DECIMALS = {**dict.fromkeys("cCeE", 2), "L": 7}  #: of letters whose integers are hundredths, or 1e-7
LATITUDE, LONGITUDE = 47.3, 8.5
WEEK, MILLISECONDS = 2340, 100_000_000  #: of the first fix
START = 5_000_000  #: µs from power-up to the first record


@dataclass(frozen=True)
class Format:
    """A kind of record: number, name, a letter for each field, the fields' names."""

    number: int
    name: str
    letters: str
    labels: str

    @property
    def size(self):
        """Return the bytes of a record, with its head."""
        return 3 + struct.calcsize("<" + "".join(STRUCT[letter] for letter in self.letters))

    def binary(self, values):
        """Return a record as bytes."""
        flat = []
        for letter, value in zip(self.letters, values, strict=True):
            whole = round(value * 10 ** DECIMALS[letter]) if letter in DECIMALS else value
            flat += list(whole) if letter == "a" else [whole.encode() if isinstance(whole, str) else whole]
        return (
            HEAD + bytes([self.number]) + struct.pack("<" + "".join(STRUCT[letter] for letter in self.letters), *flat)
        )

    def text(self, values):
        """Return a record as a line."""
        cells = [self.name]
        for letter, value in zip(self.letters, values, strict=True):
            cells.append(f"{value:.{DECIMALS[letter]}f}" if letter in DECIMALS else str(value))
        return ", ".join(cells) + "\n"


FMT = Format(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
IMU = Format(131, "IMU", "QBfffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T")
GPS = Format(132, "GPS", "QBBIHBcLLefffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,U")
GPA = Format(133, "GPA", "QBCCCC", "TimeUS,I,VDop,HAcc,VAcc,SAcc")
POS = Format(134, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt")
XKF1 = Format(135, "XKF1", "QBccCfff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD")
ATT = Format(136, "ATT", "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw")
ISBH = Format(137, "ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
ISBD = Format(138, "ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
FMTU = Format(139, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
UNIT = Format(140, "UNIT", "QbZ", "TimeUS,Id,Label")
MULT = Format(141, "MULT", "Qbd", "TimeUS,Id,Mult")
MSG = Format(142, "MSG", "QZ", "TimeUS,Message")
ALL = (IMU, GPS, GPA, POS, XKF1, ATT, ISBH, ISBD, FMTU, UNIT, MULT, MSG)


def declared(*formats):
    """Return the rows that describe formats, those of the table above without any."""
    return [(FMT, (f.number, f.size, f.name, f.letters, f.labels)) for f in (FMT, *(formats or ALL))]


def binary(rows):
    """Return rows as a binary log."""
    return b"".join(kind.binary(values) for kind, values in rows)


def text(rows):
    """Return rows as a text log."""
    return "".join(kind.text(values) for kind, values in rows).encode()


def single(value):
    """Return a number as a float of four bytes keeps it."""
    return float(np.float32(value))


def imu(i, instance=0, time=None, rate=None):
    """Return the row of an IMU at 25 Hz, whose rate about x counts."""
    values = (i / 1000, 0.01, -0.02, 0.1, 0.2, -9.8, 30 + i / 10) if rate is None else (*rate, 0.1, 0.2, -9.8, 30.0)
    time = START + 40_000 * i if time is None else time
    return IMU, (time, instance, *map(single, values))


def fix(i, instance=0, **changes):
    """Return the row of a receiver at 5 Hz, that moves north."""
    values = {
        "TimeUS": START + 200_000 * i, "I": instance, "Status": 3, "GMS": MILLISECONDS + 200 * i, "GWk": WEEK, "NSats": 10,
        "HDop": 0.8, "Lat": LATITUDE + i * 1e-5, "Lng": LONGITUDE, "Alt": 400 + i / 10, "Spd": 5.0, "GCrs": 30.0,
        "VZ": -0.5, "U": 1,
    }  # fmt: skip
    return GPS, tuple({**values, **changes}[name] for name in GPS.labels.split(","))


def flight(count=50):
    """Return the rows of a flight: two IMUs, a receiver and its accuracies, and the solution."""
    rows = declared()
    for i in range(count):
        time = START + 40_000 * i
        rows += [imu(i), imu(i, 1, time + 3)]
        if i % 5 == 0:
            rows += [fix(i // 5), (GPA, (time + 1000, 0, 1.2, 0.5 + i / 100, 0.9, 0.3))]
        if i % 2 == 0:
            rows += [
                (POS, (time + 20, LATITUDE + i * 1e-6, LONGITUDE, 400.0, 0.0, 0.0)),
                (XKF1, (time + 10, 0, 0.0, 0.0, 0.0, 1.0 + i, 2.0, -3.0)),
                (XKF1, (time + 11, 1, 0.0, 0.0, 0.0, -99.0, -99.0, -99.0)),
                (ATT, (time + 15, 0.0, 1.5, 0.0, -2.5, 0.0, (350.0 + i) % 360)),
            ]
    return rows


def heard(path):
    """Return {name: messages} of all that pymavlink decodes of a binary log."""
    reader = pytest.importorskip("pymavlink.DFReader", reason="pymavlink, which reads ArduPilot's logs, is not there")
    found, log = {}, reader.DFReader_binary(str(path))
    while (message := log.recv_msg()) is not None:
        found.setdefault(message.get_type(), []).append(message)
    log.filehandle.close()
    return found


def imus(found):
    return {imu.name: imu for imu in found.imus}


def assert_same(one, other, rtol=0.0):
    """Compare all streams of two logs."""
    assert [imu.name for imu in one.imus] == [imu.name for imu in other.imus]
    triads = [(a.axes(), b.axes()) for a, b in zip(one.imus, other.imus, strict=True)]
    for a, b in triads:
        assert a.keys() == b.keys()
        for name in a:
            np.testing.assert_array_equal(a[name][0], b[name][0])
            np.testing.assert_allclose(a[name][1], b[name][1], rtol=rtol)
    for a, b in zip(one.imus, other.imus, strict=True):
        np.testing.assert_allclose(a.temperature.value, b.temperature.value, rtol=rtol)
    for kind, columns in (
        ("gnss", ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")),
        ("references", ("time", "position", "velocity", "attitude")),
    ):
        assert [x.name for x in getattr(one, kind)] == [x.name for x in getattr(other, kind)]
        for a, b in zip(getattr(one, kind), getattr(other, kind), strict=True):
            for column in columns:
                if getattr(a, column) is None or column == "time":
                    np.testing.assert_array_equal(getattr(a, column), getattr(b, column))
                else:
                    np.testing.assert_allclose(getattr(a, column), getattr(b, column), rtol=rtol)

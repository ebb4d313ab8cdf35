"""Formats that are not read are named, with what makes of them what is read; the file's first bytes decide."""

import bz2
import io
import lzma
import sqlite3
import struct
import tarfile
import zipfile

import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from imuwb.readers.unread import BINARIES, TEXTS, unread_binary, unread_text


def fletcher(body):
    first = second = 0
    for byte in body:
        first = (first + byte) % 256
        second = (second + first) % 256
    return body + bytes((first, second))


def crc16(body):
    crc = 0
    for byte in body:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021) & 0xFFFF if crc & 0x8000 else (crc << 1) & 0xFFFF
    return struct.pack(">H", crc)


def zipped(name):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(name, "1,2\n")
    return file.getvalue()


def tarred():
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as archive:
        archive.addfile(tarfile.TarInfo("log.csv"))
    return file.getvalue()


def database(tmp_path):
    path = tmp_path / "app.sqlite"
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE gyroscope (time, x, y, z)")
    connection.commit()
    connection.close()
    return path.read_bytes()


VN = b"\xfa\x01\x08\x01" + bytes(range(24))
VN += crc16(VN[1:])
XSENS = b"\xfa\xff\x36\x04" + bytes((1, 2, 3, 4))
XSENS += bytes((-sum(XSENS[1:]) % 256,))
SBG = b"\xff\x5a\x03\x00" + struct.pack("<H", 6) + bytes(6) + b"\x12\x34\x33"
RINEX = f"{'3.04':>9}{'':11}{'OBSERVATION DATA':20}{'M':20}RINEX VERSION / TYPE\n"

FILES = {
    "blackbox": b"H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\n",
    "RINEX observation": RINEX.encode() + b"  2024     5     1\n",
    "Hatanaka": f"{'3.0':20}{'COMPACT RINEX FORMAT':40}CRINEX VERS   / TYPE\n".encode(),
    "RINEX navigation": f"{'3.04':>9}{'':11}{'NAVIGATION DATA':20}{'M':20}RINEX VERSION / TYPE\n".encode(),
    "RTKLIB as a baseline": b"% program   : RTKLIB\n%\n%  GPST   e-baseline(m)  n-baseline(m)  u-baseline(m)   Q\n2341 212818.000 1.0 2.0 3.0 1\n",
    "RTKLIB in ECEF": b"% program   : RTKLIB\r\n%  UTC,x-ecef(m),y-ecef(m),z-ecef(m),Q\r\n2024/11/19 11:06:00.000,4180000.0,850000.0,4720000.0,1\r\n",
    "RTKLIB in degrees, minutes": b"%  GPST   latitude(d'\")   longitude(d'\")   height(m)   Q\n2341 212818.000 48 06 01.5 11 30 02.5 550.0 1\n",
    "Vector ASC": b"date Mon May 6 09:30:00.000 am 2024\nbase hex  timestamps absolute\n0.0 1 123 Rx d 8 00 01\n",
    "PDF": b"%PDF-1.7\n1 0 obj\n",
    "Git LFS": b"version https://git-lfs.github.com/spec/v1\noid sha256:1234\nsize 12\n",
    "HTML": b"<!DOCTYPE html>\n<html><body>404</body></html>",
    "GPX": b"<?xml version='1.0'?>\n<gpx version='1.1'><trk/></gpx>",
    "KML": b"<?xml version='1.0'?><kml xmlns='http://www.opengis.net/kml/2.2'></kml>",
    "XML": b"\xef\xbb\xbf<?xml version='1.0'?><other>1</other>",
    "version 1.2": b"#ROSBAG V1.2\n" + bytes(20),
    "gpsd": b'{"class":"VERSION","release":"3.22"}\n{"class":"TPV","lat":47.5}\n',
    "JSON text": b'[\n  {"sensor": "Gyroscope", "time": "1752154081456345900", "x": "0.3"}]',
    "rosbag2 recording": b"rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - a_0.db3\n",
    "PCD": b"# .PCD v.7 - Point Cloud Data file format\nVERSION .7\n1 2 3\n",
    "Garmin FIT": b"\x0e\x20\x54\x08\x10\x00\x00\x00.FIT\x00\x00" + bytes(20),
    "Septentrio": b"$@\x12\x34\xab\x0f\x60\x00" + bytes(90),
    "time tag of RTKLIB": b"TIMETAG RTKLIB demo5".ljust(60, b"\0") + struct.pack("<IId", 5, 6, 0.5),
    ".xls)": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(60),
    ".xlsx": zipped("xl/workbook.xml"),
    "Rerun": b"RRF2\0\x29\0\0" + bytes(30),
    "pcap": struct.pack("<IHHIIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1),
    "video": b"\0\0\0\x20ftypisom" + bytes(20),
    "sound": b"RIFF\x24\0\0\0WAVEfmt " + bytes(20),
    "image": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(20),
    "LAS": b"LASF" + bytes(200),
    "SQLite": None,
    "zip archive": zipped("photo.bmp"),
    "tar archive": tarred(),
    "xz": lzma.compress(b"1,2,3\n"),
    "bzip2": bz2.compress(b"1,2,3\n"),
    "LZ4": b"\x04\x22\x4d\x18\x64\x40" + bytes(20),
    "7z": b"7z\xbc\xaf\x27\x1c\0\4" + bytes(20),
    "RAR": b"Rar!\x1a\x07\x01\0" + bytes(20),
    "BLF": b"LOGG" + struct.pack("<I", 144) + bytes(136),
    "MicroStrain": fletcher(b"ue\x80\x0e\x0e\x04" + struct.pack(">fff", 0.1, 0.2, 1.0)) * 3,
    "VectorNav": VN * 3,
    "Xsens": XSENS * 3,
    "SBG": SBG * 3,
    "RTCM": (b"\xd3\x00\x04abcd\x01\x02\x03") * 3,
    "Applanix": b"$GRP\x01\x00" + bytes(90),
    "DJI": bytes(16) + b"BUILD 2015-11-05" + bytes(90),
    "TDMS": b"TDSm\x0e\0\0\0" + bytes(30),
    "pickle": b"\x80\x04\x95\x0a\0\0\0\0\0\0\0" + bytes(10),
    "Feather": b"FEA1" + bytes(50),
    "encrypted Parquet": b"PARE" + bytes(50),
    "ORC": b"ORC\x08\x03" + bytes(50),
    "Avro": b"Obj\x01\x04" + bytes(20),
    "program": b"\x7fELF\x02\x01\x01" + bytes(50),
}


@pytest.mark.parametrize("name", FILES)
def test_a_format_that_is_not_read_is_named(tmp_path, name):
    path = tmp_path / "recording"
    path.write_bytes(database(tmp_path) if FILES[name] is None else FILES[name])
    with pytest.raises(UnreadableLogError) as raised:
        read(path)
    message = str(raised.value)
    assert message.startswith(f"{path}: this is ")
    assert name in message
    assert raised.value.exit_code == 4


def test_each_entry_has_its_file():
    named = [x.name for x in (*BINARIES, *TEXTS)]
    assert len(set(named)) == len(named)
    found = {
        name: [x.name for x in (*BINARIES, *TEXTS) if content and x.test(content)] for name, content in FILES.items()
    }
    firsts = {names[0] for names in found.values() if names} | {"an SQLite database that is no recording of ROS 2"}
    assert set(named) - firsts == set()


@pytest.mark.parametrize(
    "head",
    [
        b"", b"u", b"ue\x80", b"ue\x80\x0e" + bytes(20), b"\xfa", b"\xfa\xff\x36\xff", VN[:-1] + b"\0", XSENS[:-1], b"\xff\x5a", b"\xd3\0", b"RIFF",
        b"t,gx,gy,gz\n1,2,3,4\n", b"date,gyro_x\n1,2\n", b"3.04,1,2,3\n", bytes(4096), bytes(range(256)) * 4, b"\xef\xbb\xbf", b"<3,4,5\n",
    ],
)  # fmt: skip
def test_other_bytes_are_not_named(head):
    assert unread_text(head) is None
    assert unread_binary(head) is None

"""Names of formats that imuwb does not read, by the first bytes of a file, and what makes of them what it reads.

Signatures are those of the formats' own documents or programs; a binary protocol without a magic number is known by the checksum
of its first packet.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

Test = Callable[[bytes], bool]

TO_CSV = "save it as CSV with a header line"


@dataclass(frozen=True, slots=True)
class Unread:
    """A format that is not read."""

    name: str
    remedy: str
    test: Test


def _starts(*magics: bytes, at: int = 0) -> Test:
    return lambda head: head[at:].startswith(magics)


def _matches(pattern: bytes) -> Test:
    found = re.compile(pattern, re.IGNORECASE | re.MULTILINE)
    return lambda head: found.match(head.removeprefix(b"\xef\xbb\xbf").lstrip()[:4096]) is not None


def _rtklib(column: bytes) -> Test:
    return _matches(rb"(%[^\n]*\n)*%\s+(GPST|UTC|JST)[\s,;]+" + column)


def _all(*tests: Test) -> Test:
    return lambda head: all(test(head) for test in tests)


# Binary protocols: the first packet has a correct checksum.


def _mip(head: bytes) -> bool:
    """Return whether a MicroStrain packet is first: ``75 65``, descriptor set, length, payload, two sums of bytes."""
    if not head.startswith(b"ue") or len(head) < 6 or len(head) < 6 + head[3]:  # noqa: PLR2004 - header and checksum
        return False
    first = second = 0
    for byte in head[: 4 + head[3]]:
        first = (first + byte) % 256
        second = (second + first) % 256
    return head[4 + head[3] : 6 + head[3]] == bytes((first, second))


def _xsens(head: bytes) -> bool:
    """Return whether an Xbus message is first: ``FA``, bus, message, length, payload, and a byte that makes the sum 0."""
    if not head.startswith(b"\xfa\xff") or len(head) < 5 or head[3] == 255:  # noqa: PLR2004 - header and checksum
        return False
    message = head[1 : 5 + head[3]]
    return len(message) == 4 + head[3] and sum(message) % 256 == 0


def _vectornav(head: bytes) -> bool:
    """Return whether a VectorNav output is first: ``FA``, groups, payload, and a CRC-16 (CCITT) that makes the whole 0."""
    if not head.startswith(b"\xfa"):
        return False
    crc = 0
    for size, byte in enumerate(head[1:1024], 2):
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
        if crc == 0 and size > 12 and head[size : size + 2] == head[:2]:  # noqa: PLR2004 - the shortest output
            return True
    return False


def _sbg(head: bytes) -> bool:
    """Return whether an sbgECom frame is first: ``FF 5A``, message, class, length (2 bytes), payload, CRC (2 bytes), ``33``."""
    end = 6 + int.from_bytes(head[4:6], "little") + 2
    return head.startswith(b"\xff\x5a") and head[end : end + 1] == b"\x33"


def _rtcm(head: bytes) -> bool:
    """Return whether two RTCM 3 messages follow each other: ``D3``, 6 zero bits, 10 bits of length, payload, CRC (3 bytes)."""
    if not head.startswith(b"\xd3") or len(head) < 3 or head[1] > 3:  # noqa: PLR2004 - 6 zero bits
        return False
    after = 6 + (head[1] << 8 | head[2])
    return len(head) > after + 1 and head[after] == 0xD3 and head[after + 1] <= 3  # noqa: PLR2004


def _transport_stream(head: bytes) -> bool:
    """Return whether five packets of MPEG begin as they must, 188 bytes from each other."""
    return head[: 188 * 5 : 188] == b"GGGGG"


UNPACK = "unpack it, and name the log within"
NO_LOG = "it holds no log of an IMU"
#: formats of text; they are asked for before rows of numbers are looked for
TEXTS = (
    Unread("a Betaflight or iNav blackbox log", "convert it with blackbox_decode --unit-rotation deg/s --unit-acceleration m/s2",
           _starts(b"H Product:Blackbox")),
    Unread("a RINEX observation file", "compute fixes with RTKLIB (rnx2rtkp or RTKPOST) and give the .pos file",
           _matches(rb"[0-9.]+ +(O|OBSERVATION DATA|C).{0,60}RINEX VERSION / TYPE")),
    Unread("a compressed RINEX observation file (Hatanaka)", "unpack it with crx2rnx, then compute fixes with RTKLIB",
           _matches(rb"[0-9.]+ +COMPACT RINEX FORMAT")),
    Unread("a RINEX navigation file", "it holds orbits of satellites; RTKLIB computes fixes from it and an observation file",
           _matches(rb"[0-9.]+ +[NGHLEJ].{0,70}RINEX VERSION / TYPE")),
    Unread("a solution of RTKLIB as a baseline", "compute it again with out-solformat=llh", _rtklib(b"e-baseline")),
    Unread("a solution of RTKLIB in ECEF coordinates", "compute it again with out-solformat=llh", _rtklib(b"x-ecef")),
    Unread("a solution of RTKLIB in degrees, minutes and seconds", "compute it again with out-degform=deg", _rtklib(rb"latitude\(d'")),
    Unread("a trace of a CAN bus (Vector ASC)", "decode it with its DBC file, for example with asammdf or cantools, and write MDF4 or CSV",
           _matches(rb"date \w{3} \w{3} .*\r?\nbase (hex|dec)")),
    Unread("a PDF document", NO_LOG, _starts(b"%PDF-")),
    Unread("a pointer of Git LFS, not the file itself", "fetch the file with git lfs pull", _starts(b"version https://git-lfs.github.com/spec/")),
    Unread("a web page (HTML)", "the download gave a page in place of the log; download the log itself",
           _matches(rb"(<!--.*?-->\s*)?<(!doctype html|html|head)\b")),
    Unread("a GPX track", "convert it to CSV, for example with gpsbabel -i gpx -o unicsv", _matches(rb"(<\?xml[^>]*\?>\s*)?(<!--.*?-->\s*)*<gpx\b")),
    Unread("a KML document", "convert it to CSV, for example with gpsbabel -i kml -o unicsv", _matches(rb"(<\?xml[^>]*\?>\s*)?(<!--.*?-->\s*)*<kml\b")),
    Unread("an XML document", TO_CSV, _matches(rb"<\?xml\b")),
    Unread("a ROS bag of version 1.2", "convert it with rosbag migrate, which writes version 2.0", _starts(b"#ROSBAG V1", b"#ROSRECORD V1")),
    Unread("a log of gpsd (JSON)", "log NMEA sentences in place of it: gpspipe -r", _matches(rb'\{"class":"(VERSION|TPV|SKY|DEVICES|WATCH)"')),
    Unread("JSON text", TO_CSV, _matches(rb'\[?\s*\{\s*"|\[\s*\[')),
    Unread("the metadata of a rosbag2 recording", "give the folder in which it lies, with its .db3 or .mcap files",
           _starts(b"rosbag2_bagfile_information:")),
    Unread("a PCD point cloud", NO_LOG, _matches(rb"# ?\.PCD v")),
)  # fmt: skip
#: formats that are no text; they are asked for after all readers
BINARIES = (
    Unread("a Garmin FIT activity", "convert it to CSV with Garmin's FitCSVTool, or with the Python package fitdecode", _starts(b".FIT", at=8)),
    Unread("a log of a Septentrio receiver (SBF)", "convert it to text with Septentrio's bin2asc or SBF Converter, or to RINEX and .pos with RTKLIB",
           _starts(b"$@")),
    Unread("a time tag of RTKLIB", "name the log that lies beside it; its reader takes the tag, too", _starts(b"TIMETAG RTKLIB")),
    Unread("a workbook of Excel (.xls)", f"{TO_CSV}; phyphox exports CSV itself", _starts(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")),
    Unread("a workbook of Excel (.xlsx)", f"{TO_CSV}; phyphox exports CSV itself",
           _all(_starts(b"PK\x03\x04"), lambda head: b"xl/" in head or b"[Content_Types].xml" in head)),
    Unread("a recording of Rerun (.rrd)", "it is a review, such as imuwb writes; imuwb view opens it, and analyses need the log", _starts(b"RRF", b"RRIO")),
    Unread("a capture of network packets (pcap)", "extract the payload of its packets, for example with tshark -T fields, as the device's own log",
           _starts(b"\xa1\xb2\xc3\xd4", b"\xd4\xc3\xb2\xa1", b"\xa1\xb2\x3c\x4d", b"\x4d\x3c\xb2\xa1", b"\x0a\x0d\x0d\x0a")),
    Unread("a video", f"{NO_LOG} in a form that imuwb knows; export the camera's motion data as CSV",
           lambda head: head[4:8] in (b"ftyp", b"moov", b"mdat") or head.startswith(b"\x1a\x45\xdf\xa3") or (head.startswith(b"RIFF") and head[8:12] == b"AVI ")
           or _transport_stream(head)),
    Unread("sound", NO_LOG, lambda head: (head.startswith(b"RIFF") and head[8:12] == b"WAVE") or head.startswith((b"fLaC", b"OggS", b"ID3"))),
    Unread("an image", NO_LOG,
           lambda head: head.startswith((b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"GIF87a", b"GIF89a", b"II*\0", b"MM\0*"))
           or (head.startswith(b"RIFF") and head[8:12] == b"WEBP")),
    Unread("a point cloud (LAS)", NO_LOG, _starts(b"LASF")),
    Unread("an SQLite database that is no recording of ROS 2", f"{TO_CSV}, for example with sqlite3 -csv -header FILE and a query",
           _starts(b"SQLite format 3\0")),
    Unread("a zip archive", UNPACK, _starts(b"PK\x03\x04", b"PK\x05\x06")),
    Unread("a tar archive", UNPACK, _starts(b"ustar", at=257)),
    Unread("an archive or file packed with xz", f"{UNPACK} (xz -d)", _starts(b"\xfd7zXZ\0")),
    Unread("an archive or file packed with bzip2", f"{UNPACK} (bzip2 -d)", _starts(*(b"BZh%d1AY" % size for size in range(1, 10)))),
    Unread("a file packed with LZ4", f"{UNPACK} (lz4 -d)", _starts(b"\x04\x22\x4d\x18")),
    Unread("a 7z archive", UNPACK, _starts(b"7z\xbc\xaf\x27\x1c")),
    Unread("a RAR archive", UNPACK, _starts(b"Rar!\x1a\x07")),
    Unread("a trace of a CAN bus (Vector BLF)", "decode it with its DBC file, for example with asammdf or cantools, and write MDF4 or CSV",
           _starts(b"LOGG")),
    Unread("a binary log of a MicroStrain sensor (MIP)", "export CSV from SensorConnect, or convert it with MicroStrain's MIP SDK", _mip),
    Unread("a binary log of a VectorNav sensor", "export CSV from VectorNav's Control Center", _vectornav),
    Unread("a log of an Xsens sensor (.mtb)", "export text from Xsens's MT Manager", _xsens),
    Unread("a binary log of an SBG sensor (sbgECom)", "convert it to text with SBG's sbgBasicLogger or sbgCenter", _sbg),
    Unread("RTCM 3 corrections", "compute fixes with RTKLIB (convbin, then rnx2rtkp) and give the .pos file", _rtcm),
    Unread("a raw log of an Applanix POS", "export the trajectory from POSPac as SBET, which imuwb reads", _starts(b"$GRP")),
    Unread("a flight record of DJI (.DAT)", "convert it to CSV with DatCon", _starts(b"BUILD", at=16)),
    Unread("a TDMS file of LabVIEW", f"{TO_CSV}, for example with the Python package npTDMS", _starts(b"TDSm")),
    Unread("a pickle of Python", "imuwb never opens one, because it may run any code; save arrays as .npz or tables as Parquet",
           _starts(b"\x80\x02", b"\x80\x03", b"\x80\x04\x95", b"\x80\x05\x95")),
    Unread("a Feather file of version 1", "write it again with pyarrow or pandas, which write version 2", _starts(b"FEA1")),
    Unread("an encrypted Parquet file", "write it without encryption", _starts(b"PARE")),
    Unread("an ORC file", "write its table as Parquet or CSV", _starts(b"ORC")),
    Unread("an Avro file", "write its table as Parquet or CSV", _starts(b"Obj\x01")),
    Unread("a program, not a log", NO_LOG, _starts(b"\x7fELF", b"MZ\x90")),
)  # fmt: skip


def unread_text(head: bytes) -> str | None:
    """Return the name of a format of text that is not read, and the remedy, from a file's first bytes; None for another."""
    return _told(TEXTS, head)


def unread_binary(head: bytes) -> str | None:
    """Return the name of another format that is not read, and the remedy; None for a format that is not known."""
    return _told((*BINARIES, *TEXTS), head)


def _told(table: tuple[Unread, ...], head: bytes) -> str | None:
    return next((f"this is {x.name}, which imuwb does not read; {x.remedy}" for x in table if x.test(head)), None)

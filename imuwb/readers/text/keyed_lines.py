"""Lines of names and values, as ArduPilot's mavlogdump prints them: ``2024-05-01 12:00:00.25: IMU {TimeUS : 12, I : 0, GyrX : 0.1}``.

The date before a message is in the time zone of the computer that printed it, which is not stated, so it is not used.
Source: ArduPilot/pymavlink, tools/mavlogdump.py and DFReader.py.
"""

import re
from collections.abc import Iterator, Sequence

from imuwb.readers.text.layout import SAMPLE, Layout, Tag
from imuwb.readers.text.trust import is_number

_LINE = re.compile(r"(?P<date>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d(?:\.\d+)?): (?P<tag>\w+) \{(?P<body>.*)\}\s*")
_KEY = re.compile(r"(?:^|, )(\w+) : ")
_KEYS = re.compile(rb"(?<=[,{])\s*\w+ : ")
KEYED = 0.6  #: least share of the lines


def tables_of_keys(lines: Sequence[str], layout: Layout) -> Iterator[Layout]:
    """Yield a layout for each kind of message; none for other lines."""
    filled = [line for line in lines if line.strip()]
    found = [match for line in filled if (match := _LINE.fullmatch(line.strip()))]
    if not found or len(found) < KEYED * len(filled):
        return
    for tag in dict.fromkeys(match["tag"] for match in found):
        bodies = [match["body"] for match in found if match["tag"] == tag]
        names = tuple(_KEY.findall(bodies[0]))
        rows = [tuple(_KEY.sub("\n", body).split("\n")[1:]) for body in bodies if tuple(_KEY.findall(body)) == names]
        sample = tuple(("", "", *map(str.strip, row)) for row in rows)[:SAMPLE]
        if names and any(map(is_number, sample[0])):
            yield Layout(
                ",", 0, ("-", "-", *names), sample[0], sample=sample, encoding=layout.encoding, fault=layout.fault,
                tag=Tag(1, tag, keyed=True),
            )  # fmt: skip


def values_of(data: bytes, tag: str) -> bytes:
    """Return the values of the messages of one kind, as lines of cells: date, tag, values."""
    lines = re.findall(rb"(?m)^([^{\n]*): " + re.escape(tag.encode()) + rb" (\{[^\n]*)\}[ \t\r]*$", data)
    name = tag.encode()
    return b"".join(b"%b,%b,%b\n" % (date, name, _KEYS.sub(b"", body)[1:]) for date, body in lines)

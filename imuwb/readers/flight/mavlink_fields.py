"""The MAVLink messages of inertial sensors, receivers and clocks, and the offsets of their fields.

Definitions: https://mavlink.io/en/messages/common.html; fields are ordered by their size, and followed by extensions.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.readers.bytes.gather import Field, columns, gather

_COUNTS = "xacc:i2 yacc:i2 zacc:i2 xgyro:i2 ygyro:i2 zgyro:i2 xmag:i2 ymag:i2 zmag:i2"
_SCALED, _RAW = f"time_boot_ms:u4 {_COUNTS} temperature:i2", f"time_usec:u8 {_COUNTS}"
_FLOATS = (
    "time_usec:u8 xacc:f4 yacc:f4 zacc:f4 xgyro:f4 ygyro:f4 zgyro:f4 xmag:f4 ymag:f4 zmag:f4 abs_pressure:f4 "
    "diff_pressure:f4 pressure_alt:f4 temperature:f4"
)
_FIX = "time_usec:u8 lat:i4 lon:i4 alt:i4"
_COURSE = "eph:u2 epv:u2 vel:u2 cog:u2 fix_type:u1 satellites:u1"
_ACCURACY = "alt_ellipsoid:i4 h_acc:u4 v_acc:u4 vel_acc:u4"
_MESSAGES = {
    2: ("SYSTEM_TIME", "time_unix_usec:u8 time_boot_ms:u4"),
    24: ("GPS_RAW_INT", f"{_FIX} {_COURSE} {_ACCURACY}"),
    26: ("SCALED_IMU", _SCALED),
    27: ("RAW_IMU", f"{_RAW} id:u1 temperature:i2"),
    30: ("ATTITUDE", "time_boot_ms:u4 roll:f4 pitch:f4 yaw:f4"),
    33: ("GLOBAL_POSITION_INT", "time_boot_ms:u4 lat:i4 lon:i4 alt:i4 relative_alt:i4 vx:i2 vy:i2 vz:i2"),
    105: ("HIGHRES_IMU", f"{_FLOATS} fields_updated:u2 id:u1"),
    107: ("HIL_SENSOR", f"{_FLOATS} fields_updated:u4 id:u1"),
    116: ("SCALED_IMU2", _SCALED),
    124: ("GPS2_RAW", f"{_FIX} dgps_age:u4 {_COURSE} dgps_numch:u1 yaw:u2 {_ACCURACY}"),
    129: ("SCALED_IMU3", _SCALED),
}


@dataclass(frozen=True, slots=True)
class MessageLayout:
    """The fields of one message."""

    name: str
    fields: tuple[Field, ...]
    size: int  #: bytes of the payload with all fields


def _layout(name: str, text: str) -> MessageLayout:
    fields: list[Field] = []
    for part in text.split():
        field, _, kind = part.partition(":")
        fields.append(Field(field, f"<{kind}", 0, fields[-1].end if fields else 0))
    return MessageLayout(name, tuple(fields), fields[-1].end)


LAYOUTS = {number: _layout(name, text) for number, (name, text) in _MESSAGES.items()}


def decoded(layout: MessageLayout, buffer: Bytes, payload: Integers, length: Integers) -> dict[str, NDArray[Any]]:
    """Return a message's fields, (n,) each; zeros at the end of a payload, which are not sent, are restored.

    Args:
        layout: layout of the message.
        buffer: bytes.
        payload: (n,) offsets of the payloads.
        length: (n,) their lengths.
    """
    whole = np.zeros((payload.size, layout.size), np.uint8)
    for size in np.unique(np.minimum(length, layout.size)):
        rows = np.flatnonzero(np.minimum(length, layout.size) == size)
        if size:
            whole[rows, :size] = gather(buffer, payload[rows], "|u1", int(size))
    return columns(layout.fields, whole.ravel(), np.arange(payload.size) * layout.size)

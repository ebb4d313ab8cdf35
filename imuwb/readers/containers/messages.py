"""Channels, schemas, and messages in a buffer: what MCAP, bag and db3 have in common."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers


@dataclass(frozen=True, slots=True)
class Schema:
    """The definition of a channel's messages."""

    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic of one publisher."""

    topic: str
    message_encoding: str
    schema_id: int


@dataclass(frozen=True, eq=False, slots=True)
class Messages:
    """The messages of all channels in one buffer."""

    buffer: Bytes
    channel: NDArray[np.integer[Any]]  #: (n,)
    log_time: Integers  #: (n,) ns, when the message was recorded
    publish_time: Integers  #: (n,) ns, when the message was sent
    start: Integers  #: (n,) offset of the payload in the buffer
    length: Integers  #: (n,) bytes of the payload
    bytes_read: int  #: position in the file

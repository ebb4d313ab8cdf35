"""Channels, schemas, and messages in a buffer: what MCAP, bag and db3 have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


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

    buffer: NDArray[np.uint8]
    channel: NDArray[np.integer[Any]]  #: (n,)
    log_time: NDArray[np.int64]  #: (n,) ns, when the message was recorded
    publish_time: NDArray[np.int64]  #: (n,) ns, when the message was sent
    start: NDArray[np.int64]  #: (n,) offset of the payload in the buffer
    length: NDArray[np.int64]  #: (n,) bytes of the payload
    bytes_read: int  #: position in the file

"""What the containers of robots' messages (MCAP, bag, db3) have in common: channels, and messages in a buffer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Schema:
    """How a channel's messages are laid out."""

    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic."""

    topic: str
    message_encoding: str
    schema_id: int


@dataclass(frozen=True, eq=False, slots=True)
class Messages:
    """Messages of all channels that lie in one buffer."""

    buffer: NDArray[np.uint8]
    channel: NDArray[np.integer[Any]]
    log_time: NDArray[np.int64]  #: ns
    publish_time: NDArray[np.int64]  #: ns
    start: NDArray[np.int64]  #: of the payload in the buffer
    length: NDArray[np.int64]  #: of the payload
    bytes_read: int  #: of the file, so far

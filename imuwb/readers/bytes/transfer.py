"""Requests the bytes of one remote object, in order, and tries again within a bound where a transfer is interrupted."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from time import sleep
from typing import Any

import obstore
from obstore.exceptions import NotSupportedError, PermissionDeniedError, UnauthenticatedError

from imuwb.errors import TransferError, UnreadableLogError, UsageError
from imuwb.readers.bytes.address import Address
from imuwb.readers.bytes.stores import REMEDIES, SILENCE, store_of

PIECE = 1  #: bytes that must have come before they are passed on: those that wait are lost when the connection is cut
ATTEMPTS = 5  #: requests in a row without progress, after which a transfer ends
PROGRESS = 1 << 20  #: bytes after which the attempts are counted anew
NO_SUCH_RANGE = 416  #: status; an empty object has no range
PAUSE = 0.2  #: s before the second attempt; twice as long before each further one

_STATUS = re.compile(r"status code: (\d{3})")
_CODE = re.compile(r"<Code>(\w{1,60})</Code>")  # how S3, Google and Azure name a fault
_PASSING = (408, 425, 429)  # the other statuses below 500 stay as they are
#: parts of obstore's texts -> the fault. The texts themselves have the whole URL, so they are never shown.
_FAULTS = {
    "dns error": "the name of its host cannot be resolved; check the address and the network",
    "InvalidCertificate": "the certificate of its host is not valid",
    "kind: Timeout": f"its host sent nothing for {SILENCE.seconds} s",
    "kind: Connect": "its host cannot be reached; check the address, the port and the network",
    "kind: Interrupted": "the connection was cut",
    "MissingContentLength": "its host does not state the length of the object; download it first",
    "MissingLastModified": "its host does not state when the object was written; download it first",
    "BareRedirect": "its host redirects without a target; a bucket of S3 may be in another region: state AWS_REGION",
}
_LASTING = ("dns error", "InvalidCertificate", "MissingContentLength", "MissingLastModified", "BareRedirect")


class NoRangesError(Exception):
    """The server does not send a part of an object."""


class AbsentError(Exception):
    """There is no such object, or no right to read it."""

    def __init__(self, text: str, *, denied: bool) -> None:
        """Set the text, and whether access is denied."""
        super().__init__(text)
        self.denied = denied


@dataclass(frozen=True, slots=True)
class Fault:
    """Why a request failed, in words, and whether another attempt may succeed."""

    text: str
    passing: bool = False


class Transfer:
    """The requests to one object. All of its bytes are of one version, which the first answer states.

    Args:
        address: where the object is.
        ranged: whether parts of it are asked for.

    Raises:
        UsageError: the environment does not state what the store needs.
    """

    def __init__(self, address: Address, *, ranged: bool = True) -> None:
        """Open the store; nothing is sent yet."""
        self.address = address
        self.ranged = ranged
        self.size: int | None = None  #: bytes; None before the first answer
        self._version: object = None
        self._store, self._key = store_of(address)

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[bytes]:
        """Yield the bytes from ``start`` to ``stop`` or the object's end, in order.

        Raises:
            NoRangesError: a part is asked for, and the server sends only the whole object.
            AbsentError: there is no such object, or the store denies access before the first byte.
            UnreadableLogError: the transfer ended; the message states where and why.
        """
        at, failures, since = start, 0, start
        while True:
            try:
                for piece in self._answer(at, stop):
                    at += len(piece)
                    yield piece
                if self.size is None or at >= min(self.size, self.size if stop is None else stop):
                    return
                fault = Fault("the connection was cut", passing=True)
            except (NoRangesError, AbsentError, UnreadableLogError, UsageError):
                raise
            except Exception as error:  # noqa: BLE001 - of many types
                fault = self._fault(error)
            failures, since = (1, at) if at - since >= PROGRESS else (failures + 1, since)
            if not fault.passing or failures >= ATTEMPTS:
                raise self._ended(at, failures, fault) from None
            sleep(PAUSE * 2 ** (failures - 1))

    def _answer(self, at: int, stop: int | None) -> Iterator[bytes]:
        """Yield the bytes that one request brings from a byte on."""
        ranged = self.ranged and (at > 0 or stop is not None)
        part: Any = {} if not ranged else {"range": {"offset": at} if stop is None else (at, stop)}
        answer = obstore.get(self._store, self._key, options=part)
        version = self._seen(answer.meta)
        if self._version is None:
            self._version, self.size = version, answer.meta["size"]
        elif version != self._version:
            raise UnreadableLogError(
                f"{self.address}: the object changed while it was read, at byte {at} of {self.size}; run the command again"
            )
        skip = at - answer.range[0]  # a server without ranges sends the beginning again
        for piece in answer.stream(min_chunk_size=PIECE):
            if skip < len(piece):
                yield bytes(piece)[skip:] if skip else bytes(piece)
            skip = max(0, skip - len(piece))

    @staticmethod
    def _seen(meta: Any) -> tuple[object, ...]:  # noqa: ANN401 - obstore's dictionary
        return meta["size"], meta["e_tag"] or meta["last_modified"]

    def _fault(self, error: Exception) -> Fault:
        """Return what an error of obstore means."""
        text = str(error)
        status, code = _STATUS.search(text), _CODE.search(text)
        number = int(status[1]) if status else 0
        named = f" ({code[1]})" if code else ""
        absent = ""
        if isinstance(error, FileNotFoundError):
            absent = f"there is no such object{named}; check the address"
        elif isinstance(error, PermissionDeniedError | UnauthenticatedError):
            absent = f"access is denied{named}; {REMEDIES[self.address.scheme]}"
        if self.size is None and absent:
            raise AbsentError(absent, denied=not isinstance(error, FileNotFoundError)) from None
        if absent:
            return Fault(absent)
        if self.size is None and self.ranged and (isinstance(error, NotSupportedError) or number == NO_SUCH_RANGE):
            raise NoRangesError from None
        if isinstance(error, ValueError):
            return Fault(
                "obstore asks for no name with an empty part, a part . or .., or control letters; copy the object to another name"
            )
        if number:
            return Fault(f"its host answers with status {number}{named}", passing=number >= 500 or number in _PASSING)  # noqa: PLR2004
        known = next((part for part in _FAULTS if part in text), "")
        return Fault(_FAULTS.get(known, f"the request failed ({type(error).__name__})"), passing=known not in _LASTING)

    def _ended(self, at: int, attempts: int, fault: Fault) -> UnreadableLogError:
        times = f" after {attempts} attempts" if attempts > 1 else ""
        kind = TransferError if fault.passing else UnreadableLogError
        if self.size is None:
            return kind(f"{self.address}: it cannot be read{times}: {fault.text}")
        return kind(
            f"{self.address}: the transfer ended at byte {at} of {self.size}{times}: {fault.text}; "
            "run the command again, or download the log first"
        )

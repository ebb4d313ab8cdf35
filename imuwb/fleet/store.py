"""Where results lie: a folder of this machine, or a folder in an object store. Each file is written whole or not at all."""

import os
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Protocol, TypeVar

from imuwb.errors import ImuwbError, UsageError
from imuwb.fleet.executor import TransportError
from imuwb.readers.bytes.address import STORES, Address, is_address
from imuwb.writers.whole import whole_file

ATTEMPTS = 4  #: to ask a store
PAUSE = 0.2  #: s before the second attempt; twice as long before each further one
STATUS = re.compile(r"status code: (\d{3})")
DENIED, NOT_FOUND = (401, 403), 404
Item = TypeVar("Item")


class Store(Protocol):
    """A folder of results. Names are relative, with ``/``."""

    def names(self, folder: str) -> Iterator[str]:
        """Yield the names of all files in a folder and below it."""
        ...

    def read(self, name: str) -> bytes | None:
        """Return the content of a file; None: there is none."""
        ...

    def write(self, name: str, content: bytes) -> None:
        """Write a file, in place of one that exists.

        Raises:
            TransportError: it cannot be written.
        """
        ...

    def create(self, name: str, content: bytes) -> None:
        """Write a file, unless it exists. Errors as in ``write``."""
        ...


def store_at(place: str) -> Store:
    """Return the store of a folder: a path, or an address such as s3://bucket/results/.

    Raises:
        UsageError: a file, or an address that no results can be written to.
    """
    if not is_address(place):
        if Path(place).is_file():
            raise UsageError(f"{place}: this is a file; give a folder for the results")
        return FolderStore(Path(place))
    scheme, bucket, folder = parted(place)
    return BucketStore(scheme, bucket, folder.rstrip("/"))


def parted(place: str) -> tuple[str, str, str]:
    """Return scheme, bucket and key of an address of an object store; the key may be empty, a folder, or a pattern.

    Raises:
        UsageError: an address of another kind.
    """
    scheme, _, rest = place.partition("://")
    bucket, _, key = rest.partition("/")
    if scheme.lower() not in STORES:
        raise UsageError(
            f"{scheme}://: a folder or a pattern is a path of this machine, or an address of s3://, gs:// or az://"
        )
    Address.from_text(f"{scheme}://{bucket}/x")  # refuses a bucket that is none
    return scheme.lower(), bucket, key


class FolderStore:
    """A folder of this machine."""

    def __init__(self, root: Path) -> None:
        """State the folder; it is made when something is written."""
        self.root = root

    def names(self, folder: str) -> Iterator[str]:
        """Yield the names of all files in a folder and below it; drafts are none."""
        for at, _, files in os.walk(self.root / folder):
            for file in files:
                if not file.startswith("."):
                    yield Path(at, file).relative_to(self.root).as_posix()

    def read(self, name: str) -> bytes | None:
        """Return the content of a file; None: there is none."""
        try:
            return (self.root / name).read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise TransportError(f"{self.root / name}: the file cannot be read: {error.strerror or error}") from error

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole."""
        path = self.root / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise TransportError(f"{path.parent}: the folder cannot be made: {error.strerror or error}") from error
        try:
            with whole_file(path) as draft:
                draft.write_bytes(content)
        except ImuwbError as error:
            raise TransportError(str(error)) from error

    def create(self, name: str, content: bytes) -> None:
        """Write a file whole, unless it exists."""
        if not (self.root / name).exists():
            self.write(name, content)


class BucketStore:
    """A folder in an object store. A put is whole or not at all; ``create`` is a conditional put."""

    def __init__(self, scheme: str, bucket: str, folder: str) -> None:
        """Open the store; nothing is sent yet."""
        from imuwb.readers.bytes.stores import store_of  # noqa: PLC0415 - obstore is imported for addresses only

        self._address = Address(f"{scheme}://{bucket}/{folder}")
        self._folder = f"{folder}/" if folder else ""
        self._store: Any = store_of(self._address)[0]

    def names(self, folder: str) -> Iterator[str]:
        """Yield the names of all objects below a folder."""
        for meta in listed(self._store, self._address, f"{self._folder}{folder}/" if folder else self._folder):
            yield meta["path"].removeprefix(self._folder)

    def read(self, name: str) -> bytes | None:
        """Return the content of an object; None: there is none."""
        import obstore  # noqa: PLC0415 - as above

        def get() -> bytes | None:
            try:
                return bytes(obstore.get(self._store, self._folder + name).bytes())
            except FileNotFoundError:
                return None

        return attempted(get, self._address)

    def write(self, name: str, content: bytes) -> None:
        """Put an object."""
        self._put(name, content, "overwrite")

    def create(self, name: str, content: bytes) -> None:
        """Put an object on the condition that there is none."""
        from obstore.exceptions import AlreadyExistsError  # noqa: PLC0415 - as above

        try:
            self._put(name, content, "create")
        except AlreadyExistsError:
            return

    def _put(self, name: str, content: bytes, mode: Any) -> None:  # noqa: ANN401 - obstore's own words
        import obstore  # noqa: PLC0415 - as above

        attempted(lambda: obstore.put(self._store, self._folder + name, content, mode=mode), self._address)


def listed(store: Any, address: Address, prefix: str) -> Iterator[Any]:  # noqa: ANN401 - obstore's own types
    """Yield the metadata of all objects below a prefix; errors as in ``attempted``."""
    import obstore  # noqa: PLC0415 - as above

    # A list that failed does not go on: all of it is asked for again.
    yield from attempted(
        lambda: [meta for page in obstore.list(store, prefix=prefix or None) for meta in page], address
    )


def attempted(request: Callable[[], Item], address: Address) -> Item:
    """Return what a request to a store returns; one that fails in passing is asked again.

    Raises:
        TransportError: it fails. The message has nothing of the store's own texts, which may have secrets.
    """
    from obstore.exceptions import (  # noqa: PLC0415 - as above
        AlreadyExistsError,
        PermissionDeniedError,
        PreconditionError,
        UnauthenticatedError,
    )

    from imuwb.readers.bytes.stores import REMEDIES  # noqa: PLC0415 - as above

    for attempt in range(ATTEMPTS):
        try:
            return request()
        except (AlreadyExistsError, PreconditionError) as error:
            raise AlreadyExistsError from error
        except Exception as error:  # noqa: BLE001 - of many types
            status = _status(error)
            if status in DENIED or isinstance(error, PermissionDeniedError | UnauthenticatedError):
                raise TransportError(f"{address}: access is denied; {REMEDIES[address.scheme]}") from None
            if status == NOT_FOUND or isinstance(error, FileNotFoundError):
                raise TransportError(f"{address}: there is no such bucket; check the address") from None
            if attempt == ATTEMPTS - 1:
                text = f"{address}: the store does not answer as it should ({type(error).__name__}), also after {ATTEMPTS} attempts"
                raise TransportError(
                    f"{text}; check the address, the region and the network, and run the command again"
                ) from None
            time.sleep(PAUSE * 2**attempt)
    raise AssertionError


def _status(error: Exception) -> int | None:
    """Return the status of HTTP that an error states in its text; None: none. A list that fails has no error of a type of its own."""
    found = STATUS.search(str(error).partition("Debug source")[0])
    return None if found is None else int(found[1])

"""Where a log lies: a path of this machine, or an address on the web or in an object store."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self, TypeAlias
from urllib.parse import quote, unquote, urlsplit

from imuwb.errors import UsageError

WEB = ("http", "https")
STORES = ("s3", "gs", "az")
LONGEST = 100  #: letters of the name of a file
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://")  # one letter is a drive of Windows
_HOST = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[^:@/\s]+)(:\d+)?")
#: the start of an address before its user, or the query of an address after its path
_SECRETS = re.compile(r"(\b[A-Za-z][A-Za-z0-9+.-]+:/{1,2})[^/@\s'\"]*@|(?<=[/\w])\?[^\s'\"=]+=[^\s'\"]*")
_QUERY = re.compile(r"[?#]")


@dataclass(frozen=True, slots=True, repr=False)
class Address:
    """The address of a remote log.

    Its text has neither a user, nor a password, nor the query of a signed URL: it may stand in messages and in documents.
    """

    url: str = field(repr=False)  #: as the user gives it; it may have secrets

    #: what the texts of this type are, in words that follow "must be"
    FORMS = "an address (http://, https://, s3://, gs:// or az://)"

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Return the address that a text states.

        Raises:
            ValueError: the text is the path of a file.
            UsageError: an address that is not read.
        """
        scheme = _scheme(text)
        if scheme not in (*WEB, *STORES):
            raise ValueError
        address = cls(text)
        if not _HOST.fullmatch(address.host):
            raise UsageError(
                f"an address of {scheme}:// has no valid host or bucket; a user or a password in it must have "
                "its / as %2F, ? as %3F and # as %23"
            )
        if scheme in STORES and "@" in address.authority:
            raise UsageError(
                f"{address}: credentials in an address of {scheme}:// are not used; state them in the environment"
            )
        if scheme in STORES and (not address.key or address.key.endswith("/")):
            raise UsageError(
                f"{address}: this is a bucket or a folder in it; name one object, such as {scheme}://bucket/log.mcap"
            )
        return address

    @property
    def scheme(self) -> str:
        """``http``, ``https``, ``s3``, ``gs`` or ``az``."""
        return _scheme(self.url)

    @property
    def authority(self) -> str:
        """The host or the bucket, with the user and the password of a URL: a secret."""
        return self._location().partition("/")[0]

    @property
    def host(self) -> str:
        """The host with its port, or the bucket or container."""
        return self.authority.rpartition("@")[2]

    @property
    def key(self) -> str:
        """The name of the object in its bucket, or the path of a URL, as it is given."""
        return self._location().partition("/")[2]

    @property
    def name(self) -> str:
        """The last part of the path."""
        last = self.key.rpartition("/")[2]
        return (unquote(last) if self.scheme in WEB else last) or self.host

    @property
    def file_name(self) -> str:
        """The name that a file of this machine gets."""
        safe = "".join(c if c.isalnum() or c in "._-+ " else "_" for c in self.name).strip(". ")
        return safe[-LONGEST:] or "log"

    @property
    def signed(self) -> bool:
        """Whether the address has a query, which is valid for this object only."""
        return self.scheme in WEB and "?" in self.url

    def beside(self, name: str) -> "Address":
        """Return the address of an object in the same folder."""
        folder, mark, _ = self.key.rpartition("/")
        last = quote(name) if self.scheme in WEB else name
        return Address(f"{self.scheme}://{self.authority}/{folder}{mark}{last}")

    def _location(self) -> str:
        """Return what follows the scheme, without the query and the fragment of a URL; a key may have any character."""
        location = self.url.split("://", 1)[1]
        return _QUERY.split(location, maxsplit=1)[0] if self.scheme in WEB else location

    def __str__(self) -> str:
        """Return the address without secrets."""
        return f"{self.scheme}://{self.host}/{self.key}"

    def __repr__(self) -> str:
        """Return the address without secrets."""
        return f"Address({str(self)!r})"


Place: TypeAlias = Path | Address


def without_secrets(text: str) -> str:
    """Return a message in which no address, also one with a single slash as a path has it, has a user, a password or a query."""
    return _SECRETS.sub(lambda found: found[1] or "", text)


def is_address(text: str) -> bool:
    """Return whether a text is an address and no path."""
    return bool(_scheme(text))


def place_of(text: "str | Place") -> Place:
    """Return where a log lies, from its path or address; ``file://`` is a path.

    Raises:
        UsageError: an address that is not read.
    """
    if not isinstance(text, str):
        return text
    scheme = _scheme(text)
    if not scheme:
        return Path(text)
    if scheme == "file":
        from urllib.request import url2pathname  # noqa: PLC0415 - few logs are named so

        parts = urlsplit(text)
        if parts.netloc not in ("", "localhost"):
            raise UsageError(f"{text}: a file of another machine; a file:// address has no host")
        return Path(url2pathname(parts.path))
    try:
        return Address.from_text(text)
    except ValueError:
        raise UsageError(
            f"{scheme}:// is not read; logs are files, or addresses of http://, https://, s3://, gs://, az:// or file://"
        ) from None


def _scheme(text: str) -> str:
    """Return the scheme of an address in small letters; empty for a path."""
    match = _SCHEME.match(text)
    return match[1].lower() if match else ""

"""Servers of the tests on this machine: a web server that counts what it sends and can fail on purpose, and an S3 server (moto)."""

from __future__ import annotations

import hashlib
import re
import threading
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from time import sleep
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

_RANGE = re.compile(r"bytes=(\d+)-(\d*)")


@dataclass(frozen=True)
class Request:
    """What a client asked for."""

    path: str  #: with the query
    start: int | None  #: first byte of a range; None without one
    authorization: str | None


@dataclass
class WebServer:
    """A web server of a few objects. The faults are set by a test; ``reset`` ends them."""

    port: int = 0
    objects: dict[str, object] = field(default_factory=dict)  #: path -> bytes, or an object with len and slices
    requests: list[Request] = field(default_factory=list)
    sent: int = 0  #: bytes of all bodies
    ranges: bool = True
    tags: bool = True
    statuses: list[int] = field(default_factory=list)  #: answers of the next requests
    redirects: dict[str, str] = field(default_factory=dict)
    cut: int | None = None  #: bytes after which the connection ends
    cuts: int = 10**9  #: how often
    claimed: int = 0  #: bytes that are stated besides those that are sent
    slow: bool = False  #: whether a body comes in many pieces
    silent: bool = False  #: whether nothing is answered
    page: bytes = b""  #: the answer where there is no object
    then: Callable[[], None] | None = None  #: called when an answer is chosen, before it is sent

    def reset(self) -> None:
        """Forget objects, requests and faults."""
        port = self.port
        self.__init__()
        self.port = port

    def url(self, path: str, user: str = "", query: str = "") -> str:
        """Return the address of an object."""
        return f"http://{user}127.0.0.1:{self.port}/{path}{query}"


class _Handler(BaseHTTPRequestHandler):
    web: WebServer
    ended: threading.Event
    protocol_version = "HTTP/1.1"

    def log_message(self, *_: object) -> None:
        pass

    def do_GET(self) -> None:
        wanted = _RANGE.fullmatch(self.headers.get("Range", ""))
        start = int(wanted[1]) if wanted else None
        self.web.requests.append(Request(self.path, start, self.headers.get("Authorization")))
        path = self.path.partition("?")[0].removeprefix("/")
        if self.web.silent:
            self.ended.wait(60)
            self.close_connection = True
        elif self.web.statuses:
            self._short(self.web.statuses.pop(0))
        elif path in self.web.redirects:
            self._short(302, {"Location": self.web.redirects[path]})
        elif path not in self.web.objects and not self.web.page:
            self._short(404)
        else:
            self._object(self.web.objects.get(path, self.web.page), wanted if self.web.ranges else None)

    def _chosen(self) -> None:
        if self.web.then is not None:
            self.web.then()

    def _short(self, status: int, headers: dict[str, str] | None = None) -> None:
        self._chosen()
        self.send_response(status)
        for name, value in {"Content-Length": "0", **(headers or {})}.items():
            self.send_header(name, value)
        self.end_headers()

    def _object(self, content: object, wanted: re.Match[str] | None) -> None:
        size = len(content)
        start, stop = (int(wanted[1]), min(int(wanted[2] or size) + 1, size)) if wanted else (0, size)
        if wanted and start >= size:
            self._short(416)
            return
        body = content[start:stop]
        tag = tag_of(content)
        self._chosen()
        self.send_response(206 if wanted else 200)
        if wanted:
            self.send_header("Content-Range", f"bytes {start}-{stop - 1}/{size}")
        self.send_header("Last-Modified", "Mon, 01 Jan 2024 00:00:00 GMT")
        if self.web.tags:
            self.send_header("ETag", f'"{tag}"')
        self.send_header("Content-Length", str(len(body) + self.web.claimed))
        self.end_headers()
        if self.web.cut is not None and len(body) > self.web.cut and self.web.cuts > 0:
            self.web.cuts -= 1
            body = body[: self.web.cut]
            self.close_connection = True
        if self.web.claimed:
            self.close_connection = True
        step = 1 + (len(body) // 20 if self.web.slow else len(body))
        for at in range(0, len(body), step):
            self.wfile.write(body[at : at + step])
            sleep(0.002 if self.web.slow else 0)
        self.web.sent += len(body)


def tag_of(content: object) -> str:
    """Return a tag of a version of an object."""
    return getattr(content, "tag", None) or hashlib.md5(content).hexdigest()  # noqa: S324 - no secret


class _Quiet(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, *_: object) -> None:
        """A client that has enough ends the connection."""


@pytest.fixture(scope="module")
def running_server():
    """Run one web server for the tests of a module."""
    server, ended = WebServer(), threading.Event()
    handler = type("Handler", (_Handler,), {"web": server, "ended": ended})
    with _Quiet(("127.0.0.1", 0), handler) as http:
        server.port = http.server_address[1]
        thread = threading.Thread(target=http.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        thread.start()
        yield server
        ended.set()
        http.shutdown()
        thread.join()


@pytest.fixture
def web(running_server, monkeypatch):
    """Return the web server without objects and faults; pauses between attempts are short."""
    from imuwb.readers.bytes import transfer

    monkeypatch.setattr(transfer, "PAUSE", 1e-3)
    running_server.reset()
    return running_server


@dataclass(frozen=True)
class Bucket:
    """A bucket of a local S3 server."""

    name: str
    url: str  #: of the server
    put: Callable[[str, bytes], None]


@pytest.fixture(scope="module")
def moto_server():
    """Run an S3 server for the tests of a module."""
    moto = pytest.importorskip("moto.server", reason="moto[server] is not installed")
    server = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    yield "http://{}:{}".format(*server.get_host_and_port())
    server.stop()


@pytest.fixture
def bucket(moto_server, monkeypatch):
    """Return a bucket, with an environment that leads to it and has secrets."""
    import obstore
    from obstore.store import S3Store

    for name in ("AWS_PROFILE", "AWS_ENDPOINT", "AWS_ENDPOINT_URL_S3", "AWS_SESSION_TOKEN", "AWS_DEFAULT_REGION"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "SECRET-KEY-ID")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "SECRET-ACCESS-KEY")
    monkeypatch.setenv("AWS_REGION", "us-east-1")
    monkeypatch.setenv("AWS_ENDPOINT_URL", moto_server)
    store = S3Store("logs", client_options={"allow_http": True})
    import urllib.request

    urllib.request.urlopen(urllib.request.Request(f"{moto_server}/logs", method="PUT")).close()  # noqa: S310 - our own server
    return Bucket("logs", moto_server, lambda key, content: obstore.put(store, key, content))

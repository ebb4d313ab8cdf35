"""An address at which no scheduler of Dask listens: one sentence, at once."""

import socket
import threading
import time
from contextlib import contextmanager

import pytest

from imuwb.errors import ImuwbError, UsageError

cluster = pytest.importorskip("imuwb.fleet.dask_cluster")
pytest.importorskip("distributed", reason="distributed is not installed")


@contextmanager
def listening(answer):
    """Listen on a port of this machine, send an answer to who connects, and yield the address."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            while True:
                try:
                    connection, _ = server.accept()
                except OSError:
                    return
                with connection:
                    connection.sendall(answer)
                    time.sleep(0.2)

        threading.Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"


@pytest.mark.parametrize("answer", [b"HTTP/1.1 400 Bad Request\r\n\r\n", b"", b"\xff" * 64])
def test_another_service_is_no_scheduler(monkeypatch, answer):
    monkeypatch.setattr(cluster, "CONNECTING", 1.0)
    began = time.monotonic()
    with listening(answer) as address, pytest.raises(ImuwbError, match="scheduler"):
        cluster.DaskCluster(address, "0")
    assert time.monotonic() - began < 10


@pytest.mark.parametrize(
    "address",
    ["foo", "tcp://", "127.0.0.1", "tcp://host:port", "a b:1", "ftp://127.0.0.1:8786", "tcp://127.0.0.1:99999"],
)
def test_a_text_that_is_no_address_is_refused_before_anything_is_asked(address):
    with pytest.raises(UsageError, match="is no address"):
        cluster.DaskCluster(address, "0")

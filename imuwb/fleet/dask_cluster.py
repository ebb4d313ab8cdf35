"""A Dask cluster as an executor: one that runs already, by the address of its scheduler, or one of this machine.

Each worker of the cluster runs a call in a process of its own (``OwnChild``): a log that hangs or takes too much memory ends that
process, and the worker of the cluster goes on. Source: the API of Dask.distributed, https://distributed.dask.org/en/stable/api.html
"""

import asyncio
import queue
import re
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from typing import Any, cast

from imuwb.errors import ImuwbError, UsageError
from imuwb.fleet.executor import Call, Completed, Fault
from imuwb.fleet.own_child import OwnChild, warm

ADDRESS = re.compile(r"(?:(?P<scheme>[a-z]+)://)?[^/\s]+:(?P<port>\d{1,5})/?")  #: of a scheduler
SCHEMES, LAST_PORT = (None, "tcp", "tls", "ws", "wss", "ucx"), 65535
CONNECTING = 10.0  #: s until a scheduler must have answered
PATIENCE = 60.0  #: s that a cluster may be without any worker
PERIOD = 2.0  #: s between two looks at the workers
INSTALL = 'pip install "imuwb[fleet]"'


class DaskCluster:
    """An executor on a Dask cluster.

    Raises:
        UsageError: Dask is not installed, the address is none, or the workers have another version of imuwb.
        ImuwbError: no scheduler answers.
    """

    def __init__(self, address: str, version: str, own: Any = None) -> None:  # noqa: ANN401 - Dask's own LocalCluster
        """Connect.

        Args:
            address: of the scheduler, such as tcp://127.0.0.1:8786.
            version: of imuwb, which the workers must have too.
            own: a cluster of this machine that is closed with the executor; None: the cluster is another's.
        """
        distributed = _distributed()
        self.name, self._own = address, own
        if own is None:
            _ask(address)
        try:
            self._client: Any = distributed.Client(own or address, timeout=CONNECTING, set_as_default=False)
        except OSError as error:
            raise ImuwbError(
                f"--scheduler {address}: the scheduler has gone ({error}); start it, and run the command again"
            ) from None
        self._done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        self._futures: dict[int, Any] = {}
        self._alone: float | None = None
        try:
            self._check(version)
        except BaseException:
            self.close()
            raise

    @property
    def slots(self) -> int:
        """The threads of all workers; at least one, because workers may still come."""
        return max(sum(worker["nthreads"] for worker in self._workers().values()), 1)

    @property
    def link(self) -> str:
        """Dask's dashboard."""
        return self._client.dashboard_link or ""

    def warm(self) -> None:
        """Compile what the workers need, by one worker of each machine."""
        first = {own["host"]: worker for worker, own in sorted(self._workers().items(), reverse=True)}
        self._client.run(warm, workers=list(first.values()), on_error="ignore")

    def submit(self, number: int, call: Call) -> None:
        """Take a call."""
        future: Any = self._client.submit(guarded, number, call, pure=False, retries=0)
        self._futures[number] = future
        future.add_done_callback(partial(self._put, number))

    def _put(self, number: int, future: Any) -> None:  # noqa: ANN401 - Dask's own
        self._done.put((number, future))

    def as_completed(self) -> Iterator[Completed]:
        """Yield the calls that are ready."""
        while self._futures:
            try:
                number, future = self._done.get(timeout=PERIOD)
            except queue.Empty:
                self._check_alive()
                continue
            if self._futures.pop(number, None) is not None:
                yield self._outcome(number, future)

    def close(self) -> None:
        """Drop the calls, and leave the cluster; one of this machine ends."""
        self._futures.clear()
        try:
            self._client.close(timeout=CONNECTING)
        finally:
            if self._own is not None:
                self._own.close(timeout=CONNECTING)

    def _workers(self) -> dict[str, Any]:
        return self._client.scheduler_info(n_workers=-1)["workers"]

    def _check(self, version: str) -> None:
        """Raise UsageError if a worker has another version of imuwb, or none."""
        for worker, own in self._client.run(worker_version, on_error="return").items():
            if own != version:
                has = "no imuwb" if isinstance(own, Exception) else f"imuwb {own}"
                raise UsageError(
                    f"--scheduler {self.name}: the worker {worker} has {has}, and this is imuwb {version}; install this version there"
                )

    def _check_alive(self) -> None:
        """Raise ImuwbError if the scheduler has gone, or had no worker for long."""
        if self._client.status != "running":
            if self._alone is None:
                self._alone = time.monotonic()
            if time.monotonic() - self._alone > CONNECTING:
                raise ImuwbError(
                    f"{self.name}: the connection to the scheduler is lost; start it, and run the command again: what is done is kept"
                )
            return
        if self._workers():
            self._alone = None
        elif self._alone is None:
            self._alone = time.monotonic()
        elif time.monotonic() - self._alone > PATIENCE:
            raise ImuwbError(
                f"{self.name}: the scheduler has had no worker for {PATIENCE:g} s; start workers (dask worker {self.name}), and run the command again"
            )

    def _outcome(self, number: int, future: Any) -> Completed:  # noqa: ANN401 - Dask's own
        if future.status == "finished":
            try:
                done: Completed = future.result(timeout=CONNECTING)
            except Exception as error:  # noqa: BLE001 - the worker that has the result may have gone
                return Completed(
                    number, fault=Fault("lost", f"its worker went away with the result ({type(error).__name__})")
                )
            finally:
                future.release()
            return done
        error = future.exception(timeout=CONNECTING) if future.status == "error" else None
        return Completed(
            number, fault=Fault("lost", f"its worker was lost ({type(error).__name__ if error else future.status})")
        )


def _ask(address: str) -> None:
    """Raise an error unless a scheduler of Dask answers; a client that waits for one would go on trying after its error."""
    matched = ADDRESS.fullmatch(address)
    if matched is None or int(matched["port"]) > LAST_PORT or matched["scheme"] not in SCHEMES:
        raise UsageError(f"--scheduler {address}: this is no address; write it as in tcp://127.0.0.1:8786")
    core: Any = import_module("distributed.core")
    security: Any = import_module("distributed.security")

    async def identity() -> Any:  # noqa: ANN401 - Dask's own
        options = security.Security().get_connection_args("client")
        async with core.rpc(address, timeout=CONNECTING, connection_args=options) as scheduler:
            return await asyncio.wait_for(scheduler.identity(), CONNECTING)

    found: Any = None
    try:
        with suppress(TimeoutError, MemoryError):  # the answer does not end, or states a size that is none
            found = asyncio.run(identity())
    except OSError:
        raise ImuwbError(
            f"--scheduler {address}: no scheduler answers within {CONNECTING:g} s; start one (dask scheduler) and its workers (dask "
            "worker ADDRESS), or leave the option out: then this machine works alone"
        ) from None
    except Exception:  # noqa: BLE001 - what reads the answer may raise anything
        found = None
    if not isinstance(found, dict) or cast("Any", found).get("type") != "Scheduler":
        raise ImuwbError(f"--scheduler {address}: what listens there is no scheduler of Dask; check the port")


def local_cluster(slots: int) -> Any:  # noqa: ANN401 - Dask's own
    """Return a Dask cluster of this machine with a process for each slot."""
    distributed = _distributed()
    return distributed.LocalCluster(
        n_workers=slots, threads_per_worker=1, processes=True, memory_limit=0, dashboard_address=":0"
    )


def worker_version() -> str:
    """Return the version of imuwb of a worker."""
    from imuwb import __version__  # noqa: PLC0415 - it reads the installed metadata

    return __version__


_free: list[OwnChild] = []  #: processes of this worker that have no call
_lock = threading.Lock()


def guarded(number: int, call: Call) -> Completed:
    """Return what becomes of a call in a process of this worker; it runs on the worker."""
    with _lock:
        child = _free.pop() if _free else OwnChild()
    try:
        return child.call(number, call)
    finally:
        with _lock:
            _free.append(child)


def _distributed() -> Any:  # noqa: ANN401 - the module
    try:
        return import_module("distributed")  # an extra, without types
    except ImportError:
        raise UsageError(f"a Dask cluster needs the extra fleet: {INSTALL}") from None

"""A pool of processes on this machine. A process that is killed, hangs or takes too much memory loses its own call only.

Each process belongs to a thread, which sends it one call at a time; nothing is shared that a killed process could hold. The
pool of the standard library loses all calls that wait when a process dies.
"""

import os
import queue
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress

from imuwb.errors import ImuwbError
from imuwb.fleet.executor import Call, Completed
from imuwb.fleet.own_child import OwnChild, warm

ENDING = 10.0  #: s until a killed process must have ended
AGAIN = 0.5  #: s until a process that cannot be started is tried again
_Item = tuple[int, Call] | None


class LocalPool:
    """An executor with processes of this machine."""

    link = ""

    def __init__(self, slots: int = 0, most: int | None = None) -> None:
        """Start no process yet.

        Args:
            slots: processes; 0: one for each core that this process may use.
            most: calls that there will be, beyond which a process has nothing to do; None: it is not known.
        """
        self.slots = min(slots or cores(), most or sys.maxsize)
        self.name = f"{self.slots} process{'es' if self.slots > 1 else ''}"
        self._calls: queue.SimpleQueue[_Item] = queue.SimpleQueue()
        self._done: queue.SimpleQueue[Completed] = queue.SimpleQueue()
        self._children: list[OwnChild] = []
        self._threads: list[threading.Thread] = []
        self._starting = threading.Lock()
        self._left = 0

    def warm(self) -> None:
        """Compile what the processes need."""
        warm()

    def submit(self, number: int, call: Call) -> None:
        """Take a call, and start another process if all have one.

        Raises:
            ImuwbError: this machine starts not even one.
        """
        self._left += 1
        if len(self._children) < min(self.slots, self._left):
            self._serve_more()
        self._calls.put((number, call))

    def _serve_more(self) -> None:
        child = OwnChild()
        thread = threading.Thread(target=self._serve, args=(child,), daemon=True)
        try:
            thread.start()
        except RuntimeError:  # the system has no thread left: the others do the calls
            if not self._threads:
                raise ImuwbError(
                    "no process can be started on this machine; end other programs, or give --workers 0"
                ) from None
            return
        self._children.append(child)
        self._threads.append(thread)

    def as_completed(self) -> Iterator[Completed]:
        """Yield the calls that are ready."""
        while self._left:
            done = self._done.get()
            self._left -= 1
            yield done

    def close(self) -> None:
        """Drop the calls that wait, and kill the processes."""
        with suppress(queue.Empty):
            while True:
                self._calls.get_nowait()
        for child in self._children:
            self._calls.put(None)
            child.kill()
        for thread in self._threads:
            thread.join(ENDING)

    def _serve(self, child: OwnChild) -> None:
        while (item := self._calls.get()) is not None:
            with self._starting:  # one after another, so that each knows of the others
                works = child.start() or not any(other.runs() for other in self._children)
            if works:
                self._done.put(child.call(*item))
            else:  # this machine has no room for one more process: the others do its calls meanwhile
                self._calls.put(item)
                time.sleep(AGAIN)
        child.close()


def cores() -> int:
    """Return the cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

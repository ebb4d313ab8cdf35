"""What a run shows while it works: how many logs are ready, the rate, the time left and the faults; and ``progress.jsonl``."""

import json
import time
from collections import Counter
from dataclasses import dataclass, field

from imuwb.fleet.own_files import PROGRESS
from imuwb.fleet.store import FolderStore, Store

SECONDS_A_MINUTE, SECONDS_AN_HOUR = 60, 3600


@dataclass(slots=True)
class Progress:
    """The state of a run."""

    total: int  #: logs to do
    known: int = 0  #: logs that were done before
    done: int = 0
    faults: Counter[str] = field(default_factory=Counter[str])  #: by kind
    _began: float = field(default_factory=time.monotonic)

    def add(self, path: str, kind: str, message: str, worker: str) -> str:
        """Count a log, and return its line of progress.jsonl; kind and message are empty for one that gives a result."""
        self.done += 1
        if kind:
            self.faults[kind] += 1
        return json.dumps({
            "seconds": round(time.monotonic() - self._began, 3), "done": self.done, "of": self.total, "path": path,
            "state": kind or "done", "message": message, "worker": worker,
        }, ensure_ascii=True)  # fmt: skip

    @property
    def rate(self) -> float:
        """Return the logs in a second, since the beginning."""
        return self.done / max(time.monotonic() - self._began, 1e-9)

    def text(self) -> str:
        """Return the state in words: "312 of 600 logs, 4.1/s, 1 min left, 12 faults (unreadable 10, time 2)"."""
        parts = [f"{self.done} of {self.total} logs"]
        if self.done:
            parts += [f"{self.rate:.3g}/s", f"{time_text((self.total - self.done) / self.rate)} left"]
        return ", ".join([*parts, faults_text(self.faults)])


def faults_text(faults: Counter[str]) -> str:
    """Return how many faults there are of which kind."""
    count = faults.total()
    kinds = ", ".join(
        f"{kind} {number}" for kind, number in sorted(faults.items(), key=lambda item: (-item[1], item[0]))
    )
    return f"{count or 'no'} fault{'' if count == 1 else 's'}" + (f" ({kinds})" if kinds else "")


def quarantined_text(count: int) -> str:
    """Return how many logs are in quarantine."""
    return f"{count} {'is' if count == 1 else 'are'} in quarantine"


def time_text(seconds: float) -> str:
    """Return a time in the unit that suits it."""
    if seconds < 2 * SECONDS_A_MINUTE:
        return f"{seconds:.0f} s"
    return (
        f"{seconds / SECONDS_A_MINUTE:.0f} min"
        if seconds < 2 * SECONDS_AN_HOUR
        else f"{seconds / SECONDS_AN_HOUR:.1f} h"
    )


class ProgressFile:
    """Writes progress.jsonl: line by line into a folder, at the end into a store that appends nothing."""

    def __init__(self, store: Store) -> None:
        """Begin the file."""
        self._store, self._lines = store, list[str]()
        self._file = None
        if isinstance(store, FolderStore):
            store.root.mkdir(parents=True, exist_ok=True)
            self._file = (store.root / PROGRESS).open("w", encoding="ascii", buffering=1)

    def add(self, line: str) -> None:
        """Write a line."""
        if self._file is not None:
            self._file.write(line + "\n")
        else:
            self._lines.append(line)

    def close(self) -> None:
        """Finish the file."""
        if self._file is not None:
            self._file.close()
        else:
            self._store.write(PROGRESS, "".join(f"{line}\n" for line in self._lines).encode())

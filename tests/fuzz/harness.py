"""Reads damaged logs in processes of their own, with a limit of time and memory for each, and tells what went wrong.

A worker is forked after everything is imported, so that a log costs no more than its reading. It reports each log through a pipe; if it
dies, the log that it read is at fault, and another worker goes on after it.
"""

import multiprocessing
import os
import random
import resource
import signal
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from imuwb.errors import ImuwbError
from imuwb.log import Log
from imuwb.readers import ReadOptions, read

from .mutators import damaged, spoilt

LONGEST = 5.0  #: s of CPU
MOST = 1 << 30  #: bytes above what the worker holds at its start
MEMORY = ("/dev/shm",)  # noqa: S108 - a folder that is no disk, for small files
BATCH = 500  #: logs of a worker
RARE = {"log.h5": 10}  #: logs whose reading starts a process, and how many seeds each takes
SPOILT = 0.1  #: share of the logs with a wrong checksum, where the format has one
#: options that are set for some of the logs
OPTIONS: tuple[dict[str, Any], ...] = (
    {}, {}, {}, {}, {"rate": 50.0}, {"even": True}, {"frame": "FLU"}, {"time_source": "log"}, {"memory": 0.05}, {"epoch": "boot"},
    {"units": {"gyro": "deg/s", "accel": "g"}}, {"columns": ("time", "gx", "gy", "gz", "ax", "ay", "az")},
)  # fmt: skip


@dataclass
class Tally:
    """What came of the damaged logs."""

    read: Counter[str] = field(default_factory=Counter[str])  #: logs by name
    sound: int = 0  #: logs that were read, and not refused
    faults: list[tuple[str, int, str]] = field(default_factory=list[tuple[str, int, str]])  #: (name, seed, what)
    spoilt: int = 0  #: logs with a wrong checksum
    prefixes: int = 0  #: logs whose beginning was whole, and was compared
    slowest: float = 0.0  #: s
    largest: int = 0  #: bytes above what the worker held at its start


def rows_of(log: Log) -> set[bytes]:
    """Return the samples of a log as bytes that can be compared."""
    triads = [t.value for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
    return {
        row.tobytes() for value in (*triads, *(g.position for g in log.gnss)) for row in np.ascontiguousarray(value)
    }


def damage(name: str, data: bytes, seed: int) -> tuple[bytes, str, dict[str, Any]]:
    """Return a damaged log, what is known of its rows (``subset``, ``prefix`` or nothing), and the options of its reading."""
    rng = random.Random(f"{name}/{seed}")  # noqa: S311 - the same damage each time
    if rng.random() < SPOILT and (content := spoilt(name, data, rng)) is not None:
        return content, "subset", {}
    if rng.random() < 0.05:
        return data[: rng.randrange(len(data))], "prefix", {}
    return damaged(name, data, rng), "", rng.choice(OPTIONS)


def tallied(logs: dict[str, bytes], seeds: range, *, workers: int = 1, seconds: float = 1e9) -> Tally:
    """Read each log with the damage of each seed; return what came of it.

    Args:
        logs: {name: content}; a name that ends in .toml is the sidecar of the text beside it.
        seeds: of the damage.
        workers: processes at a time.
        seconds: after which no further worker begins.
    """
    tally, began = Tally(), time.monotonic()
    cases = [(name, seed) for seed in seeds for name in logs if name not in RARE or seed % RARE[name] == 0]
    batches = [cases[i : i + BATCH] for i in range(0, len(cases), BATCH)]
    while batches and time.monotonic() - began < seconds:
        group, batches = batches[:workers], batches[workers:]
        for rest in [rest for rest in _run(logs, group, tally) if rest]:
            batches.insert(0, rest)
    return tally


def alone(work: Callable[[], object], seconds: float = LONGEST, most: int = MOST) -> tuple[str, float, int]:
    """Do some work in a process of its own; return what it raised or its death, the CPU time (s), and the bytes that it took."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)

    def run() -> None:
        held = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (held + 2 * most,) * 2)
        at_start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        signal.setitimer(signal.ITIMER_PROF, seconds)
        began, what = time.process_time(), ""
        try:
            work()
        except BaseException as error:  # noqa: BLE001 - any is told
            what = f"{type(error).__name__}: {error}"
        theirs.send(
            (what, time.process_time() - began, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - at_start) << 10)
        )

    worker = context.Process(target=run)
    worker.start()
    theirs.close()
    try:
        told = ours.recv()
    except EOFError:
        told = None
    worker.join()
    return told or (f"died: {worker.exitcode}", seconds, most)


def _run(logs: dict[str, bytes], group: list[list[tuple[str, int]]], tally: Tally) -> Iterator[list[tuple[str, int]]]:
    """Run a worker for each list of cases; yield what a worker that died left."""
    context = multiprocessing.get_context("fork")
    running = []
    for cases in group:
        ours, theirs = context.Pipe(duplex=False)
        worker = context.Process(target=_work, args=(logs, cases, theirs))
        worker.start()
        theirs.close()
        running.append((worker, ours, cases))
    for worker, ours, cases in running:
        done = 0
        try:
            while True:
                told = ours.recv()
                _add(tally, cases[done], told)
                done += 1
        except EOFError:
            worker.join()
        if done < len(cases):
            what = (
                "not ended" if worker.exitcode in (-signal.SIGVTALRM, -signal.SIGPROF) else f"died: {worker.exitcode}"
            )
            tally.faults.append((*cases[done], what))
            tally.read[cases[done][0]] += 1
            yield cases[done + 1 :]


def _add(tally: Tally, case: tuple[str, int], told: tuple[bool, str, str, float, int]) -> None:
    sound, kind, fault, seconds, size = told
    tally.read[case[0]] += 1
    tally.sound += sound
    tally.spoilt += kind == "subset"
    tally.prefixes += kind == "prefix"
    tally.slowest, tally.largest = max(tally.slowest, seconds), max(tally.largest, size)
    if fault:
        tally.faults.append((*case, fault))


def _work(logs: dict[str, bytes], cases: list[tuple[str, int]], told: Connection) -> None:
    """Read the damaged logs of some cases, and tell of each."""
    os.nice(2)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + 2 * MOST,) * 2)
    at_start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with tempfile.TemporaryDirectory(dir=next((p for p in MEMORY if Path(p).is_dir()), None)) as folder:
        sound = {name: _rows(Path(folder), name, data, logs, {}) for name, data in logs.items()}
        for name, seed in cases:
            content, kind, options = damage(name, logs[name], seed)
            signal.setitimer(signal.ITIMER_PROF, LONGEST)
            began = time.process_time()
            rows = _rows(Path(folder), name, content, logs, options)
            seconds = time.process_time() - began
            signal.setitimer(signal.ITIMER_PROF, 0)
            fault = rows if isinstance(rows, str) and rows else ""
            if kind and isinstance(rows, set) and (wrong := rows - sound[name]):
                # The last row of a cut text may be any beginning of its numbers where nothing shows the cut.
                fault = (
                    ""
                    if kind == "prefix" and len(wrong) <= 2
                    else f"{len(wrong)} rows that the sound log lacks ({kind})"
                )
            size = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - at_start) << 10
            if size > MOST:
                fault = fault or "above 1 GB"
            told.send((isinstance(rows, set), kind, fault, seconds, size))
    told.close()


def _rows(folder: Path, name: str, content: bytes, logs: dict[str, bytes], options: dict[str, Any]) -> set[bytes] | str:
    """Return the rows of a log; an empty text if it is refused, and a fault's own text otherwise."""
    path = folder / name
    path.write_bytes(content)
    if name.endswith(".toml"):
        path = path.with_suffix(".csv")
        path.write_bytes(logs[path.name])
    elif (beside := name.rpartition(".")[0] + ".toml") in logs:
        (folder / beside).write_bytes(logs[beside])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return rows_of(read(path, ReadOptions(**options)))
    except ImuwbError:
        return ""
    except MemoryError:
        return "above the limit of memory"
    except BaseException:  # noqa: BLE001 - any traceback is a fault
        return traceback.format_exc(limit=-3)
    finally:
        for file in folder.iterdir():
            if file.is_file():
                file.unlink()

"""Run an analysis over a simulated fleet while workers and clients are killed, and compare its tables with those of a plain loop.

The fleet has 5 logs of each sensor, a month apart; 3 % of the logs are damaged, one hangs, one takes memory without end. The analysis is
``fleet_analysis.py``, the spectra of imuwb. The plain loop is ``--workers 0``. The others run on a pool of two processes, or on a real
Dask scheduler with two workers in processes of their own; over files, or over a local S3 server, in a process of its own, from which
the logs are read and into which the tables are written. Every 20 s a worker gets SIGKILL, and the client gets it after a third and
after two thirds of the logs; it is then started again.

* equal: sensors, outages, logs and quarantine have the same bytes as those of the loop over the same logs.
* worked twice: logs on which work was begun again, because a worker or the client was killed.
* CPU: of the client and of all processes that it started, without the workers of Dask and the servers.
* overhead: CPU of the pool over that of the loop, for logs that take 2 s each (``noise``); the loop runs before and after.

Command: ``python tests/studies/fleet.py`` (600 logs: an hour on two cores; ``fleet.md`` states what was run. Linux).
Seeds: 1, of the fleet.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path

import obstore
import psutil
from fleet_logs import GROUP, MONTHS, fleet
from fleet_scale import scale
from obstore.store import S3Store
from study_report import GOALS, Table, main, verdict

QUESTION = "A fleet of logs under kills"
HERE = Path(__file__).resolve().parent
SECONDS, RATE = 60, 50
KILL = (
    20.0  #: s between two kills of a worker; the bound of time is below it, or the log that hangs would never reach it
)
BOUNDS = ("--task-time", "15", "--task-memory", "1")
TABLES = ("sensors", "outages", "logs", "quarantine")
BUCKET, PORT = "fleet", 5127
LONG = 10  #: logs of 2 s each
STORE = {
    "AWS_ACCESS_KEY_ID": "k", "AWS_SECRET_ACCESS_KEY": "s", "AWS_REGION": "us-east-1", "AWS_ENDPOINT_URL": f"http://127.0.0.1:{PORT}",
}  # fmt: skip


def command(*arguments):
    return [sys.executable, "-m", "imuwb", "fleet", *map(str, arguments)]


def cpu():
    """Return the CPU time of all processes that this one has waited for, and of theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(arguments, folder):
    """Run a command to its end, and return its CPU and wall time."""
    before, began = cpu(), time.monotonic()
    done = subprocess.run(command(*arguments), cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return cpu() - before, time.monotonic() - began


class Killer(threading.Thread):
    """Kills a process of a kind every 20 s."""

    def __init__(self, above, word) -> None:
        super().__init__(daemon=True)
        self.above, self.word, self.kills, self.ended = above, word, 0, threading.Event()

    def run(self):
        while not self.ended.wait(KILL):
            found = [p for top in self.above() for p in _below(top) if self.word in _words(p)]
            if found:
                found[self.kills % len(found)].kill()
                self.kills += 1


def _below(number):
    try:
        return psutil.Process(number).children(recursive=True)
    except psutil.Error:
        return []


def _words(process):
    try:
        return " ".join(process.cmdline())
    except psutil.Error:
        return ""


def under_kills(arguments, folder, logs, count, above, word):
    """Run a command while workers are killed and it is killed twice itself; return kills and logs that were worked on."""
    client, worked = None, 0
    killer = Killer(lambda: [*above, *([client.pid] if client is not None else [])], word)
    killer.start()
    for share in (1 / 3, 2 / 3, 2.0):
        client = subprocess.Popen(command(*arguments), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        while client.poll() is None:
            time.sleep(0.2)
            if count() >= share * logs:
                client.kill()
        worked += client.wait() == -signal.SIGKILL
        problem = client.stderr.read()
        client.stderr.close()
    killer.ended.set()
    if client.returncode:
        raise RuntimeError(problem.decode())
    return killer.kills, worked


@contextmanager
def servers(folder):
    """Run an S3 server, a scheduler of Dask and two workers that are started again when they are killed."""
    file, running = folder / "scheduler.json", []

    def start(*arguments):
        environment = {**os.environ, **STORE}
        running.append(
            subprocess.Popen(
                arguments, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
        )

    start(sys.executable, "-c", f"from moto.server import main; main(['-p{PORT}'])")
    dask = ("--scheduler-file", str(file), "--no-dashboard")
    start(sys.executable, "-m", "distributed.cli.dask_scheduler", *dask, "--port", "0", "--host", "127.0.0.1")
    start(
        sys.executable,
        "-m",
        "distributed.cli.dask_worker",
        *dask,
        "--nworkers",
        "2",
        "--nthreads",
        "1",
        "--memory-limit",
        "0",
    )
    try:
        while not file.exists():
            time.sleep(0.1)
        yield json.loads(file.read_text())["address"], running[-1].pid
    finally:
        for process in running[::-1]:
            for one in (*_below(process.pid), psutil.Process(process.pid)):
                one.kill()
            process.wait()


def bucket(folder):
    """Put the logs into a bucket, and return it."""
    made = urllib.request.Request(f"{STORE['AWS_ENDPOINT_URL']}/{BUCKET}", method="PUT")  # noqa: S310 - as below
    for _ in range(100):
        try:
            urllib.request.urlopen(made).close()  # noqa: S310 - our own server
            break
        except OSError:
            time.sleep(0.2)
    store = S3Store(BUCKET, client_options={"allow_http": True})
    for path in sorted((folder / "logs").rglob("*.mcap")):
        obstore.put(store, path.relative_to(folder).as_posix(), path.read_bytes())
    return store


def tables(folder):
    return {name: (folder / f"{name}.parquet").read_bytes() for name in TABLES}


def stored(store, name):
    return {table: bytes(obstore.get(store, f"{name}/{table}.parquet").bytes()) for table in TABLES}


def overhead(folder, rerun):
    """Return the rows on the CPU of a pool over that of a loop, which runs before and after it, for logs of 2 s each."""
    subprocess.run([sys.executable, "-m", "imuwb", "warm"], check=True, capture_output=True)
    fleet(folder / "more", LONG // MONTHS, 180, 100, seed=2)
    runs = (("loop", 0), ("pool", 2), ("loop again", 0))
    spent = {
        name: timed(("noise", folder / "more", "-o", folder / f"{name}-long", "--workers", workers), folder)[0]
        for name, workers in runs
    }
    return goals_of(spent["loop"], spent["pool"], spent["loop again"], rerun)


def goals_of(first, pool, second, rerun):
    """Return the rows on overhead from the CPU of two loops and of the pool between them."""
    each, more = min(first, second) / LONG, pool / ((first + second) / 2) - 1
    return (
        ("CPU of a log in the loop", "at least 2 s", f"{each:.2f} s", verdict(each >= 2)),
        (f"CPU of the pool, its start included, over the mean of two loops of {LONG} such logs", "at most 5 %",
         f"{100 * more:.1f} % ({pool:.1f} s; loops {first:.1f} and {second:.1f} s)", verdict(more <= 0.05)),
        ("CPU of a run that finds all done, over 600 such logs", "at most 2 %", f"{100 * rerun / (600 * each):.2f} %",
         verdict(rerun <= 0.02 * 600 * each)),
    )  # fmt: skip


def under(folder, logs, plain, rows):
    """Add a row for each executor over files and over a store."""
    analysis, common = HERE / "fleet_analysis.py", ("--group", GROUP, *BOUNDS)
    with servers(folder) as (address, workers):
        store = bucket(folder)
        given = {"files": ("logs", *common), "S3": (f"s3://{BUCKET}/logs/", *common)}
        print("loop over S3", timed((analysis, *given["S3"], "-o", "loop-s3", "--workers", 0), folder), flush=True)
        loop = {"files": plain, "S3": tables(folder / "loop-s3")}
        for executor, options, above, word in (
            ("pool", ("--workers", 2), [], "imuwb.fleet.child"), ("Dask", ("--scheduler", address), [workers], "spawn_main"),
        ):  # fmt: skip
            for place, patterns in given.items():
                name = f"{executor}-{place}"
                output = name if place == "files" else f"s3://{BUCKET}/{name}"

                def count(name=name, place=place):
                    if place == "files":
                        return sum(1 for _ in (folder / name / "parts").rglob("*.parquet"))
                    return sum(len(page) for page in obstore.list(store, prefix=f"{name}/parts/"))

                began = time.monotonic()
                kills, clients = under_kills(
                    (analysis, *patterns, "-o", output, *options), folder, logs, count, above, word
                )
                took = time.monotonic() - began
                found = tables(folder / name) if place == "files" else stored(store, name)
                same = found == loop[place] and found["sensors"] == plain["sensors"]
                again = timed((analysis, *patterns, "-o", output, *options), folder)[0]
                rows.append(
                    (executor, place, logs, kills, clients, "yes" if same else "NO", f"{took:.0f}", f"{again:.2f}")
                )
                print(rows[-1], flush=True)


def study(records):
    """Return the tables."""
    os.environ.update(STORE)
    with tempfile.TemporaryDirectory(prefix="imuwb-fleet-") as place:
        folder = Path(place)
        logs, damaged = fleet(folder / "logs", records // MONTHS, SECONDS, RATE)
        print(f"{logs} logs, {damaged} damaged", flush=True)
        arguments = (HERE / "fleet_analysis.py", "logs", "--group", GROUP, *BOUNDS, "-o", "loop", "--workers", 0)
        first, _ = timed(arguments, folder)
        plain = tables(folder / "loop")
        again, _ = timed(arguments, folder)
        print("loop", first, again, flush=True)
        rows = []
        under(folder, logs, plain, rows)
        goals = (
            ("tables equal to those of the loop", f"{len(rows)} of {len(rows)}", f"{sum(r[5] == 'yes' for r in rows)} of {len(rows)}",
             verdict(all(r[5] == "yes" for r in rows))),
            (f"CPU of a run that finds all done, over the first of {logs} logs", "at most 2 %", f"{100 * again / first:.2f} % ({again:.2f} s of {first:.0f} s)",
             verdict(again <= 0.02 * first)),
            *overhead(folder, again),
        )  # fmt: skip
        heads = (
            "executor",
            "logs in",
            "logs",
            "workers killed",
            "clients killed",
            "equal",
            "s by the clock",
            "s CPU of another run",
        )
        return (
            Table("Goals", GOALS, goals),
            Table("Runs under kills", heads, tuple(rows), f"{damaged} of the logs are damaged, hang or take memory."),
            scale(folder),
        )


if __name__ == "__main__":
    main(__file__, QUESTION, study, 600, lambda records: f"{records} logs, {SECONDS} s at {RATE} Hz each")

"""Run an analysis over a simulated fleet while workers and clients are killed, and compare its tables with those of a plain loop.

The fleet has 5 logs of each sensor, a month apart; one sensor drifts, three are out of family, 3 % of the logs are damaged, one hangs,
one takes memory without end. The analysis is ``fleet_analysis.py``, the spectra of imuwb. The plain loop is ``--workers 0``. The others
run on a pool of two processes, or on a real Dask scheduler with two workers in processes of their own; over files, or over a local S3
server, in a process of its own, from which the logs are read and into which the tables are written. Every 10 s a worker gets SIGKILL,
and the client gets it after a third and after two thirds of the logs; it is then started again.

* equal: sensors, outages, logs and quarantine have the same bytes as those of the loop over the same logs.
* CPU: user and system time of the client and of all processes that it started, without the workers of Dask and the servers.
* overhead: CPU of the pool over that of the loop, for logs that take about 2 s each (``noise``), in pairs of runs whose order alternates.
* planted: what ``imuwb fleet report`` finds in the tables of the loop at an error of 1 %.

Command: ``nice -n 15 python tests/studies/fleet.py`` (600 logs: an hour of CPU. Linux).
Seeds: 1, of the fleet; 2, of the logs of about 2 s.
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
from contextlib import contextmanager, suppress
from pathlib import Path

import obstore
import psutil
from fleet_logs import GROUP, MONTHS, fleet
from fleet_scale import scale
from obstore.store import S3Store
from study_report import GOALS, Table, main, verdict

QUESTION = "A fleet of logs under kills"
HERE = Path(__file__).resolve().parent
SECONDS, RATE = 120, 100
KILL = 10.0  #: s between two kills of a worker; each worker is killed twice, then the other twice, so the log that hangs has 30 s at times
BOUNDS = ("--task-time", "15", "--task-memory", "1")
TABLES = ("sensors", "outages", "logs", "quarantine")
BUCKET, PORT = "fleet", 5127
LONG, LONG_SECONDS = 120, 600  #: logs of about 2 s of CPU each, and the seconds that they last
PAIRS = 2  #: runs of loop and pool over them
AGAIN = 3  #: runs that find all done
PLANTED = {"s000": {"drifts"}, "s001": {"out of family"}, "s002": {"out of family"}, "s003": {"out of family"}}
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
    """Kills a process of a kind every 10 s."""

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


def under_kills(arguments, folder, logs, count, above, word, pause):
    """Run a command while workers are killed and it is killed twice itself; return how often each was killed."""
    client, worked = None, 0
    killer = Killer(lambda: [*above, *([client.pid] if client is not None else [])], word)
    killer.start()
    for share in (1 / 3, 2 / 3, 2.0):
        client = subprocess.Popen(command(*arguments), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        while client.poll() is None:
            time.sleep(pause)
            if count() >= share * logs:
                client.kill()
        worked += client.wait() == -signal.SIGKILL
        problem = client.stderr.read()
        client.stderr.close()
    killer.ended.set()
    if client.returncode:
        raise RuntimeError(problem.decode())
    return killer.kills, worked


def address_in(file):
    """Return the address of the scheduler that writes a file, when the file is whole."""
    while True:
        with suppress(OSError, ValueError):
            return json.loads(file.read_text())["address"]
        time.sleep(0.1)


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
    dask, port = (sys.executable, "-m"), ("--port", "0", "--host", "127.0.0.1")
    start(*dask, "distributed.cli.dask_scheduler", "--no-dashboard", "--scheduler-file", str(file), *port)
    try:
        address = address_in(file)
        two = ("--nworkers", "2", "--nthreads", "1", "--memory-limit", "0")
        start(*dask, "distributed.cli.dask_worker", address, "--no-dashboard", *two)
        yield address, running[-1].pid
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
    """Return the rows on the CPU of a pool over that of a loop, for logs of about 2 s each."""
    fleet(folder / "more", LONG // MONTHS, LONG_SECONDS, RATE, seed=2)
    spent = {0: [], 2: []}
    for pair in range(PAIRS):
        for workers in (0, 2) if pair % 2 == 0 else (2, 0):
            arguments = ("noise", folder / "more", "-o", folder / f"long-{workers}-{pair}", "--workers", workers)
            spent[workers].append(timed(arguments, folder)[0])
        print("overhead", {workers: f"{used[-1]:.1f}" for workers, used in spent.items()}, flush=True)
    return goals_of(spent[0], spent[2], rerun)


def goals_of(loops, pools, rerun):
    """Return the rows on overhead from the CPU of each loop and of the pool beside it."""
    each = sum(loops) / len(loops) / LONG
    more = sum(pools) / sum(loops) - 1
    pairs = ", ".join(f"{100 * (pool / loop - 1):+.1f}" for loop, pool in zip(loops, pools, strict=True))
    return (
        ("CPU of a log in the loop; of dearer logs the overhead is less", "–", f"{each:.2f} s", "–"),
        (f"CPU of the pool, its start included, over that of the loop: {PAIRS} pairs of {LONG} such logs", "at most 5 %",
         f"{100 * more:+.1f} % ({sum(pools):.0f} s, {sum(loops):.0f} s; of each pair {pairs} %)", verdict(more <= 0.05)),
        ("CPU of a run that finds all done, over 600 such logs", "at most 2 %", f"{100 * rerun / (600 * each):.2f} %",
         verdict(rerun <= 0.02 * 600 * each)),
    )  # fmt: skip


def planted(folder):
    """Return the row on what the report finds."""
    arguments = ("report", "loop", "-o", "loop.rrd", "--force", "--json", "report.json")
    timed(arguments, folder)
    found = {}
    for one in json.loads((folder / "report.json").read_text())["result"]["findings"]:
        found.setdefault(one["sensor"], set()).add(one["finding"])
    shown = "; ".join(f"{sensor} {', '.join(sorted(kinds))}" for sensor, kinds in sorted(found.items()))
    print("found", shown, flush=True)
    goal = "; ".join(f"{sensor} {', '.join(kinds)}" for sensor, kinds in PLANTED.items())
    return ("sensors found at an error of 1 %: those planted, and no other", goal, shown, verdict(found == PLANTED))


def under(folder, logs, plain, first, rows):
    """Add a row for each executor over files and over a store."""
    analysis, common = HERE / "fleet_analysis.py", ("--group", GROUP, *BOUNDS)
    with servers(folder) as (address, workers):
        store = bucket(folder)
        print("bucket", flush=True)
        given = {"files": ("logs", *common), "S3": (f"s3://{BUCKET}/logs/", *common)}
        first = {"files": first, "S3": timed((analysis, *given["S3"], "-o", "loop-s3", "--workers", 0), folder)[0]}
        print("loops", first, flush=True)
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
                    (analysis, *patterns, "-o", output, *options), folder, logs, count, above, word,
                    0.2 if place == "files" else 2.0,
                )  # fmt: skip
                took = time.monotonic() - began
                found = tables(folder / name) if place == "files" else stored(store, name)
                same = found == loop[place] and found["sensors"] == plain["sensors"]
                again = timed((analysis, *patterns, "-o", output, *options), folder)[0]
                rows.append((
                    executor, place, logs, kills, clients, "yes" if same else "NO", f"{took:.0f}", f"{again:.2f}",
                    f"{100 * again / first[place]:.2f} %",
                ))  # fmt: skip
                print(rows[-1], flush=True)


def study(records):
    """Return the tables."""
    os.environ.update(STORE)
    subprocess.run([sys.executable, "-m", "imuwb", "warm"], check=True, capture_output=True)
    with tempfile.TemporaryDirectory(prefix="imuwb-fleet-") as place:
        folder = Path(place)
        logs, damaged = fleet(folder / "logs", records // MONTHS, SECONDS, RATE)
        print(f"{logs} logs, {damaged} damaged", flush=True)
        arguments = (HERE / "fleet_analysis.py", "logs", "--group", GROUP, *BOUNDS, "-o", "loop", "--workers", 0)
        first, _ = timed(arguments, folder)
        plain = tables(folder / "loop")
        again = sum(timed(arguments, folder)[0] for _ in range(AGAIN)) / AGAIN
        print("loop", first, again, flush=True)
        found = planted(folder)
        rows = []
        under(folder, logs, plain, first, rows)
        goals = (
            ("tables equal to those of the loop", f"{len(rows)} of {len(rows)}", f"{sum(r[5] == 'yes' for r in rows)} of {len(rows)}",
             verdict(all(r[5] == "yes" for r in rows))),
            found,
            (f"CPU of a run that finds all done, over the first of {logs} logs", "at most 2 %",
             f"{100 * again / first:.2f} % ({again:.2f} s, mean of {AGAIN}; first {first:.0f} s)", verdict(again <= 0.02 * first)),
            *overhead(folder, again),
        )  # fmt: skip
        heads = (
            "executor", "logs in", "logs", "workers killed", "clients killed", "equal", "s by the clock", "s CPU of another run",
            "of the loop",
        )  # fmt: skip
        note = (
            f"{damaged} of the logs are damaged, hang or take memory. "
            "The last column is the CPU of another run, which finds all done, over that of the loop over the same logs."
        )
        return (Table("Goals", GOALS, goals), Table("Runs under kills", heads, tuple(rows), note), scale(folder))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 600, lambda records: f"{records} logs, {SECONDS} s at {RATE} Hz each")

"""How a fleet of 100,000 logs would fare: all of them listed and planned; fewer for the rest, with tasks that do nothing on a real Dask scheduler.

The bucket is that of ``listing_server.py``, which sends 1,000 objects at a time, as S3 does.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import psutil
from study_report import Table

from imuwb import __version__
from imuwb.errors import UsageError
from imuwb.fleet.dask_cluster import DaskCluster, local_cluster
from imuwb.fleet.executor import Bounds, Call, TransportError
from imuwb.fleet.identity import ByGroup, Identity
from imuwb.fleet.listing import Listed, found
from imuwb.fleet.parts import Part, known_parts, part_name
from imuwb.fleet.plan import Task, ordered, planned
from imuwb.fleet.running import completed
from imuwb.fleet.store import FolderStore
from imuwb.fleet.tables import Entry, tables_of

LOGS, PARTS, EMPTY = 100_000, 2_000, 2_000  #: files that are listed; parts that become tables; tasks that do nothing
AXES, LETTERS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"), "QNBKR"
MEGA = 1e6
HERE, PORT = Path(__file__).resolve().parent, 5133
STORE = {
    "AWS_ACCESS_KEY_ID": "k", "AWS_SECRET_ACCESS_KEY": "s", "AWS_REGION": "us-east-1", "AWS_ENDPOINT_URL": f"http://127.0.0.1:{PORT}",
}  # fmt: skip


def memory(process=None):
    return (process or psutil.Process()).memory_info().rss / MEGA


def row(number):
    """Return the part of a log with all coefficients of all axes."""
    key = f"sha256:{number:064x}"
    common = {
        "analysis": "noise",
        "stream": "/imu/data",
        "level": 0.95,
        "log": key,
        "duration": 3600.0,
        "temperature": 25.0,
    }
    sensors = tuple(
        {**common, "axis": axis, "coefficient": letter, "value": number * 1e-9 + 1e-3, "lower": 9e-4, "upper": 2e-3, "unit": "rad/s",
         "estimator": "likelihood", "headline": True, "verdict": "sound", "remarks": "white noise to 12 s, bias instability to 1600 s"}
        for axis in AXES for letter in LETTERS
    )  # fmt: skip
    return Part(
        {"log": key, "format": "mcap", "imu": "/imu/data", "rate": 100.0, "streams": 2, "duration": 3600.0}, sensors
    )


def listing(folder):
    """Return rows on listing and planning 100,000 files."""
    logs = folder / "many"
    for number in range(LOGS):
        path = logs / f"v{number // 600:03d}/s{number // 100:04d}/{number}.mcap"
        if number % 100 == 0:
            path.parent.mkdir(parents=True)
        path.touch()
    before, began = memory(), time.process_time()
    listed = found([str(logs)])
    took = time.process_time() - began
    tasks = ordered(planned(listed, ByGroup(r"(?P<vehicle>v\d+)/(?P<serial>s\d+)/"), ()))
    both = time.process_time() - began
    return (
        ("list the logs of a folder", LOGS, f"{took:.1f} s", f"{took:.1f} s"),
        ("plan and order them", len(tasks), f"{both - took:.1f} s", f"{both - took:.1f} s"),
        ("memory of the list and the plan", LOGS, f"{memory() - before:.0f} MB", f"{memory() - before:.0f} MB"),
    )


def results(folder):
    """Return rows on the parts and the tables of many logs."""
    store, entries = FolderStore(folder / "parts-of-many"), []
    size = 0
    for number in range(PARTS):
        task = Task(
            Listed(f"{number}.mcap", 10**6, str(number)), Identity("v", str(number // 5)), (), "", f"{number:016x}"
        )
        name = part_name("run", task.tag, f"{number:016x}"[::-1])
        content = row(number).packed()
        size += len(content)
        path = store.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        entries.append(Entry(task, name))
    began = time.process_time()
    assert len(known_parts(store, "run", ())) == PARTS
    names, before = time.process_time() - began, memory()
    made = tables_of(entries, store)
    took = time.process_time() - began - names
    made.write(store)
    times = LOGS / PARTS
    sizes = {name: (store.root / f"{name}.parquet").stat().st_size / MEGA for name in ("sensors", "logs")}
    return (
        ("find the parts that are there", PARTS, f"{names:.2f} s", f"{names * times:.1f} s"),
        ("parts, 30 coefficients each", PARTS, f"{size / MEGA:.0f} MB", f"{size / MEGA * times:.0f} MB"),
        ("tables from the parts", PARTS, f"{took:.1f} s", f"{took * times:.0f} s"),
        ("memory of that", PARTS, f"{memory() - before:.0f} MB", f"{(memory() - before) * times:.0f} MB"),
        *((f"{name}.parquet", PARTS, f"{mega:.2f} MB", f"{mega * times:.1f} MB") for name, mega in sizes.items()),
    )


def apart(what):
    """Return rows that a process of its own measures: "bucket" on 100,000 objects of a store, "scheduler" on a Dask scheduler."""
    own = subprocess.run([sys.executable, __file__, what], capture_output=True, text=True, check=True)
    return tuple(tuple(line.split("\t")) for line in own.stdout.splitlines())


def scale(folder):
    """Return the table."""
    rows = (*listing(folder), *apart("bucket"), *results(folder), *apart("scheduler"))
    note = (
        "The last column is in proportion to the number; the scheduler holds only the tasks that wait (three for each worker). The rows are\n"
        "made up and alike, so real tables are larger; the memory of the tables is mostly that of 1,000 logs at a time, and its proportion an upper end."
    )
    return Table("100,000 logs", ("what", "measured with", "measured", "of 100,000"), rows, note)


def bucket():
    """Print the rows of a store."""
    os.environ.update(STORE)
    server = subprocess.Popen([sys.executable, str(HERE / "listing_server.py"), str(PORT), str(LOGS)])
    try:
        _answers()
        before, began, used = memory(), time.monotonic(), time.process_time()
        listed = found(["s3://fleet/drives/**/*.mcap"])
        took, used = time.monotonic() - began, time.process_time() - used
    finally:
        server.kill()
        server.wait()
    assert len(listed) == LOGS
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / MEGA - before
    print(f"CPU to list the objects of a bucket\t{LOGS}\t{used:.1f} s\t{used:.1f} s")
    print(f"time by the clock, the server on the same machine\t{LOGS}\t{took:.1f} s\t{took:.1f} s")
    print(f"most memory that this takes more\t{LOGS}\t{grown:.0f} MB\t{grown:.0f} MB")


def _answers():
    """Wait until the server of the store answers, and import what lists it."""
    for _ in range(100):
        try:
            found(["s3://fleet/none/"])
        except UsageError:  # it has no such object
            return
        except TransportError:
            time.sleep(0.2)
    raise RuntimeError("the server does not answer")


def scheduler():
    """Print the rows of a Dask scheduler in a process of its own and two workers, with tasks that do nothing."""
    cluster = local_cluster(2)
    executor = DaskCluster("local", __version__, cluster)
    calls = (Call(abs, number, Bounds(60, 1e9)) for number in range(EMPTY))
    before, began = memory(), time.monotonic()
    used = time.process_time()
    most = 0
    for done in completed(calls, executor):
        assert done.fault is None, done.fault
        most = max(most, len(cluster.scheduler.tasks))
    took, used = time.monotonic() - began, time.process_time() - used
    grown = memory() - before
    executor.close()
    times = LOGS / EMPTY
    print(f"CPU of client and scheduler\t{EMPTY}\t{used:.1f} s\t{used * times:.0f} s")
    print(f"time by the clock, two workers\t{EMPTY}\t{took:.1f} s\t{took * times:.0f} s")
    print(f"memory that client and scheduler take more\t{EMPTY}\t{grown:.0f} MB\t–")
    print(f"most tasks in the scheduler\t{EMPTY}\t{most}\t{most}")


if __name__ == "__main__":
    {"bucket": bucket, "scheduler": scheduler}[sys.argv[1]]()

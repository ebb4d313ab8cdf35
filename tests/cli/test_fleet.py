"""A fleet of logs on the command line: a plugin's analysis over good, damaged, hanging and greedy logs, in files and in a store.

Only the log that hangs has a bound of time, so that no slow machine makes another log fail.
"""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

HEADER = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"
#: A plugin that waits while there is a file "wait", hangs, takes memory or fails by the number of rows of the log.
PLUGIN = '''
"""Mean square of the gyros.

Example: imuwb mean.py LOG
"""
import time
from dataclasses import dataclass
from pathlib import Path
import numpy as np
from imuwb.analysis import Finding
from imuwb.options import Options
from imuwb.statistics import Coefficient

@dataclass(frozen=True)
class Parameters(Options):
    scale: float = 1.0
    file: Path | None = None

def run(logs, parameters):
    rate = logs[0].imu().angular_rate
    rows = len(rate)
    while rows == 60 and Path("wait").exists():
        time.sleep(0.02)
    if rows == 61:
        time.sleep(10**6)
    if rows == 62:
        return bytearray(10**11)
    if rows == 63:
        return 1 / 0
    more = float(parameters.file.read_text()) if parameters.file else 0.0
    return {axis: parameters.scale * float(np.std(rate.value[:, i])) + more for i, axis in enumerate("xyz")}

def draw(result, review):
    pass

def findings(result):
    return tuple(Finding(f"gyro_{a}", "mean", {"N": Coefficient(v, v / 2, 2 * v)}) for a, v in result.items())
'''
GROUP = r"logs/(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/[^/]*$"
SHORT = ("--task-time", "0.5")  #: for the log that hangs
TABLES = ("sensors", "outages", "logs", "quarantine")
KINDS = ["fault", "memory", "unreadable"]
PATIENCE = 300  #: s that a test waits for another process


def text(rows, seed):
    values = np.random.default_rng(seed).normal(0, 0.01, (rows, 6)) - np.array([0, 0, 0, 0, 0, 9.8])
    return "\n".join([HEADER, *(",".join(map(repr, [i / 100, *row])) for i, row in enumerate(values.tolist()))]) + "\n"


def made(folder):
    """Write five sound logs of three sensors, one that can wait, three that are not sound, and apart one that hangs."""
    (folder / "mean.py").write_text(PLUGIN)
    contents = {f"logs/v{i % 3}/s{i % 3}/{i}.csv": text(60 if i == 3 else 59, i) for i in range(6)}
    contents |= {"logs/v0/s0/greedy.csv": text(62, 2), "logs/v0/s0/fails.csv": text(63, 3)}
    contents |= {"logs/v0/s0/words.csv": "no log", "hangs/v0/s0/hangs.csv": text(61, 1)}
    for name, content in contents.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)


def tables(folder):
    return {name: (Path(folder) / f"{name}.parquet").read_bytes() for name in TABLES}


def rows(folder, table):
    return pq.read_table(Path(folder) / f"{table}.parquet").to_pylist()


def worked(folder):
    """Return the logs on which the last run worked."""
    return [json.loads(line)["path"] for line in (Path(folder) / "progress.jsonl").read_text().splitlines()]


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    """Return a folder with a fleet, and its tables by a plain loop."""
    folder = tmp_path_factory.mktemp("fleet")
    made(folder)
    done = ran(folder, "mean.py", "logs", "-o", "loop", "--group", GROUP, "--workers", "0")
    assert done.returncode == 0, done.stderr
    return folder


def ran(folder, *arguments, **environment):
    command = [sys.executable, "-m", "imuwb", "fleet", *map(str, arguments)]
    environment = {**os.environ, **environment}
    return subprocess.run(
        command, capture_output=True, text=True, cwd=folder, env=environment, check=False, encoding="utf-8"
    )


def test_a_plain_loop(loop):
    assert sorted(row["kind"] for row in rows(loop / "loop", "quarantine")) == KINDS
    assert len(rows(loop / "loop", "sensors")) == 18
    assert {row["serial"] for row in rows(loop / "loop", "logs")} == {"s0", "s1", "s2"}


@pytest.mark.skipif(sys.platform == "win32", reason="a loop in one process has no bound of time there")
def test_a_log_that_hangs_is_ended_by_a_loop_and_by_a_pool(imuwb, loop, monkeypatch):
    monkeypatch.chdir(loop)
    for workers in (0, 1):
        done = imuwb("fleet", "mean.py", "hangs", "-o", f"hangs-{workers}", "--workers", workers, *SHORT)
        assert (done.code, "more than 0.5 s" in done.err) == (1, True), done.err
    assert tables("hangs-0") == tables("hangs-1")
    assert [row["kind"] for row in rows("hangs-0", "quarantine")] == ["time"]


def test_a_run_does_what_is_missing_and_nothing_else(imuwb, loop, monkeypatch):
    monkeypatch.chdir(loop)
    before = tables("loop")
    given = ("fleet", "mean.py", "logs", "-o", "loop", "--group", GROUP, "--workers", "0")
    done = imuwb(*given)
    assert (done.code, "nothing was left" in done.err, "Wrote" in done.err, len(done.err.splitlines()) <= 15) == (
        0,
        True,
        False,
        True,
    )
    Path("loop/outages.parquet").write_bytes(before["outages"][:40])
    done = imuwb(*given)
    assert (done.code, "nothing was left" in done.err, "Wrote" in done.err, tables("loop")) == (0, True, True, before)
    part = next(p for p in Path("loop/parts").rglob("*.parquet") if pq.read_table(p).column("sensors")[0].as_py())
    part.unlink()
    Path("loop/sensors.parquet").unlink()
    assert imuwb(*given).code == 0
    assert (len(worked("loop")), tables("loop")) == (1, before)


def test_a_pool_with_a_client_that_is_killed_gives_the_tables_of_the_loop(loop):
    folder = loop / "pool"
    command = [
        sys.executable,
        "-m",
        "imuwb",
        "fleet",
        "mean.py",
        "logs",
        "-o",
        "pool",
        "--group",
        GROUP,
        "--workers",
        "2",
    ]
    (loop / "wait").touch()
    client = subprocess.Popen(command, cwd=loop, stderr=subprocess.DEVNULL)
    end = time.monotonic() + PATIENCE
    while len(list(folder.glob("parts/*/*/*.parquet"))) < 3 and time.monotonic() < end:
        time.sleep(0.02)
    assert client.poll() is None
    client.send_signal(signal.SIGKILL)
    client.wait()
    (loop / "wait").unlink()
    done = ran(loop, *command[4:])
    assert done.returncode == 0, done.stderr
    assert tables(folder) == tables(loop / "loop")
    assert 1 <= len(worked(folder)) <= 6


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("logs/*.bag",), 2, ["no log matches", "logs/*.bag"]),
        (("logs", "--group", "(?P<serial>x+y)"), 2, ["matches no log", "logs/v0/s0"]),
        (("logs", "--group", "s"), 2, ["named groups", "serial"]),
        (("logs", "--identities", "none.csv"), 2, ["none.csv"]),
        (("logs", "--group", "(?P<serial>s)", "--metadata", "serial=a"), 2, ["--group", "--metadata"]),
        (("logs", "--scheduler", "nowhere"), 2, ["tcp://"]),
        (("logs", "--task-time", "0"), 2, ["--task-time"]),
        (("logs", "--imu", "all"), 2, ["--imu all"]),
        (("http://127.0.0.1:9/*.bin",), 2, ["does not list"]),
        (("logs", "--through", "nothing"), 2, ["nothing"]),
    ],
)
def test_bad_input(imuwb, loop, monkeypatch, arguments, code, words):
    if "--scheduler" in arguments:
        pytest.importorskip("distributed", reason="distributed is not installed")
    monkeypatch.chdir(loop)
    done = imuwb("fleet", "mean.py", *arguments, "-o", "bad")
    assert done.code == code, done.err
    assert all(word in done.err for word in words), done.err
    assert not Path("bad").exists()


DENIED = "access is denied; check the address, and set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY"
ABSENT = "there is no such bucket; check the address"


@pytest.mark.parametrize(
    ("logs", "place", "status", "said"),
    [
        ("s3://drives/**/*.csv", "denied", 401, DENIED),
        ("s3://drives/**/*.csv", "denied", 403, DENIED),
        ("s3://drives/v0/", "denied", 404, ABSENT),
        ("logs", "s3://drives/denied", 403, DENIED),
    ],
)
def test_a_store_that_refuses_is_asked_once(imuwb, loop, monkeypatch, web, logs, place, status, said):
    pytest.importorskip("obstore", reason="obstore is not installed")
    monkeypatch.chdir(loop)
    monkeypatch.delenv("AWS_PROFILE", raising=False)
    web.statuses = [status] * 20
    keys = {"AWS_ACCESS_KEY_ID": "WRONG-KEY", "AWS_SECRET_ACCESS_KEY": "WRONG-SECRET", "AWS_REGION": "us-east-1"}
    done = imuwb("fleet", "mean.py", logs, "-o", place, **keys, AWS_ENDPOINT_URL=web.url(""))
    assert (done.code, len(done.err.splitlines()), len(web.requests)) == (1, 1, 1)
    assert f"imuwb: {place if logs == 'logs' else logs}: {said}" in done.err
    assert "WRONG" not in done.err
    assert not Path("denied").exists()


def test_results_of_another_run_are_kept(imuwb, loop, monkeypatch):
    monkeypatch.chdir(loop)
    before = tables("loop")
    for arguments, word in ((("--scale", "2"), "options"), ((), "version")):
        if word == "version":
            state = json.loads(Path("loop/run.json").read_text())
            Path("loop/run.json").write_text(json.dumps({**state, "schema": 99}))
        done = imuwb("fleet", "mean.py", "logs", "-o", "loop", "--workers", "0", *arguments)
        assert (done.code, "--force" in done.err) == (2, True)
        assert tables("loop") == before
    Path("loop/run.json").write_text(json.dumps(state))


def test_an_option_of_each_sensor(imuwb, loop, monkeypatch):
    monkeypatch.chdir(loop)
    Path("s0.txt").write_text("5")
    Path("s1.txt").write_text("7")
    done = imuwb(
        "fleet",
        "mean.py",
        "logs/**/[0-2].csv",
        "-o",
        "own",
        "--group",
        GROUP,
        "--workers",
        "0",
        "--file",
        "{serial}.txt",
    )
    assert done.code == 0, done.err
    assert {row["serial"]: round(row["value"]) for row in rows("own", "sensors")} == {"s0": 5, "s1": 7}
    assert [(row["serial"], row["kind"]) for row in rows("own", "quarantine")] == [("s2", "fault")]


def test_a_list_of_the_logs(imuwb, loop, monkeypatch):
    monkeypatch.chdir(loop)
    done = imuwb("fleet", "list", "logs", "--group", GROUP, "-o", "logs.csv", "--force")
    assert (done.code, "9 logs of 3 sensors" in done.err) == (0, True), done.err
    assert "kB in all; no log has an index that states its duration" in " ".join(done.err.split())
    assert Path("logs.csv").read_text().count("\n") == 10
    again = imuwb("fleet", "list", "logs", "--identities", "logs.csv")
    assert "9 logs of 3 sensors" in again.out


def test_the_list_replaces_no_input(imuwb, loop, tmp_path, monkeypatch):
    monkeypatch.chdir(loop)
    table = tmp_path / "who.csv"
    table.write_text("log,serial\nlogs/v0/s0/0.csv,A\n")
    before = Path("logs/v1/s1/1.csv").read_bytes(), table.read_bytes()
    for output in ("logs/v1/s1/1.csv", table, "loop/logs.parquet"):
        done = imuwb("fleet", "list", "logs", "--identities", table, "-o", output, "--force")
        assert (done.code, str(output) in done.err) == (2, True), done.err
    assert (Path("logs/v1/s1/1.csv").read_bytes(), table.read_bytes()) == before


def test_rows_of_the_table_that_match_no_log_are_said(imuwb, loop, tmp_path, monkeypatch):
    monkeypatch.chdir(loop)
    table = tmp_path / "who.csv"
    table.write_text("log,serial,date\nlogs/v0/s0/0.csv,A,2026-01-02\ngone.csv,B,\n")
    listed = imuwb("fleet", "list", "logs", "--identities", table, "-o", tmp_path / "list.csv")
    done = imuwb("fleet", "mean.py", "logs", "-o", tmp_path / "own", "--identities", table, "--workers", "0")
    for text in (listed.out + listed.err, done.err):
        assert "1 of 2 rows of" in text
        assert "gone.csv" in text
    assert "2026-01-02T00:00:00+00:00" in (tmp_path / "list.csv").read_text()


@pytest.mark.parametrize(
    ("group", "about", "said"),
    [
        ("logs/(?P<vehicle>[^/]+)/(?P<serial>s)", "9 logs of 1 sensor", "Serial s is in 3 vehicles (v0, v1, v2)"),
        ("logs/(?P<vehicle>[^/]+)/", "9 logs of 3 vehicles, whose sensors are not named", ""),
        ("logs/v0/(?P<serial>s0)/", "9 logs of 1 sensor", "The sensor of 4 logs is not known"),
    ],
)
def test_sensors_and_vehicles_are_counted_alike(imuwb, loop, tmp_path, monkeypatch, group, about, said):
    monkeypatch.chdir(loop)
    listed = imuwb("fleet", "list", "logs", "--group", group)
    done = imuwb("fleet", "mean.py", "logs", "-o", tmp_path / "counted", "--group", group, "--workers", "0")
    for text in (listed.out, done.err):
        whole = " ".join(text.split())
        assert about in whole, text
        assert said in whole, text
        assert bool(said) or "not known" not in whole, text


def test_a_store_and_a_cluster_give_the_tables_of_the_loop(loop, bucket, imuwb, monkeypatch):
    distributed = pytest.importorskip("distributed", reason="distributed is not installed")
    assert distributed
    monkeypatch.setattr("imuwb.fleet.dask_cluster.CONNECTING", PATIENCE)
    monkeypatch.chdir(loop)
    for path in Path("logs").rglob("*.csv"):
        bucket.put(path.as_posix(), path.read_bytes())
    given = (
        "fleet",
        "mean.py",
        "s3://logs/logs/**/*.csv",
        "--group",
        r"logs/logs/(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/[^/]*$",
    )
    assert imuwb(*given, "-o", "store", "--workers", "0").code == 0
    with cluster(loop) as address:
        done = imuwb(*given, "-o", "s3://logs/results/", "--scheduler", address)
        assert (done.code, address in done.err) == (0, True), done.err
        assert "nothing was left" in imuwb(*given, "-o", "s3://logs/results/", "--scheduler", address).err
        assert imuwb("fleet", "mean.py", "hangs", "-o", "hung", "--scheduler", address, *SHORT).code == 1
    assert [row["kind"] for row in rows("hung", "quarantine")] == ["time"]
    import obstore
    from obstore.store import S3Store

    store = S3Store("logs", client_options={"allow_http": True})
    kept = {name: bytes(obstore.get(store, f"results/{name}.parquet").bytes()) for name in TABLES}
    assert kept == tables("store")
    for name in ("sensors", "outages"):
        assert kept[name] == tables("loop")[name]


def address_in(file):
    """Return the address of the scheduler that writes a file, when the file is whole."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with suppress(OSError, ValueError):
            return json.loads(file.read_text())["address"]
        time.sleep(0.05)
    raise TimeoutError(file)


@contextmanager
def cluster(folder):
    """Run a scheduler of Dask and a worker with two threads in processes of their own, and yield its address."""
    file, running = folder / "scheduler.json", []

    def start(module, *arguments):
        command = [
            sys.executable,
            "-m",
            f"distributed.cli.{module}",
            "--no-dashboard",
            *arguments,
        ]
        running.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder))

    start("dask_scheduler", "--scheduler-file", str(file), "--port", "0", "--host", "127.0.0.1")
    try:
        address = address_in(file)
        start("dask_worker", address, "--nthreads", "2", "--no-nanny", "--memory-limit", "0")
        yield address
    finally:
        for process in running:
            process.kill()
            process.wait(20)

"""Whatever happens to a log's bytes, reading it ends soon, in a sound log or in an error of ours.

Small logs of every format, and the samples, are cut at random places and have random bits flipped, from fixed seeds. One
process of its own reads them all, with little memory to take; it also asks an MCAP for ``describe``, as ``imuwb info`` does.
A part of the damage by default, about 15 s; with ``IMUWB_FULL_FUZZ=1`` 200 cuts and 3 x 200 flips of each file, some minutes.

One case again: ``damaged(data, name, kind, number)``; the list of what went wrong names all three.
"""

import faulthandler
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import time
import traceback
import warnings
import zlib
from pathlib import Path

import numpy as np
import pytest

from imuwb.errors import ImuwbError
from imuwb.log import GnssStream, ImuStream, Log, Provenance, Triad
from imuwb.readers import describe, read
from imuwb.summary import summarize
from imuwb.writers import write

from . import binary_corpus

pytestmark = pytest.mark.slow

FULL = os.environ.get("IMUWB_FULL_FUZZ", "0") not in ("", "0")
ROOT = Path(__file__).resolve().parents[2]
KINDS = {"cut": 0, "1 bit": 1, "20 bits": 20, "1000 bits": 1000}  #: and how many bits are flipped
EACH = (
    dict.fromkeys(KINDS, 200) if FULL else {"cut": 12, "1 bit": 6, "20 bits": 5, "1000 bits": 3}
)  # tests/fuzz reads many more
SAMPLE_EACH = EACH if FULL else dict.fromkeys(KINDS, 3)  #: of a file that takes longer
LONGEST = 5.0  #: s
HANG = 60  #: s, after which a reader that does not end is shown and killed
MOST = 1 << 30  #: bytes above what the process holds when the first damaged file is opened
T = 1_714_564_800 * 10**9  #: ns
TEXT = (".csv", ".gz", ".log", ".pos")  #: logs whose last number may be cut where nobody can see it
TELLING = (".mcap", ".db3")  #: logs that know how long they are: rows that are cut away are told
ROWS = 12  #: that fit into a page of a database
CORPUS = (
    "zstd.mcap", "lz4.mcap", "unchunked.mcap", "json.mcap", "lz4.bag", "plain.bag", "drive.db3", "flight.tlog", "flight.bin",
    "flight.log", "flight.ulg", "imu.csv", "imu.csv.gz", "fixes.csv", "fixes.pos", *binary_corpus.NAMES,
)  # fmt: skip
SAMPLES = tuple(sorted(path.name for path in (ROOT / "samples").iterdir() if path.suffix != ".ipynb"))


# The logs


@pytest.fixture(scope="module")
def corpus(tmp_path_factory, mcap, ros):
    """Return the folder of the undamaged logs, and those that cannot be written here with the reason."""
    folder = tmp_path_factory.mktemp("corpus")
    for path in (ROOT / "samples").iterdir():
        shutil.copy(path, folder / path.name)
    for make in (_mcaps, _bags, _database, _telemetry, _dataflash, _ulog):
        make(folder, mcap, ros)
    binary_corpus.write(folder)
    rng, count = np.random.default_rng(1), 300
    time = T + np.arange(count) * 10_000_000
    rate, force = (Triad(time, rng.normal(0, 0.1, (count, 3)) + mean) for mean in ((0, 0, 0), (0, 0, -9.8)))
    position = np.radians([47.3, 8.5, 0]) + rng.normal(0, 1e-6, (count, 3)) + (0, 0, 450)
    gnss = GnssStream("gnss", time, position, rng.normal(0, 1, (count, 3)), np.abs(position), None, np.full(count, 3))
    write(Log(Provenance("", "", "", 0), imus=(ImuStream("imu", rate, force),)), folder / "imu.csv")
    write(Log(Provenance("", "", "", 0), gnss=(gnss,)), folder / "fixes.csv")
    (folder / "imu.csv.gz").write_bytes(gzip.compress((folder / "imu.csv").read_bytes(), mtime=0))
    (folder / "fixes.pos").write_text(_positions(count), "utf-8")
    return folder


def _imu_values(i):
    return (i / 1000, 0.25, -0.5), (0.125, -0.25, 9.8 + i / 10_000)


def _mcaps(folder, mcap, ros):
    from mcap.writer import CompressionType

    imu = [(T + i * 10**7 + 777, ros.imu(T + i * 10**7, *_imu_values(i))) for i in range(300)]
    fix = []
    for i in range(15):
        seconds, rest = divmod(T + i * 2 * 10**8, 10**9)
        items = [("i", seconds), ("I", rest), ("str", "gps"), ("b", 0), ("H", 1), ("d", (47.3 + i * 1e-5, 8.5, 450.0))]
        covariance = ("d", (4.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 25.0))
        fix.append((T + i * 2 * 10**8 + 777, ros.encode([*items, covariance, ("B", 2)])))
    topics = mcap.Topic(imu), mcap.Topic(fix, "/fix", "sensor_msgs/msg/NavSatFix", ros.fix_2)
    text = []
    for i in range(300):
        rate, force = (dict(zip("xyz", values, strict=True)) for values in _imu_values(i))
        stamp = {"sec": T // 10**9 + i // 100, "nsec": i % 100 * 10**7}
        told = {"header": {"stamp": stamp, "frame_id": "imu"}, "angular_velocity": rate, "linear_acceleration": force}
        text.append((T + i * 10**7 + 777, json.dumps(told).encode()))
    spoken = mcap.Topic(text, "/imu", "sensor_msgs/Imu", "{}", "jsonschema", "json")
    for name, made, options in (
        ("zstd.mcap", topics, {"compression": CompressionType.ZSTD, "chunk_size": 8000}),
        ("lz4.mcap", topics, {"compression": CompressionType.LZ4, "chunk_size": 8000}),
        ("unchunked.mcap", topics, {"use_chunking": False}),
        ("json.mcap", (spoken,), {"use_chunking": False}),
    ):
        shutil.move(mcap.write(*made, **options), folder / name)


def _bags(folder, _mcap, ros):
    try:
        from .containers.bag_writer import Topic, write_bag
    except pytest.skip.Exception:
        return
    rows = [(T + i * 10**7, ros.imu(T + i * 10**7, *_imu_values(i), code=ros.ROS_1)) for i in range(300)]
    for compression, name in (("lz4", "lz4.bag"), ("none", "plain.bag")):
        write_bag(folder / name, Topic(rows), compression=compression, chunk=8000)


def _database(folder, _mcap, ros):
    try:
        from rosbags.rosbag2 import Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        return
    with Writer(folder / "recording", version=8) as writer:
        kind = "sensor_msgs/msg/Imu"
        to = writer.add_connection("/imu", kind, typestore=get_typestore(Stores.ROS2_HUMBLE))
        for i in range(300):
            writer.write(to, T + i * 10**7 + 777, ros.imu(T + i * 10**7, *_imu_values(i)))
    shutil.move(folder / "recording" / "recording.db3", folder / "drive.db3")
    shutil.rmtree(folder / "recording")


def _telemetry(folder, _mcap, _ros):
    try:
        from .flight.mavlink_writer import frame, record
    except pytest.skip.Exception:
        return
    records = []
    for i in range(300):
        boot, stamp = 5000 + 100 * i, T // 1000 + 100_000 * i
        place = {"lat": 473_977_420 + i, "lon": 85_455_940, "alt": 488_000}
        sent = [
            frame("SCALED_IMU", time_boot_ms=boot, xgyro=i + 1, zacc=-1000),
            frame("RAW_IMU", time_usec=1000 * boot, xgyro=i + 1, zacc=-1000, temperature=3000 + i, version=2 - i % 2),
            frame("ATTITUDE", time_boot_ms=boot, yaw=0.5, signed=True),
        ]
        if i % 5 == 0:
            sent += [
                frame("SYSTEM_TIME", time_unix_usec=stamp, time_boot_ms=boot),
                frame("GPS_RAW_INT", time_usec=1000 * boot, fix_type=3, vel=100, cog=9000, **place),
                frame("GLOBAL_POSITION_INT", time_boot_ms=boot, vx=100, **place),
            ]
        records += [record(stamp, one) for one in sent]
    (folder / "flight.tlog").write_bytes(b"".join(records))


def _dataflash(folder, _mcap, _ros):
    from .flight import dataflash_writer as ardupilot

    rows = ardupilot.flight(300)
    (folder / "flight.bin").write_bytes(ardupilot.binary(rows))
    (folder / "flight.log").write_bytes(ardupilot.text(rows))


def _ulog(folder, _mcap, _ros):
    from .flight import ulog_writer as px4

    rows = [{"timestamp": px4.START + 5000 * i, "timestamp_sample": px4.START + 5000 * i - 100, "device_id": 7,
             "temperature": 30 + i / 100, "x": i / 1000, "z": -9.8} for i in range(200)]  # fmt: skip
    raw = [
        {**rows[32 * i], "samples": 32, "dt": 125.0, "scale": 0.001, "x": range(32), "z": (-9800,) * 32}
        for i in range(6)
    ]
    more = (
        px4.topic("sensor_gyro", 5, px4.GYRO, rows), px4.topic("sensor_accel", 6, px4.ACCEL, rows),
        px4.topic("sensor_accel_fifo", 7, px4.FIFO, raw), px4.dropout(20),
    )  # fmt: skip
    (folder / "flight.ulg").write_bytes(px4.flight() + b"".join(more))


def _positions(count):
    header = "%  GPST latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"
    header += "    vn(m/s)    ve(m/s)    vu(m/s)      sdvn     sdve     sdvu    sdvne    sdveu    sdvun"
    rows = ["% program   : RTKPOST", header]
    for i in range(count):
        when = f"2024/05/01 12:{i // 240:02d}:{i / 4 % 60:06.3f}"
        rows.append(
            f"{when} {47.5 + i * 1e-6:.9f} -122.250000000 {101.5 + i / 100:.4f} {1 + i % 2} 9 0.0100 0.0200 0.0300 0.0 0.0 0.0 "
            f"1.00 5.0 {i / 100:.5f} 0.50000 -0.25000 0.01000 0.02000 0.03000 0.0 0.0 0.00000"
        )
    return "\n".join(rows) + "\n"


# The damage, and what is read of it


def damaged(data, name, kind, number):
    """Return a copy of a log's bytes, cut or with bits flipped, the same each time."""
    rng = np.random.default_rng([zlib.crc32(name.encode()), KINDS[kind], number])
    if kind == "cut":
        return data[: int(rng.integers(1, len(data)))]
    changed = np.frombuffer(data, np.uint8).copy()
    bits = rng.choice(8 * len(data), size=min(KINDS[kind], 4 * len(data)), replace=False)
    np.bitwise_xor.at(changed, bits // 8, (1 << bits % 8).astype(np.uint8))
    return changed.tobytes()


def streams(log):
    """Return {(name, kind): (time, values)} of all in a log, values as (n, count)."""
    found = {}
    for imu in log.imus:
        for kind in ("angular_rate", "specific_force", "temperature"):
            if (part := getattr(imu, kind)) is not None:
                found[imu.name, kind] = part.time, part.value.reshape(len(part), -1)
    for stream in (*log.gnss, *log.references):
        found[stream.name, type(stream).__name__] = stream.time, stream.position
    for speed in log.speeds:
        found[speed.name, "speed"] = speed.time, speed.value[:, None]
    return found


def unsound(log):
    """Return what is wrong with a log, whatever it was read from."""
    for (name, kind), (stamps, values) in streams(log).items():
        if not (np.diff(stamps) > 0).all():
            return f"{name} {kind}: time does not increase"
        there = ~np.isnan(values).all(axis=0)
        if not there.all() and not any(getattr(note, "id", "") == "axes_missing" for note in log.notes):
            return f"{name} {kind}: an axis is missing, and nothing says so"
        if not np.isfinite(values[:, there]).all() or len(values) != len(stamps):
            return f"{name} {kind}: values that are not finite"
    return ""


def no_prefix(part, whole, suffix):
    """Return why the rows of a cut log are not the first of the whole log's."""
    named = {}  # an IMU of two parts has the name of one, as long as the other is not there
    for (name, kind), rows in streams(whole).items():
        named |= {(one, kind): rows for one in (name, *name.split("+"))}
    told = part.notes or any(stream.origin.repairs for stream in (*part.imus, *part.gnss))
    for (name, kind), (stamps, values) in streams(part).items():
        if (name, kind) not in named:
            return f"{name} {kind} is not in the whole log"
        full_stamps, full = named[name, kind]
        if suffix in TELLING and len(stamps) < len(full_stamps) and not told:
            return f"{name} {kind}: {len(stamps)} rows of {len(full_stamps)}, and nothing says so"
        if suffix == ".db3":  # a page is filled from its end: what is lost of the last are its first rows
            kept = np.isin(full_stamps, stamps) | (np.arange(full_stamps.size) < len(stamps) - ROWS)
            full_stamps, full = full_stamps[kept], full[kept]
        # What tells the date may be cut away: times then count from elsewhere.
        shift = 0 if epoch(part) == epoch(whole) else stamps[0] - full_stamps[0]
        if len(stamps) > len(full_stamps) or not np.array_equal(stamps - shift, full_stamps[: len(stamps)]):
            return f"{name} {kind}: other times than the first of the whole log's"
        different = values != full[: len(stamps)]
        if suffix in TEXT and different[-1].sum() == 1:
            different[-1] = False  # half a number is one, too
        if different.any():
            return f"{name} {kind}: another value in row {int(np.argmax(different.any(axis=1)))} of {len(stamps)}"
    return ""


def epoch(log):
    return next((stream.origin.epoch for stream in (*log.imus, *log.gnss, *log.references)), "")


def judged(path, whole, kind):
    """Read a damaged log; return whether it was read, and what is wrong."""
    try:
        log = read(path)
    except ImuwbError as error:
        message = str(error)
        return False, "" if str(path) in message or "unit" in message or "column" in message else f"no path: {message}"
    told = summarize(log)
    if [s for s in told.streams if s.count < 1]:
        return True, "a stream without rows"
    wrong = unsound(log)
    if kind == "cut" and not wrong:
        wrong = no_prefix(log, whole, path.suffix)
    return True, wrong


def described(path):
    """Ask what an MCAP's index says, as ``imuwb info`` does; other logs are read for it."""
    try:
        if path.suffix == ".mcap":
            describe(path)
    except ImuwbError:
        return


def shown(error):
    """Return an exception, and where in our own code it came up."""
    places = [f for f in traceback.extract_tb(error.__traceback__) if f"imuwb{os.sep}" in f.filename]
    where = (
        f"{Path(places[-1].filename).name}, line {places[-1].lineno}, {places[-1].name}"
        if places
        else "nowhere of ours"
    )
    return f"{type(error).__name__}: {error} ({where})"


def held(field):
    """Return bytes that this process holds, as Linux tells; 0 elsewhere."""
    status = Path("/proc/self/status")
    lines = status.read_text("utf-8").splitlines() if status.exists() else []
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith(field)), 0)


def survey(folder, *names):
    """Damage logs of a folder and read each; print a line of JSON for every one. This runs in a process of its own."""
    warnings.simplefilter("error")
    folder = Path(folder)
    wholes = {name: read(folder / name) for name in names if name != "README.md"}
    for name, whole in wholes.items():
        summarize(whole)
        describe(folder / name)
    before = held("VmData:")
    if before:
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (before + MOST, before + MOST))
    for name in names:
        data = (folder / name).read_bytes()
        result = {"name": name, "read": 0, "refused": 0, "slowest": 0.0, "wrong": []}
        for kind, count in (SAMPLE_EACH if name in SAMPLES else EACH).items():
            for number in range(count):
                path = folder / f"damaged-{name}"
                path.write_bytes(damaged(data, name, kind, number))
                (folder / "now").write_text(f"{kind}\n{number}", "utf-8")  # known also when this process is killed
                faulthandler.dump_traceback_later(HANG, exit=True)
                begin = time.perf_counter()
                try:
                    done, wrong = judged(path, wholes.get(name), kind)
                    described(path)
                except Exception as error:  # noqa: BLE001 - none may come
                    done, wrong = False, shown(error)
                spent = time.perf_counter() - begin
                faulthandler.cancel_dump_traceback_later()
                result["read" if done else "refused"] += 1
                result["slowest"] = max(result["slowest"], spent)
                if spent > LONGEST:
                    wrong = f"{wrong} {spent:.1f} s"
                if wrong:
                    result["wrong"].append([kind, number, wrong])
        result["peak"] = held("VmHWM:")
        print(json.dumps(result), flush=True)


@pytest.fixture(scope="module")
def surveyed(corpus):
    """Return what came of every damaged log, by the log's name."""
    command = [sys.executable, "-c", "import sys; from tests.readers.test_damage import survey; survey(*sys.argv[1:])"]
    found, left = {}, [name for name in (*CORPUS, *SAMPLES) if (corpus / name).exists()]
    while left:
        done = subprocess.run([*command, corpus, *left], cwd=ROOT, capture_output=True, text=True, check=False)
        found |= {result["name"]: result for result in map(json.loads, done.stdout.splitlines())}
        left = [name for name in left if name not in found]
        if left:  # the process was killed, or died, over this one
            kind, number = (corpus / "now").read_text("utf-8").splitlines()
            told = "\n".join(line[:200] for line in done.stderr.splitlines()[-30:])
            found[left[0]] = {"name": left[0], "wrong": [[kind, number, f"exit code {done.returncode}: {told}"]]}
            left = left[1:]
    return found


@pytest.mark.parametrize("name", [*CORPUS, *SAMPLES])
def test_no_damage_is_more_than_an_error_of_ours(surveyed, corpus, name):
    if not (corpus / name).exists():
        pytest.skip("what writes such logs is not installed")
    found = surveyed[name]
    print({key: found[key] for key in found if key != "wrong"})
    alike = {}
    for kind, number, why in found["wrong"]:
        alike.setdefault(re.sub(r"-?\d+", "N", why), []).append(f"{name}, {kind}, number {number}: {why}")
    assert not alike, "\n".join(f"{len(cases)} x such as {cases[0]}" for cases in alike.values())
    if name != "README.md":
        assert found["read"] > 0


def test_damage_is_the_same_each_time():
    data = bytes(range(256)) * 20
    for kind, bits in KINDS.items():
        one, again, other = (damaged(data, "log", kind, number) for number in (3, 3, 4))
        assert one == again != other
        if bits:
            assert int.from_bytes(one, "big") ^ int.from_bytes(data, "big") != 0
            assert (int.from_bytes(one, "big") ^ int.from_bytes(data, "big")).bit_count() == bits

"""Measure the speed and memory of reading logs: ``imuwb.read`` against named peers, on the same bytes.

* mcap: a million sensor_msgs/Imu messages in a zstd MCAP written by imuwb, against the decoder of mcap-ros2-support.
* tlog: a million MAVLink 2 frames of ten kinds, against pymavlink's mavutil.
* bin: a million ArduPilot records of seven kinds, against pymavlink's DFReader.
* table: a text log of 287,000 rows of seven columns, in a process that has imported nothing but ``imuwb.readers``, and again in it.
* csv: a text log of 1 GB through ``imuwb.readers.stream``, with the largest resident memory.
* info: ``imuwb info`` of an indexed MCAP of 1 GB, wall clock of the process from its start to its end.

A peer reads the beginning of the same log from a file of its own; its figure is messages per CPU second of that file. The numbers
that the peer and imuwb read from that file are compared one by one. Figures are CPU seconds (``time.process_time``: all threads, and
imuwb also hashes the file), the least of three runs. Logs are written in one process and read in another. Files are in the system's
cache, and compiled code is in numba's cache.

Command: ``python tests/benchmarks/read_speed.py [mcap] [tlog] [bin] [table] [csv] [info]`` (all parts: two minutes, and 1 GB in the
temporary folder; needs ``pip install -e ".[bench,test]"``). Seed: 0.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from measure import RUNS, resident, timed, versions
from telemetry_frames import FRAMES, START, frames_of, mavlink_dialect

MESSAGES, RATE = 1_000_000, 100.0
SUBSET = {"mcap": 50_000, "tlog": 100_000, "bin": 100_000}  #: number of messages for the peer
GIGABYTE = 10**9
TABLE_ROWS = 287_000
PACKAGES = ("imuwb", "numpy", "numba", "pyarrow", "mcap", "mcap-ros2-support", "pymavlink", "zstandard")


def main():
    """Write and read the logs of every part, each in a process of its own, and print the table."""
    parser = argparse.ArgumentParser(description="Measure the speed and memory of reading logs.")
    parser.add_argument(
        "parts", nargs="*", metavar="PART", help=f"Parts to measure: {', '.join(PARTS)} (default: all)."
    )
    parser.add_argument("--step", choices=("write", "read", "memory"), help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"unknown part {', '.join(sorted(unknown))}; the parts are {', '.join(PARTS)}")
    if options.step:
        print(json.dumps(PARTS[options.parts[0]][options.step](options.folder)))
        return
    rows = []
    for part in options.parts or PARTS:
        with tempfile.TemporaryDirectory() as folder:
            for step in PARTS[part]:
                print(f"{part}: {step} ...", file=sys.stderr)
                # A process inherits its parent's largest memory, so this process stays small.
                command = [sys.executable, __file__, part, "--step", step, "--folder", folder]
                ended = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
                rows += json.loads(ended.stdout)
    print(f"{versions(*PACKAGES)}\n")
    print("| measured | time or memory | messages per CPU second | goal |\n| --- | --- | --- | --- |")
    print("\n".join(f"| {' | '.join(row)} |" for row in rows))


def compared(long, short, peer, *, name, part, least, ratio):
    """Return the rows that compare imuwb on both files with a peer on the short file, and the short file as imuwb and the peer read it."""
    import imuwb

    ours, _ = timed(lambda: imuwb.read(long))
    ours_short, read = timed(lambda: imuwb.read(short))
    theirs, rows = timed(peer)
    count, mine, other = SUBSET[part], MESSAGES / ours, SUBSET[part] / theirs
    return [
        (f"{part}: imuwb.read, {MESSAGES:,} messages, {long.stat().st_size / 1e6:.0f} MB", f"{ours:.2f} s", f"{mine:,.0f}", f"at least {least:,}"),
        (f"  imuwb.read, {count:,} messages", f"{ours_short:.3f} s", f"{count / ours_short:,.0f}", ""),
        (f"  {name}, {count:,} messages", f"{theirs:.2f} s", f"{other:,.0f}", ""),
        (f"  **imuwb / {name}**", "", f"**{mine / other:.0f}**", f"at least {ratio}"),
    ], read, rows  # fmt: skip


# MCAP


def write_mcap(folder):
    """Write a million messages, and the first of them in a file of their own."""
    from dataclasses import replace

    import imuwb
    from imuwb.simulation import preset, static
    from imuwb.writers import write

    long = folder / "long.mcap"
    log = static(preset("3dm-gx3-25"), MESSAGES / RATE, RATE, 0)
    log = replace(log, imus=tuple(replace(imu, temperature=None) for imu in log.imus))
    spent, _ = timed(lambda: write(log, long))
    write(imuwb.select(log, end=f"{(SUBSET['mcap'] - 0.5) / RATE}"), folder / "short.mcap")
    return [(f"mcap: imuwb's writer, {MESSAGES:,} messages", f"{spent:.2f} s", f"{MESSAGES / spent:,.0f}", "")]


def read_mcap(folder):
    """Read both files; mcap-ros2-support reads the short one."""
    from mcap_ros2.reader import read_ros2_messages

    def peer():
        rows = []
        for message in read_ros2_messages(folder / "short.mcap"):
            imu = message.ros_msg
            rate, force, stamp = imu.angular_velocity, imu.linear_acceleration, imu.header.stamp
            rows.append((stamp.sec, stamp.nanosec, rate.x, rate.y, rate.z, force.x, force.y, force.z))
        return rows

    rows, log, theirs = compared(
        folder / "long.mcap", folder / "short.mcap", peer, name="mcap_ros2", part="mcap", least=1_500_000, ratio=60
    )
    columns = np.array(theirs).T
    (imu,) = log.imus
    assert np.array_equal(imu.angular_rate.time, columns[0].astype(np.int64) * 10**9 + columns[1].astype(np.int64))
    assert np.array_equal(imu.angular_rate.value * (1, -1, -1), columns[2:5].T)
    assert np.array_equal(imu.specific_force.value * (1, -1, -1), columns[5:].T)
    return rows


def mcap_memory(folder):
    """Return the row of the memory that a process needs to read the long file, above the arrays of the log."""
    import imuwb

    imuwb.read(folder / "short.mcap")
    before = resident()
    log = imuwb.read(folder / "long.mcap")
    grown = resident() - before
    parts = [part for imu in log.imus for part in (imu.angular_rate, imu.specific_force)]
    assert len(parts[0]) == MESSAGES
    arrays = {array.__array_interface__["data"][0]: array.nbytes for p in parts for array in (p.time, p.value)}
    kept = sum(arrays.values())
    return [
        (f"  memory above its arrays of {kept / 1e6:.0f} MB", f"{(grown - kept) / 1e6:.0f} MB", "", "at most 200 MB")
    ]


# Telemetry


def write_tlog(folder):
    """Write frames: pymavlink packs one frame of each kind, and the times, counts and checksums of its copies are set by column."""
    count, rng = MESSAGES // len(FRAMES), np.random.default_rng(0)
    boot = 5_000_000 + 100_000 * np.arange(count)  # µs
    columns = [frames_of(name, clock, unit, boot, rng) for name, clock, unit in FRAMES]
    cycles = np.concatenate(columns, axis=1)
    (folder / "long.tlog").write_bytes(cycles.tobytes())
    (folder / "short.tlog").write_bytes(cycles[: SUBSET["tlog"] // len(FRAMES)].tobytes())
    return []


def read_tlog(folder):
    """Read both files; pymavlink reads the short one."""
    mavlink_dialect()
    from pymavlink import mavutil

    mavutil.set_dialect("ardupilotmega")

    def peer():
        log, messages = mavutil.mavlink_connection(str(folder / "short.tlog")), []
        while (message := log.recv_msg()) is not None:
            messages.append(message)
        log.close()
        return messages

    rows, log, theirs = compared(
        folder / "long.tlog", folder / "short.tlog", peer, name="pymavlink", part="tlog", least=400_000, ratio=15
    )
    by_kind = {}
    for message in theirs:
        by_kind.setdefault(message.get_type(), []).append(message)
    assert sum(map(len, by_kind.values())) == SUBSET["tlog"]
    assert {name for name, _, _ in FRAMES} == set(by_kind)
    for imu in log.imus:
        messages = by_kind.pop(imu.name)
        for triad, sensor, unit in (
            (imu.angular_rate, "gyro", 1e-3), (imu.specific_force, "acc", 9.80665e-3),
        ):  # fmt: skip
            counts = [[getattr(m, f"{axis}{sensor}") for axis in "xyz"] for m in messages]
            np.testing.assert_allclose(triad.value, np.array(counts) * unit, rtol=1e-14)
            boot = [m.time_usec if imu.name == "RAW_IMU" else 1000 * m.time_boot_ms for m in messages]
            assert np.array_equal(triad.time // 1000 - START, boot)
    for stream, name in ((log.gnss[0], "GPS_RAW_INT"), (log.references[0], "GLOBAL_POSITION_INT")):
        place = np.array([(m.lat, m.lon, m.alt) for m in by_kind.pop(name)])
        np.testing.assert_allclose(np.degrees(stream.position[:, :2]), place[:, :2] * 1e-7, rtol=1e-14)
        np.testing.assert_allclose(stream.position[:, 2], place[:, 2] * 1e-3, rtol=1e-14)
    assert "RAW_IMU" not in by_kind
    return rows


# ArduPilot's logs

#: number, name, letters of the types, labels, records in a cycle
RECORDS = (
    (131, "IMU", "QBfffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T", 3),
    (132, "GPS", "QBBIHBcLLefff", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ", 1),
    (133, "GPA", "QBCCCC", "TimeUS,I,VDop,HAcc,VAcc,SAcc", 1),
    (134, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", 1),
    (135, "ATT", "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw", 2),
    (136, "BARO", "QBfff", "TimeUS,I,Alt,Press,Temp", 1),
    (137, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4", 1),
)
#: numpy's types of the letters
LETTERS = {
    "Q": "<u8", "B": "u1", "f": "<f4", "I": "<u4", "H": "<u2", "c": "<i2", "L": "<i4", "e": "<i4", "C": "<u2",
}  # fmt: skip
HEAD = b"\xa3\x95"


def write_bin(folder):
    """Write records, ten in a cycle; all fields except a few constants are set by column."""
    import struct

    cycle = np.dtype([
        (f"{name}{i}", [("head", "S2"), ("number", "u1"), *zip(labels.split(","), map(LETTERS.get, letters), strict=True)])
        for _, name, letters, labels, instances in RECORDS for i in range(instances)
    ])  # fmt: skip
    declared = b"".join(
        HEAD + struct.pack("<BBB4s16s64s", 128, number, 3 + sum(np.dtype(LETTERS[x]).itemsize for x in letters),
                           name.encode(), letters.encode(), labels.encode())
        for number, name, letters, labels, _ in ((128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 1), *RECORDS)
        if name != "FMT"
    )  # fmt: skip
    own = HEAD + struct.pack("<BBB4s16s64s", 128, 128, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")
    rng, count = np.random.default_rng(0), MESSAGES // len(cycle)
    rows, step = np.zeros(count, cycle), np.arange(count)
    for number, name, _, labels, instances in RECORDS:
        for i in range(instances):
            record = rows[f"{name}{i}"]
            record["head"], record["number"], record["TimeUS"] = HEAD, number, 5_000_000 + 40_000 * step + 7 * i
            for label in labels.split(",")[1:]:
                record[label] = i if label == "I" else rng.integers(0, 1000, count)
    gps, place = rows["GPS0"], rows["POS0"]
    gps["Status"], gps["GWk"], gps["GMS"] = 3, 2340, 100_000_000 + 40 * step
    for record in (gps, place):
        record["Lat"], record["Lng"] = 473_000_000 + step, 85_000_000 - step
    for i in range(3):
        for label in ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ", "T"):
            rows[f"IMU{i}"][label] = rng.normal({"AccZ": -9.8, "T": 30}.get(label, 0), 0.1, count)
    (folder / "long.bin").write_bytes(own + declared + rows.tobytes())
    (folder / "short.bin").write_bytes(own + declared + rows[: SUBSET["bin"] // len(cycle)].tobytes())
    return []


def read_bin(folder):
    """Read both files; pymavlink's DFReader reads the short one."""
    from pymavlink.DFReader import DFReader_binary

    def peer():
        log, by_kind = DFReader_binary(str(folder / "short.bin")), {}
        while (message := log.recv_msg()) is not None:
            by_kind.setdefault(message.get_type(), []).append(message)
        log.close()
        return by_kind

    rows, log, by_kind = compared(
        folder / "long.bin", folder / "short.bin", peer, name="DFReader", part="bin", least=800_000, ratio=8
    )
    assert sum(map(len, by_kind.values())) - len(by_kind["FMT"]) == SUBSET["bin"]
    assert [imu.name for imu in log.imus] == ["IMU.0", "IMU.1", "IMU.2"]
    for instance, imu in enumerate(log.imus):
        mine = [message for message in by_kind["IMU"] if instance == message.I]
        for triad, sensor in ((imu.angular_rate, "Gyr"), (imu.specific_force, "Acc")):
            assert triad.value.tolist() == [[getattr(m, f"{sensor}{axis}") for axis in "XYZ"] for m in mine]
            assert np.ptp(triad.time // 1000 - [m.TimeUS for m in mine]) == 0
        assert imu.temperature.value.tolist() == [m.T for m in mine]
    (gnss,) = log.gnss
    place = np.array([(m.Lat, m.Lng, m.Alt) for m in by_kind["GPS"]])
    np.testing.assert_allclose(gnss.position, np.column_stack([np.radians(place[:, :2]), place[:, 2]]), rtol=1e-14)
    return rows


# Text, and an MCAP with an index


def write_table(folder):
    """Write a text log of 287,000 rows."""
    rng = np.random.default_rng(0)
    values = rng.normal((0, 0, 0, 0, 0, -9.8), 0.1, (TABLE_ROWS, 6))
    names = ["time_ns", *(f"gyro_{axis}_rad_s" for axis in "xyz"), *(f"accel_{axis}_m_s2" for axis in "xyz")]
    lines = (f"{START * 1000 + 5_000_000 * i}," + ",".join(f"{x:.9f}" for x in row) for i, row in enumerate(values))
    (folder / "table.csv").write_text("\n".join([",".join(names), *lines, ""]), "utf-8")
    return []


def read_table(folder):
    """Return the CPU time of the first reading in a process, which imports what it needs, and of later ones."""
    path = folder / "table.csv"
    code = (
        "import sys, time\nimport imuwb.readers\nspent = []\nfor _ in range(4):\n    begin = time.process_time()\n"
        "    log = imuwb.readers.read(sys.argv[1])\n    spent.append(time.process_time() - begin)\n"
        "print(len(log.imus[0].angular_rate), spent[0], min(spent[1:]))"
    )
    runs = []
    for _ in range(RUNS):
        done = subprocess.run([sys.executable, "-c", code, path], check=True, stdout=subprocess.PIPE, text=True)
        rows, first, later = done.stdout.split()
        assert int(rows) == TABLE_ROWS
        runs.append((float(first), float(later)))
    first, later = (min(column) for column in zip(*runs, strict=True))
    title = f"table: imuwb.readers.read, {TABLE_ROWS:,} rows of 7 columns, {path.stat().st_size / 1e6:.0f} MB"
    return [
        (title, f"{later:.2f} s", f"{TABLE_ROWS / later:,.0f}", "at most 0.35 s"),
        ("  the first time in a process, with the imports of numpy, pyarrow and all else", f"{first:.2f} s", "", ""),
    ]  # fmt: skip


def write_csv(folder):
    """Write a text log of 1 GB, some rows at a time."""
    import pyarrow as pa
    from pyarrow import csv

    names = ["time_ns", *(f"gyro_{axis}_rad_s" for axis in "xyz"), *(f"accel_{axis}_m_s2" for axis in "xyz")]
    rng, block, row = np.random.default_rng(0), 1 << 18, 0
    options = csv.WriteOptions(include_header=False, quoting_style="none")
    with (folder / "long.csv").open("wb") as file:
        file.write((",".join(names) + "\n").encode())
        while file.tell() < GIGABYTE:
            stamps = START * 1000 + (row + np.arange(block)) * 10_000_000
            values = rng.normal(0, 0.1, (6, block))
            values[5] -= 9.8
            csv.write_csv(pa.table([stamps, *values], names=names), file, options)
            row += block
    (folder / "rows.txt").write_text(str(row), "utf-8")
    return []


def read_csv(folder):
    """Return the rows of streaming the text log, in a process that does nothing else."""
    from imuwb.readers import Batch, stream

    path = folder / "long.csv"

    def counted():
        rows = first = last = 0
        for part in stream(path):
            if isinstance(part, Batch):
                first = first or int(part.time[0])
                rows, last = rows + part.time.size, int(part.time[-1])
        return rows, first, last

    spent, (rows, first, last) = timed(counted)
    assert rows == int((folder / "rows.txt").read_text("utf-8")) == (last - first) // 10_000_000 + 1
    return [
        (f"csv: imuwb.readers.stream, {rows:,} rows, {path.stat().st_size / 1e6:.0f} MB", f"{spent:.1f} s", f"{rows / spent:,.0f}", ""),
        ("  largest memory of the process", f"{resident() / 1e6:.0f} MB", "", "at most 600 MB"),
    ]  # fmt: skip


def write_indexed(folder):
    """Write an indexed MCAP of 1 GB."""
    from imuwb.log import ImuStream, Log, Provenance, Triad
    from imuwb.writers import write

    def log(count):
        stamps = START * 1000 + np.arange(count) * 10_000_000
        rate, force = (Triad(stamps, rng.normal(0, 0.1, (count, 3))) for _ in range(2))
        return Log(Provenance("", "", "", 0), imus=(ImuStream("/imu", rate, force),))

    rng, probe, path = np.random.default_rng(0), 100_000, folder / "long.mcap"
    write(log(probe), path)
    write(log(int(1.01 * probe * GIGABYTE / path.stat().st_size)), path)
    return []


def read_indexed(folder):
    """Return the row of ``imuwb info`` on the command line."""
    path = folder / "long.mcap"
    size = path.stat().st_size
    assert size >= GIGABYTE
    with path.open("rb") as file:
        while file.read(1 << 24):
            pass
    spent = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        done = subprocess.run([sys.executable, "-m", "imuwb", "info", path], check=True, capture_output=True, text=True)
        spent.append(time.perf_counter() - begin)
    assert "/imu" in done.stdout
    return [(f"info: imuwb info, MCAP of {size / 1e6:.0f} MB, wall clock", f"{min(spent):.2f} s", "", "at most 1 s")]


PARTS = {
    "mcap": {"write": write_mcap, "read": read_mcap, "memory": mcap_memory},
    "tlog": {"write": write_tlog, "read": read_tlog},
    "bin": {"write": write_bin, "read": read_bin},
    "table": {"write": write_table, "read": read_table},
    "csv": {"write": write_csv, "read": read_csv},
    "info": {"write": write_indexed, "read": read_indexed},
}

if __name__ == "__main__":
    main()

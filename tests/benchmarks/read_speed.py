"""How fast are ROS 2 IMU messages read? ``imuwb.read`` against the decoder of mcap-ros2-support.

A million sensor_msgs/Imu messages in a zstd MCAP written by imuwb. mcap_ros2 reads the first 50 000 of
the same log, in a file of their own, and its figure is messages per CPU second of those. CPU seconds
(``time.process_time``: all threads, so imuwb's hashing of the file counts), least of three runs.

Command: ``python tests/benchmarks/read_speed.py`` (about a minute; needs ``pip install -e ".[bench,test]"``).
Seed: 0.
"""

from __future__ import annotations

import os
import platform
import tempfile
import time
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np
from mcap_ros2.reader import read_ros2_messages

import imuwb
from imuwb.simulation import preset, static
from imuwb.writers import write

MESSAGES, SUBSET, RATE, RUNS = 1_000_000, 50_000, 100.0, 3


def main():
    """Write both files, read both, print the table."""
    with tempfile.TemporaryDirectory() as folder:
        long, short = Path(folder) / "long.mcap", Path(folder) / "short.mcap"
        log = static(preset("3dm-gx3-25"), MESSAGES / RATE, RATE, 0)
        log = replace(log, imus=tuple(replace(imu, temperature=None) for imu in log.imus))
        spent, _ = cpu(lambda: write(log, long), 1)
        write(imuwb.select(imuwb.read(long), end=f"{(SUBSET - 0.5) / RATE}"), short)
        ours, read = cpu(lambda: imuwb.read(long))
        ours_short, part = cpu(lambda: imuwb.read(short))
        theirs, rows = cpu(lambda: by_mcap_ros2(short), 1)
        megabytes = long.stat().st_size / 1e6
    assert read.imus[0].angular_rate.time.size == MESSAGES
    assert np.array_equal(rows, np.column_stack([np.hstack([s.value * (1, -1, -1)]) for s in (part.imus[0].angular_rate, part.imus[0].specific_force)]))  # fmt: skip
    mine, other = MESSAGES / ours, len(rows) / theirs
    lines = [
        (f"imuwb.read, {MESSAGES:,} messages, {megabytes:.0f} MB", f"{ours:.2f} s", f"{mine:,.0f}"),
        (f"imuwb.read, {len(rows):,} messages", f"{ours_short:.3f} s", f"{len(rows) / ours_short:,.0f}"),
        (f"mcap_ros2, {len(rows):,} messages, six numbers of each", f"{theirs:.2f} s", f"{other:,.0f}"),
        ("**imuwb / mcap_ros2**", "", f"**{mine / other:.0f}**"),
        (f"imuwb's writer, {MESSAGES:,} messages", f"{spent:.2f} s", f"{MESSAGES / spent:,.0f}"),
    ]
    packages = ", ".join(f"{name} {version(name)}" for name in ("imuwb", "mcap", "mcap-ros2-support", "zstandard"))
    print(f"Python {platform.python_version()}, {packages}; {os.cpu_count()} processors\n")
    print("| what | CPU | messages per CPU second |\n| --- | --- | --- |")
    print("\n".join(f"| {a} | {b} | {c} |" for a, b, c in lines))


def cpu(work, runs=RUNS):
    """Return the least CPU time of some runs, and what the last returned."""
    spent, result = [], None
    for _ in range(runs):
        begin = time.process_time()
        result = work()
        spent.append(time.process_time() - begin)
    return min(spent), result


def by_mcap_ros2(path):
    """Return the rates and forces, a row for each message."""
    rows = []
    for message in read_ros2_messages(path):
        rate, force = message.ros_msg.angular_velocity, message.ros_msg.linear_acceleration
        rows.append((rate.x, rate.y, rate.z, force.x, force.y, force.z))
    return np.array(rows)


if __name__ == "__main__":
    main()

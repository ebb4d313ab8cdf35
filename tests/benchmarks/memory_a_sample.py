"""Measure the memory of a sample: long still records through ``info``, ``health``, ``allan`` and ``noise``, and a part through ``convert``.

A sample is a row of six axes, of 56 bytes in a ``Log``. The record is white noise and a random walk at 1 kHz, written piece by piece as
MCAP (zstd), so that the writer needs no memory. Every command runs in a process of its own, whose largest resident memory the system
gives; bytes a sample are this memory over the number of samples, with the program and its libraries (0.33 to 0.40 GB). Times are those
of the whole process, from its start to its end.

Command: ``python tests/benchmarks/memory_a_sample.py [--hours 4] [--folder DIR] [--log FILE] [COMMAND ...]`` (4 h: about ten minutes,
and 1.1 GB in the folder; 24 h: about half an hour, 6.7 GB, and 8 GB of memory). Seed: 0.
"""

# ruff: noqa: SLF001 - the record is written with the parts of imuwb's own writer, which is given a whole log otherwise

from __future__ import annotations

import argparse
import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from measure import versions

from imuwb.log import SECOND, ImuStream, Log, Origin, Provenance, Triad
from imuwb.writers import mcap_log
from imuwb.writers.ros_messages import stamped, topics

RATE = 1000
BLOCK = 12_000  #: samples of a chunk
START = 1_714_564_800 * SECOND
COMMANDS = {
    "info": ("info", "{log}", "--scan"),
    "health": ("health", "{log}", "-o", "{folder}/out.rrd", "--force"),
    "allan --no-estimators": ("allan", "{log}", "--no-estimators", "-o", "{folder}/out.rrd", "--force"),
    "allan": ("allan", "{log}", "-o", "{folder}/out.rrd", "--force"),
    "noise": ("noise", "{log}", "-o", "{folder}/out.rrd", "--force", "--save-model", "{folder}/out.toml"),
    "convert --end 60": ("convert", "{log}", "--end", "60", "-o", "{folder}/part.mcap", "--force"),
    "allan --start 3600 --end 3660": (
        "allan", "{log}", "--start", "3600", "--end", "3660", "-o", "{folder}/out.rrd", "--force",
    ),
}  # fmt: skip


def main():
    """Write the record unless it is given, run the commands on it, and print the table."""
    parser = argparse.ArgumentParser(description="Measure the memory of a sample.")
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=f"Any of: {', '.join(COMMANDS)} (default: all).")
    parser.add_argument("--hours", type=float, default=4.0, help="Length of the record (h).")
    parser.add_argument("--folder", type=Path, help="Folder for the record and the results.")
    parser.add_argument("--log", type=Path, help="A record that this script wrote; it is written if it is not there.")
    options = parser.parse_args()
    if unknown := set(options.commands) - set(COMMANDS):
        parser.error(f"unknown command {', '.join(sorted(unknown))}; the commands are {', '.join(COMMANDS)}")
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        log = options.log or Path(folder) / "long.mcap"
        samples = round(options.hours * 3600 * RATE)
        if not log.exists():
            write(log, samples)
        print(
            f"{versions('imuwb', 'numpy', 'scipy', 'numba')}; {samples:,} samples, {log.stat().st_size / 1e9:.2f} GB\n"
        )
        print("| command | wall clock | CPU time | largest memory | bytes a sample |\n| --- | --- | --- | --- | --- |")
        for name in options.commands or COMMANDS:
            wall, cpu, memory = run(name, log, folder)
            each = f"{memory / samples:.0f}" if "--end" not in name else "—"
            print(f"| `{name}` | {wall:.1f} s | {cpu:.1f} s | {memory / 1e6:.0f} MB | {each} |", flush=True)


def run(name, log, folder):
    """Return wall clock (s), CPU time (s) and largest resident memory (bytes) of a command."""
    command = [sys.executable, "-m", "imuwb", *(word.format(log=log, folder=folder) for word in COMMANDS[name])]
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status):
        raise SystemExit(f"{' '.join(command)}: exit code {os.waitstatus_to_exitcode(status)}")
    # ru_maxrss is in kilobytes on Linux and in bytes on macOS.
    memory = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return time.monotonic() - begin, usage.ru_utime + usage.ru_stime, memory


def write(path, samples):
    """Write a still record, chunk by chunk."""
    rng, walk = np.random.default_rng(0), np.zeros(6)
    index = mcap_log._Index()
    with path.open("wb") as file:
        file.write(mcap_log.MAGIC + mcap_log._record(mcap_log.HEADER, mcap_log._text("ros2") + mcap_log._text("")))
        declared = b""
        for first in range(0, samples, BLOCK):
            count = min(BLOCK, samples - first)
            steps = walk + np.cumsum(rng.normal(0, 1e-7, (count, 6)), axis=0)
            walk = steps[-1]
            values = steps + rng.normal(0, [1e-3] * 3 + [1e-2] * 3, (count, 6))
            values[:, 5] -= 9.8
            time_ns = START + (first + np.arange(count)) * (SECOND // RATE)
            imu = ImuStream(
                "/imu", Triad(time_ns, values[:, :3]), Triad(time_ns, values[:, 3:]), origin=Origin(epoch="unix")
            )
            (topic,) = topics(Log(Provenance("", "mcap", "", 0), (imu,)))
            if not declared:
                declared = mcap_log._declarations([(topic.name, topic.schema)])
                file.write(declared)
            mcap_log._write_chunk(file, [stamped(topic, 1, slice(0, count), mcap_log.MESSAGE)], index)
        file.write(mcap_log._record(mcap_log.DATA_END, struct.pack("<I", 0)))
        mcap_log._write_summary(file, declared, index, 1)


if __name__ == "__main__":
    main()

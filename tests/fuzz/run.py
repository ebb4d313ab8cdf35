"""Reads many damaged logs: ``python -m tests.fuzz.run --logs 100000``; see README.md beside this file.

A fault is shown with its log and its seed; ``python -m tests.fuzz.run --case flight.ulg 1234 file`` writes that damaged log.
"""

import argparse
import tempfile
import time
from pathlib import Path

from .harness import BATCH, damage, tallied
from .seeds import write


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="", help="part of the names of the logs")
    parser.add_argument("--case", nargs=3, metavar=("NAME", "SEED", "FILE"))
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        logs = {name: data for name, data in write(Path(folder)).items() if given.only in name}
    if given.case:
        name, seed, file = given.case
        content, kind, options = damage(name, logs[name], int(seed))
        Path(file).write_bytes(content)
        print(kind, options)
        return
    began, done, faults, sound, spoilt, prefixes, slowest, largest = time.monotonic(), 0, 0, 0, 0, 0, 0.0, 0
    each = max(BATCH * given.workers // len(logs), 1)
    for first in range(given.first, given.first + given.logs // len(logs) + 1, each):
        tally = tallied(logs, range(first, first + each), workers=given.workers)
        done, faults, sound = done + tally.read.total(), faults + len(tally.faults), sound + tally.sound
        spoilt, prefixes = spoilt + tally.spoilt, prefixes + tally.prefixes
        slowest, largest = max(slowest, tally.slowest), max(largest, tally.largest)
        for name, seed, what in tally.faults:
            print(f"FAULT {name} {seed}: {what}", flush=True)
        print(
            f"{done} logs of {len(logs)} formats, {sound} read, {done - sound} refused, {spoilt} with a wrong checksum, {prefixes} cut, {faults} faults, "
            f"slowest {slowest:.2f} s, {largest >> 20} MB, {time.monotonic() - began:.0f} s", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()

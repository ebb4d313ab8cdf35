"""Parts that the benchmarks share: CPU time, memory, versions, and measurements in processes of their own."""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

RUNS = 3


def timed(work, runs=RUNS):
    """Return the least CPU time (s, all threads) of some runs, and the result of the last run."""
    spent, result = [], None
    for _ in range(runs):
        result = None  # frees the last result, so that two results never stand in memory at once
        begin = time.process_time()
        result = work()
        spent.append(time.process_time() - begin)
    return min(spent), result


def cpu(work, runs=RUNS):
    """Return the least CPU time (s, all threads) of some runs."""
    return timed(work, runs)[0]


def resident():
    """Return the largest resident memory of this process so far, bytes."""
    # ru_maxrss is in kilobytes on Linux and in bytes on macOS.
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def versions(*packages):
    """Return a line with the versions of Python and of the installed packages, and the number of processors."""
    installed = ", ".join(filter(None, map(_installed, packages)))
    return f"Python {platform.python_version()}, {installed}; {os.cpu_count()} processors"


def _installed(package):
    try:
        return f"{package} {version(package)}"
    except PackageNotFoundError:
        return None


def run_parts(script, description, parts, simulated, table, *, empty_cache=False):
    """Measure each part on the same samples in a process of its own, and print the table of all figures.

    A script calls this function, and so does each process that the function starts.

    Args:
        script: path of the script.
        description: for --help.
        parts: {name: function of the samples that returns the figures of a part}.
        simulated: a function that returns the samples.
        table: a function that returns the Markdown table from {name: figures}.
        empty_cache: whether the first part finds an empty cache of compiled code; the next parts find a filled one.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--part", choices=("simulate", *parts), help=argparse.SUPPRESS)
    parser.add_argument("--samples", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.part == "simulate":
        np.save(options.samples, simulated())
    elif options.part:
        print(json.dumps(parts[options.part](np.load(options.samples))))
    else:
        with tempfile.TemporaryDirectory() as folder:
            print(table(_figures(script, parts, Path(folder), empty_cache)))


def _figures(script, parts, folder, empty_cache):
    """Return {part: figures}; a process inherits its parent's largest memory, so this process stays small."""
    samples, figures = str(folder / "samples.npy"), {}
    environment = {**os.environ, **({"NUMBA_CACHE_DIR": str(folder / "numba")} if empty_cache else {})}
    subprocess.run([sys.executable, script, "--part", "simulate", "--samples", samples], check=True)
    for part in parts:
        print(f"{part} ...", file=sys.stderr)
        command = [sys.executable, script, "--part", part, "--samples", samples]
        ended = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
        figures[part] = json.loads(ended.stdout)
    return figures

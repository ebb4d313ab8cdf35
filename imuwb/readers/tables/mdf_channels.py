"""The channels of an MDF file that have a known name, by their groups, each with the time of its group.

asammdf reads them in a process of its own (``mdf_export``): its compiled parts end the process at some damaged files.
"""

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Remark, unused
from imuwb.readers.bytes import budget
from imuwb.readers.tables.named_arrays import Tree
from imuwb.readers.tables.packed import refuse_packed
from imuwb.units import SECOND

MOST_NAMES = 40  #: channels that are named one by one
LONGEST, SLOWEST = 60.0, 1e5  #: s, and bytes each s; a reading that takes longer does not end


def channels(path: Path) -> tuple[Tree, list[Remark]]:
    """Return the channels of known quantities, {group: {name with unit: samples}}, and remarks on the others.

    Raises:
        UnreadableLogError: asammdf is not installed, or the file is damaged.
    """
    if importlib.util.find_spec("asammdf") is None:
        raise UnreadableLogError(
            f'{path}: an MDF file needs asammdf, which is not installed: pip install "imuwb[mdf]"; or save the channels as CSV or Parquet'
        )
    refuse_packed(path)
    memory = budget.current().most * budget.SHARES / 1e9
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-P", "-m", "imuwb.readers.tables.mdf_export", str(path), folder, f"{memory:g}"]
        longest = LONGEST + path.stat().st_size / SLOWEST
        try:
            environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
            subprocess.run(command, capture_output=True, check=False, timeout=longest, env=environment)  # noqa: S603 - our own module
        except subprocess.TimeoutExpired as error:
            raise UnreadableLogError(
                f"{path}: asammdf does not end within {longest:.0f} s; the file is damaged"
            ) from error
        index = Path(folder) / "index.json"
        told: dict[str, Any] = (
            json.loads(index.read_text("utf-8")) if index.exists() else {"error": "asammdf ended early"}
        )
        if "error" in told:
            raise UnreadableLogError(
                f"{path}: the MDF file cannot be read ({told['error']}); it is cut or damaged: copy it again"
            )
        names = [Path(folder) / f"{number}.npy" for number in range(told["arrays"])]
        budget.check(sum(name.stat().st_size for name in names), "its channels")
        arrays = [np.load(name, allow_pickle=False) for name in names]
    groups = {
        group: {name: arrays[number] for name, number in names.items()} for group, names in told["groups"].items()
    }
    tree = {group: dict(_dated(found, told["start"])) for group, found in groups.items()}
    return tree, list(_remarks(told))


def _remarks(told: dict[str, Any]) -> Iterator[Remark]:
    if told["start"] is None:
        yield Remark(Note("no_date", "the file states no time zone of its start; times count from the start"))
    if others := told["others"]:
        more = f", and {len(others) - MOST_NAMES} more" if len(others) > MOST_NAMES else ""
        yield unused(others[:MOST_NAMES], f"channels{more} of no quantity that imuwb uses")


def _dated(found: dict[str, Any], start: int | None) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of a group, the times in ns since 1970 if the start is known."""
    for name, array in found.items():
        if name == "time_s" and start is not None:
            with np.errstate(invalid="ignore"):
                seconds = np.where(np.abs(array) < 2**31, array, 0.0)
            yield "time_ns", start + np.rint(seconds * SECOND).astype(np.int64)
        else:
            yield name, array

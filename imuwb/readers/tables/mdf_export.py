"""Writes the channels of an MDF file that have a known name into a folder: ``python -m imuwb.readers.tables.mdf_export LOG FOLDER GB``.

The folder then has an array for each channel, 0.npy and so on, and index.json: ``start`` (ns since 1970, or null), ``groups``
({group: {name with unit: number of the array}}), ``others`` (names of channels that are not read), or ``error``.
"""

import json
import logging
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from imuwb.errors import UsageError
from imuwb.readers.bytes.budget import Budget, under
from imuwb.readers.bytes.memory_limit import limited
from imuwb.readers.text.column_names import columns as known_columns
from imuwb.readers.text.column_names import with_units
from imuwb.units import unix_nanoseconds


def main(log: str, folder: Path, memory: float) -> None:
    """Write the channels, or the error; ``memory``: GB that the process may take."""
    import asammdf  # noqa: PLC0415 - an extra, which takes three seconds

    logging.disable(logging.CRITICAL)  # what is wrong with a file comes as an exception, too
    try:
        told = under(Budget(memory=memory), lambda: _opened(asammdf, log, folder))
    except Exception as error:  # noqa: BLE001 - asammdf raises whatever its own parts do at damaged bytes
        told = {"error": (str(error).splitlines() or [type(error).__name__])[0][:120]}
    (folder / "index.json").write_text(json.dumps(told), "utf-8")


def _opened(asammdf: Any, log: str, folder: Path) -> dict[str, Any]:  # noqa: ANN401 - of a library without types
    with limited(), asammdf.MDF(log) as file:
        return _exported(file, folder)


def _exported(file: Any, folder: Path) -> dict[str, Any]:  # noqa: ANN401 - of a library without types
    begin = file.start_time
    start = unix_nanoseconds(begin) if begin is not None and begin.tzinfo is not None else None
    groups: dict[str, dict[str, int]] = {}
    others: list[str] = []
    count = 0
    for index, group in enumerate(file.groups):
        master, found = file.masters_db.get(index), dict[str, int]()
        wanted = _known([_shown(str(channel.name), str(channel.unit or "")) for channel in group.channels])
        for number, channel in enumerate(group.channels):
            name = str(channel.name)
            if number == master:
                continue
            signal = file.get(group=index, index=number) if master is not None and number in wanted else None
            if signal is None or signal.samples.ndim != 1 or signal.samples.dtype.kind not in "fiu":
                others.append(name)
                continue
            for shown, samples in (
                ("time_s", signal.timestamps),
                (_shown(name, str(signal.unit or "")), signal.samples),
            ):
                if shown not in found:
                    np.save(folder / f"{count}.npy", samples)
                    found[shown], count = count, count + 1
        if found:
            groups[_name(group, index, groups)] = found
    return {"start": start, "groups": groups, "others": others, "arrays": count}


def _name(group: Any, index: int, taken: dict[str, Any]) -> str:  # noqa: ANN401 - of a library without types
    name = str(getattr(group.channel_group, "acq_name", "") or "").strip()
    return name if name and name not in taken else f"{name or 'group'} {index}"


def _shown(name: str, measure: str) -> str:
    return f"{name} [{measure}]" if measure and next(with_units(name))[1] is None else name


def _known(names: list[str]) -> set[int]:
    """Return the places of the names that mean a quantity."""
    try:
        found = known_columns(tuple(names), {})
    except UsageError:  # two of one meaning
        found = tuple(replace(c, index=i) for i, name in enumerate(names) for c in known_columns((name,), {}))
    return {column.index for column in found if column.quantity != "time"}


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]))

"""ArduPilot's high-rate batches (ISBH, ISBD): samples of one sensor at its full rate, for a short time.

The head of a batch states its sensor, its rate, its scale and the time of its first sample; 32 samples come in a record of data.
The number N of a batch has 16 bits and begins again at 0, so a batch is found by its number and its time. Source: ArduPilot,
``libraries/AP_InertialSensor/BatchSampler.cpp`` and ``LogStructure.h``.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Integers
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.units import SECOND

Columns = Mapping[str, NDArray[Any]]

SIZE = 32  #: samples in a record of data
KINDS = {0: "specific_force", 1: "angular_rate"}  #: by the field ``type``
SLOWEST, FASTEST = 1.0, 1e6  #: Hz; a rate outside is damage
LATE = 60_000_000  #: µs; the head is written right after the first samples, so another difference is damage
LATEST = 2**53  #: µs; a later time is damage
HEAD = ("N", "type", "instance", "mul", "smp_cnt", "SampleUS", "smp_rate")


def high_rate(heads: Columns, data: Columns, offset: int, origin: Origin, size: int) -> Iterator[Batch | Remark]:
    """Yield the batches, and remarks on those that are cut or whose head is impossible.

    Args:
        heads: columns of ISBH.
        data: columns of ISBD.
        offset: ns, Unix time less the time since power-up; 0 if it is unknown.
        origin: units, frame and clock.
        size: bytes of the file.
    """
    if not _is_whole(heads, data):
        return
    fields = {name: heads[name].astype(np.float64) for name in (*HEAD, "TimeUS")}
    possible = _possible(fields)
    started, undated = _started(fields)
    rows = _rows_of_batches(heads, data)
    cut = 0
    dated = dict[str, int]()
    for i in np.flatnonzero(possible).tolist():
        own, rate = rows[i], float(fields["smp_rate"][i])
        count = own.size * SIZE
        if count != int(fields["smp_cnt"][i]) or (data["seqno"][own] != np.arange(own.size)).any():
            cut += 1
            continue
        samples = np.stack([data[axis][own] for axis in "xyz"], axis=-1).reshape(-1, 3)
        name = f"ISB.{int(fields['instance'][i])}"
        time = int(started[i] * 1000) + offset + np.rint(np.arange(count) * (SECOND / rate)).astype(np.int64)
        columns = {KINDS[int(fields["type"][i])]: samples / float(fields["mul"][i])}
        if undated[i]:
            dated[name] = dated.get(name, 0) + count
        yield Batch(name, "imu", time, columns, origin, size, exact=True)
    for name, count in dated.items():
        text = (
            "samples of high-rate batches whose own time is 0 or impossible: dated back from the record of their head"
        )
        yield Remark(Note("batch_time", text), name, count, "time")
    if cut:
        yield Remark(Note("cut_batch", f"{cut} incomplete high-rate batches left out"))
    if not possible.all():
        count = int(np.count_nonzero(~possible))
        text = f"{count} high-rate batches left out: their head states an impossible rate, scale, count or sensor"
        yield Remark(Note("impossible_batch", text))


def _is_whole(heads: Columns, data: Columns) -> bool:
    """Return whether the records of high-rate batches have all their fields."""
    nothing = np.empty((0, 0))
    if any(heads.get(key, nothing).ndim != 1 for key in (*HEAD, "TimeUS")):
        return False
    if any(data.get(key, nothing).ndim != 1 for key in ("N", "seqno", "TimeUS")):
        return False
    return all(data.get(axis, nothing).shape[1:] == (SIZE,) for axis in "xyz")


def _possible(heads: Columns) -> Booleans:
    """Return which heads state a sensor, a rate, a scale and a count that there can be."""
    possible = np.isin(heads["type"], list(KINDS)) & (heads["instance"] >= 0)
    for name, least, most in (("smp_rate", SLOWEST, FASTEST), ("mul", 1, np.inf), ("smp_cnt", 1, np.inf)):
        possible &= (heads[name] >= least) & (heads[name] <= most)
    return possible & (heads["TimeUS"] >= 0) & (heads["TimeUS"] < LATEST)


def _started(heads: Columns) -> tuple[NDArray[np.float64], Booleans]:
    """Return the time of each first sample (µs), and for which batches it is the head's time less the batch's length."""
    undated = ~((heads["SampleUS"] > 0) & (np.abs(heads["TimeUS"] - heads["SampleUS"]) < LATE))
    with np.errstate(divide="ignore", invalid="ignore"):
        # A head is written when the first record of data is full.
        back = heads["TimeUS"] - np.minimum(heads["smp_cnt"], SIZE) / heads["smp_rate"] * 1e6
    return np.where(undated, np.maximum(back, 0), heads["SampleUS"]), undated


def _rows_of_batches(heads: Columns, data: Columns) -> list[Integers]:
    """Return the rows of data of each head, in the order of their numbers: those after it, up to the next head of its number."""

    def keys(columns: Columns) -> Integers:
        time = np.nan_to_num(columns["TimeUS"].astype(np.float64)).clip(0, 2**46).astype(np.int64)
        return (np.nan_to_num(columns["N"]).astype(np.int64) << 46) + time

    head, body = keys(heads), keys(data)
    order = np.argsort(head, kind="stable")
    place = np.searchsorted(head[order], body, side="right") - 1
    of = np.where(place >= 0, order[place], -1)
    of[(place < 0) | (heads["N"][of] != data["N"])] = -1
    rows = np.lexsort((data["seqno"], of))
    edges = np.searchsorted(of[rows], np.arange(head.size + 1))
    return [rows[edges[i] : edges[i + 1]] for i in range(head.size)]

"""Leaves out the rows of receivers that state themselves that they have no fix: their positions are old, reckoned, or nothing."""

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.log import GnssStream, Repair
from imuwb.notes import Note

HIGHEST = 1000  #: fix type; a larger number is damage
NO_FIX = 1  #: fix type of such a row; 0: the type is not known


def fix_types(values: Floats) -> Integers:
    """Return fix types as whole numbers; 0, not known, for what is no number or far beyond any type."""
    known = np.isfinite(values) & (np.abs(values) <= HIGHEST)
    return np.where(known, values, 0.0).astype(np.int64)


def without_unfixed(streams: Sequence[GnssStream]) -> tuple[tuple[GnssStream, ...], list[Note]]:
    """Return receivers with those rows only that are fixes, as far as they state it, and notes on receivers without any."""
    kept: list[GnssStream] = []
    notes: list[Note] = []
    for gnss in streams:
        fixed = np.ones(len(gnss), bool) if gnss.fix_type is None else gnss.fix_type != NO_FIX
        lost = int(np.count_nonzero(~fixed))
        if lost == len(gnss) > 0:
            text = f"{gnss.name}: all {lost} rows state that the receiver has no fix; they are left out"
            notes.append(Note("no_fix", text))
        elif lost:
            repair = Repair(Note("no_fix", "rows that state that the receiver has no fix left out"), lost)
            kept.append(_taken(gnss, fixed, repair))
        else:
            kept.append(gnss)
    return tuple(kept), notes


def _taken(gnss: GnssStream, rows: Booleans, repair: Repair) -> GnssStream:
    """Return some rows of a receiver, and the repair with its others."""
    columns = {field.name: getattr(gnss, field.name) for field in fields(gnss)}
    some = {name: values[rows] for name, values in columns.items() if isinstance(values, np.ndarray)}
    kind = some.pop("fix_type")
    known = kind if kind.any() else None  # a flag says no more than whether there is a fix
    return replace(gnss, **some, fix_type=known, origin=replace(gnss.origin, repairs=(*gnss.origin.repairs, repair)))

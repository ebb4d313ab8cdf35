"""The units that a DataFlash log states for the fields of its records."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from imuwb.readers.flight.dataflash_tables import LAYOUT, Tables
from imuwb.readers.flight.dataflash_text import TextTables
from imuwb.units import UNITS

_SPELLINGS = {"m/s/s": "m/s²", "degC": "°C"}


def si_factors(tables: Tables | TextTables) -> dict[tuple[int, str], float]:
    """Return {(layout, field): factor to SI} of the fields whose unit the log states, where the factor is not 1."""
    stated, labels, multipliers = (tables.table(name) for name in ("FMTU", "UNIT", "MULT"))
    if isinstance(tables, TextTables) or stated is None or labels is None or multipliers is None:
        return {}  # a text log has its fields in SI
    if not _is_whole(stated, labels, multipliers):
        return {}
    names = {
        int(i): bytes(text).rstrip(b"\0").decode("ascii", "replace")
        for i, text in zip(labels["Id"], labels["Label"], strict=True)
    }
    scales = {int(i): float(x) for i, x in zip(multipliers["Id"], multipliers["Mult"], strict=True)}
    factors: dict[tuple[int, str], float] = {}
    for layout, units, letters in zip(stated[LAYOUT].tolist(), stated["UnitIds"], stated["MultIds"], strict=True):
        fields = tables.layouts[layout].fields if layout >= 0 else ()
        for field, unit, letter in zip(fields, units, letters, strict=False):
            # For a field whose type has a factor, the log states this factor again.
            scale = scales.get(int(letter), 0.0) if field.factor == 1 else 1.0
            label = names.get(int(unit), "")
            known = UNITS.get(_SPELLINGS.get(label, label))
            factors[layout, field.name] = (scale or 1.0) * (known.factor if known else 1.0)
    return {key: factor for key, factor in factors.items() if factor != 1}


def _is_whole(
    stated: Mapping[str, NDArray[Any]], labels: Mapping[str, NDArray[Any]], multipliers: Mapping[str, NDArray[Any]]
) -> bool:
    """Return whether the three records have their fields, in their shapes."""
    if not ({LAYOUT, "UnitIds", "MultIds"} <= stated.keys() and {"Id", "Label"} <= labels.keys()):
        return False
    if not {"Id", "Mult"} <= multipliers.keys():
        return False
    arrays = (stated["UnitIds"], stated["MultIds"], labels["Label"], multipliers["Mult"])
    return [array.ndim for array in arrays] == [2, 2, 2, 1]

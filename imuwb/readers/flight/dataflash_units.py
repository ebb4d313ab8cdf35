"""The units that a DataFlash log states for the fields of its records."""

from collections.abc import Mapping
from typing import Any, Protocol

from numpy.typing import NDArray

from imuwb.units import UNITS

_SPELLINGS = {"m/s/s": "m/s²", "degC": "°C"}


class _TableSource(Protocol):
    def table(self, name: str) -> dict[str, NDArray[Any]] | None: ...


def si_factors(tables: _TableSource) -> dict[tuple[str, str], float]:
    """Return {(record, field): factor to SI} of the fields whose unit the log states."""
    stated, labels, multipliers = (tables.table(name) for name in ("FMTU", "UNIT", "MULT"))
    formats = getattr(tables, "formats", None)  # a text log has its fields in SI
    if stated is None or labels is None or multipliers is None or formats is None:
        return {}
    if not _is_whole(stated, labels, multipliers):
        return {}
    names = {
        int(i): bytes(text).rstrip(b"\0").decode("ascii", "replace")
        for i, text in zip(labels["Id"], labels["Label"], strict=True)
    }
    scales = {int(i): float(x) for i, x in zip(multipliers["Id"], multipliers["Mult"], strict=True)}
    factors: dict[tuple[str, str], float] = {}
    for number, units, letters in zip(stated["FmtType"], stated["UnitIds"], stated["MultIds"], strict=True):
        record = formats.get(int(number))
        for field, unit, letter in zip(record.fields if record else (), units, letters, strict=False):
            # For a field whose type has a factor, the log states this factor again.
            scale = scales.get(int(letter), 0.0) if field.factor == 1 else 1.0
            factors[record.name, field.name] = (scale or 1.0) * _factor(names.get(int(unit), ""))
    return factors


def _factor(label: str) -> float:
    unit = UNITS.get(_SPELLINGS.get(label, label))
    return 1.0 if unit is None else unit.factor


def _is_whole(
    stated: Mapping[str, NDArray[Any]], labels: Mapping[str, NDArray[Any]], multipliers: Mapping[str, NDArray[Any]]
) -> bool:
    """Return whether the three records have their fields, in their shapes."""
    if not ({"FmtType", "UnitIds", "MultIds"} <= stated.keys() and {"Id", "Label"} <= labels.keys()):
        return False
    if not {"Id", "Mult"} <= multipliers.keys():
        return False
    arrays = (stated["UnitIds"], stated["MultIds"], labels["Label"], multipliers["Mult"])
    return [array.ndim for array in arrays] == [2, 2, 2, 1]

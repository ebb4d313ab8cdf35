"""The rows of the tables by what is compared: one coefficient of the sensors of one type, or one filter in outages of one duration."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.fleet.schemas import SUSPICIOUS
from imuwb.identification.family import Limits, Observations, observations
from imuwb.identification.family.observations import usable
from imuwb.texts import name_of
from imuwb.units import Unit, coefficient_units, unit

compute: Any = pc
LEVEL = 0.95  #: of intervals of which nothing is stated
LETTERS = "QNBKR"  #: coefficients whose squares are estimated
LIMITED = "QNBK"  #: those of which a limit counts: that of a ramp has another likelihood
EVEN = 0.5  #: probability of a limit, above which it says that the coefficient is below
FEWEST = 2  #: values of a family that is judged
LEAST = 0.25  #: share of values among values and limits, of a family that is judged
SECOND = 1e9  #: ns
UNKNOWN_SENSOR, DOUBTFUL = "the sensor is not known", "a remark puts the value in doubt"
LIMIT_ONLY, NO_INTERVAL, OTHER_LEVEL = (
    "the log gives a limit only",
    "there is no interval",
    "the interval is of another level",
)


@dataclass(frozen=True, eq=False, slots=True)
class Group:
    """One coefficient of the sensors of one type."""

    type: str  #: of the sensors
    source: str  #: analysis; of outages, the filter
    axis: str  #: empty: of the whole log
    coefficient: str
    unit: str  #: SI
    sensors: tuple[str, ...]  #: names; a row's number counts them
    logs: tuple[str, ...]  #: (n,) key of the log of each row
    observations: Observations
    value: Floats  #: (n,) SI
    lower: Floats
    upper: Floats
    limited: Limits  #: of the logs that give a limit only, on the scale of the observations
    limited_logs: tuple[str, ...]  #: (m,) keys of these logs
    limited_time: Floats  #: (m,) s since 1970; nan: not known
    further: tuple[str, ...]  #: sensors that have limits only; they are numbered after ``sensors``
    limits: Mapping[str, float]  #: sensor -> largest limit, of sensors without any value; SI
    left_out: Mapping[str, int]  #: reason -> rows

    @property
    def name(self) -> str:
        """Return what is compared, in words: "gyro x N"."""
        return f"{self.axis.replace('_', ' ')} {self.coefficient}".strip()

    @property
    def named(self) -> tuple[str, ...]:
        """Return the names of the sensors that have a value or a limit, by their numbers."""
        return (*self.sensors, *self.further)

    @property
    def is_judged(self) -> bool:
        """Return whether there are enough values for a family."""
        values = self.observations.y.size
        return values >= max(FEWEST, LEAST * (values + self.limited.upper.size))

    @property
    def display(self) -> Unit:
        """Return the unit in which people read it."""
        try:
            return coefficient_units(self.axis, self.coefficient)[1]
        except KeyError:
            return unit(self.unit or "1")


def sensor_groups(table: pa.Table, *, doubtful: bool = False) -> tuple[Group, ...]:
    """Return the groups of a table of sensors; only the estimates that an error model takes.

    Args:
        table: with the columns of ``imuwb.fleet.schemas.SENSORS``.
        doubtful: whether values count that a remark puts in doubt.
    """
    table = table.filter(compute.fill_null(table["headline"], fill_value=True))
    if not table.num_rows:
        return ()
    named = compute.binary_join_element_wise(table["vehicle"], table["stream"], " ")
    who, names = codes(compute.coalesce(table["serial"], named))
    keys = [codes(column) for column in (
        compute.coalesce(table["family"], table["stream"]), table["analysis"], table["axis"], table["coefficient"], table["unit"],
    )]  # fmt: skip
    return tuple(
        _group(table.take(pa.array(rows)), tuple(key), who[rows], names, doubtful=doubtful) for key, rows in parts(keys)
    )


def parts(keys: Sequence[tuple[Integers, list[str]]]) -> Iterator[tuple[list[str], Integers]]:
    """Yield each combination of texts, and its rows."""
    codes = np.stack([code for code, _ in keys], axis=1)
    known, inverse = np.unique(codes, axis=0, return_inverse=True)
    order = np.argsort(inverse.ravel(), kind="stable")
    bounds = np.searchsorted(inverse.ravel()[order], np.arange(1, len(known)))
    for row, own in zip(known, np.split(order, bounds), strict=True):
        if own.size:
            yield [texts[code] if code >= 0 else "" for code, (_, texts) in zip(row, keys, strict=True)], own


def codes(column: Any) -> tuple[Integers, list[str]]:  # noqa: ANN401 - pyarrow has no types
    """Return the number of each text of a column, -1 for null, and the texts, as they can be shown."""
    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    coded: Any = (whole if not isinstance(whole, pa.ChunkedArray) else whole.chunk(0)).dictionary_encode()
    return np.asarray(coded.indices.fill_null(-1), dtype=np.int64), [
        name_of(text) for text in coded.dictionary.to_pylist()
    ]


def _group(table: pa.Table, key: tuple[str, ...], who: Integers, names: list[str], *, doubtful: bool) -> Group:
    kind, source, axis, coefficient, si = key
    value, lower, upper, level, temperature = (
        np.asarray(table[name].to_numpy(), float) for name in ("value", "lower", "upper", "level", "temperature")
    )
    time = seconds(table["start"])
    level = np.where(np.isfinite(level), level, LEVEL)
    logarithmic = bool(coefficient in LETTERS or not (value <= 0).any())
    common = float(Counter(level.tolist()).most_common(1)[0][0])
    doubt = np.asarray(compute.equal(table["verdict"], SUSPICIOUS).fill_null(False)) & (not doubtful)
    limit = ~np.isfinite(value) | (logarithmic & ~(lower > 0) & np.isfinite(upper))
    sound = usable(value, lower, upper, logarithmic=logarithmic)
    counted = limit & (coefficient in LIMITED) & (common > EVEN) & np.isfinite(upper) & (upper > 0) & ~(value >= upper)
    reasons = {
        UNKNOWN_SENSOR: who < 0, DOUBTFUL: doubt, OTHER_LEVEL: (level != common) & (counted | sound), LIMIT_ONLY: limit & ~counted,
        NO_INTERVAL: ~sound & ~counted,
    }  # fmt: skip
    left_out, kept = _left_out(reasons)
    counted, kept = kept & counted, kept & sound & ~limit
    used, number = np.unique(who[kept], return_inverse=True)
    rows = observations(
        number.astype(np.int64), value[kept], lower[kept], upper[kept], level=common, time=time[kept],
        temperature=temperature[kept], squares=coefficient in LETTERS, logarithmic=logarithmic,
    )  # fmt: skip
    further = np.setdiff1d(who[counted], used)
    place = {int(one): i for i, one in enumerate((*used, *further))}
    stated = np.isfinite(value[counted])
    limited = Limits(
        np.array([place[int(one)] for one in who[counted]], dtype=np.int64), np.log(upper[counted]),
        np.where(stated, value[counted] / upper[counted], 0.0) ** 2, np.where(stated, (1 + common) / 2, common), temperature[counted],
    )  # fmt: skip
    mine = {names[i] for i in used}
    limits: dict[str, float] = {}
    for i in np.flatnonzero(limit & ~doubt & (who >= 0) & np.isfinite(upper)):
        if (name := names[who[i]]) not in mine:
            limits[name] = max(limits.get(name, 0.0), float(upper[i]))
    logs, limited_logs = (tuple(table["log"].take(pa.array(np.flatnonzero(of))).to_pylist()) for of in (kept, counted))
    return Group(
        kind, source, axis, coefficient, si, tuple(names[i] for i in used), logs, rows, value[kept], lower[kept], upper[kept], limited,
        limited_logs, time[counted], tuple(names[i] for i in further), limits, left_out,
    )  # fmt: skip


def _left_out(reasons: Mapping[str, Booleans]) -> tuple[dict[str, int], Booleans]:
    """Return how many rows each reason leaves out, each row counted once, and the rows that are kept."""
    kept = np.ones_like(next(iter(reasons.values())))
    counts: dict[str, int] = {}
    for reason, rows in reasons.items():
        if count := int((rows & kept).sum()):
            counts[reason] = count
        kept &= ~rows
    return counts, kept


def seconds(column: Any) -> Floats:  # noqa: ANN401 - as above
    """Return a column of times in s since 1970; nan for null."""
    whole = column.cast(pa.int64()).to_numpy().astype(float)
    return whole / SECOND

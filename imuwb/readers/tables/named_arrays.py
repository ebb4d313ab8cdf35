"""Arrays with names, alone or in structures, as the columns of tables: MATLAB's variables and NumPy's archives.

Arrays of one length are the columns of a table, and a matrix of three columns (or rows) is x, y and z. A structure with a time of
its own is a table; another belongs to the table around it. Two programs fix names and units that need no option: NaveGo's structures
(rodralez/NaveGo, ins_gnss.m: ``t`` s, ``fb`` m/s², ``wb`` rad/s forward-right-down; ``lat``, ``lon`` rad, ``h`` m, ``vel`` m/s NED;
``roll``, ``pitch``, ``yaw`` rad) and PSINS's matrices (gmyan's PSINS, imufile.m: ``[wm vm t]`` rad, m/s, s; right-forward-up).
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.tables.array_tables import array_table
from imuwb.readers.tables.arrow_tables import streamed as streamed_table
from imuwb.readers.text.column_names import columns as known_columns
from imuwb.readers.text.column_names import with_units
from imuwb.readers.text.stamps import words_of

Array: TypeAlias = NDArray[Any]
Tree: TypeAlias = Mapping[str, Any]  #: name -> array, or another tree

AXES = 3
MOST = 64  #: tables in a file
TIMES = {"t", "time", "times", "timestamp", "timestamps", "stamp", "tow", "utc"}
GRAVITY = (3.0, 30.0)  #: m/s²; the median specific force of a vehicle lies in between
LONGEST_STEP = 1.0  #: s
#: NaveGo's field -> names of its columns
NAVEGO = {
    "t": ("t [s]",), "fb": ("accel_x [m/s²]", "accel_y [m/s²]", "accel_z [m/s²]"), "wb": ("gyro_x [rad/s]", "gyro_y [rad/s]", "gyro_z [rad/s]"),
    "lat": ("latitude [rad]",), "lon": ("longitude [rad]",), "h": ("height [m]",),
    "vel": ("velocity_north [m/s]", "velocity_east [m/s]", "velocity_down [m/s]"),
    "roll": ("roll [rad]",), "pitch": ("pitch [rad]",), "yaw": ("heading [rad]",),
}  # fmt: skip
#: NaveGo's deviations, one for each axis or one row for each fix -> names of their columns
NAVEGO_SIGMAS = {
    "stdm": ("sigma_north [m]", "sigma_east [m]", "sigma_down [m]"),
    "stdv": ("sigma_velocity_north [m/s]", "sigma_velocity_east [m/s]", "sigma_velocity_down [m/s]"),
}
SIGNATURES = (
    {"t", "fb", "wb"},
    {"t", "lat", "lon", "h", "vel"},
    {"t", "lat", "lon", "h", "stdm"},
    {"t", "lat", "lon", "h", "roll", "pitch", "yaw"},
)
_STEPS = tuple(
    f"{kind}_increment_{axis} [{unit}]" for kind, unit in (("attitude", "rad"), ("velocity", "m/s")) for axis in "xyz"
)


@dataclass(frozen=True, eq=False, slots=True)
class _Table:
    """Arrays of one length."""

    name: str  #: of the structure; empty for the file's own variables
    columns: dict[str, Array]  #: name with its unit -> (n,)
    left: tuple[str, ...]  #: names of arrays of another length
    shape: str = ""  #: the program whose names these are
    named: bool = True


def streamed(path: Path, options: ReadOptions, tree: Tree) -> Iterator[Batch | Remark]:
    """Yield the streams of all tables.

    Raises:
        UnreadableLogError: no arrays make a table.
        UsageError: the columns, units or rate of the arrays are unknown.
    """
    tables = list(_tables("", tree))
    used = [table for table in tables if _is_of_use(table, options)][:MOST]
    if not used:
        names = (
            ", ".join(sorted({table.name or name for table in tables for name in (*table.columns, *table.left)})[:20])
            or "none"
        )
        raise UnreadableLogError(
            f"{path}: no arrays of a gyro, an accelerometer, or positions (arrays: {names}); name them like time_s, gyro_rad_s (n x 3), "
            "accel_m_s2 (n x 3), latitude_deg, or save a table with such names"
        )
    rest = [table.name or name for table in tables if table not in used for name in (table.columns or ("",))]
    if rest:
        yield unused(dict.fromkeys(filter(None, rest)), "arrays of no gyro, accelerometer, or positions")
    for table in used:
        if table.shape:
            yield Remark(Note("shape", f"{table.name or 'the arrays'}: read as {table.shape}"))
        if table.left:
            yield unused(
                (f"{table.name}.{name}" if table.name else name for name in table.left),
                "arrays of another length than the time",
            )
        stated = replace(options, frame=options.frame or "FRD") if table.shape else options
        source = array_table(table.columns)
        for part in streamed_table(path, stated, lambda _, source=source: source, named=table.named):
            yield _renamed(part, table.name) if len(used) > 1 and table.name else part


def _renamed(part: Batch | Remark, name: str) -> Batch | Remark:
    """Return a part of a table with the name of its structure, because several tables have streams of the same names."""
    if isinstance(part, Remark):
        return replace(part, stream=f"{name}" if part.stream else "")
    return replace(part, stream=name)


def _is_of_use(table: _Table, options: ReadOptions) -> bool:
    if not table.columns:
        return False
    if not table.named or (options.columns and not table.name):
        return True
    try:
        quantities = {column.quantity for column in known_columns(tuple(table.columns), {})}
    except UsageError:  # two columns of one meaning: the user hears of them when the table is read
        return True
    return bool(quantities & {"gyro", "accel", "attitude_increment", "velocity_increment", "latitude", "speed"})


def _tables(name: str, tree: Tree) -> Iterator[_Table]:
    """Yield the table of a structure, and those of the structures in it that have a time of their own."""
    arrays, inner = dict[str, Array](), list[tuple[str, Tree]]()
    for key, value in _flat("", tree, inner):
        arrays[key] = value
    yield from _table(name, arrays)
    for key, part in inner:
        yield from _tables(f"{name}.{key}" if name else key, part)


def _flat(prefix: str, tree: Tree, inner: list[tuple[str, Tree]]) -> Iterator[tuple[str, Array]]:
    for key, value in tree.items():
        name = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping):
            part = cast("Tree", value)
            if any(
                _is_time(field) and isinstance(x, np.ndarray) and cast("Array", x).size > 1 for field, x in part.items()
            ):
                inner.append((name, part))
            else:
                yield from _flat(name, part, inner)
        elif isinstance(value, np.ndarray):
            array = cast("Array", value)
            if array.dtype.names:
                fields = {field: array[field] for field in array.dtype.names if array[field].dtype.kind in "fiub"}
                yield from ((field if not prefix else f"{name}.{field}", column) for field, column in fields.items())
            elif array.dtype.kind in "fiub":
                yield name, array


def _is_time(name: str) -> bool:
    return bool(set(words_of(name)) & TIMES)


def _table(name: str, arrays: dict[str, Array]) -> Iterator[_Table]:
    """Yield the table of some arrays: as NaveGo has them, one matrix, or all of one length."""
    arrays = {key: np.squeeze(array) for key, array in arrays.items() if array.size > 1}
    if any(signature <= arrays.keys() for signature in SIGNATURES):
        yield _navego(name, arrays)
        return
    for key in [key for key, array in arrays.items() if array.ndim == 2 and min(array.shape) > AXES]:  # noqa: PLR2004 - a matrix
        matrix = _tall(arrays.pop(key))
        yield _matrix(f"{name}.{key}" if name else key, matrix)
    count = _length(arrays)
    if count:
        whole = {key: x for key, array in arrays.items() if (x := _rows(array, count)) is not None}
        found = {shown: cells for key, array in whole.items() for shown, cells in _columns(key, array)}
        yield _Table(name, found, tuple(key for key in arrays if key not in whole))


def _length(arrays: dict[str, Array]) -> int:
    """Return the length of the time, or the one of most arrays; 0 without arrays."""
    times = [array.size for key, array in arrays.items() if array.ndim == 1 and _is_time(key.rpartition(".")[2])]
    counts = Counter(max(array.shape) for array in arrays.values() if array.ndim <= 2)  # noqa: PLR2004 - a matrix
    return times[0] if times else counts.most_common(1)[0][0] if counts else 0


def _rows(array: Array, count: int) -> Array | None:
    """Return an array as (count,) or (count, 3); None for one of another shape."""
    if array.shape == (count,):
        return array
    if array.shape in ((count, AXES), (AXES, count)):
        return array if array.shape[0] == count else array.T
    return None


def _tall(matrix: Array) -> Array:
    return matrix if matrix.shape[0] >= matrix.shape[1] else matrix.T


def _columns(name: str, array: Array) -> Iterator[tuple[str, Array]]:
    if array.ndim == 1:
        yield name, array
        return
    base, measure = next(with_units(name))
    for i, axis in enumerate("xyz"):
        yield (f"{base}_{axis} [{measure.name}]" if measure is not None else f"{name}_{axis}"), array[:, i]


def _navego(name: str, arrays: dict[str, Array]) -> _Table:
    count = arrays["t"].size
    found: dict[str, Array] = {}
    for key, shown in NAVEGO.items():
        array = _rows(arrays[key], count) if key in arrays else None
        if array is not None and (array.ndim == 1) == (len(shown) == 1):
            found |= dict(zip(shown, [array] if array.ndim == 1 else array.T, strict=True))
    if "latitude [rad]" in found and np.nanmax(np.abs(found["latitude [rad]"])) > np.pi / 2:
        found = {key.replace("itude [rad]", "itude [deg]"): array for key, array in found.items()}
    for key, shown in NAVEGO_SIGMAS.items():
        if "lat" in arrays and key in arrays and arrays[key].size in (AXES, AXES * count):
            sigma = (
                np.broadcast_to(arrays[key], (count, AXES)) if arrays[key].size == AXES else _rows(arrays[key], count)
            )
            found |= dict(zip(shown, sigma.T, strict=True)) if sigma is not None else {}
    left = tuple(key for key in arrays if key not in NAVEGO and not (key in NAVEGO_SIGMAS and "lat" in arrays))
    return _Table(name, found, left, "a structure of NaveGo")


def _matrix(name: str, matrix: Array) -> _Table:
    """Return the table of a matrix of unnamed columns; that of PSINS has the time last, and increments before it."""
    if matrix.shape[1] == len(_STEPS) + 1 and _are_increments(matrix[:, :6], matrix[:, 6]):
        values = matrix.astype(np.float64)
        turned = values[:, [1, 0, 2, 4, 3, 5]] * np.array(
            [1, 1, -1, 1, 1, -1]
        )  # right-forward-up to forward-right-down
        return _Table(
            name, {"time [s]": values[:, 6]} | dict(zip(_STEPS, turned.T, strict=True)), (), "a matrix of PSINS"
        )
    return _Table(name, {str(i): column for i, column in enumerate(matrix.T)}, (), named=False)


def _are_increments(values: Array, time: Array) -> bool:
    """Return whether columns are increments over a rising time, with specific forces of about one gravity."""
    part, stamps = values[:10_000].astype(np.float64), time[:10_000].astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        steps = np.diff(stamps)
        even = ((steps > 0) & (steps <= LONGEST_STEP)).mean() > 0.95 if steps.size else False  # noqa: PLR2004 - a log may have gaps
        force = np.nanmedian(np.linalg.norm(part[1:, 3:], axis=1) / np.nanmedian(steps)) if even else 0.0
    return bool(even and GRAVITY[0] < force < GRAVITY[1])

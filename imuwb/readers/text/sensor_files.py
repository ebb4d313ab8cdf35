"""The names of files and tags that hold one sensor each, as phone apps write them, and the files that belong together."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.readers.quantities import DIMENSIONS
from imuwb.readers.text.column_names import Column, columns, with_units
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.stamps import words_of

#: word in a name -> the sensor that the file or the tag has
SENSORS = {
    **dict.fromkeys(("gyro", "gyros", "gyr", "gyroscope", "gyroscopes"), "gyro"),
    **dict.fromkeys(("accel", "accels", "acc", "acce", "accelerometer", "accelerometers", "acceleration"), "accel"),
    **dict.fromkeys(("location", "gps", "gnss"), "receiver"),
}
#: words of an acceleration without gravity, and of other sensors: such files are not looked for
OTHERS = {"linear", "user", "gravity", "free", "mag", "magnetometer", "magnetic"}
#: words that make a file of the same sensor a better or a worse partner: Sensor Logger's acceleration with gravity is "total"
BETTER, WORSE = {"total"}, {"uncalibrated", "uncal", "raw", "watch"}
#: quantity -> names of a sensor of one axis
LONE = {
    "gyro": {
        "gyro",
        "gyr",
        "gyroscope",
        "gyro rate",
        "rate",
        "omega",
        "angular rate",
        "angular velocity",
        "fog",
        "rotation rate",
    },
    "accel": {"accel", "acc", "accelerometer", "acceleration", "specific force"},
}
SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".csv.gz", ".txt.gz")
#: word in the name of a file -> that in the name of the file of the other sensor
_PAIRS = {
    "gyroscope": "accelerometer", "accelerometer": "gyroscope", "gyro": "accel", "accel": "gyro", "gyr": "acc", "acc": "gyr",
}  # fmt: skip
AXES = re.compile(r"[xyz](?:\s*[\[(].*[\])])?", re.IGNORECASE)
MOST_FILES = 200  #: in a folder that is one log


@dataclass(frozen=True, slots=True)
class SensorName:
    """What the name of a file or a tag states."""

    sensor: str  #: "gyro", "accel" or "receiver"
    rest: frozenset[str]  #: its other words


def sensor_name(name: str) -> SensorName | None:
    """Return the sensor that a name states; None for a name of none, of several, or of an acceleration without gravity."""
    words = words_of(name)
    found = {SENSORS[word] for word in words if word in SENSORS}
    if len(found) != 1 or OTHERS & set(words):
        return None
    return SensorName(found.pop(), frozenset(word for word in words if word not in SENSORS))


def named_axes(layout: Layout, name: str) -> Layout:
    """Return a layout in which axes without a sensor's name, x, y and z alone, have that in the name of the file or the tag."""
    stated = sensor_name(name)
    bare = [column for column in layout.names if AXES.fullmatch(column.strip())]
    if stated is None or stated.sensor == "receiver" or len(bare) != 3:  # noqa: PLR2004 - x, y and z
        return layout
    return replace(
        layout, names=tuple(f"{stated.sensor}.{column}" if column in bare else column for column in layout.names)
    )


def lone_axes(layout: Layout) -> Layout:
    """Return a layout in which a gyro or an accelerometer with one column and no letter has the axis x: a single fibre-optic gyro."""
    names, known = list(layout.names), {column.quantity for column in _known(layout.names)}
    for quantity, words in LONE.items():
        found = [
            (i, base, measure)
            for i, name in enumerate(names)
            for base, measure in _bases(name, quantity)
            if base in words
        ]
        if len(found) == 1 and quantity not in known:
            index, _, measure = found[0]
            names[index] = f"{quantity}_x [{measure}]" if measure else f"{quantity}_x"
    return replace(layout, names=tuple(names))


def _known(names: tuple[str, ...]) -> tuple[Column, ...]:
    try:
        return columns(names, {})
    except UsageError:  # two columns of one quantity; the table's own reading says so
        return ()


def _bases(name: str, quantity: str) -> list[tuple[str, str]]:
    """Return a name without its unit, and the unit; none if the unit is that of something else."""
    for text, measure in with_units(name):
        base = " ".join(words_of(text))
        if measure is None:
            return [(base, "")]
        if measure.dimension == DIMENSIONS[quantity]:
            return [(base, measure.name)]
    return []


def stem(path: Path) -> str:
    """Return the name of a file without its suffixes."""
    return path.name.split(".")[0]


def partners_of(path: Path) -> list[Path]:
    """Return the files beside one of a gyro or an accelerometer that may have the other sensor of the same record, the best first."""
    own = sensor_name(stem(path))
    if own is None or own.sensor == "receiver":
        return []
    found: list[tuple[tuple[int, int, str], Path]] = []
    for file in sorted(path.parent.iterdir()):
        other = sensor_name(stem(file)) if file.name.lower().endswith(SUFFIXES) else None
        if other is None or other.sensor in (own.sensor, "receiver") or file == path:
            continue
        difference = own.rest ^ other.rest
        if difference <= BETTER | WORSE:
            found.append(((len(difference & WORSE), -len(difference & BETTER), file.name), file))
    return [file for _, file in sorted(found)]


def counterparts(name: str) -> tuple[str, ...]:
    """Return the name of the file with the other sensor of a record, where a name has one of the usual words; else nothing.

    ``partners_of`` finds the files of a folder; of an address, only objects whose name is known can be found.
    """
    words = [word for word in _PAIRS if re.search(rf"(?<![a-z]){word}(?![a-z])", name, re.IGNORECASE)]
    if len(words) != 1 or sensor_name(stem(Path(name))) is None:
        return ()

    def other(found: re.Match[str]) -> str:
        word = _PAIRS[words[0]]
        return word.upper() if found[0].isupper() else word.capitalize() if found[0][0].isupper() else word

    return (re.sub(words[0], other, name, flags=re.IGNORECASE),)


def files_in(folder: Path) -> list[Path]:
    """Return the text files of a folder whose names state sensors, and of the folders in it."""
    files = sorted(file for file in folder.rglob("*") if file.is_file() and file.name.lower().endswith(SUFFIXES))
    return [file for file in files[:MOST_FILES] if not file.name.startswith(".")]


def is_folder_of_sensors(folder: Path) -> bool:
    """Return whether a folder has a file for a gyro or an accelerometer."""
    stated = [sensor_name(stem(file)) for file in files_in(folder)]
    return any(name is not None and name.sensor != "receiver" for name in stated)

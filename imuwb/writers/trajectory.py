"""Trajectories for other tools: TUM (evo), KML (Google Earth and other maps), CSV and MCAP."""

from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.tangent_plane import ned_of
from imuwb.log import SECOND, Log, Provenance, Reference
from imuwb.writers.whole import whole_file, write_text

SUFFIXES = (".tum", ".kml", ".csv", ".mcap")
MOST_POINTS = 20_000  #: largest number of points of a KML line


def check_trajectory(path: str | Path) -> None:
    """Raise UsageError unless the suffix is a format of trajectories."""
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise UsageError(
            f"{path}: the suffix is {suffix!r}; the suffix of a trajectory must be one of {', '.join(SUFFIXES)}"
        )


def write_trajectory(reference: Reference, quaternion: Floats, path: str | Path) -> None:
    """Write a trajectory; the suffix of the path is the format.

    Args:
        reference: time, position, velocity and attitude.
        quaternion: (n, 4) w, x, y, z, of the body to north-east-down.
        path: the file.

    Raises:
        UsageError: no such format.
    """
    check_trajectory(path)
    path = Path(path)
    if path.suffix in (".csv", ".mcap"):
        from imuwb.writers import write  # noqa: PLC0415 - the other formats do not need it

        write(Log(Provenance(reference.name, "imuwb", "", 0), references=(reference,)), path)
    elif path.suffix == ".tum":
        _write_tum(reference, quaternion, path)
    else:
        _write_kml(reference, path)


def _write_tum(reference: Reference, quaternion: Floats, path: Path) -> None:
    """Write lines of time (s), x y z (m) and quaternion x y z w; north, east and down from the first point, along its axes."""
    north, east, down = ned_of(reference.position, reference.position[0]).T
    whole, rest = np.divmod(reference.time, SECOND)
    with whole_file(path) as temporary, temporary.open("w", encoding="ascii") as file:
        for i in range(reference.time.size):
            w, x, y, z = quaternion[i]
            file.write(
                f"{whole[i]}.{rest[i]:09d} {north[i]:.4f} {east[i]:.4f} {down[i]:.4f} {x:.9f} {y:.9f} {z:.9f} {w:.9f}\n"
            )


def _write_kml(reference: Reference, path: Path) -> None:
    rows = slice(None, None, max(1, -(-len(reference) // MOST_POINTS)))
    places = np.degrees(reference.position[rows, :2])
    points = " ".join(
        f"{longitude:.9f},{latitude:.9f},{height:.3f}"
        for (latitude, longitude), height in zip(places, reference.position[rows, 2], strict=True)
    )
    name = reference.name.replace("&", "&amp;").replace("<", "&lt;")
    write_text(
        path,
        '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark>'
        f"<name>{name}</name><Style><LineStyle><color>ff4682ff</color><width>3</width></LineStyle></Style>"
        f"<LineString><coordinates>{points}</coordinates></LineString></Placemark></Document></kml>\n",
    )

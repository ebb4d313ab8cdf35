"""Trajectories for other tools: TUM (evo), KML (Google Earth and other maps), CSV and MCAP."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.earth import ned_scale
from imuwb.geodesy.tangent_plane import ned_of
from imuwb.log import SECOND, Log, Provenance, Reference
from imuwb.writers.whole import whole_file, write_text

SUFFIXES = (".tum", ".kml", ".csv", ".mcap")
COLORS = ("ff4682ff", "ffb4771f", "ff2ca02c")  #: of the lines of KML: alpha, blue, green, red
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
        write_kml((reference,), path)


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


def write_kml(references: Sequence[Reference], path: Path) -> None:
    """Write a line for each trajectory."""
    lines = "".join(
        f"<Placemark><name>{_escaped(reference.name)}</name><Style><LineStyle><color>{color}</color><width>3</width></LineStyle>"
        f"</Style><LineString><coordinates>{_points(reference)}</coordinates></LineString></Placemark>"
        for reference, color in zip(references, COLORS, strict=False)
    )
    write_text(
        path,
        f'<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{lines}</Document></kml>\n',
    )


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _points(reference: Reference) -> str:
    rows = slice(None, None, max(1, -(-len(reference) // MOST_POINTS)))
    places = np.degrees(reference.position[rows, :2])
    return " ".join(
        f"{longitude:.9f},{latitude:.9f},{height:.3f}"
        for (latitude, longitude), height in zip(places, reference.position[rows, 2], strict=True)
    )


def write_smoothed(
    smoothed: Reference, forward: Reference, backward: Reference, quaternion: Floats, path: str | Path
) -> None:
    """Write a smoothed trajectory, with the forward and the backward ones beside it; the suffix of the path is the format.

    CSV has the smoothed trajectory, and columns with the other two as differences from it and from each other. MCAP and KML have three
    trajectories, TUM has the smoothed one only.

    Args:
        smoothed: time, position, velocity, attitude and their sigmas.
        forward: at the same times.
        backward: at some of these times: where it is known.
        quaternion: (n, 4) w, x, y, z of the smoothed attitude.
        path: the file.

    Raises:
        UsageError: no such format.
    """
    check_trajectory(path)
    path = Path(path)
    if path.suffix == ".tum":
        _write_tum(smoothed, quaternion, path)
    elif path.suffix == ".kml":
        write_kml((smoothed, forward, backward), path)
    elif path.suffix == ".mcap":
        from imuwb.writers import write  # noqa: PLC0415 - the other formats do not need it

        write(Log(Provenance(smoothed.name, "imuwb", "", 0), references=(smoothed, forward, backward)), path)
    else:
        from imuwb.writers.csv_text import write_reference  # noqa: PLC0415 - pyarrow is slow to import

        write_reference(smoothed, _differences(smoothed, forward, backward), path)


def _differences(smoothed: Reference, forward: Reference, backward: Reference) -> dict[str, Floats]:
    """Return forward and backward minus smoothed, backward minus forward, and their sigmas, m NED, nan where unknown."""
    scale = ned_scale(smoothed.position[:, 0], smoothed.position[:, 2])
    rows = np.searchsorted(smoothed.time, backward.time)
    unknown = np.full((len(smoothed), 3), np.nan)
    there, sigma = unknown.copy(), unknown.copy()
    there[rows], sigma[rows] = backward.position, _sigma(backward)
    ahead = (forward.position - smoothed.position) * scale
    behind = (there - smoothed.position) * scale
    parts = {
        "forward_minus_smoothed_{}_m": ahead, "forward_own_sigma_{}_m": _sigma(forward),
        "backward_minus_smoothed_{}_m": behind, "backward_own_sigma_{}_m": sigma,
        "separation_{}_m": behind - ahead, "separation_own_sigma_{}_m": np.hypot(_sigma(forward), sigma),
    }  # fmt: skip
    ways = ("north", "east", "down")
    return {name.format(way): values[:, i] for name, values in parts.items() for i, way in enumerate(ways)}


def _sigma(reference: Reference) -> Floats:
    return np.full((len(reference), 3), np.nan) if reference.position_sigma is None else reference.position_sigma

"""Which axis points up in each position of a cube, found from the means of the accelerometers."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats

FACES = tuple((axis, sign) for axis in range(3) for sign in (1, -1))
LEANS = 0.35  #: largest share of gravity that a horizontal axis may show: a tilt of about 20°


def face_name(face: tuple[int, int]) -> str:
    """Return ``x up`` or ``x down``."""
    return f"{'xyz'[face[0]]} {'up' if face[1] > 0 else 'down'}"


def faces(force: Floats, names: Sequence[str], *, raw: bool) -> list[tuple[int, int]]:
    """Return (axis, +1 up or -1 down) of each position.

    An axis that points up reads +g; an axis that points down reads -g. The z axis of a level forward-right-down IMU points down.

    Args:
        force: (P, 3) means of the accelerometers.
        names: names of the positions, for messages.
        raw: whether the means are in counts or volts; the zero is then taken from the positions in which an axis is horizontal.

    Raises:
        ValueError: a position stands on no face, or a face is missing; the message names it.
    """
    shifted = force - np.median(force, axis=0) if raw else force
    size = np.abs(shifted).max(axis=0) if raw else np.full(3, np.median(np.linalg.norm(force, axis=1)))
    share = shifted / np.maximum(size, np.finfo(float).tiny)
    standing: list[tuple[int, int]] = []
    for row, name in zip(share, names, strict=True):
        axis = int(np.argmax(np.abs(row)))
        others = np.delete(np.abs(row), axis)
        if np.abs(row[axis]) < 1 - LEANS or others.max() > LEANS:
            raise ValueError(
                f"{name}: no axis points up or down (of gravity, x, y and z show {', '.join(f'{x:+.2f}' for x in row)}); "
                "six-position needs the six faces of a cube; multi-position takes any attitudes"
            )
        standing.append((axis, 1 if row[axis] > 0 else -1))
    missing = [face_name(face) for face in FACES if face not in standing]
    if missing:
        raise ValueError(
            f"{len(standing)} position{'s' if len(standing) > 1 else ''}, and none with {', '.join(missing)}; "
            f"the positions are {_listed(standing, names)}"
        )
    return standing


def _listed(standing: list[tuple[int, int]], names: Sequence[str]) -> str:
    by_face = {face: [n for n, f in zip(names, standing, strict=True) if f == face] for face in FACES}
    return "; ".join(f"{face_name(face)}: {', '.join(held)}" for face, held in by_face.items() if held)

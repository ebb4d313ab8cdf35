"""The earth's rate in gyros that are turned by hand: its horizontal part, whose direction is not known, and an unknown vertical part."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.identification.calibration.motions import Integral, Motion, across_of
from imuwb.identification.calibration.static_gyros import MIDDLE


def earth_rows(
    motions: Sequence[Motion], parts: Sequence[Integral], gain: Floats, up: Floats, latitude: float | None
) -> tuple[Floats, Floats]:
    """Return the columns of the earth's rate, (3 P + 2 M, K), and the standard deviation of each parameter before, (K,) rad/s.

    The horizontal part has one direction. The gyros carry it from one motion to the next as long as no sample between them is left
    out; each such chain has two parameters. The vertical part is one more if the latitude is not known; it turns no direction of up.

    Args:
        motions: the M motions.
        parts: their integrals.
        gain: (3, 3) of the gyros.
        up: (P, 3) direction of up in each position.
        latitude: rad; None: not known.
    """
    across = EARTH_RATE * (MIDDLE if latitude is None else float(np.cos(latitude)))
    columns: list[Floats] = []
    shown = np.zeros(len(up), dtype=np.bool_)
    basis, frame = np.zeros((2, 3)), np.eye(3)
    for i, (m, p) in enumerate(zip(motions, parts, strict=True)):
        before = motions[i - 1] if i else None
        if before is None or before.before + 1 != m.before or not (before.whole and m.whole):
            columns.append(np.zeros((3 * len(up) + 2 * len(motions), 2)))
            basis, frame = across_of(up[m.before]), np.eye(3)
        rate = frame.T @ basis.T  # (3, 2) rate of the earth in the motion's frame
        columns[-1][3 * len(up) + 2 * i : 3 * len(up) + 2 * i + 2] = p.earth @ rate
        for number, turned in zip((m.before, m.before + 1), p.turned, strict=True):
            if not shown[number]:
                columns[-1][3 * number : 3 * number + 3] = gain @ turned.T @ rate
                shown[number] = True
        frame = frame @ p.next_frame
    for number in np.flatnonzero(~shown):  # a position between no two motions
        columns.append(np.zeros((3 * len(up) + 2 * len(motions), 2)))
        columns[-1][3 * number : 3 * number + 3] = gain @ across_of(up[number]).T
    sizes = [across / 2**0.5] * (2 * len(columns))
    if latitude is None:
        vertical = np.zeros((3 * len(up) + 2 * len(motions), 1))
        vertical[: 3 * len(up), 0] = (up @ gain.T).ravel()
        columns.append(vertical)
        sizes.append(EARTH_RATE * MIDDLE)
    return np.concatenate(columns, axis=1), np.array(sizes)

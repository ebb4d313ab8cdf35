"""A record whose truth is known, in FRD axes and SI units, from which each writer makes a file of its shape."""

from dataclasses import dataclass

import numpy as np

N, RATE_HZ = 300, 100
START = 1_700_000_000_000_000_000  # ns since 1970 UTC
STEP = 10_000_000  # ns
GPS_AHEAD = 18  # s, since 2017
GPS_EPOCH = 315_964_800  # s since 1970
DEG, G = np.pi / 180, 9.80665

TIME = START + STEP * np.arange(N)
_PHASE = np.arange(N)[:, None] * [0.07, 0.11, 0.05]
#: still for 1.5 s, then a turn about the vertical; the accelerometer is level
GYRO = 1e-3 * np.sin(_PHASE) + np.where(np.arange(N)[:, None] < N // 2, 0.0, [0.01, -0.02, 0.3])
ACCEL = [0.02, -0.03, -9.79] + 0.05 * np.cos(_PHASE) + np.where(np.arange(N)[:, None] < N // 2, 0.0, [0.4, 1.5, 0.1])
#: a receiver at 10 Hz
FIX_TIME = START + 100_000_000 * np.arange(30)
LATITUDE, LONGITUDE = 47.1 + 1e-6 * np.arange(30), 8.5 - 2e-6 * np.arange(30)  # deg
HEIGHT, UNDULATION = 400 + 0.1 * np.arange(30), 47.5  # m
VELOCITY = np.stack([1 + 0.1 * np.arange(30), -2 + 0.05 * np.arange(30), 0.01 * np.arange(30)], axis=1)  # NED

_AXES = {"F": (0, 1), "B": (0, -1), "R": (1, 1), "L": (1, -1), "D": (2, 1), "U": (2, -1)}


def axes(values, frame):
    """Return FRD values in axes whose directions are the letters of a frame."""
    return np.stack([sign * values[:, axis] for axis, sign in (_AXES[letter] for letter in frame)], axis=1)


def gps(time):
    """Return GPS weeks and ns of the week of times since 1970 UTC."""
    return np.divmod(time - (GPS_EPOCH - GPS_AHEAD) * 10**9, 604_800 * 10**9)


def decimals(nanoseconds, places=9):
    """Return whole ns as texts of seconds."""
    return [f"{ns // 10**9}.{ns % 10**9:09d}"[: places - 9 or None] for ns in np.asarray(nanoseconds).tolist()]


def table(header, *columns, mark=","):
    """Return a table: a header and columns, (n,) or (n, m), of numbers or texts."""
    parts = [column if isinstance(column, list) else _texts(column) for column in columns]
    rows = (mark.join(cells) for cells in zip(*(_flat(parts)), strict=True))
    return "\n".join(([header] if header else []) + [*rows, ""])


def _texts(column):
    array = np.asarray(column)
    if array.ndim == 1:
        return [repr(x) for x in array.tolist()]
    return [[repr(x) for x in array[:, i].tolist()] for i in range(array.shape[1])]


def _flat(parts):
    for part in parts:
        if part and isinstance(part[0], list):
            yield from part
        else:
            yield part


@dataclass(frozen=True)
class File:
    """A file of a shape, and what a reader must make of it."""

    text: str
    name: str = "log.csv"
    time: np.ndarray | None = None  #: (n,) ns that the reader returns; None: since 1970
    epoch: str = "unix"
    gyro: np.ndarray | None = None  #: (n, 3) FRD; None: the truth
    accel: np.ndarray | None = None
    sensors: str = "gyro accel"
    rate: float | None = None  #: option --rate
    frame: str = ""  #: begins ``Origin.frame``
    streams: tuple[str, ...] = ("imu",)
    resolution: float = 0.0  #: rad/s or m/s², a count

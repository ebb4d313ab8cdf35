"""Scores, tracks and drives made by hand, for the tests of the replay."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from imuwb.log import AXES, SECOND, GnssStream, Log
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.outages import Drift
from imuwb.replay.references.reference import ReferenceTrack
from imuwb.replay.scoring.scores import Scores
from imuwb.simulation import Receiver, drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum, WhiteNoise

E2 = 6.69437999014e-3  # WGS 84
A = 6_378_137.0
DEGREE = np.pi / 180


def radii(latitude):
    """Return the meridian's and the transverse radius, m (Groves, eq. 2.105 and 2.106)."""
    root = np.sqrt(1 - E2 * np.sin(latitude) ** 2)
    return A * (1 - E2) / root**3, A / root


def scores(end, start=None, sigma=1.0, seconds=1, heading=0.0, distance=None):
    """Return scores whose north errors grow as straight lines to some ends, m."""
    end = np.asarray(end, dtype=float)
    share = np.arange(1, seconds + 1) / seconds
    north = end[:, None] * share
    start = np.arange(end.size, dtype=float) if start is None else np.asarray(start, dtype=float)
    covariance = np.broadcast_to(sigma**2 * np.eye(2), (end.size, seconds, 2, 2))
    driven = np.broadcast_to(20.0 * np.arange(1, seconds + 1), north.shape) if distance is None else distance
    return Scores(
        start, np.arange(1.0, seconds + 1), np.stack([north, 0 * north], axis=-1), covariance, -0.5 * north, 0.1 * north,
        np.full(north.shape, heading), driven,
    )  # fmt: skip


def track(position, velocity, seconds, heading=None, sigma=0.0):
    """Return a reference once a second."""
    n = len(position)
    return ReferenceTrack(
        "made", "truth", np.linspace(0, seconds, n), np.asarray(position, float), np.asarray(velocity, float), heading,
        np.broadcast_to(np.asarray(sigma, float), (n, 3)).copy(),
    )  # fmt: skip


def drift_of(start, time, state, covariance, sound=True):
    """Return a drift of given states."""
    count, length = time.shape
    zeros = np.zeros((count, length), np.int64)
    return Drift(
        np.zeros(count, np.int64), np.asarray(start, float), np.arange(1.0, length + 1), zeros, time, state, covariance,
        np.full(count, sound),
    )  # fmt: skip


def error_model(white=(2e-4, 2e-3), turn_on=(1e-3, 0.02), slow=None):
    """Return the same model for all gyros, and for all accelerometers."""
    axes = {}
    for axis in AXES:
        k = int(axis[0] == "a")
        more = () if slow is None else (GaussMarkov(slow[k], 100.0),)
        axes[axis] = AxisModel(Sum((WhiteNoise(white[k]), *more, Constant(turn_on[k]))))
    return ImuErrorModel("made", axes)


def town(seconds=240, route_seed=0, seed=1, model=None, receiver=None, **options):
    """Return a simulated drive of 50 Hz and the filter that knows its noise."""
    model = model or error_model()
    log = drive(model, mixed_route(seconds, route_seed), seed, rate=50.0, receiver=receiver or Receiver(), **options)
    return SimpleNamespace(log=log, model=FilterModel("known", model, settings=Settings(settling=30.0)))


def gnss_of(log: Log, rows=slice(None), **changes) -> GnssStream:
    """Return a log's receiver, cut and changed."""
    g = log.gnss[0]
    names = ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    parts = {name: getattr(g, name) for name in names} | changes
    return GnssStream(
        g.name, **{k: None if v is None else np.array(v)[rows] for k, v in parts.items()}, origin=g.origin
    )


def with_gnss(log: Log, rows=slice(None), **changes) -> Log:
    """Return a log whose receiver is cut or changed."""
    return replace(log, gnss=(gnss_of(log, rows, **changes),))


def seconds_of(stream):
    """Return a stream's times, s from the simulation's start."""
    return (stream.time - stream.time[0]) / SECOND

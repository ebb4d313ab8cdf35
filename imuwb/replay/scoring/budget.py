"""The error budget of outages: the share of each source in the filter's horizontal variance.

Without updates, the covariance is linear in its initial value and in the noise, so each source is propagated alone. The
correlations of the sources at the start are one more source, "in common". Its variance may be negative: a tilt and an
accelerometer's bias, for example, cancel until the vehicle turns.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.log import AXES
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.filter import Solution
from imuwb.navigation.filter_model import RECEIVER
from imuwb.navigation.outages import drift, seconds_of
from imuwb.navigation.tables import AxisTables

COMMON = "in common"  #: the correlations of the sources at the start
SENSORS = ("gyro", "accelerometer")


@dataclass(frozen=True, eq=False, slots=True)
class Budget:
    """The horizontal variance of a filter by source, mean over outages."""

    sources: tuple[str, ...]
    elapsed: Floats  #: (L,) s
    variance: Floats  #: (sources, L) m²
    total: Floats  #: (L,) m²


def budget(solution: Solution, events: Integers, duration: float) -> Budget:
    """Return the error budget of a filter in outages.

    Args:
        solution: the filter's run.
        events: (s,) the last fix before each outage, among the solution's events.
        duration: s.
    """
    total = _horizontal(solution, events, duration)
    sources: dict[str, Floats] = {}
    quiet = _without_noise(solution.tables)
    for name, states in _groups(solution):
        mask = np.zeros(int(solution.tables.first[6]), dtype=bool)
        mask[states] = True
        kept = np.zeros(solution.track.covariance.shape)  # an outage needs the covariance at its start only
        kept[events] = solution.track.covariance[events] * (mask[:, None] & mask)
        alone = replace(solution, track=solution.track._replace(covariance=kept), tables=quiet)
        sources[name] = _horizontal(alone, events, duration)
    empty = solution.track._replace(covariance=np.zeros(solution.track.covariance.shape))
    for name, tables in _noises(solution.tables):
        sources[name] = _horizontal(replace(solution, track=empty, tables=tables), events, duration)
    variance = np.array(list(sources.values()))
    shared = total - variance.sum(axis=0)
    elapsed = seconds_of(duration)
    return Budget((*sources, COMMON), elapsed, np.vstack([variance, shared]), total)


def _horizontal(solution: Solution, events: Integers, duration: float) -> Floats:
    covariance = drift(solution, events, duration).covariance
    return (covariance[..., 0, 0] + covariance[..., 1, 1]).mean(axis=0)


def _groups(solution: Solution) -> Iterator[tuple[str, Integers]]:
    """Yield the sources at the start of an outage, and their error states."""
    yield "position at the start", np.array([0, 1, 2])
    yield "velocity at the start", np.array([3, 4, 5])
    yield "tilt at the start", np.array([6, 7])
    yield "heading at the start", np.array([8])
    kinds: dict[str, list[int]] = {}
    for i, name in enumerate(solution.model.states(solution.measurement.interval)[NAVIGATION:]):
        axis, _, rest = name.partition(": ")
        if axis == RECEIVER:
            kinds.setdefault("correlated error of the receiver, at the start", []).append(NAVIGATION + i)
            continue
        kind = rest.partition(",")[0]
        kind = kind.rstrip("0123456789 ") if kind.startswith("AR(") else kind
        sensor = SENSORS[int(axis.startswith("accel"))]
        source = {"constant": "turn-on bias", "scale factor": "scale factor"}.get(kind, f"{kind} bias")
        kinds.setdefault(f"{sensor} {source}, at the start", []).append(NAVIGATION + i)
    for kind, states in kinds.items():
        yield kind, np.array(states)


def _without_noise(tables: AxisTables) -> AxisTables:
    zero = {name: np.zeros_like(getattr(tables, name)) for name in ("noise", "inside", "cross", "white")}
    return tables._replace(**zero)


def _noises(tables: AxisTables) -> Iterator[tuple[str, AxisTables]]:
    """Yield the sources of noise in an outage, and tables with that noise only."""
    quiet = _without_noise(tables)
    for sensor, name in enumerate(SENSORS):
        axes = [i for i, axis in enumerate(AXES) if axis.startswith("accel") == bool(sensor)]
        white = np.zeros_like(tables.white)
        white[:, axes] = tables.white[:, axes]
        if white.any():
            yield f"{name} white noise", quiet._replace(white=white)
        noise, inside, cross = (np.zeros_like(part) for part in (tables.noise, tables.inside, tables.cross))
        for i in axes:
            noise[:, :, i], inside[:, :, i] = tables.noise[:, :, i], tables.inside[:, :, i]
            place = slice(int(tables.first[i]) - NAVIGATION, int(tables.first[i + 1]) - NAVIGATION)
            cross[..., place] = tables.cross[..., place]
        if noise.any():
            yield f"{name} bias noise", quiet._replace(noise=noise, inside=inside, cross=cross)

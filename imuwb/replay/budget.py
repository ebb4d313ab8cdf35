"""What the drift is made of: how much of the filter's horizontal variance each source brings, in outages.

A covariance carried on without updates is linear in what it begins with and in the noise that comes in: each source is carried on
alone. What the sources have in common at the start, such as a tilt that an accelerometer's bias hides behind, is a part of its own,
and may be negative: the two cancel for as long as the vehicle does not turn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import AXES
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.outages import drift, seconds_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from imuwb.log import Floats
    from imuwb.navigation.filter import Solution
    from imuwb.navigation.tables import AxisTables

COMMON = "in common"  #: what several sources share at the start
SENSORS = ("gyro", "accelerometer")


@dataclass(frozen=True, eq=False, slots=True)
class Budget:
    """Horizontal variance by source, mean over outages."""

    sources: tuple[str, ...]
    elapsed: Floats  #: (L,) s
    variance: Floats  #: (sources, L) m²
    total: Floats  #: (L,) m²


def budget(solution: Solution, events: NDArray[np.int64], duration: float) -> Budget:
    """Return the budget of a filter's sigma in outages.

    Args:
        solution: the filter's run.
        events: (s,) the last fix before each outage.
        duration: s.
    """
    total = _horizontal(solution, events, duration)
    sources: dict[str, Floats] = {}
    quiet = _without_noise(solution.tables)
    for name, states in _groups(solution):
        mask = np.zeros(int(solution.tables.first[6]), dtype=bool)
        mask[states] = True
        kept = solution.track.covariance * (mask[:, None] & mask)
        alone = replace(solution, track=solution.track._replace(covariance=kept), tables=quiet)
        sources[name] = _horizontal(alone, events, duration)
    empty = solution.track._replace(covariance=np.zeros_like(solution.track.covariance))
    for name, tables in _noises(solution.tables):
        sources[name] = _horizontal(replace(solution, track=empty, tables=tables), events, duration)
    variance = np.array(list(sources.values()))
    shared = total - variance.sum(axis=0)
    elapsed = seconds_of(duration)
    return Budget((*sources, COMMON), elapsed, np.vstack([variance, shared]), total)


def _horizontal(solution: Solution, events: NDArray[np.int64], duration: float) -> Floats:
    covariance = drift(solution, events, duration).covariance
    return (covariance[..., 0, 0] + covariance[..., 1, 1]).mean(axis=0)


def _groups(solution: Solution) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Yield what is uncertain when an outage begins, and which error states that is."""
    yield "position at the start", np.array([0, 1, 2])
    yield "velocity at the start", np.array([3, 4, 5])
    yield "tilt at the start", np.array([6, 7])
    yield "heading at the start", np.array([8])
    kinds: dict[str, list[int]] = {}
    for i, name in enumerate(solution.model.states(solution.moves.interval)[NAVIGATION:]):
        axis, _, rest = name.partition(": ")
        kind = rest.partition(",")[0]
        kind = kind.rstrip("0123456789 ") if kind.startswith("AR(") else kind
        sensor = SENSORS[int(axis.startswith("accel"))]
        what = {"constant": "turn-on bias", "scale factor": "scale factor"}.get(kind, f"{kind} bias")
        kinds.setdefault(f"{sensor} {what}, at the start", []).append(NAVIGATION + i)
    for kind, states in kinds.items():
        yield kind, np.array(states)


def _without_noise(tables: AxisTables) -> AxisTables:
    zero = {name: np.zeros_like(getattr(tables, name)) for name in ("noise", "inside", "cross", "white")}
    return tables._replace(**zero)


def _noises(tables: AxisTables) -> Iterator[tuple[str, AxisTables]]:
    """Yield what comes in during an outage, and tables with that alone."""
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

"""Faults of a GNSS receiver's fixes: held rows, changes of the fix type, jumps and spikes."""

from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.geodesy import radii_of_curvature
from imuwb.health.fault import Fault
from imuwb.log import GnssStream, Log
from imuwb.sampling import runs

FIXED_3D = 3
FEWEST = 3  #: least number of fixes that can be compared
FAST = 30.0  #: m/s; a spike exceeds the speeds before and after it by more
JUMP, TIMES = 20.0, 3.0  #: m/s, and times the speed: positions may change with up to the sum of both
#: sigmas of the changes of the position, at least, of a jump; and the sigma of normal values over the median of their sizes
SCATTERS, CONSISTENT = 6.0, 1.4826
HELD = 0.02  #: share of fixes; if more fixes repeat the position before, this is a fault
MANY = 0.01  #: share of the fixes; a filter rejects a few spikes and loses nothing
RESOLVED = 0.03  #: m; a position in digits of 1e-7 deg changes where the receiver moves by more from fix to fix
GATED = "a filter must reject them (innovation gate)"


def receiver_faults(log: Log, gnss: GnssStream) -> Iterator[Fault]:
    """Yield what is wrong with the fixes of a receiver."""
    time = log.seconds(gnss.time)
    if gnss.fix_type is not None:
        yield from _fix_types(gnss.name, gnss.fix_type, time)
    if len(gnss) < FEWEST:
        return
    held = (np.diff(gnss.position, axis=0) == 0).all(axis=1) & ~_rests(gnss, time)
    if held.mean() > HELD:
        yield Fault(gnss.name, "held rows", "rows that repeat the position before", "warning", int(held.sum()),
                    float(time[int(np.argmax(held)) + 1]), consequence="the receiver is slower than its rows: use each fix once")  # fmt: skip
    yield from _spikes(gnss, time)
    yield from _jumps(gnss, time, held)
    if gnss.velocity is None:
        need = "still or moving, and the start of a filter, are judged by the positions alone"
        yield Fault(gnss.name, "no velocity", "the receiver reports no velocity", "note", consequence=need)
    for what, sigma in (("position", gnss.position_sigma), ("velocity", gnss.velocity_sigma)):
        if sigma is None and getattr(gnss, what) is not None:
            text = f"the receiver reports no sigma of its {what}"
            need = "a filter needs one: state it in the filter's settings"
            yield Fault(gnss.name, f"no {what} sigma", text, "note", consequence=need)


def _rests(gnss: GnssStream, time: Floats) -> Booleans:
    """Return at which fixes but the first a receiver moves too slowly for its position to change, by its own velocity."""
    if gnss.velocity is None:
        return np.zeros(time.size - 1, dtype=bool)
    moved = np.linalg.norm(gnss.velocity[1:, :2], axis=1) * np.diff(time)
    return moved < RESOLVED  # nan is not below it


def _fix_types(name: str, fix_type: Integers, time: Floats) -> Iterator[Fault]:
    poor = fix_type < FIXED_3D
    first, length = runs(poor)
    if first.size:
        longest = int(np.argmax(length))
        last = min(first[longest] + length[longest], time.size - 1)
        start = float(time[first[longest]])
        yield Fault(name, "no 3D fix", "fixes of less than three dimensions", "warning", int(poor.sum()), start,
                    float(time[last]) - start, "do not use them for navigation")  # fmt: skip
    changes = np.flatnonzero(np.diff(fix_type) != 0)
    if changes.size:
        yield Fault(name, "fix changes", "the type of the fix changes", "note", int(changes.size), float(time[changes[0] + 1]),
                    consequence="positions may jump there")  # fmt: skip


def _speeds(gnss: GnssStream, time: Floats) -> tuple[Floats, Floats]:
    """Return the times and the horizontal speeds (m/s) of the fixes whose velocity is known."""
    if gnss.velocity is None:
        return np.empty(0), np.empty(0)
    known = np.isfinite(gnss.velocity[:, :2]).all(axis=1)
    return time[known], np.linalg.norm(gnss.velocity[known, :2], axis=1)


def _spikes(gnss: GnssStream, time: Floats) -> Iterator[Fault]:
    at, speed = _speeds(gnss, time)
    spikes = np.flatnonzero((speed[1:-1] > speed[:-2] + FAST) & (speed[1:-1] > speed[2:] + FAST)) + 1
    if spikes.size:
        what = f"spikes of the velocity, up to {speed[spikes].max():.3g} m/s"
        severity = "fault" if spikes.size > MANY * speed.size else "warning"
        yield Fault(gnss.name, "velocity spikes", what, severity, int(spikes.size), float(at[spikes[0]]), consequence=GATED)  # fmt: skip


def _jumps(gnss: GnssStream, time: Floats, held: Booleans) -> Iterator[Fault]:
    """Yield steps of the position that are too fast for the velocity, or, if no velocity is known, for the usual pace."""
    moved = _displacements(gnss.position)
    distance = np.linalg.norm(moved, axis=1)
    pace = distance / np.diff(time)
    at, speed = _speeds(gnss, time)
    if speed.size:
        nearest = np.interp(time, at, speed)
        expected = np.maximum(nearest[:-1], nearest[1:])
    else:
        moving = pace if gnss.velocity is not None else pace[~held]
        expected = np.full(pace.size, float(np.median(moving)) if moving.size else 0.0)
    off = np.abs(distance - expected * np.diff(time))
    scatter = CONSISTENT * float(np.median(off))
    if gnss.position_sigma is not None and np.isfinite(gnss.position_sigma[:, :2]).any():
        scatter = max(scatter, float(np.nanmedian(gnss.position_sigma[:, :2])))
    jumps = np.flatnonzero((pace > TIMES * expected + JUMP) & (off > SCATTERS * scatter))
    if jumps.size:
        what = f"jumps of the position, up to {distance[jumps].max():.3g} m"
        yield Fault(gnss.name, "position jumps", what, "fault", int(jumps.size), float(time[jumps[0] + 1]), consequence=GATED)  # fmt: skip


def _displacements(position: Floats) -> Floats:
    """Return the displacements to north and east from each fix to the next, (n - 1, 2) m."""
    meridian, transverse = radii_of_curvature(position[:-1, 0])
    turns = np.diff(position[:, :2], axis=0)
    turns[:, 1] = (turns[:, 1] + np.pi) % (2 * np.pi) - np.pi  # across the date line
    return turns * np.stack([meridian, transverse * np.cos(position[:-1, 0])], axis=1)

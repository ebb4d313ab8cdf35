"""The outages of a replay: a sweep, those of the log itself, or given ones; and the check that they are possible."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Integers
from imuwb.errors import MissingDataError, UsageError
from imuwb.navigation.filter import Solution
from imuwb.navigation.filter_model import FilterModel
from imuwb.replay.prepared import Prepared

#: s, and usual intervals between fixes; a span without good fixes that is longer than both is an outage of the log itself
OWN, OWN_SHARE = 3.0, 2.5
LEAST_SETTLING = 10.0  #: s of fixes that every outage needs before
WORSE = 3.0  #: ratio of a degraded fix's sigma to the usual sigma
SPACING = 0.95  #: s between two outages of a sweep, at least
ROUNDING = 1e-3  #: s; a fix that is this much later still precedes an outage


@dataclass(frozen=True, slots=True)
class Outage:
    """A span without fixes."""

    start: float  #: s from the log's start
    duration: float  #: s
    name: str = ""
    table: str = ""  #: of the table that shows it; outages with the same text are shown together


def sweep(prepared: Prepared, model: FilterModel, duration: float) -> tuple[Outage, ...]:
    """Return an outage after every fix, at most one a second, from the end of the filter's settling to the end of the log."""
    time = prepared.fix_time
    first = prepared.start_time + model.settings.settling
    last = min(time[-1], prepared.measurement.time[-1] - prepared.measurement.interval) - duration
    kept: list[Outage] = []
    for t in time[(time >= first) & (time <= last)]:
        if not kept or t - kept[-1].start >= SPACING:
            kept.append(Outage(float(t), duration))
    return tuple(kept)


def own_outages(prepared: Prepared, model: FilterModel) -> tuple[Outage, ...]:
    """Return the outages of the log itself, in whole seconds: spans between good fixes.

    A fix is good unless its sigma is larger than three times the median, or its fix type is below the median. Fixes
    within such a span are not used. Such outages need a reference that continues: truth, or all fixes smoothed.
    """
    fixes = np.flatnonzero(prepared.corrections.fix >= 0)
    variance = prepared.corrections.events.variance[fixes, 0]
    good = variance <= WORSE**2 * np.median(variance)
    if prepared.gnss.fix_type is not None:
        kind = prepared.gnss.fix_type[prepared.corrections.fix[fixes]]
        good &= kind >= np.median(kind)
    time = prepared.corrections.time[fixes[good]]
    first = prepared.start_time + model.settings.settling
    usual = float(np.median(np.diff(time)))
    long = np.flatnonzero(np.diff(time) > max(OWN, OWN_SHARE * usual))
    return tuple(Outage(float(time[k]), float(np.floor(time[k + 1] - time[k]))) for k in long if time[k] >= first)


def check_outages(prepared: Prepared, model: FilterModel, outages: Sequence[Outage]) -> None:
    """Raise an error if an outage is not possible.

    Raises:
        MissingDataError: no outages.
        UsageError: an outage before the filter has settled, after the log, in a gap of fixes, or given twice.
    """
    first, last = prepared.start_time, float(prepared.measurement.time[-1])
    if not outages:
        raise MissingDataError(
            f"no outage is possible: the filter starts at {first:.1f} s and settles for {model.settings.settling:g} s, and the "
            f"log ends at {last:.1f} s; choose shorter outages or a shorter --settling"
        )
    time = prepared.fix_time
    usual = float(np.median(np.diff(time)))
    fixes: set[tuple[float, float]] = set()
    for outage in outages:
        before = float(time[np.searchsorted(time, outage.start + ROUNDING, side="right") - 1])
        where = f"the outage of {outage.duration:g} s at {outage.start:g} s"
        if outage.start < first + LEAST_SETTLING:
            raise UsageError(
                f"{where} begins before the filter has settled; it must begin at {first + LEAST_SETTLING:.1f} s or later"
            )
        if outage.start + outage.duration > last - prepared.measurement.interval:
            raise UsageError(f"{where} ends after the log; it must end before {last:.1f} s")
        if outage.start - before > OWN_SHARE * usual:
            raise UsageError(
                f"{where} begins in a gap of the fixes; the last fix is at {before:.1f} s; begin there, or use --at own for the "
                "outages of the log itself"
            )
        if (before, outage.duration) in fixes:
            raise UsageError(f"{where} and another one begin after the same fix, at {before:.1f} s; remove one of them")
        fixes.add((before, outage.duration))


def events_of(solution: Solution, outages: Sequence[Outage]) -> Integers:
    """Return the last fix before each outage, (s,) among the solution's events."""
    time = solution.corrections.time[solution.events]
    at = np.searchsorted(time, np.array([outage.start for outage in outages]) + ROUNDING, side="right") - 1
    return solution.events[np.maximum(at, 0)]


def with_gap(prepared: Prepared, outages: Sequence[Outage]) -> Booleans:
    """Return which outages lack samples of the IMU, (s,)."""
    lacking = np.zeros(len(outages), dtype=bool)
    for begin, end in prepared.measurement.bridged:
        lacking |= np.array([o.start < end and o.start + o.duration > begin for o in outages])
    return lacking

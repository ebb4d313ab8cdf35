"""The start of the filters in a log that is too slow for the heading to come from the velocity."""

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream, Log
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import Corrections, corrections_of
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.measurement import Measurement, measurement_of
from imuwb.navigation.standstill import standstills
from imuwb.notes import Note
from imuwb.replay.prepared import receiver_of
from imuwb.replay.starts.heading_search import search_heading
from imuwb.replay.starts.logged_heading import LoggedHeading, logged_heading
from imuwb.replay.starts.straight_course import straight_course

Source: TypeAlias = Literal["auto", "search", "course", "log"]  #: where a heading comes from

TRUSTED = 25.0  #: deg; a heading with a larger sigma is not used unless it is asked for
MOVING_TILT = 3.0  #: deg; a slow vehicle, or a walker, sways as it moves
LOGGED = 10.0  #: deg, sigma of the heading that a log states: a compass in a vehicle


@dataclass(frozen=True, slots=True)
class Start:
    """A heading with which the filters start."""

    time: float  #: s from the log's start; the filters start at the first fix from then on
    heading: float  #: deg
    sigma: float  #: deg
    note: Note  #: where it comes from
    tilt: float = 0.0  #: deg, sigma of roll and pitch, at least

    def __str__(self) -> str:
        """Return the note."""
        return self.note

    __repr__ = __str__

    def applied_to(self, model: FilterModel) -> FilterModel:
        """Return a filter that starts like this."""
        known = (self.time, self.heading, self.sigma)
        tilt = max(model.settings.tilt, self.tilt)
        return replace(model, settings=replace(model.settings, known_start=known, tilt=tilt))


@dataclass(frozen=True, eq=False, slots=True)
class _Parts:
    """What the sources of a heading need."""

    log: Log
    gnss: GnssStream
    measurement: Measurement
    stills: Floats
    corrections: Corrections
    model: FilterModel


def given_start(heading: float, sigma: float) -> Start:
    """Return a start at the first fix with a heading that the user states, deg."""
    text = f"the heading at the start is stated: {heading:g} deg, sigma {sigma:g} deg"
    return Start(0.0, heading, sigma, Note("heading-stated", text))


def find_start(log: Log, model: FilterModel, receiver: str | None = None, source: Source = "auto") -> Start | None:
    """Return how the filters start, or None if the velocity of a fast fix gives the heading.

    ``auto`` takes the first source that gives a heading: the velocity of a fast fix; a spread of starts; the heading that the log
    states, in a trajectory or by its IMU, unless that of the IMU contradicts the course; the course over a straight baseline, which assumes that the vehicle moves ahead.

    Args:
        log: an IMU and a receiver.
        model: installation, settings, aids and error model.
        receiver: name of the receiver; None: the best one.
        source: where the heading comes from.

    Raises:
        MissingDataError: no source gives a heading; the message names the options that help.
        UsageError: no receiver of that name.
    """
    gnss = receiver_of(log, receiver)
    measurement = measurement_of(log, log.imu(), model.installation)
    stills = standstills(measurement, log, gnss)
    corrections = corrections_of(log, gnss, measurement, stills, model)
    parts = _Parts(log, gnss, measurement, stills, corrections, model)
    if source == "auto":
        try:
            align(measurement, corrections, stills, model)
        except MissingDataError as slow:
            found = _searched(parts, TRUSTED) or _logged(parts, agreeing=True) or _course(parts)
            if found is None:
                raise MissingDataError(f"{slow}; or state the heading at the start with --heading") from slow
            return found
        return None
    found = {
        "search": lambda: _searched(parts, 180.0),
        "log": lambda: _logged(parts),
        "course": lambda: _course(parts),
    }[source]()
    if found is None:
        why = {
            "search": "no heading at the start is more likely than the others: the vehicle accelerates too little",
            "log": "the log states no attitude that agrees with gravity within the time of the IMU and the fixes",
            "course": "the positions have no straight baseline that is long enough for a course",
        }[source]
        raise MissingDataError(f"{log.provenance.path}: {why}; state the heading at the start with --heading DEG")
    return found


def _searched(parts: _Parts, most: float) -> Start | None:
    found = search_heading(parts.log, parts.gnss, parts.measurement, parts.stills, parts.model)
    if found is None or found.sigma > most:
        return None
    text = (
        f"the vehicle is too slow for a heading by its velocity: {found.starts} filters with headings all around were run, and "
        f"{found.heading:.0f} deg at {found.time:.1f} s is the most likely one, sigma {found.sigma:.2g} deg"
    )
    return Start(found.time, found.heading, found.sigma, Note("heading-searched", text))


def _logged(parts: _Parts, *, agreeing: bool = False) -> Start | None:
    """Return the heading that the first trajectory with an attitude states, or else the IMU; if ``agreeing``, with the course."""
    for reference in parts.log.references:
        if reference.attitude is None or not len(reference):
            continue
        time = (reference.time - (parts.log.zero or 0)) / SECOND
        fixes = parts.corrections.time[parts.corrections.fix >= 0]
        inside = fixes[(fixes >= time[0]) & (fixes <= time[-1])]
        if not inside.size:
            continue
        heading = float(np.degrees(np.interp(inside[0], time, np.unwrap(reference.attitude[:, 2]))) % 360)
        text = (
            f"the heading at the start is that of {reference.name} in the log: {heading:.0f} deg, sigma {LOGGED:g} deg"
        )
        return Start(float(inside[0]), heading, LOGGED, Note("heading-of-log", text))
    found = _of_imu(parts)
    if found is None or (agreeing and found.contradicted):
        return None
    origin = "as the IMU states it" if found.stated else "assumed, because the IMU states none"
    text = (
        f"the heading at the start is that of the orientation of {found.name}: {found.heading:.0f} deg, sigma "
        f"{found.sigma:.2g} deg, {origin}; it is taken as relative to north (REP 103: yaw 0 is east){_compared(found)}"
    )
    heading, sigma = found.aligned or (found.heading, found.sigma)
    if found.contradicted:
        text += ": its zero is not east, the mounting is not the true one, or the vehicle does not move ahead; check these, or state --heading"
    if found.aligned is not None:
        text += (
            f"; the heading is turned by {-found.difference:.0f} deg to {heading:.0f} deg, sigma {sigma:.2g} deg, so that it agrees "
            "with the courses: this is right only if the vehicle moves ahead"
        )
    return Start(found.time, heading, sigma, Note("heading-of-orientation", text))


def _of_imu(parts: _Parts) -> LoggedHeading | None:
    return logged_heading(parts.log, parts.corrections, parts.model.installation.mounting)


def _compared(found: LoggedHeading) -> str:
    """Return how a heading differs from the courses, as the end of a sentence."""
    if not found.courses:
        return ""
    verb = "contradicts" if found.contradicted else "agrees with"
    return (
        f"; it {verb} the courses over {found.courses} straight baselines: it differs by {found.difference:.0f} deg in the "
        f"median, with a scatter of {found.scatter:.0f} deg"
    )


def _course(parts: _Parts) -> Start | None:
    found = straight_course(parts.corrections, parts.measurement.time[0] + 1.0)
    if found is None:
        return None
    text = (
        f"the heading at the start is the course over {found.length:.1f} m in {found.span:.0f} s, {found.course:.0f} deg, sigma "
        f"{found.sigma:.2g} deg: this is right only if the vehicle moves ahead"
    )
    stated = _of_imu(parts)
    if stated is not None and stated.contradicted:
        text += f"; the orientation of {stated.name} is not used{_compared(stated)}"
    return Start(found.time, found.course, found.sigma, Note("heading-of-course", text), MOVING_TILT)

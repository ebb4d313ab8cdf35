"""Whether the record of a still IMU suits an error model: what puts the model in doubt, and what forbids it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from imuwb import identification
from imuwb.arrays import Floats
from imuwb.health.channel import Channel, channels, sensor_seconds, value_text
from imuwb.health.lone import Lone, lone_samples
from imuwb.health.tails import tails
from imuwb.log import ImuStream, Log
from imuwb.notes import Note
from imuwb.stochastic import Autoregressive, ImuErrorModel, WhiteNoise
from imuwb.texts import counted, number_text, seconds_text

#: rad/s and m/s²; no gyro and no accelerometer measures more (57 000 deg/s and 10 000 g)
LARGEST = {"gyro": 1e3, "accel": 1e5}
SPOILT = 0.5  #: share by which lone samples and tails may raise the mean square of the changes from sample to sample


@dataclass(frozen=True, slots=True)
class Doubts:
    """What puts an error model in doubt."""

    grave: tuple[Note, ...] = ()  #: no error model should be made of the record
    slight: tuple[Note, ...] = ()  #: an error model states them

    @property
    def all(self) -> tuple[Note, ...]:
        """Return all doubts, the grave ones first."""
        return (*self.grave, *self.slight)

    def of(self, log: str) -> Doubts:
        """Return the doubts with the name of a log before each."""
        grave, slight = (tuple(Note(n.id, f"{log}: {n}") for n in notes) for notes in (self.grave, self.slight))
        return Doubts(grave, slight)

    def __add__(self, other: Doubts) -> Doubts:
        """Return both, each doubt once."""
        grave = dict.fromkeys((*self.grave, *other.grave))
        return Doubts(tuple(grave), tuple(dict.fromkeys(n for n in (*self.slight, *other.slight) if n not in grave)))


def record_doubts(log: Log, still: identification.Stillness | None) -> Doubts:
    """Return what speaks against noise coefficients from the log's IMU as those of a still sensor.

    Args:
        log: the log.
        still: of its IMU, as ``imuwb.identification.stillness`` finds it.
    """
    grave: list[Note] = []
    slight: list[Note] = []
    moved, note = _stillness_note(still)
    if note is not None:
        (grave if moved else slight).append(note)
    for spoilt, struck in _struck(log, log.imu(), still):
        (grave if spoilt else slight).append(struck)
    return Doubts(tuple(grave), tuple(slight))


def stillness_of(log: Log, drift: Callable[[str, Floats], Floats] | None = None) -> identification.Stillness | None:
    """Return when the log's IMU is still; None where the record is too short, or its rate too low, to show it.

    Args:
        log: the log.
        drift: gives the known drift of an axis at times (s), which is no motion; None: there is none.
    """
    from imuwb.navigation.travel import travels  # noqa: PLC0415 - imuwb info reads this module, and needs no scipy

    imu = log.imu()
    times = sensor_seconds(log, imu)
    axes = {
        name: (times[name.partition("_")[0]], values) for name, (_, values) in imu.axes().items() if np.ptp(values) > 0
    }
    if drift is not None:
        axes = {name: (at, values - drift(name, at)) for name, (at, values) in axes.items()}
    return identification.stillness(axes, travels(log)) if axes else None


def _stillness_note(still: identification.Stillness | None) -> tuple[bool, Note | None]:
    """Return whether the record is that of a moving IMU, and a note on what moves."""
    if still is None:
        text = (
            "the record is too short, or its rate too low, to test whether the IMU is still; if the IMU moves, the coefficients "
            "are not those of the sensor's noise"
        )
        return False, Note("stillness-unknown", text)
    # Whole seconds from the start of the log, rounded inwards: what --start and --end take.
    quiet = (
        f"analyse the longest quiet part: --start {math.ceil(still.quiet_start)} --end {math.floor(still.quiet_end)}"
    )
    if still.quiet_end - still.quiet_start < 1:
        quiet = "no part of the record is quiet"
    even = sum(end - start for start, end in still.even)
    if still.moving:
        text = "the IMU moves in most of the record"
        if even:
            text += f" (a receiver or an odometer shows even motion for {seconds_text(even)}, which the samples do not show)"
        return True, Note("moving", f"{text}, so the coefficients are not those of the sensor's noise; {quiet}")
    if even:
        text = (
            f"a receiver or an odometer shows even motion for {seconds_text(even)}, which the samples do not show; the "
            f"coefficients are also those of the motion; {quiet}"
        )
        return False, Note("even-motion", text)
    if not still.disturbances:
        return False, None
    worst = max(still.disturbances, key=lambda d: d.largest)
    count = len(still.disturbances)
    text = (
        f"{count} shock{'s' if count > 1 else ''} or movement{'s' if count > 1 else ''}, the largest at {worst.start:.0f} s "
        f"({number_text(worst.largest)} times the usual scatter, {', '.join(worst.axes)})"
    )
    if still.spoilt:
        text += f", raise{'' if count > 1 else 's'} the mean square of an axis by a factor of {number_text(1 + still.excess)}"
    return still.spoilt, Note("disturbances", f"{text}; {quiet}")


def _struck(log: Log, imu: ImuStream, still: identification.Stillness | None) -> Iterator[tuple[bool, Note]]:
    """Yield notes on samples that are not of the sensor's noise, and whether they spoil the coefficients."""
    for axis, channel in channels(log, imu).items():
        values = channel.values
        worst = min(int(values.argmin()), int(values.argmax()), key=lambda row: (-abs(values[row]), row))
        if abs(float(values[worst])) > LARGEST[axis.partition("_")[0]]:
            text = (
                f"{axis} has a sample of {value_text(axis, float(values[worst]))} at {channel.time[worst]:.2f} s; no sensor gives "
                "so much; exclude its time with --start and --end"
            )
            yield True, Note("impossible-sample", text)
            continue
        lone = lone_samples(channel)
        if (heavy := _tails(channel, lone, still)) is not None:
            yield heavy
        if not lone.rows.size:
            continue
        changes, mended = (_mean_square_change(v) for v in (values, lone.without(values)))
        spoilt = changes > (1 + SPOILT) * mended
        count = lone.rows.size
        text = (
            f"{axis} has {count} lone sample{'s' if count > 1 else ''}, up to {value_text(axis, float(lone.off.max()))} from "
            f"the neighbours, the first at {channel.time[lone.rows[0]]:.2f} s"
        )
        yield spoilt, Note("lone-samples", text)


def _tails(channel: Channel, lone: Lone, still: identification.Stillness | None) -> tuple[bool, Note] | None:
    """Return a note on the samples of a quiet record that are further off than noise is, and whether they spoil it."""
    if still is None or still.moving:
        return None
    quiet = np.ones(channel.time.size, dtype=bool)
    for span in still.disturbances:
        quiet[slice(*np.searchsorted(channel.time, (span.start, span.end)))] = False
    found = tails(channel, lone.without(channel.values), quiet)
    if found is None:
        return None
    text = (
        f"{channel.axis} has {counted(found.count, 'sample')} ({100 * found.share:.2g} %) that are more than five sigmas off, the first at "
        f"{found.first:.2f} s; they raise the mean square by a factor of {number_text(1 + found.excess)}"
    )
    return found.excess > SPOILT, Note("heavy-tails", text)


def _mean_square_change(values: Floats) -> float:
    changes = np.diff(values)
    return float(np.mean(np.square(changes, out=changes)))


def model_doubts(model: ImuErrorModel) -> Doubts:
    """Return what an error model of a still record lacks: an axis without white noise would be taken as free of noise."""
    silent = [
        axis
        for axis, own in model.axes.items()
        if not any(
            (isinstance(term, WhiteNoise) and term.N) or (isinstance(term, Autoregressive) and term.beta0)
            for term in own.processes.terms
        )
    ]
    if not silent:
        return Doubts()
    text = (
        f"{', '.join(silent)}: the record shows no white noise, and no sensor is without; the samples may be rounded, filtered or "
        "simulated; a filter would trust them without limit"
    )
    return Doubts((Note("no-white-noise", text),))

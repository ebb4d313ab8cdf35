"""Gives the rows of a stream their times: their stamps, or even times where the stamps are not those of the samples."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats, step_blocks
from imuwb.log import Kind, Nanoseconds, Repair
from imuwb.notes import Note
from imuwb.readers.assembly.even_stamps import EvenStamps, batches_of, even_stamps, spread_stamps
from imuwb.readers.assembly.time_order import REPEATED, taken
from imuwb.units import SECOND

#: kinds of which rows with equal stamps are samples; of other streams, the first row is enough
_SAMPLED: tuple[Kind, ...] = ("imu", "speed", "gnss", "velocity")
FROZEN = Repair(
    Note("frozen_clock", "all rows have the same time, so all but one are left out; state --rate HZ"), 0, "lost"
)
SPREAD = Repair(
    Note("repeated_stamps", "stamps that several samples have: the samples are spread up to the next stamp"), 0, "time"
)


@dataclass(frozen=True, slots=True)
class Clock:
    """What is known about the stamps of a stream."""

    kind: Kind
    exact: bool = False  #: they are the sensor's own times
    rate: float | None = None  #: Hz, as the user states
    even: bool = False  #: the samples are even, as the user states


def sample_times(
    time: Nanoseconds, columns: dict[str, Floats], clock: Clock, repairs: list[Repair]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return the rows with rising times, and add the repairs.

    Args:
        time: (n,) ns, not falling; no row repeats the row before it.
        columns: the values of the rows.
        clock: what is known about the stamps.
        repairs: of the stream; they are added to.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        return time, columns
    inertial = clock.kind == "imu" and set(columns) != {"temperature"}
    if inertial and clock.rate is not None:
        return _stated(time, clock.rate, repairs), columns
    frozen = inertial and bool(time[0] == time[-1])
    repeated = sum(int(np.count_nonzero(steps == 0)) for steps in step_blocks(time))
    if not (clock.exact or frozen) and (inertial or (repeated and clock.kind in _SAMPLED)):
        even = even_stamps(time, forced=clock.even and inertial)
        if even is not None:
            repairs.append(Repair(_note(even), time.size, "time"))
            return even.time, columns
        if inertial and (batches := batches_of(time)) is not None:
            text = (
                f"the rows come in batches of {batches.rows} at {batches.rate:.4g} Hz, which are taken as times of the sensor with gaps "
                f"between the batches; if they are times of arrival, the samples are even at {batches.even_rate:.4g} Hz: --even"
            )
            repairs.append(Repair(Note("batches", text), 1, "time"))
    if not repeated:
        return time, columns
    if inertial and not (clock.exact or frozen):
        repairs.append(replace(SPREAD, count=repeated))
        return spread_stamps(time), columns
    if set(columns) != {"temperature"}:
        repairs.append(replace(FROZEN if frozen else REPEATED, count=repeated))
    return taken(time, columns, np.concatenate([[True], np.diff(time) > 0]))


def _stated(time: Nanoseconds, rate: float, repairs: list[Repair]) -> Nanoseconds:
    """Return times from the first stamp on, one period of the stated rate after the other."""
    stated = time[0] + np.rint(np.arange(time.size) * (SECOND / rate)).astype(np.int64)
    if np.abs(stated - time).max() > SECOND / rate / 2:
        mean = (time.size - 1) * SECOND / max(int(time[-1] - time[0]), 1)
        text = f"times by the stated rate of {rate:.6g} Hz, not by the stamps, which have {mean:.6g} rows a second"
        repairs.append(Repair(Note("stated_rate", text), time.size, "time"))
    return stated


def _note(even: EvenStamps) -> Note:
    """Return the note on even times: why, how far the stamps are off, and the rate."""
    seconds = float(even.time[-1] - even.time[0]) / SECOND
    rate = (even.time.size - 1 + even.lost) / max(seconds, 1e-9)
    about = f"even times at {rate:.6g} Hz; the stamps scatter by {_duration(even.scatter)}, at most {_duration(even.latest)}"
    lost = f"; {even.lost} samples are missing" if even.lost else "; no sample is missing"
    why = {
        "arrival": ("arrival_stamps", "stamps of arrival, several samples at once"),
        "coarse": ("coarse_stamps", "stamps of a clock that ticks coarsely"),
        "jitter": ("uneven_stamps", "stamps that scatter about even times"),
    }
    name, text = why[even.cause]
    return Note(name, f"{text}: {about}{lost}")


def _duration(seconds: float) -> str:
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"

"""The notes of an outage replay: what does not fit, how it was done, and what was estimated."""

from collections.abc import Iterator

import numpy as np

from imuwb.navigation import Aids
from imuwb.notes import Note
from imuwb.replay import Clocks, Mounting, Replay, Tuned
from imuwb.statistics import Estimate
from imuwb.texts import number_text
from imuwb_plugins.outage.left_out import left_out
from imuwb_plugins.outage.result import DurationSummary, FilterInfo

#: A filter does not fit above this NIS over its degrees of freedom, or this share of refused fixes.
MISFIT, REFUSED = 3.0, 0.1


def prefixed(prefix: str, note: Note) -> Note:
    """Return a note with a prefix."""
    return Note(note.id, f"{prefix}: {note}")


def notes(
    replay: Replay, durations: tuple[DurationSummary, ...], infos: tuple[FilterInfo, ...], clocks: Clocks | None,
    mounting: Mounting | None, tuned: Tuned | None,
) -> tuple[str, ...]:  # fmt: skip
    """Return the notes, the most important first."""
    aids = next(iter(replay.runs.values())).solution.model.aids
    reference = Note("reference", f"the drift is measured against {replay.reference.name}")
    own = [*misfits(infos), *_choices(durations), reference, *left_out(replay), *replay.notes, _aids(aids)]
    if clocks is not None:
        own.append(_clocks(clocks))
    if mounting is not None:
        roll, pitch, heading = mounting.angles
        half = mounting.heading.upper - mounting.heading.value
        text = f"mounting estimated from the log: roll {roll:.2f}, pitch {pitch:.2f}, heading {heading:.2f} ± {half:.2f} deg"
        own.append(Note("mounting", text))
    if tuned is not None:
        own.append(_tuned(tuned))
    return tuple(own)


def misfits(infos: tuple[FilterInfo, ...]) -> Iterator[Note]:
    """Yield a note for each filter that does not fit the log."""
    for f in infos:
        worst = max(f.nis_position, f.nis_velocity or 0.0)
        if worst > MISFIT or f.refused > REFUSED * f.fixes:
            text = (
                f"{f.name} does not fit this log: its innovations are {np.sqrt(worst):.1f} times as large as their sigma, and "
                f"the gate refuses {f.refused} of {f.fixes} positions and velocities"
            )
            yield Note("misfit", text)


def _choices(durations: tuple[DurationSummary, ...]) -> Iterator[Note]:
    for own in durations:
        if own.choice is not None:
            best = own.choice.candidates[0]
            text = (
                f"{own.duration:g} s: the errors are most likely with {best.model}, which is the best in {best.folds} of "
                f"{own.choice.folds} folds"
            )
            yield Note("choice", text)


def _aids(aids: Aids) -> Note:
    used = [
        f"{name} (sigma {sigma:g} m/s)"
        for name, sigma in (("no slip", aids.straight), ("standstills", aids.still), ("the log's speed", aids.speed))
        if sigma
    ]
    return Note("aids", f"the filters use fixes and {', '.join(used)}" if used else "the filters use fixes only")


def _clocks(c: Clocks) -> Note:
    parts: list[str] = []
    if c.delay is not None and c.velocity_delay is not None:
        parts.append(f"fixes are {_signed(c.delay, 1e3, 'ms late', 'ms early')}")
        parts.append(
            f"their velocities are {_signed(c.velocity_delay, 1e3, 'ms older', 'ms younger')} than their positions"
        )
    if c.rate is not None:
        longer = c.rate.shifted(-1.0)
        parts.append(
            f"a second of the IMU's clock is {_signed(longer, 1e6, 'µs longer', 'µs shorter')} than a true one"
        )
    text = f"{', '.join(parts)}: estimated by the likelihood of the innovations, with {c.noise:.2g} times the model's white noise"
    return Note("clocks", text)


def _signed(x: Estimate, factor: float, above: str, below: str) -> str:
    """Return an estimate of either sign with its interval as text."""
    positive = x.value >= 0
    own = x.scaled(factor if positive else -factor, "")
    interval = f" [{own.lower:.0f}, {own.upper:.0f}]" if np.isfinite([own.lower, own.upper]).all() else " (no interval)"
    return f"{own.value:.0f}{interval} {above if positive else below}"


def _tuned(t: Tuned) -> Note:
    text = (
        f"tuned on {t.fitted} outages before {t.split:.0f} s: white noise of gyros x {t.white[0]:.2g}, of accelerometers "
        f"x {t.white[1]:.2g}; slower noise of gyros x {t.slow[0]:.2g}, of accelerometers x {t.slow[1]:.2g}; in the {t.judged} "
        f"outages after, which are not fitted, NEES/2 at the end changes from {t.nees_per_dof[0]:.2f} to {t.nees_per_dof[1]:.2f}, "
        f"and the median error from {number_text(t.median_end[0])} to {number_text(t.median_end[1])} m"
    )
    return Note("tuned", text)

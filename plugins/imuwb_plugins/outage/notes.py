"""The notes of an outage replay: what does not fit, how it was done, and what was estimated."""

from collections.abc import Iterator

import numpy as np

from imuwb.navigation import Aids
from imuwb.notes import Note
from imuwb.replay import Clocks, MotionNoise, Replay, Tuned, refusal_note
from imuwb.statistics import Estimate
from imuwb.texts import converted_text, number_text
from imuwb.units import coefficient_units
from imuwb_plugins.outage.installation import Installed
from imuwb_plugins.outage.left_out import left_out
from imuwb_plugins.outage.models import Filters
from imuwb_plugins.outage.result import DurationSummary, FilterInfo

#: A filter does not fit above this NIS over its degrees of freedom, or this share of refused fixes.
MISFIT, REFUSED = 3.0, 0.1


def prefixed(prefix: str, note: Note) -> Note:
    """Return a note with a prefix."""
    return Note(note.id, f"{prefix}: {note}")


def notes(
    replay: Replay,
    durations: tuple[DurationSummary, ...],
    infos: tuple[FilterInfo, ...],
    own: Installed,
    chosen: Filters,
) -> tuple[str, ...]:
    """Return the notes, the most important first."""
    aids = next(iter(replay.runs.values())).solution.model.aids
    reference = Note("reference", f"the drift is measured against {replay.reference.name}")
    first = () if chosen.motion is None else motion_notes(chosen.motion)
    found = [
        *first,
        *misfits(infos),
        *_refused(replay),
        *_choices(durations),
        reference,
        *left_out(replay),
        *replay.notes,
        _aids(aids),
    ]
    if own.clocks is not None:
        found.append(_clocks(own.clocks))
    if chosen.tuned is not None:
        found.append(_tuned(chosen.tuned))
    return tuple(found)


def motion_notes(noise: MotionNoise) -> tuple[Note, ...]:
    """Return what makes the bench's sigma too small in motion, with intervals, and the remedy."""
    causes = [cause for kind in ("gyro", "accel") if (cause := _noisier(noise, kind))]
    if not causes:
        return (Note("motion-as-bench", "in motion, the innovations show no more noise than the bench record does"),)
    grows = ", in proportion to the square of the vibration" if noise.grows else ""
    text = f"in motion, {' and '.join(causes)} than on the bench{grows}"
    if noise.scale_factor:
        text += (
            f", besides scale factors that err by about {noise.scale_factor * 100:.0f} %, which the innovations show "
            f"(log-likelihood + {noise.scale_factor_gain:.0f})"
        )
    remedy = "the filter motion has this noise, from the innovations alone; --save-model FILE.toml writes it, and imuwb model compare shows it beside the bench's"
    return Note("motion-noise", text), Note("motion-remedy", remedy)


def _noisier(noise: MotionNoise, kind: str) -> str:
    """Return how much noisier a triad is in motion; empty if its interval includes the bench's noise."""
    middle = noise.noisier(kind)
    if middle is None:
        return ""
    sensor = "gyros" if kind == "gyro" else "accelerometers"
    amplitude = converted_text(noise.white[int(kind == "accel")], coefficient_units(f"{kind}_x", "N")[1])
    if not np.isfinite(middle.value):
        return f"the {sensor} act {amplitude} noisier"
    return f"the {sensor} act {number_text(middle.value)} [{number_text(middle.lower)}, {number_text(middle.upper)}] times noisier ({amplitude})"


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


def _refused(replay: Replay) -> Iterator[Note]:
    """Yield a note on the positions that the last filter refuses."""
    *_, last = replay.runs.values()
    note = refusal_note(last.solution)
    if note is not None:
        yield note


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

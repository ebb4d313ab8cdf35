"""Figures as text, and the notes of an outage replay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.replay import Interval

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.replay import Clocks, Run, Tuned
    from imuwb_plugins.outage.result import Result

#: NIS over its degrees of freedom, and share of fixes refused, of a filter that does not fit
MISFIT, REFUSED = 3.0, 0.1


def notes(result: Result, review: Review) -> None:
    """Say what a reader must know: verdicts first, then what does not fit, then how it was done."""
    for words in result.verdicts:
        review.note(words)
    for f in result.filters:
        worst = max(f.nis_position, f.nis_velocity or 0.0)
        if worst > MISFIT or f.refused > REFUSED * f.fixes:
            review.note(
                f"{f.name} does not fit this log: its innovations are {np.sqrt(worst):.1f} times larger than it thinks, "
                f"{f.refused} of {f.fixes} fixes are refused at the gate"
            )
    for one in result.summary:
        if one.choice is not None:
            best = one.choice.candidates[0]
            review.note(
                f"{one.duration:g} s: {best.model} makes the errors likeliest, chosen in {best.folds} of {one.choice.folds} blocks"
            )
    review.note(f"drift is measured against {result.reference}")
    for note in result.notes:
        review.note(note)
    review.note(_aids_text(result.replay.runs))
    if result.clocks is not None:
        review.note(_clocks_text(result.clocks))
    if result.mounting is not None:
        roll, pitch, heading = result.mounting.angles
        review.note(
            f"mounting, from the log itself: roll {roll:.2f}, pitch {pitch:.2f}, heading {heading:.2f} "
            f"± {result.mounting.heading_half_width:.2f} deg"
        )
    if result.tuned is not None:
        review.note(_tuned_text(result.tuned))


def _aids_text(runs: dict[str, Run]) -> str:
    aids = next(iter(runs.values())).solution.model.aids
    said = [
        f"{what} (sigma {sigma:g} m/s)"
        for what, sigma in (("no slip", aids.straight), ("standing still", aids.still), ("the log's speed", aids.speed))
        if sigma
    ]
    return f"besides fixes the filters use {', '.join(said)}" if said else "filters use fixes alone: no other aid"


def _clocks_text(c: Clocks) -> str:
    said: list[str] = []
    if c.delay is not None and c.velocity_delay is not None:
        said.append(f"fixes are {_signed(c.delay, 1e3, 'ms late', 'ms early')}")
        said.append(
            f"their velocities are {_signed(c.velocity_delay, 1e3, 'ms older', 'ms younger')} than their positions"
        )
    if c.rate is not None:
        longer = Interval(c.rate.value - 1, c.rate.lower - 1, c.rate.upper - 1)
        said.append(f"a second of the IMU is {_signed(longer, 1e6, 'millionths longer', 'millionths shorter')}")
    return f"{', '.join(said)}: by the likelihood of the innovations, with white noise {c.noise:.2g} times the model's"


def _signed(x: Interval, factor: float, above: str, below: str) -> str:
    """Return a value of either sign with its interval in words."""
    sign = 1 if x.value >= 0 else -1
    ends = sorted((sign * x.lower * factor, sign * x.upper * factor))
    told = f" [{ends[0]:.0f}, {ends[1]:.0f}]" if np.isfinite(ends).all() else " (nothing bounds it)"
    return f"{abs(x.value) * factor:.0f}{told} {above if sign > 0 else below}"


def _tuned_text(t: Tuned) -> str:
    return (
        f"tuned on {t.fitted} outages before {t.split:.0f} s: white noise of gyros x {t.white[0]:.2g}, of accelerometers "
        f"x {t.white[1]:.2g}, slower noise x {t.slow[0]:.2g} and x {t.slow[1]:.2g}; on the {t.judged} outages behind, which it "
        f"has not seen, NEES/2 at the end goes from {t.nees_per_dof[0]:.2f} to {t.nees_per_dof[1]:.2f} and the median error "
        f"from {number(t.median_end[0])} to {number(t.median_end[1])} m"
    )


def metres(interval: Interval) -> str:
    """Return a length with its interval, if it has one."""
    if not np.isfinite(interval.lower):
        return f"{number(interval.value)} m"
    return f"{number(interval.value)} [{number(interval.lower)}, {number(interval.upper)}] m"


def percent(interval: Interval) -> str:
    """Return a share in per cent, likewise."""
    told = f"{interval.value * 100:.1f}"
    if np.isfinite(interval.lower):
        told += f" [{interval.lower * 100:.1f}, {interval.upper * 100:.1f}]"
    return f"{told} %"


def number(value: float) -> str:
    """Return a figure with three digits, never as a power of ten."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"  # noqa: PLR2004 - three digits

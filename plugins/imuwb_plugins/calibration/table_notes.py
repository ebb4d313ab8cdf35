"""What a reader of a rate table's result must know."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from imuwb.identification.calibration import RateRun, RateTableCalibration
    from imuwb_plugins.calibration.parameters import RateTable

MISSED = 1e-3  #: of the span, by which a step misses the fitted line where something is wrong
LARGE = 0.1  #: of a scale factor


def table_notes(
    runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable, full_range: float, *, known: bool
) -> tuple[str, ...]:
    """Return notes on the rates, the axes, the bias and the earth's rate.

    Args:
        runs: as they were fitted.
        fit: what they tell.
        p: what was asked for.
        full_range: rad/s, of the non-linear part.
        known: g-sensitivity is taken off.
    """
    return (*_doubts(runs, fit, p), *_axes(runs, fit, p, full_range), *_bias(runs, p, known=known))


def _doubts(runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable) -> Iterator[str]:
    """Yield what looks as if the given rates were wrong."""
    for run, found in zip(runs, fit.runs, strict=True):
        missed = float(np.abs(found.residual[:, run.axis]).max() / np.ptp(run.means.value[:, run.axis]))
        if missed > MISSED:
            yield f"{run.name}: steps miss the fitted line by up to {100 * missed:.2g} % of their span: are the rates right?"
    for k, c in zip("xyz", fit.axes, strict=True):
        if c.scale_factor is not None and not p.raw and abs(c.scale_factor.value) > LARGE:
            yield f"gyro_{k}: a scale factor of {100 * c.scale_factor.value:+.0f} % is more than sensors have: are the rates right?"


def _axes(runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable, full_range: float) -> Iterator[str]:
    missing = [k for i, k in enumerate("xyz") if all(run.axis != i for run in runs)]
    if missing:
        yield f"no run turns {', '.join(missing)}: no scale factor there, and no coupling of its rate into the others"
    for run in runs:
        if not run.rate.min() < 0 < run.rate.max():
            yield f"{run.name}: it turns one way only; bias and scale factor lean on each other"
    turned = [c for c in fit.axes if c.scale_factor is not None]
    if any(c.scale_factor_nonlinear is None for c in turned):
        yield "one rate alone does not part the non-linear scale factor from the linear one: it is left out"
    if any(c.scale_factor_nonlinear is not None for c in turned):
        yield f"the non-linear part is told for a full range of {np.degrees(full_range):g} deg/s"
    yield (
        f"cross-couplings are those against the table's axis; a mounting {p.misplacement:g}° rms off (--misplacement) is in "
        "their intervals"
    )


def _bias(runs: Sequence[RateRun], p: RateTable, *, known: bool) -> Iterator[str]:
    if known:
        yield "g-sensitivity of the given model is taken off"
    elif len(runs) > 1:
        yield (
            f"the bias is the mean over {len(runs)} runs, with the interval of their scatter: g-sensitivity differs with attitude; "
            "--into with a six-position's model takes it off"
        )
    else:
        yield "the bias is that of one attitude: g-sensitivity is in it"
    if p.latitude is None:
        yield "the earth's rate (0.0042 deg/s) is not taken off without --latitude; it is in the intervals"
    elif any(run.up is None for run in runs):
        yield "without an accelerometer nobody knows which way the turned axis points: the earth's rate is in the intervals"

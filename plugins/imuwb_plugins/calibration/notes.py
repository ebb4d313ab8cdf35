"""Notes on the results of a calibration."""

from collections.abc import Iterator, Sequence

import numpy as np

from imuwb.identification.calibration import Means, MovedGyros, PositionCalibration, RateRun, RateTableCalibration
from imuwb.notes import Note
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.calibration.parameters import Positions, RateTable, SixPosition

UNLIKELY = 0.01  #: probability of the residuals, below which noise does not explain them
RARE = 1e-6  #: smaller probabilities are not printed
MISSED = 1e-3  #: share of the span; a step that misses the fitted line by more shows wrong rates
LARGE = 0.1  #: largest plausible scale factor


def probability_text(probability: float) -> str:
    """Return a small probability."""
    return "below 1e-6" if probability < RARE else f"{probability:.1e}"


def position_notes(
    p: Positions, gravity: tuple[float, str], fit: PositionCalibration, full_range: float | None
) -> Iterator[Note]:
    """Yield notes on gravity, misplacement, residuals and what the method leaves out.

    Args:
        p: the options.
        gravity: m/s², and where it comes from.
        fit: calibration of the accelerometers.
        full_range: m/s², of the non-linear part; None: the method has none.
    """
    yield _gravity(p, gravity)
    yield from _residuals(p, fit)
    if isinstance(p, SixPosition):
        yield Note("no-non-linear", "the scale factor includes the non-linear part: the six faces do not separate them")
    elif full_range is None:
        yield Note(
            "frame",
            "attitudes are not known: the x axis is that of the x accelerometer and y lies in the plane of x and y, so the "
            "cross-couplings of y and z into x, and of z into y, are 0 by definition",
        )
        yield Note(
            "three-quarters", "there is no non-linear part: the scale factor includes about three quarters of it"
        )
    elif fit.axes[0].scale_factor_nonlinear is None:
        yield Note(
            "no-non-linear", "there is no non-linear part: these positions do not separate it from the scale factor"
        )
    else:
        yield Note(
            "full-range", f"the non-linear part is defined on a full range of {full_range / STANDARD_GRAVITY:g} g"
        )


def _gravity(p: Positions, gravity: tuple[float, str]) -> Note:
    text = f"gravity {gravity[0]:.6f} m/s² ({gravity[1]})"
    if p.gravity is not None:
        return Note("gravity", text)
    if p.latitude is None:
        error = "gravity on earth differs by up to 0.3 %, and all three scale factors would have this error"
        return Note("gravity-unknown", f"{text}; {error}")
    error = (
        "the local gravity anomaly (50 mGal are 0.005 %) is an error of all three scale factors that no position shows"
    )
    return Note("gravity-anomaly", f"{text}; {error}")


def _residuals(p: Positions, fit: PositionCalibration) -> Iterator[Note]:
    if fit.misplacement is not None:
        tilt = f"{np.degrees(fit.misplacement):.3g}° rms"
        yield Note("misplaced", f"positions are tilted by {tilt}; the intervals of the cross-couplings include this")
    unlikely = fit.freedom and fit.probability < UNLIKELY
    chance = probability_text(fit.probability)
    if fit.misplacement is None and unlikely:
        yield Note(
            "residuals", f"residuals are larger than the noise (probability {chance}); the intervals include them"
        )
    if p.misplacement is not None and unlikely:
        yield Note(
            "too-narrow",
            f"residuals are larger than noise and --misplacement {p.misplacement:g} explain (probability {chance}): the "
            "intervals are too narrow; without --misplacement it is estimated from the residuals",
        )
    if fit.misplacement is None and not fit.freedom:
        yield Note(
            "no-residuals",
            "there are as many parameters as positions, so no residuals; take more positions to check the fit",
        )


def gyro_note(p: Positions, moved: MovedGyros | None) -> Note:
    """Return a note on what the gyros' calibration is made from.

    Args:
        p: the options.
        moved: calibration from the motions between positions; None: from still positions only.
    """
    if moved is None:
        text = "gyros: still positions give bias and g-sensitivity; scale factors and cross-couplings need a rate table"
    else:
        apart = np.degrees(float(np.sqrt((moved.apart**2).mean())))
        text = (
            f"gyros: over {len(moved.apart)} motions between positions, their integral and the accelerometers differ by {apart:.2g}° rms, "
            f"{moved.excess:.2g} times the known noise; there is no non-linear part: the scale factor includes some of it"
        )
    if p.latitude is None:
        text += "; without --latitude the earth's rate (0.0042 deg/s) is not subtracted, and the intervals include it"
    return Note("gyros" if moved is None else "gyros-moved", text)


def red_notes(sensor: str, means: Means) -> Iterator[Note]:
    """Yield a note if the noise within positions is not white."""
    if any(means.red):
        axes = ", ".join(k for k, red in zip("xyz", means.red, strict=True) if red)
        yield Note(
            "red-noise",
            f"{sensor} {axes}: noise within positions is not white; the mean over a position is no more certain than the "
            "mean over a quarter of it, and the bias is valid only at the time of the record",
        )


def table_notes(
    runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable, full_range: float, *, known: bool
) -> tuple[Note, ...]:
    """Return notes on the rates, the axes, the bias and the earth's rate.

    Args:
        runs: the runs of the table.
        fit: the fit to the runs.
        p: the options.
        full_range: rad/s, of the non-linear part.
        known: whether the g-sensitivity is subtracted.
    """
    return (*_doubts(runs, fit, p), *_axes(runs, fit, p, full_range), *_bias(runs, p, known=known))


def _doubts(runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable) -> Iterator[Note]:
    for run, fitted in zip(runs, fit.runs, strict=True):
        missed = float(np.abs(fitted.residual[:, run.axis]).max() / np.ptp(run.means.value[:, run.axis]))
        if missed > MISSED:
            yield Note(
                "steps-miss",
                f"{run.name}: steps miss the fitted line by up to {100 * missed:.2g} % of their span; check the rates",
            )
    for k, c in zip("xyz", fit.axes, strict=True):
        if c.scale_factor is not None and not p.raw and abs(c.scale_factor.value) > LARGE:
            yield Note(
                "large-scale-factor",
                f"gyro_{k}: a scale factor of {100 * c.scale_factor.value:+.0f} % is implausibly large; check the rates",
            )


def _axes(runs: Sequence[RateRun], fit: RateTableCalibration, p: RateTable, full_range: float) -> Iterator[Note]:
    missing = [k for i, k in enumerate("xyz") if all(run.axis != i for run in runs)]
    if missing:
        yield Note(
            "not-turned",
            f"no run turns {', '.join(missing)}: these axes get no scale factor, and the others no coupling of their rate",
        )
    for run in runs:
        if not run.rate.min() < 0 < run.rate.max():
            yield Note("one-way", f"{run.name}: it turns in one direction only; bias and scale factor are correlated")
    turned = [c for c in fit.axes if c.scale_factor is not None]
    if any(c.scale_factor_nonlinear is None for c in turned):
        yield Note(
            "no-non-linear", "there is no non-linear part: a single rate does not separate it from the scale factor"
        )
    if any(c.scale_factor_nonlinear is not None for c in turned):
        yield Note("full-range", f"the non-linear part is defined on a full range of {np.degrees(full_range):g} deg/s")
    yield Note(
        "mounting",
        f"cross-couplings are relative to the table's axis; their intervals include a mounting error of {p.misplacement:g}° rms "
        "(--misplacement)",
    )


def _bias(runs: Sequence[RateRun], p: RateTable, *, known: bool) -> Iterator[Note]:
    if known:
        yield Note("g-sensitivity", "the g-sensitivity of the given model is subtracted")
    elif len(runs) > 1:
        yield Note(
            "bias-of-runs",
            f"the bias is the mean over {len(runs)} runs, with the interval of their scatter, since g-sensitivity differs with "
            "attitude; --into with a model of six-position subtracts it",
        )
    else:
        yield Note("bias-of-one-attitude", "the bias is that of one attitude: it includes the g-sensitivity")
    if p.latitude is None:
        yield Note(
            "earth-rate",
            "without --latitude the earth's rate (0.0042 deg/s) is not subtracted, and the intervals include it",
        )
    elif any(run.up is None for run in runs):
        yield Note(
            "earth-rate",
            "without an accelerometer the direction of the turned axis is not known, and the intervals include the earth's rate",
        )

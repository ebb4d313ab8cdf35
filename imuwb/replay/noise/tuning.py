"""The noise of a filter, fitted to outages in the first part of a log and judged on those in the rest."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.outages import drift
from imuwb.replay.noise.scaled import scaled
from imuwb.replay.outages import Outage, events_of, sweep, with_gap
from imuwb.replay.prepared import Prepared, run
from imuwb.replay.references.reference import ReferenceTrack, own_track, reference_names, reference_track
from imuwb.replay.references.reference_check import FROM_FIXES, contradiction, discrepancy, elsewhere, yardsticks
from imuwb.replay.scoring.choice import log_likelihood
from imuwb.replay.scoring.overlap import without_overlap
from imuwb.replay.scoring.scores import Scores, scores

DURATION = 30.0  #: s, of the outages
AT = (5.0, 10.0, 20.0, 30.0)  #: s since the start of an outage; the errors at these times count
SHARE = 0.5  #: share of the log to which the noise is fitted
LEAST = 4  #: outages in each part
STEP = 1.0  #: size of the first simplex, in the logarithm of a factor
PRIOR = 2.0  #: sigma of the logarithm of a factor: a factor without effect in outages stays near 1


@dataclass(frozen=True, slots=True)
class Tuned:
    """Factors of a filter's noise, and their effect in outages to which they were not fitted."""

    white: tuple[float, float]  #: factors of the white noise of gyros and accelerometers
    slow: tuple[float, float]  #: factors of the slower processes of gyros and accelerometers
    fitted: int  #: outages
    judged: int  #: outages
    split: float  #: s from the log's start; the outages before are fitted, those after are judged
    log_likelihood: tuple[float, float]  #: of an outage, mean over the judged outages, before and after tuning
    nees_per_dof: tuple[float, float]  #: at the end, before and after tuning
    median_end: tuple[float, float]  #: m, before and after tuning

    def __str__(self) -> str:
        """Return the factors and their effect in a line."""
        return (
            f"Tuned: white noise x {self.white[0]:.2g} and x {self.white[1]:.2g}, slower noise x {self.slow[0]:.2g} and "
            f"x {self.slow[1]:.2g}; NEES/2 {self.nees_per_dof[0]:.2f} before and {self.nees_per_dof[1]:.2f} after"
        )


def tune(prepared: Prepared, model: FilterModel, reference: str) -> tuple[FilterModel, Tuned]:
    """Return a filter with the noise for which the errors in outages are most likely, and its results in other outages.

    The outages do not overlap. The horizontal errors at several times in an outage count as independent, with the filter's own
    covariance.

    Args:
        prepared: the log.
        model: the filter.
        reference: as for ``replay``.

    Raises:
        ValueError: the log is too short; the log lacks the wanted reference.
    """
    track = _track(prepared, model, reference)
    early, late, split = _parts(prepared, model, track)

    def misfit(factors: Floats) -> float:
        _, errors = _scored(prepared, model, factors, early, track)
        value = -float(np.nanmean(log_likelihood(errors, AT))) * len(early)
        return value + float((factors**2).sum()) / (2 * PRIOR**2)

    start = np.zeros(4)
    options = {"initial_simplex": np.vstack([start, np.eye(4) * STEP]), "xatol": 0.02, "fatol": 0.02, "maxfev": 160}
    from scipy import optimize  # noqa: PLC0415 - scipy is slow to import

    best = optimize.minimize(misfit, start, method="Nelder-Mead", options=options)
    tuned, after = _scored(prepared, model, best.x, late, track)
    _, before = _scored(prepared, model, start, late, track)
    g, a, slow_g, slow_a = (float(f) for f in np.exp(best.x))
    likelihoods, nees, medians = zip(_figures(before), _figures(after), strict=True)
    return tuned, Tuned((g, a), (slow_g, slow_a), len(early), len(late), split, likelihoods, nees, medians)


def _figures(errors: Scores) -> tuple[float, float, float]:
    """Return log-likelihood, NEES over its degrees of freedom at the end, and median error at the end, m."""
    return (
        float(np.nanmean(log_likelihood(errors, AT))), float(np.nanmean(errors.nees[:, -1]) / 2),
        float(np.nanmedian(errors.horizontal[:, -1])),
    )  # fmt: skip


def _track(prepared: Prepared, model: FilterModel, wanted: str) -> ReferenceTrack:
    """Return the first of the wanted references that does not contradict the fixes.

    Raises:
        ValueError: none; the message states why.
    """
    refused: list[str] = []
    for name in reference_names(prepared.log, wanted):
        track = reference_track(prepared.log, run(model, prepared, smooth=name == "smoothed"), name)
        reason = elsewhere(track, prepared)
        if reason is None and track.kind in FROM_FIXES:
            reason = contradiction(track, prepared)
        if reason is None:
            return track
        refused.append(f"{track.name}: {reason}")
    raise ValueError(f"no reference can judge the noise: {'; '.join(refused)}")


def _parts(
    prepared: Prepared, model: FilterModel, track: ReferenceTrack
) -> tuple[list[Outage], list[Outage], float]:  # fmt: skip
    """Return the outages to fit, those to judge, and the time between; only those in which the reference can judge."""
    swept = sweep(prepared, model, DURATION)
    whole = [o for o, lacking in zip(swept, with_gap(prepared, swept), strict=True) if not lacking]
    if whole:
        solution = run(model, prepared)
        drifted = drift(solution, events_of(solution, whole), DURATION)
        extent = discrepancy(track, drifted.start, drifted.time)[:, -1]
        able = yardsticks(extent, [scores(drifted, own_track(solution))])
        whole = [o for o, can in zip(whole, able, strict=True) if can or track.kind == "own"]
    alone = [whole[i] for i in without_overlap([o.start for o in whole], DURATION)]
    split = alone[0].start + SHARE * (alone[-1].start + DURATION - alone[0].start) if alone else 0.0
    early = [o for o in alone if o.start + o.duration <= split]
    late = [o for o in alone if o.start >= split]
    if min(len(early), len(late)) < LEAST:
        raise ValueError(
            f"tuning needs {LEAST} outages of {DURATION:g} s that do not overlap in each half of the log; there are "
            f"{len(early)} and {len(late)}; use a longer log"
        )
    return early, late, float(split)


def _scored(
    prepared: Prepared, model: FilterModel, factors: Floats, outages: Sequence[Outage], track: ReferenceTrack
) -> tuple[FilterModel, Scores]:
    """Return the filter with its noise scaled, and its scores in some outages.

    Args:
        prepared: the log.
        model: the filter.
        factors: (4,) logarithms of the factors: white and slower noise, each of gyros and accelerometers.
        outages: all last ``DURATION``.
        track: the reference.
    """
    g, a, slow_g, slow_a = (float(f) for f in np.exp(factors))
    changed = replace(model, error_model=scaled(model.error_model, (g, a), (slow_g, slow_a)))
    solution = run(changed, prepared)
    drifted = drift(solution, events_of(solution, outages), DURATION)
    extent = discrepancy(track, drifted.start, drifted.time) if track.kind != "own" else None
    return changed, scores(drifted, track, extent)

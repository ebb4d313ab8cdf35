"""Outage replay: filters over a log, their drift against a reference, and its statistics."""

from imuwb.replay.clocks import Clocks, estimate_clocks
from imuwb.replay.fixes.degraded import Degradation, degraded
from imuwb.replay.fixes.refusals import Refusals, refusal_note, refusals
from imuwb.replay.models import AR_ORDERS, NAMES, TURN_ON, kept, model_named
from imuwb.replay.mounting import Mounting, estimate_mounting
from imuwb.replay.noise.denoised_ar import of_static, with_autoregressive
from imuwb.replay.noise.gnss_correlation import GnssCorrelation, estimate_gnss_correlation
from imuwb.replay.noise.motion_noise import MotionNoise, estimate_motion_noise, in_motion, usual_in_motion
from imuwb.replay.noise.scaled import scaled
from imuwb.replay.noise.tuning import Tuned, tune
from imuwb.replay.noise.unidentified import with_unidentified
from imuwb.replay.outages import Outage, check_outages, events_of, own_outages, sweep
from imuwb.replay.prepared import Prepared, prepare, receiver_of, run
from imuwb.replay.references.external import Placing, external_reference
from imuwb.replay.references.reference import ReferenceTrack, check_reference, own_track, reference_track
from imuwb.replay.references.true_errors import true_errors
from imuwb.replay.replay import FilterRun, Replay, ScoredDrift, replay
from imuwb.replay.scoring.budget import Budget, budget
from imuwb.replay.scoring.choice import Choice, FilterCandidate, choose
from imuwb.replay.scoring.motion import motion_classes
from imuwb.replay.scoring.overlap import effective_count, without_overlap
from imuwb.replay.scoring.pooling import pooled
from imuwb.replay.scoring.scores import HORIZONS, Scores, scores
from imuwb.replay.scoring.solutions import fixes_outside, overlapping, solution_scores, whole_run_scores
from imuwb.replay.scoring.statistics import FEWEST as ENOUGH
from imuwb.replay.scoring.statistics import (
    Consistency,
    DriftCurve,
    Paired,
    Summary,
    compare,
    drift_curve,
    summarize,
    verdict,
)
from imuwb.replay.starts.start import Start, find_start, given_start

__all__ = [
    "AR_ORDERS",
    "ENOUGH",
    "HORIZONS",
    "NAMES",
    "TURN_ON",
    "Budget",
    "Choice",
    "Clocks",
    "Consistency",
    "Degradation",
    "DriftCurve",
    "FilterCandidate",
    "FilterRun",
    "GnssCorrelation",
    "MotionNoise",
    "Mounting",
    "Outage",
    "Paired",
    "Placing",
    "Prepared",
    "ReferenceTrack",
    "Refusals",
    "Replay",
    "ScoredDrift",
    "Scores",
    "Start",
    "Summary",
    "Tuned",
    "budget",
    "check_outages",
    "check_reference",
    "choose",
    "compare",
    "degraded",
    "drift_curve",
    "effective_count",
    "estimate_clocks",
    "estimate_gnss_correlation",
    "estimate_motion_noise",
    "estimate_mounting",
    "events_of",
    "external_reference",
    "find_start",
    "fixes_outside",
    "given_start",
    "in_motion",
    "kept",
    "model_named",
    "motion_classes",
    "of_static",
    "overlapping",
    "own_outages",
    "own_track",
    "pooled",
    "prepare",
    "receiver_of",
    "reference_track",
    "refusal_note",
    "refusals",
    "replay",
    "run",
    "scaled",
    "scores",
    "solution_scores",
    "summarize",
    "sweep",
    "true_errors",
    "tune",
    "usual_in_motion",
    "verdict",
    "whole_run_scores",
    "with_autoregressive",
    "with_unidentified",
    "without_overlap",
]  # fmt: skip

"""Outages replayed: filters over a log, their drift against a reference, and what that says of them."""

from imuwb.replay.delay import estimate_delay
from imuwb.replay.models import NAMES, model_named
from imuwb.replay.motion import motion_classes
from imuwb.replay.reference import Yardstick, own, yardstick
from imuwb.replay.replay import Outage, Prepared, Replay, Replayed, Run, prepare, replay, run, sweep
from imuwb.replay.scores import HORIZONS, Scores, scores
from imuwb.replay.statistics import (
    Consistency,
    Interval,
    Paired,
    Summary,
    compare,
    drift_curve,
    effective_count,
    summarize,
    verdict,
)

__all__ = [
    "HORIZONS",
    "NAMES",
    "Consistency",
    "Interval",
    "Outage",
    "Paired",
    "Prepared",
    "Replay",
    "Replayed",
    "Run",
    "Scores",
    "Summary",
    "Yardstick",
    "compare",
    "drift_curve",
    "effective_count",
    "estimate_delay",
    "model_named",
    "motion_classes",
    "own",
    "prepare",
    "replay",
    "run",
    "scores",
    "summarize",
    "sweep",
    "verdict",
    "yardstick",
]

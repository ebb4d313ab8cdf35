"""Outages replayed: filters over a log, their drift against a reference, and what that says of them."""

from imuwb.replay.budget import Budget, budget
from imuwb.replay.choice import Choice, choose
from imuwb.replay.clocks import Clocks, estimate_clocks
from imuwb.replay.degraded import Degradation, degraded
from imuwb.replay.models import NAMES, model_named
from imuwb.replay.motion import motion_classes
from imuwb.replay.mounting import Mounting, estimate_mounting
from imuwb.replay.reference import Yardstick, own, yardstick
from imuwb.replay.replay import (
    Outage,
    Prepared,
    Replay,
    Replayed,
    Run,
    apart,
    events_of,
    own_outages,
    prepare,
    replay,
    run,
    sweep,
)
from imuwb.replay.scaled import scaled
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
from imuwb.replay.true_errors import true_errors
from imuwb.replay.tuning import Tuned, tune

__all__ = [
    "HORIZONS",
    "NAMES",
    "Budget",
    "Choice",
    "Clocks",
    "Consistency",
    "Degradation",
    "Interval",
    "Mounting",
    "Outage",
    "Paired",
    "Prepared",
    "Replay",
    "Replayed",
    "Run",
    "Scores",
    "Summary",
    "Tuned",
    "Yardstick",
    "apart",
    "budget",
    "choose",
    "compare",
    "degraded",
    "drift_curve",
    "effective_count",
    "estimate_clocks",
    "estimate_mounting",
    "events_of",
    "model_named",
    "motion_classes",
    "own",
    "own_outages",
    "prepare",
    "replay",
    "run",
    "scaled",
    "scores",
    "summarize",
    "sweep",
    "true_errors",
    "tune",
    "verdict",
    "yardstick",
]

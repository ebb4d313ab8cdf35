"""The family of many sensors of one type: its mean and spread, the sensors outside it, and those that change from log to log."""

from imuwb.identification.family.changes import Change
from imuwb.identification.family.judgement import Judged, Judgement, judge
from imuwb.identification.family.limits import Limits
from imuwb.identification.family.members import Members, Outside
from imuwb.identification.family.observations import Observations, observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.identification.family.tails import tails_together

__all__ = [
    "Change", "Judged", "Judgement", "Limits", "Members", "Observations", "Outside", "RandomEffects", "judge", "observations", "random_effects",
    "tails_together",
]  # fmt: skip

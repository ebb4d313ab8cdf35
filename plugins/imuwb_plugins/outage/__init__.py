"""Outage replay: drift of loosely coupled GNSS/INS filters by error model, with intervals, and whether their sigma is right.

Each filter runs once over all fixes. Outages then branch off after the fixes: a sweep, or those of --at. The drift is measured
against the best reference of the log: truth, RTK-fixed positions, or a filter's smoothed run.

Example: imuwb outage drive.mcap --error-model static.error-model.toml --lever-arm 0.4,0,-1.2 --straight 0.2
"""

import lazy_loader

DEMO = "drive"
LOGS = (1, None)

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["Parameters"], "drives": ["run", "error_model"], "drives_show": ["draw"], "answer": ["answer"],
        "drifts": ["drifts"],
        "output": ["outputs", "write_outputs"],
    },
)  # fmt: skip

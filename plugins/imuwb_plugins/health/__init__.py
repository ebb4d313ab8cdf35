"""Faults of a log: gaps, stuck or saturated channels, spikes, wrong gravity, with time, count and consequence.

A verdict for each stream, its rate over time, when the IMU is still and when it moves, and the tracks.

Example: imuwb health flight.bin --json faults.json
"""

import lazy_loader

EVERY_IMU = True
TAKES_COUNTS = True

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["SHOWS_FAULTS", "Parameters"],
        "compute": ["run"],
        "show": ["draw"],
        "answer": ["answer"],
    },
)

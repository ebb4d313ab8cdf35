"""Logs of known truth: what a sensor of a given error model would have put out."""

from imuwb.simulation.presets import preset, preset_names
from imuwb.simulation.static import static

__all__ = ["preset", "preset_names", "static"]

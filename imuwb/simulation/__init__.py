"""Logs of known truth: what a sensor of a given error model would have put out."""

from imuwb.simulation.drive import drive
from imuwb.simulation.plans import PlannedOutage, mixed_route, planned_outages, planned_route
from imuwb.simulation.presets import preset, preset_names
from imuwb.simulation.receiver import Odometer, Receiver
from imuwb.simulation.route import Route
from imuwb.simulation.static import static

__all__ = [
    "Odometer",
    "PlannedOutage",
    "Receiver",
    "Route",
    "drive",
    "mixed_route",
    "planned_outages",
    "planned_route",
    "preset",
    "preset_names",
    "static",
]

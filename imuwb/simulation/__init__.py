"""Simulated logs with known truth: the output of a sensor with a given error model."""

from imuwb.simulation.bench import Site
from imuwb.simulation.chamber import chamber, set_points
from imuwb.simulation.drive import drive
from imuwb.simulation.gnss_errors import GnssErrors
from imuwb.simulation.motion_noise import MotionNoise
from imuwb.simulation.plans import PlannedOutage, mixed_route, planned_outages, planned_route
from imuwb.simulation.presets import preset, preset_names
from imuwb.simulation.rate_table import RateTable, rate_table
from imuwb.simulation.receiver import Odometer, Receiver
from imuwb.simulation.road import Road
from imuwb.simulation.road_vibration import RoadVibration
from imuwb.simulation.route import Route
from imuwb.simulation.six_position import Positions, six_position
from imuwb.simulation.static import static
from imuwb.simulation.suspension import Suspension
from imuwb.simulation.thermal import Temperature
from imuwb.simulation.tolerances import Tolerances, specimen

__all__ = [
    "GnssErrors",
    "MotionNoise",
    "Odometer",
    "PlannedOutage",
    "Positions",
    "RateTable",
    "Receiver",
    "Road",
    "RoadVibration",
    "Route",
    "Site",
    "Suspension",
    "Temperature",
    "Tolerances",
    "chamber",
    "drive",
    "mixed_route",
    "planned_outages",
    "planned_route",
    "preset",
    "preset_names",
    "rate_table",
    "set_points",
    "six_position",
    "specimen",
    "static",
]

"""The quantities of a text log, and what their units measure."""

from collections.abc import Iterable, Mapping

from imuwb.errors import UsageError
from imuwb.units import COUNT, SENSORS, Unit, unit

#: quantity -> the dimension of its units
DIMENSIONS = {
    "gyro": "angular_rate", "accel": "specific_force", "time": "time", "temperature": "temperature",
    "latitude": "angle", "longitude": "angle", "height": "length",
    "velocity_north": "speed", "velocity_east": "speed", "velocity_down": "speed", "velocity_up": "speed",
    "sigma_north": "length", "sigma_east": "length", "sigma_down": "length",
    "sigma_velocity_north": "speed", "sigma_velocity_east": "speed", "sigma_velocity_down": "speed",
    "sigma_attitude_north": "angle", "sigma_attitude_east": "angle", "sigma_attitude_down": "angle",
    "fix_type": "dimensionless", "speed": "speed", "roll": "angle", "pitch": "angle", "heading": "angle",
    "week": "dimensionless",
    # of known shapes alone: increments over a step, heights above the sea, velocities along a course, and what tells rows apart
    "attitude_increment": "angle", "velocity_increment": "speed", "step": "time", "height_msl": "length", "undulation": "length",
    "sigma_horizontal": "length", "sigma_vertical": "length", "sigma_speed": "speed", "ground_speed": "speed", "course": "angle",
    "instance": "dimensionless", "counter": "dimensionless",
}  # fmt: skip
#: The unit of one of these names is the unit of several quantities.
GROUPS = {
    "position": ("latitude", "longitude"),
    "velocity": ("velocity_north", "velocity_east", "velocity_down", "velocity_up"),
}


def measures(measure: Unit, quantity: str) -> bool:
    """Return whether a unit is one of a quantity; samples of gyros and accelerometers may be counts."""
    return measure.dimension == DIMENSIONS[quantity] or (quantity in SENSORS and measure.name == COUNT)


def units_text(units: Iterable[tuple[str, Unit | None]]) -> str:
    """Return the names of units, each once, from (quantity, unit); counts are named with their sensor: ``gyro count, m/s²``."""
    names = (f"{quantity} {COUNT}" if u.name == COUNT else u.name for quantity, u in units if u is not None)
    return ", ".join(dict.fromkeys(names))


def units_by_quantity(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the unit of each quantity; ``position`` and ``velocity`` stand for their parts.

    Raises:
        UsageError: an unknown quantity or unit, or a unit of another dimension.
    """
    units: dict[str, str] = {}
    for quantity, text in texts.items():
        for name in GROUPS.get(quantity, (quantity,)):
            if name not in DIMENSIONS:
                raise UsageError(
                    f"units: there is no quantity {quantity!r}; write one of: {', '.join((*DIMENSIONS, *GROUPS))}"
                )
            if not measures(unit(text), name):
                dimension = DIMENSIONS[name].replace("_", " ")
                raise UsageError(f"units: {text!r} is not a unit of {dimension}, which {quantity} needs")
            units[name] = text
    return units

"""How many sensors and vehicles some logs are of, counted alike by every command of a fleet."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from imuwb.texts import counted, name_of, names_text

MOST = 4  #: vehicles that a sentence names


@dataclass(frozen=True, slots=True)
class Owned:
    """Whose some logs are. A serial number names one sensor, wherever it is mounted."""

    sensors: int  #: with a serial number or a name
    vehicles: int  #: of the logs that name a vehicle, and no sensor
    moved: tuple[tuple[str, tuple[str, ...]], ...]  #: serial number and vehicles, of each sensor that is in several
    unknown: int  #: logs of which neither is known

    @property
    def text(self) -> str:
        """Return whose the logs are: "2 sensors", "3 vehicles, whose sensors are not named"."""
        named = [counted(self.sensors, "sensor")] if self.sensors else []
        if self.vehicles:
            named.append(f"{counted(self.vehicles, 'vehicle')}, whose sensors are not named")
        return " and ".join(named) or "unknown sensors"

    @property
    def moved_text(self) -> str:
        """Return which serial number is in several vehicles; empty: none."""
        if not self.moved:
            return ""
        serial, vehicles = self.moved[0]
        where = f"{len(vehicles)} vehicles ({names_text([name_of(one) for one in vehicles], MOST)})"
        more = f", and {counted(len(self.moved) - 1, 'more serial')} in several" if len(self.moved) > 1 else ""
        return f"Serial {name_of(serial)} is in {where}{more}; a serial number counts as one sensor."

    @property
    def unknown_text(self) -> str:
        """Return of how many logs nothing is known; empty: none."""
        if not self.unknown:
            return ""
        return (
            f"The sensor of {counted(self.unknown, 'log')} is not known: --group, --identities or --metadata state it."
        )

    def sentences(self) -> tuple[str, ...]:
        """Return what a user must know of the owners before the logs are compared."""
        return tuple(filter(None, (self.moved_text, self.unknown_text)))


def owned(owners: Iterable[tuple[str | None, str | None]]) -> Owned:
    """Return whose some logs are.

    Args:
        owners: vehicle and serial number of each log; None: not known.
    """
    places: dict[str, set[str]] = defaultdict(set)
    vehicles: set[str] = set()
    unknown = 0
    for vehicle, serial in owners:
        if serial is not None:
            places[serial] |= set() if vehicle is None else {vehicle}
        elif vehicle is not None:
            vehicles.add(vehicle)
        else:
            unknown += 1
    moved = tuple((serial, tuple(sorted(own))) for serial, own in sorted(places.items()) if len(own) > 1)
    return Owned(len(places), len(vehicles), moved, unknown)

"""ROS messages and MCAP marks that readers and writers have in common."""

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product
from pathlib import Path
from typing import cast

MCAP_MAGIC = b"\x89MCAP0\r\n"
OURS = "imuwb"  #: name of the MCAP metadata that imuwb writes
TRUTH = "imuwb simulation"  #: name of the MCAP metadata with the parameters of a simulated log
ABSENT = -1.0  #: first element of a covariance: the message has no such measurement
UNKNOWN = -2  #: status of a fix whose status is not known
#: packages whose types are listed in ros_messages.toml if imuwb uses them
WELL_KNOWN = (
    "action_msgs", "actionlib_msgs", "bond", "composition_interfaces", "diagnostic_msgs", "dynamic_reconfigure", "foxglove_msgs",
    "geographic_msgs", "geometry_msgs", "lifecycle_msgs", "map_msgs", "nav_msgs", "nmea_msgs", "pcl_msgs", "rcl_interfaces",
    "rosbag2_interfaces", "roscpp", "rosgraph_msgs", "rtcm_msgs", "sensor_msgs", "service_msgs", "shape_msgs", "statistics_msgs",
    "std_msgs", "std_srvs", "stereo_msgs", "tf", "tf2_msgs", "trajectory_msgs", "type_description_interfaces", "unique_identifier_msgs",
    "vision_msgs", "visualization_msgs",
)  # fmt: skip
MOST_FORMS = 16  #: a type whose parts have more forms in all has only the first of them


def short(name: str) -> str:
    """Return a type as ``package/Type``, the form common to ROS 1 and ROS 2."""
    return name.replace("/msg/", "/")


def definition(name: str) -> str:
    """Return the whole definition of a message such as ``sensor_msgs/msg/Imu``; an empty text for an unknown message.

    Of a message that has had several forms, this is the newest.
    """
    return next(definitions(name), "")


def definitions(name: str) -> Iterator[str]:
    """Yield the whole definitions that a message has had, the newest first; nothing for an unknown message."""
    name = short(name)
    if name not in known():
        return
    parts = _parts(name)
    forms = [known()[part] for part in parts]
    count = 0
    for chosen in product(*forms):
        if (count := count + 1) > MOST_FORMS:
            return
        main, *others = (_lines(text) for text in chosen)
        yield ("=" * 80 + "\n").join([
            main, *(f"MSG: {part}\n{text}" for part, text in zip(parts[1:], others, strict=True))
        ])  # fmt: skip


@cache
def known() -> Mapping[str, tuple[str, ...]]:
    """Return {package/Type: its forms, the newest first}, each as ``type name name; type name``."""
    table = tomllib.loads(Path(__file__).with_name("ros_messages.toml").read_text("utf-8"))
    return {
        f"{package}/{name}": (forms,) if isinstance(forms, str) else tuple(forms)
        for package, types in cast("dict[str, dict[str, str | list[str]]]", table).items()
        for name, forms in types.items()
    }


def _lines(form: str) -> str:
    """Return a form as the lines of a definition, with one field each."""
    fields = (field.split() for field in form.split(";"))
    return "".join(f"{kind} {name}\n" for kind, *names in fields for name in names)


def _parts(name: str) -> list[str]:
    """Return a type and the types that it contains, directly or within another."""
    found = [name]
    for part in found:  # the list grows
        kinds = {field.split()[0].partition("[")[0] for form in known()[part] for field in form.split(";")}
        found += sorted(kind for kind in kinds if kind in known() and kind not in found)
    return found

"""Options for what a file does not state itself, such as its rate, units and frame."""

from collections.abc import (
    Collection,
    Mapping,
)
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Literal

from imuwb.errors import UsageError
from imuwb.options import Between, Form, check
from imuwb.readers.quantities import units_by_quantity
from imuwb.units import Epoch

#: Words for whose time stamp of a message is used; for a text log also the name of a column.
TIME_SOURCES = ("header", "log", "publish")


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How a file is read where it does not state this itself. Texts become values: ``units="gyro=deg/s,accel=g"``.

    Raises:
        UsageError: a value that is not allowed.
    """

    time_source: Annotated[
        str,
        "Time stamp of a message: its own (header), or the time of recording (log) or of sending (publish); "
        "of a text log also the name of a column.",
        Form("header|log|publish|COLUMN"),
    ] = "header"
    rate: Annotated[
        float | None,
        "Sampling rate of the IMU (Hz), if the log has no times or wrong ones; it beats the log's own times.",
        Between(1e-6, 1e8),
        Form("HZ", "100"),
    ] = None
    even: Annotated[
        bool,
        "The IMU samples evenly, whatever the log's times look like: each count of samples takes equally long.",
    ] = False
    columns: Annotated[
        tuple[str, ...],
        "Names of a text log's columns, in order; - for a column that is not used.",
        Form("NAMES", "time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"),
    ] = ()
    units: Annotated[
        Mapping[str, str], "Units of a text log's columns.", Form("QUANTITY=UNIT,...", "gyro=deg/s,accel=g,time=ms")
    ] = field(default_factory=dict[str, str])
    frame: Annotated[
        Literal["FRD", "FLU"] | None,
        "Body frame of the IMU, if the log does not state it: forward-right-down or forward-left-up.",
    ] = None
    epoch: Annotated[
        Epoch | None,
        "Start of a text log's time: 1970 UTC (unix), power-up (boot), or the log's own start (log).",
    ] = None

    messages: Annotated[
        Path | None,
        "Definitions of a ROS log's messages, if the log does not hold them: a folder with .msg files, or one of them.",
        Form("DIR", "my_msgs/msg"),
    ] = None
    memory: Annotated[
        float | None,
        "Memory (GB) that the reading may take, for a log that needs more than 1 GB and 100 times its size.",
        Between(0.01, 1e5),
        Form("GB", "8"),
    ] = None

    def __post_init__(self) -> None:
        """Check the values before a file is opened."""
        try:
            check(self)
        except ValueError as error:
            raise UsageError(str(error)) from error
        units_by_quantity(self.units)

    def unused(self, uses: Collection[str]) -> tuple[str, ...]:
        """Return the names of the options that are set but that a format does not use."""
        default = ReadOptions()
        changed = (f.name for f in fields(self) if getattr(self, f.name) != getattr(default, f.name))
        return tuple(name for name in changed if name not in uses)

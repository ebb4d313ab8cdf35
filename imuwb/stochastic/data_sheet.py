"""Numbers of data sheets as an error model: what a sheet states, in its own units and by its own definitions.

A data sheet is a TOML document with tables ``gyro`` and ``accel``, or one for an axis such as ``accel_z`` where it differs:

    name = "ABC-123"
    source = "ABC-123 data sheet, revision C, table 1"
    grade = "industrial"                  # consumer, industrial, tactical or navigation
    [gyro]
    N = "0.3 deg/√h"                      # angle random walk, or a noise density that is said to be two-sided
    noise_density = "0.01 deg/s/√Hz"      # rms in a bandwidth, one-sided or unsaid: N lies between it over √2 and it
    allan_minimum = "5 deg/h"             # in-run bias stability, the lowest point of the Allan curve
    bias_instability = "6 deg/h"          # of unsaid definition: B lies between it and it over 0.664
    K = "20 deg/h^1.5"                    # rate random walk
    turn_on = "0.2 deg/s"                 # 1 sigma of the bias at turn-on
    range = "450 deg/s"
    lsb = "0.1 deg/s"
    bandwidth = "330 Hz"

What a sheet does not state stays unknown.
"""

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import cast

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.error_model import ImuErrorModel
from imuwb.stochastic.flicker import FLICKER_LEVEL, FlickerNoise
from imuwb.stochastic.processes import Constant, RandomWalk, WhiteNoise
from imuwb.stochastic.sums import Process, Sum
from imuwb.units import UNITS, coefficient_units, quantity


@dataclass(frozen=True, slots=True)
class _Statement:
    """How one kind of statement becomes a process: the value as it stands in the model, and the interval of its definition."""

    like: str  #: coefficient whose unit it has
    process: Callable[[float], Process]
    parameter: str
    value: float  #: factor
    interval: tuple[float, float]  #: factors


_STATEMENTS: Mapping[str, _Statement] = {
    "N": _Statement("N", WhiteNoise, "N", 1.0, (1.0, 1.0)),
    "noise_density": _Statement("N", WhiteNoise, "N", 2**-0.25, (math.sqrt(0.5), 1.0)),
    "allan_minimum": _Statement("B", FlickerNoise, "B", 1 / FLICKER_LEVEL, (0.0, 1 / FLICKER_LEVEL)),
    "bias_instability": _Statement("B", FlickerNoise, "B", 1 / FLICKER_LEVEL, (1.0, 1 / FLICKER_LEVEL)),
    "B": _Statement("B", FlickerNoise, "B", 1.0, (1.0, 1.0)),
    "K": _Statement("K", RandomWalk, "K", 1.0, (1.0, 1.0)),
    "turn_on": _Statement("rate", Constant, "sigma", 1.0, (1.0, 1.0)),
}
_PLAIN = {"range": "rate", "lsb": "rate", "bandwidth": "Hz"}
_HEAD = ("name", "source", "grade", "note")


def read_data_sheet(text: str, where: str) -> ImuErrorModel:
    """Return the error model of a data sheet.

    Raises:
        UsageError: not TOML, or a statement, number or unit that is unknown; the message names file and key.
    """
    try:
        document: dict[str, object] = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise UsageError(f"{where}: not TOML: {error}") from error
    head = {key: str(document.pop(key)) for key in _HEAD if key in document}
    axes: dict[str, AxisModel] = {}
    for name in sorted(document, key=lambda key: "_" in key):  # an axis of its own comes after its triad
        own = [axis for axis in AXES if axis == name or axis.startswith(f"{name}_")]
        content = document[name]
        if not own or not isinstance(content, dict):
            raise UsageError(
                f"{where}: unknown key {name!r}; a data sheet has {', '.join(_HEAD)}, and tables gyro, accel or {', '.join(AXES)}"
            )
        axes |= {axis: _axis(axis, cast("dict[str, object]", content), f"{where}, {name}") for axis in own}
    if not axes:
        raise UsageError(
            f'{where}: no table gyro or accel; write what the sheet states, such as [gyro] N = "0.3 deg/√h"'
        )
    provenance = {"source": head.get("source", where)} | {k: head[k] for k in ("grade", "note") if k in head}
    doubts = ("numbers of a data sheet, typical and not of one sensor",)
    return ImuErrorModel(head.get("name", "data sheet"), {a: axes[a] for a in AXES if a in axes}, provenance, doubts)


def _axis(axis: str, table: dict[str, object], where: str) -> AxisModel:
    processes: list[Process] = []
    intervals: dict[str, tuple[float, float]] = {}
    plain: dict[str, float] = {}
    for key, stated in table.items():
        if key in _PLAIN:
            measure = UNITS["Hz"] if _PLAIN[key] == "Hz" else coefficient_units(axis, _PLAIN[key])[0]
            plain[key] = quantity(stated, measure, f"{where}.{key}")
        elif key in _STATEMENTS:
            statement = _STATEMENTS[key]
            value = quantity(stated, coefficient_units(axis, statement.like)[0], f"{where}.{key}")
            low, high = statement.interval
            if low < high:
                intervals[f"{len(processes)}.{statement.parameter}"] = (low * value, high * value)
            processes.append(statement.process(statement.value * value))
        else:
            raise UsageError(f"{where}: unknown key {key!r}; a sheet states {', '.join((*_STATEMENTS, *_PLAIN))}")
    model = AxisModel(Sum(tuple(processes)), intervals)
    return replace(model, range=plain.get("range"), lsb=plain.get("lsb"), bandwidth=plain.get("bandwidth"))

"""Reads the files of estimators: the inverse of ``export``, by the same tables."""

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.estimators.analysis_results import SLOPES, is_allan_variance_ros, is_imu_utils, read_imu_utils
from imuwb.estimators.calibration import read_calibration_text
from imuwb.estimators.formula import Setting
from imuwb.estimators.matlab_text import is_matlab, matlab_lines
from imuwb.estimators.tool import SETTINGS, Field, Tool, tool_named, tools
from imuwb.log import AXES
from imuwb.renames import settle
from imuwb.stochastic import (
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
    is_data_sheet,
    merge,
    read_data_sheet,
)

LARGEST_FILE = 1 << 22  #: bytes; a file of settings is far smaller
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
#: what may stand between a name and its first number
_BETWEEN = r"[\"'\w>]{0,2}\s*+[:=,(]?\s*+(?:(?:np|numpy)\.(?:array|diag)\(|diag\(|\{)?\s*+[\[({]*+\s*+"
_NUMBERS = rf"{_NUMBER}(?:[ \t]*[,;][ \t\n]*{_NUMBER}|[ \t]+{_NUMBER})*"
#: a line of QGroundControl: vehicle, component, name, value, type
_STATION = re.compile(rf"(?m)^[ \t]*\d+[ \t]+\d+[ \t]+(\w+)[ \t]+({_NUMBER})[ \t]+\d+[ \t]*$")
_UNIT_MATRIX = re.compile(r"(?<![ \t])[ \t]*+\*[ \t]*+(?:(?:np|numpy)\.(?:eye|identity)\(3\)|(?:gtsam[.:]+)?I_3x3)")
#: what after a number makes it another: the rest of a word, an operator, a unit
_MORE = re.compile(r"[\w.][^\s;,)]*|[ \t\])}]*(?:\.?[*/^]|[^\W\d_])[^\s;,)]*")


@dataclass(frozen=True, slots=True)
class Reading:
    """What a file of an estimator states."""

    form: str  #: the tool, or another form, by name
    model: ImuErrorModel
    notes: tuple[str, ...]


def read_estimator_file(path: Path, tool: str | None = None, setting: Setting | None = None) -> Reading:
    """Return the error model that a file of an estimator states. What it does not state stays unknown.

    Args:
        path: the file.
        tool: its tool; found by the names in the file, where it is not given.
        setting: rate and step, for files that do not state them.

    Raises:
        UsageError: the file cannot be read, is of no known tool, or has values that depend on a rate that is not known.
    """
    settle(path)
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: byte {error.start} is not of UTF-8; if this is a text, save it as UTF-8") from error
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    if len(content) > LARGEST_FILE:
        raise UsageError(f"{path}: the file has more than {LARGEST_FILE} bytes, so it is no file of settings")
    return read_estimator_text(text, str(path), tool, setting)


def read_estimator_text(text: str, where: str, tool: str | None = None, setting: Setting | None = None) -> Reading:
    """Return the error model that the text of such a file states; ``where`` names it in messages.

    Raises:
        UsageError: as ``read_estimator_file``.
    """
    setting = setting or Setting()
    if tool is None and (found := _other_form(text, where, setting)) is not None:
        return found
    converted: tuple[str, ...] = ()
    if tool in (None, "matlab") and is_matlab(text):
        tool, (text, converted) = "matlab", matlab_lines(text)
    text = _STATION.sub(r"\1 \2", text)
    calibration = read_calibration_text(text, where)
    chosen = _recognized(text) if tool is None else tool_named(tool, "--from")
    if chosen is None and calibration is not None:
        return Reading(*calibration, ("a calibration: biases, scale factors and couplings, no noise",))
    if chosen is None:
        raise UsageError(
            f"{where}: its names are of no tool that imuwb reads; name the tool with --from, one of {', '.join(tools())}"
        )
    plain = _without_comments(text, chosen)
    stated = {
        key: numbers
        for field in chosen.fields
        for key in field.keys
        if (numbers := _numbers(plain, key, chosen, where))
    }
    if not any(key in stated for field in chosen.fields if field.sensor for key in field.keys):
        names = ", ".join(field.key for field in chosen.fields if field.sensor)
        raise UsageError(f"{where}: no value of {chosen.name} is in the file; it has names such as {names}")
    setting = _setting(chosen, stated, setting, where)
    try:
        axes = {axis: found for axis in AXES if (found := _axis(chosen, axis, stated, setting, where)) is not None}
    except ValueError as error:
        raise UsageError(f"{where}: read as {chosen.name}: {error}") from error
    if not axes:
        raise UsageError(f"{where}: every value of {chosen.name} in the file is 0, so nothing of the sensor is known")
    missing = [field.key for field in chosen.fields if field.sensor and not any(key in stated for key in field.keys)]
    named = [key for key in missing if chosen.form != "json" and re.search(rf"(?<!\w){re.escape(key)}(?!\w)", plain)]
    notes = (
        *converted,
        *((f"after {', '.join(named)} stands no number that can be read",) if named else ()),
        *((SLOPES,) if is_allan_variance_ros(text) else ()),
        *((f"the file does not state {', '.join(missing)}; what that says stays unknown, not 0",) if missing else ()),
        "values are as stated in the file, without intervals; if somebody tuned them for motion, they are larger than the sensor's own noise",
    )
    rate = {"rate": f"{setting.rate:g} Hz"} if math.isfinite(setting.rate) else {}
    provenance = {"source": f"{where}, read as {chosen.name}", **rate}
    doubts = ("stated in a file, not measured: no interval is known",)
    model = ImuErrorModel(Path(where).stem, axes, provenance, doubts)
    if calibration is not None:
        model = merge((model, calibration[1]), {"calibration": 1})
    return Reading(chosen.name, model, notes)


def _other_form(text: str, where: str, setting: Setting) -> Reading | None:
    """Return what a data sheet or another program's result states; None for a file of settings."""
    if is_imu_utils(text):
        return Reading("imu_utils", *read_imu_utils(text, where, setting))
    if where.endswith(".toml"):
        try:
            document = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise UsageError(f"{where}: not TOML: {error}") from error
        if is_data_sheet(document):
            said = ("numbers of a data sheet; what it does not state stays unknown",)
            return Reading("data sheet", read_data_sheet(text, where), said)
    return None


def _recognized(text: str) -> Tool | None:
    """Return the tool whose names are in a text; the one with most names of its own, if several fit."""

    def fits(tool: Tool) -> bool:
        return bool(tool.identity) and all(re.search(rf"(?<!\w){re.escape(key)}(?!\w)", text) for key in tool.identity)

    return max((tool for tool in tools().values() if fits(tool)), key=lambda tool: len(tool.identity), default=None)


def _without_comments(text: str, tool: Tool) -> str:
    if tool.form == "xml":
        return re.sub(r"<!--.*?(?:-->|\Z)", "", text, flags=re.DOTALL)
    mark = re.escape(tool.comment)
    return _UNIT_MATRIX.sub("", re.sub(rf"(?m)(?:^|(?<=\s)){mark}(?!YAML).*$", "", text))


def _numbers(text: str, key: str, tool: Tool, where: str) -> tuple[float, ...] | None:
    if tool.form == "xml":
        return _element(text, key, where)
    matches = list(re.finditer(rf"(?<!\w){re.escape(key)}{_BETWEEN}({_NUMBERS})", text))
    found = {match[1] for match in matches}
    if not found:
        return None
    for match in matches:
        if more := _MORE.match(text, match.end()):
            raise UsageError(
                f"{where}: {key} is {match[1]}, then {more[0].strip()!r}; write plain numbers in the tool's own unit"
            )
    if len(found) > 1:
        raise UsageError(f"{where}: {key} is stated {len(found)} times, with different values; give a file of one IMU")
    return tuple(float(number) for number in re.findall(_NUMBER, found.pop()))


def _element(text: str, key: str, where: str) -> tuple[float, ...] | None:
    """Return the number of an element of XML; its path may begin anywhere."""
    from xml.etree import ElementTree as ET  # noqa: PLC0415 - documents with entities are refused below

    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise UsageError(f"{where}: XML with a document type is not read; remove it")
    try:
        root = ET.fromstring(text.strip())  # noqa: S314 - no entities
    except ET.ParseError as error:
        raise UsageError(f"{where}: not XML: {error}") from error
    element = root.find(f".//{key}")
    if element is None or not (element.text or "").strip():
        return None
    try:
        return (float(str(element.text)),)
    except ValueError:
        raise UsageError(f"{where}: {key} is {str(element.text).strip()!r}; it must be a number") from None


def _setting(tool: Tool, stated: Mapping[str, tuple[float, ...]], setting: Setting, where: str) -> Setting:
    known = {
        field.term: stated[field.key][0] for field in tool.fields if field.term in SETTINGS and field.key in stated
    }
    setting = replace(setting, **{name: value for name, value in known.items() if value > 0})
    if math.isnan(setting.step) and tool.step is not None:
        setting = replace(setting, step=tool.step)
    if tool.needs and math.isnan(getattr(setting, tool.needs)):
        option = {"rate": "--rate HZ", "step": "--step SECONDS"}[tool.needs]
        raise UsageError(
            f"{where}: the values of {tool.name} depend on the {tool.needs}, which the file does not state; give {option}"
        )
    return setting


def _axis(
    tool: Tool, axis: str, stated: Mapping[str, tuple[float, ...]], setting: Setting, where: str
) -> AxisModel | None:
    sensor, _, letter = axis.partition("_")
    values: dict[str, float] = {}
    for field in tool.fields:
        if (
            field.sensor in (sensor, "both")
            and (value := _value(field, "xyz".index(letter), stated, where)) is not None
        ):
            values[field.term] = field.formula.coefficient(value * field.factor, setting)
    if "drive" in values and "Tc" in values:
        values.setdefault("sigma", values["drive"] * math.sqrt(values["Tc"] / 2))
    terms = [
        *([WhiteNoise(values["N"])] if values.get("N") else []),
        *([FlickerNoise(values["B"])] if values.get("B") else []),
        *([RandomWalk(walk)] if (walk := values.get("K") or values.get("own_K")) else []),
        *([GaussMarkov(values["sigma"], values["Tc"])] if values.get("sigma") and values.get("Tc") else []),
        *([Constant(values["turn_on"])] if values.get("turn_on") else []),
    ]
    return AxisModel(Sum(tuple(terms))) if terms else None


def _value(field: Field, axis: int, stated: Mapping[str, tuple[float, ...]], where: str) -> float | None:
    key = field.keys[axis] if field.shape == "xyz" else field.key
    if key not in stated:
        return None
    numbers = stated[key]
    wanted = {"largest": 1, "xyz": 1, "each": 3, "diagonal": 9}[field.shape]
    if len(numbers) not in (1, wanted):
        raise UsageError(f"{where}: {key} has {len(numbers)} numbers; it must have {wanted}")
    value = numbers[0] if len(numbers) == 1 else numbers[axis * 4 if wanted == 9 else axis]  # noqa: PLR2004 - a 3 × 3 matrix
    if not value >= 0:
        raise UsageError(f"{where}: {key} is {value}; it must be 0 or more")
    return value

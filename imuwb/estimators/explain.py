"""What to write into an estimator's file, why, and how wrong the usual shortcuts are for this sensor."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from imuwb.estimators.export import Export, Options, export, setting_of
from imuwb.estimators.formula import Setting
from imuwb.estimators.growth import TO_POSITION, predicted_variance, white_variance
from imuwb.estimators.sensor import SENSORS, axes_of
from imuwb.estimators.temperature import constant
from imuwb.estimators.tool import Field, Tool, tool_named
from imuwb.stochastic import FLICKER_LEVEL, ImuErrorModel, RandomWalk


@dataclass(frozen=True, slots=True)
class Shortcut:
    """A habit, and the sigma of position that it makes the estimator state, over the true one."""

    habit: str
    sensor: str
    ratio: float


@dataclass(frozen=True, slots=True)
class Explanation:
    """An export in words."""

    export: Export
    rows: tuple[tuple[str, str, str, str], ...]  #: key, value, unit, what it is
    sentences: tuple[str, ...]
    shortcuts: tuple[Shortcut, ...]


def explain(
    model: ImuErrorModel, tool: str, options: Options | None = None, remarks: Sequence[str] = ()
) -> Explanation:
    """Return what to write for a tool, and why.

    Raises:
        UsageError, MissingDataError: as ``export``.
    """
    options = options or Options()
    tool_named(tool, "--for")
    made = export(model, tool, options, remarks)
    model, _ = constant(model, options.celsius)
    setting = setting_of(made.tool, model, options)
    rows = tuple(_row(field, made) for field in made.tool.fields if field.sensor and field.keys[0] in made.values)
    return Explanation(made, rows, _sentences(made.tool, setting), _shortcuts(made.tool, model, setting))


def _row(field: Field, made: Export) -> tuple[str, str, str, str]:
    values = [value for key in field.keys for value in made.values[key] if value or field.shape != "diagonal"]
    text = ", ".join(f"{value:.4g}" for value in values)
    what = field.written.replace("c", _SYMBOLS.get(field.term, field.term))
    what += "" if field.sensor == "both" else f", {field.sensor}"
    return field.key, text, field.unit, what


_SYMBOLS = {
    "N": "N",
    "K": "K",
    "own_K": "K",
    "sigma": "sigma",
    "Tc": "τ",
    "drive": "sigma √(2/τ)",
    "turn_on": "turn-on sigma",
}


def _sentences(tool: Tool, setting: Setting) -> tuple[str, ...]:
    discrete = any(not field.formula.continuous for field in tool.fields)
    if discrete and tool.needs == "rate":
        kind = f"Its values are those of a sample: they hold at {setting.rate:g} Hz only, and a log at another rate needs others."
    elif discrete:
        kind = f"Its values are those of one step of its filter, {setting.step:g} s."
    else:
        kind = "Its values are densities of the continuous processes: they hold at every rate."
    worst = (
        "It has one value for the three axes: the worst axis is written."
        if any(f.shape == "largest" and f.sensor for f in tool.fields)
        else ""
    )
    return tuple(text for text in (kind, worst) if text)


def _shortcuts(tool: Tool, model: ImuErrorModel, setting: Setting) -> tuple[Shortcut, ...]:
    """Return the habits that apply to a tool, the most wrong first, each with its effect on the worst axis of the sensor."""
    found: list[Shortcut] = []
    for sensor in SENSORS:
        axis = max(
            (a for a in axes_of(model, sensor) if a is not None and a.white), key=lambda a: a.white or 0.0, default=None
        )
        if axis is None or axis.white is None:
            continue
        walk = axis.walk(setting.horizon)
        k = walk.process.K if walk is not None and isinstance(walk.process, RandomWalk) else 0.0
        true = _sigma(axis.white, k, sensor, setting.horizon)

        def add(habit: str, white: float, slow: float, *, sensor: str = sensor, true: float = true) -> None:
            found.append(Shortcut(habit, sensor, _sigma(white, slow, sensor, setting.horizon) / true))

        for field in tool.fields:
            if field.sensor == sensor and field.term == "N" and not field.formula.continuous:
                wrong = field.formula.coefficient(axis.white, setting)
                add("the continuous numbers of kalibr, written as they are", wrong, _as_it_is(tool, sensor, k, setting))
        add("a data sheet's noise density (one-sided) taken for N", math.sqrt(2) * axis.white, k)
        if axis.flicker and "K" in tool.terms:
            add(
                "the lowest point of the Allan curve taken for the random walk",
                axis.white,
                FLICKER_LEVEL * axis.flicker,
            )
        add("everything times 10, to be safe", 10 * axis.white, 10 * k)
        if k:
            add("no bias process", axis.white, 0.0)
    return tuple(sorted(found, key=lambda shortcut: -abs(math.log(shortcut.ratio))))


def _as_it_is(tool: Tool, sensor: str, walk: float, setting: Setting) -> float:
    """Return the walk that the tool takes where K is written without its formula."""
    field = next((f for f in tool.fields if f.sensor == sensor and f.term == "K"), None)
    return walk if field is None or not walk else field.formula.coefficient(walk, setting)


def _sigma(white: float, walk: float, sensor: str, horizon: float) -> float:
    """Return the sigma of position that an estimator of N and K states after a horizon, up to g for gyros."""
    times = TO_POSITION[sensor]
    return math.sqrt(white_variance(white, horizon, times) + predicted_variance(white, walk, horizon, times))

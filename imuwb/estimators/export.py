"""Writes an error model as the file of an estimator."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration import calibration_lines
from imuwb.estimators.formula import Setting
from imuwb.estimators.layout import filled
from imuwb.estimators.left_out import cost_texts
from imuwb.estimators.sensor import SENSORS, Axis, Factors, axes_of, with_limits
from imuwb.estimators.temperature import constant
from imuwb.estimators.tool import Field, Tool, tool_named
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum

SAME = 1e-6  #: relative difference below which white noise is the same
UNEVEN = 1.5  #: ratio of the largest axis to the smallest, above which a comment states it
_WORDS = {
    "N": "N (white noise)", "K": "K (random walk)", "own_K": "K (random walk)", "B": "B (bias instability)", "sigma": "sigma of the bias",
    "Tc": "correlation time of the bias", "drive": "noise that drives the bias", "turn_on": "sigma of the bias at turn-on",
    "scale": "sigma of the scale factors",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Options:
    """What the user says beside the model."""

    rate: float | None = None  #: Hz; that of the model by default
    step: float | None = None  #: s, of the estimator's prediction
    horizon: float = 60.0  #: s
    limits: bool = False  #: whether what is not identified is written at its upper limit
    scale_factor: float | None = None  #: 1-sigma of the scale factors, a fraction
    motion: Factors | None = None
    celsius: float | None = None  #: °C, at which a model that depends on temperature is taken

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name in ("rate", "step", "horizon", "scale_factor"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise UsageError(f"the {name.replace('_', ' ')} is {value}; it must be above 0")


@dataclass(frozen=True, slots=True)
class Export:
    """The file of an estimator."""

    tool: Tool
    text: str
    notes: tuple[str, ...]  #: what was chosen, matched and left out; the text has them as comments, where it can
    values: Mapping[str, tuple[float, ...]]  #: key -> what was written, in the unit of the field


def export(model: ImuErrorModel, tool: str, options: Options | None = None, remarks: Sequence[str] = ()) -> Export:
    """Return an error model as the file of a tool; remarks of the caller stand before its notes.

    Raises:
        UsageError: no such tool.
        MissingDataError: an axis without white noise, or no rate where values depend on it.
    """
    options = options or Options()
    chosen = tool_named(tool)
    model, by_temperature = constant(model, options.celsius)
    notes = [*remarks, *by_temperature]
    if options.motion is not None:
        model = options.motion.applied(model)
        notes.append(
            f"N in motion: the gyros' {options.motion.gyro:.4g} times, the accelerometers' {options.motion.accel:.4g} times that of the bench"
        )
    if options.limits:
        model, limited = with_limits(model)
        notes += limited
    setting = setting_of(chosen, model, options)
    sensors = {name: axes_of(model, name) for name in SENSORS}
    values: dict[str, tuple[float, ...] | None] = {}
    for field in chosen.fields:
        found = _values(field, sensors, setting, options, notes)
        values |= _keyed(field, _within(field, found, notes))
    notes += _match_notes(chosen, sensors, setting)
    notes += cost_texts(chosen, model, setting.horizon)
    notes += chosen.notes
    if chosen.calibration:
        lines, turned = calibration_lines(model, chosen.calibration)
        chosen = replace(chosen, layout=chosen.layout.replace("{calibration}", "\n".join(lines)))
        notes += turned
    told = tuple(dict.fromkeys(notes))
    known = {key: value for key, value in values.items() if value is not None}
    return Export(chosen, filled(chosen, values, _head(chosen, model, setting), told), told, known)


def setting_of(tool: Tool, model: ImuErrorModel, options: Options) -> Setting:
    """Return the rate, step and horizon of an export.

    Raises:
        MissingDataError: the tool needs a rate or a step that neither the model nor the user states.
    """
    rate = options.rate or model_rate(model)
    step = options.step or tool.step
    if rate is None and tool.needs == "rate":
        raise MissingDataError(
            f"{tool.name} writes values of a sample, which depend on the rate, and model {model.name} does not state its rate; give --rate HZ"
        )
    if step is None and tool.needs == "step":
        raise MissingDataError(f"{tool.name} writes values of a step of its filter; give its step with --step SECONDS")
    return Setting(rate or math.nan, step or math.nan, options.horizon)


def model_rate(model: ImuErrorModel) -> float | None:
    """Return the rate (Hz) that a model's provenance states; None where it states none, or more than one."""
    text = model.provenance.get("rate", "")
    rates: set[float] = set()
    for part in text.split(","):
        words = part.split()
        if len(words) > 1 and words[-1] == "Hz":
            try:
                rates.add(float(words[-2]))
            except ValueError:
                return None
    return rates.pop() if len(rates) == 1 else None


def _values(
    field: Field, sensors: Mapping[str, tuple[Axis | None, ...]], setting: Setting, options: Options, notes: list[str]
) -> tuple[float, ...] | None:
    """Return the values of a field in its unit; None where the model does not know them."""
    if not field.sensor:
        stated = getattr(setting, field.term)
        if math.isnan(stated):
            notes.append(f"{field.key}: the model does not state its {field.term}; give --{field.term}")
            return None
        return (stated / field.factor,)
    names = SENSORS if field.sensor == "both" else (field.sensor,)
    if field.term == "scale":
        known = [options.scale_factor] * 3
    else:
        known = [_coefficient(axis, field.term, setting) for name in names for axis in sensors[name]]
    found = [value for value in known if value]
    what = f"{field.sensor} {_WORDS[field.term]}".removeprefix("both ")
    if field.term == "N" and (not found or (len(found) < len(known) and field.shape != "largest")):
        lacking = "" if not found else " on one of its axes"
        raise MissingDataError(
            f"the model has no {_WORDS['N']} for the {field.sensor}{lacking}; every estimator needs it; add it to the model, or give --limits where the model has a limit"
        )
    if not found or (len(found) < len(known) and field.shape != "largest"):
        some = "" if not found else f" on {len(known) - len(found)} of {len(known)} axes"
        notes.append(
            f"{what}: not known{some}, so {', '.join(field.keys)} is not written{'; ' + field.default if field.default else ''}"
        )
        return None
    if len(found) < len(known):
        notes.append(f"{what}: {len(known) - len(found)} of {len(known)} axes have none")
    if field.shape == "largest":
        if max(found) > UNEVEN * min(found):
            notes.append(f"{what}: the largest of the axes, {max(found) / min(found):.2g} times the smallest")
        found = [max(found)]
    return tuple(field.formula.value(value, setting) / field.factor for value in found)


def _coefficient(axis: Axis | None, term: str, setting: Setting) -> float | None:
    """Return a coefficient of an axis, SI."""
    if axis is None:
        return None
    if term in ("N", "B", "turn_on", "own_K"):
        return {"N": axis.white, "B": axis.flicker, "turn_on": axis.turn_on, "own_K": axis.own_walk}[term]
    if term == "K":
        walk = axis.walk(setting.horizon)
        return None if walk is None else getattr(walk.process, "K", None)
    match = axis.gauss_markov(setting.horizon)
    if match is None or not isinstance(match.process, GaussMarkov):
        return None
    sigma, time = match.process.sigma, match.process.Tc
    return {"sigma": sigma, "Tc": time, "drive": sigma * math.sqrt(2 / time)}[term]


def _within(field: Field, values: tuple[float, ...] | None, notes: list[str]) -> tuple[float, ...] | None:
    """Return the values within the limits of the tool, with a note where one was outside."""
    if values is None or (field.least is None and field.most is None):
        return values
    low, high = -math.inf if field.least is None else field.least, math.inf if field.most is None else field.most
    held = tuple(min(max(value, low), high) for value in values)
    for key, value, kept in zip(field.keys, values, held, strict=False):
        if kept != value:
            notes.append(
                f"{key}: {value:.3g} {field.unit} is outside the range of the tool, {low:g} to {high:g}; {kept:g} is written"
            )
    return held


def _keyed(field: Field, values: tuple[float, ...] | None) -> dict[str, tuple[float, ...] | None]:
    if field.shape == "xyz":
        return {key: None if values is None else (values[i],) for i, key in enumerate(field.keys)}
    if field.shape == "diagonal" and values is not None:
        return {field.key: tuple(values[i // 4] if i % 4 == 0 else 0.0 for i in range(9))}
    return {field.key: values}


def _match_notes(tool: Tool, sensors: Mapping[str, tuple[Axis | None, ...]], setting: Setting) -> list[str]:
    """Return a sentence for each sensor whose slow errors are matched, not written as they are."""
    notes: list[str] = []
    walks, bounded = "K" in tool.terms, bool({"sigma", "drive"} & tool.terms)
    for name in SENSORS if walks or bounded else ():
        matches = [
            found
            for axis in sensors[name]
            if axis is not None
            and (found := axis.walk(setting.horizon) if walks else axis.gauss_markov(setting.horizon)) is not None
        ]
        if all(match.exact for match in matches):
            continue
        ratios = [match.ratios for match in matches if not match.exact]
        kind = "a random walk" if walks else "a Gauss-Markov process"
        integrals = (
            (("attitude", 0), ("velocity", 1), ("position", 2))
            if name == "gyro"
            else (("velocity", 0), ("position", 1))
        )
        sizes = ", ".join(f"{word} {_range([r[i] for r in ratios])}" for word, i in integrals)
        notes.append(
            f"{name}: {kind} stands for the model's slow errors, so that the drift after {setting.horizon:g} s (--horizon) is right; "
            f"sigma in the tool over the true one: {sizes}"
        )
    return notes


def _range(values: Sequence[float]) -> str:
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return low if low == high else f"{low} to {high}"


def _head(tool: Tool, model: ImuErrorModel, setting: Setting) -> tuple[str, ...]:
    source = "; ".join(f"{key}: {text}" for key, text in model.provenance.items())
    rate = {
        "rate": f"values hold at {setting.rate:g} Hz only",
        "step": f"values hold for a filter step of {setting.step:g} s only",
    }
    return (
        tool.title,
        f"facts from {tool.source}",
        f"model {model.name}" + (f", {source}" if source else ""),
        *((rate[tool.needs],) if tool.needs else ()),
        *(f"in doubt: {doubt}" for doubt in model.doubts),
    )


def with_motion(bench: ImuErrorModel, road: ImuErrorModel) -> tuple[ImuErrorModel, str]:
    """Return a model in motion under the name of the bench's, and a sentence with the factors between the two.

    Biases at turn-on are those of the bench: a replay assumes usual ones.

    Raises:
        MissingDataError: the two have no axis with white noise in common, or all of it is the same.
    """
    parts: list[str] = []
    same = True
    for name in SENSORS:
        pairs = [(a.white, b.white) for a, b in zip(axes_of(bench, name), axes_of(road, name), strict=True) if a and b]
        ratios = [after / before for before, after in pairs if before and after]
        if ratios:
            parts.append(f"{name} {_range(ratios)}")
            same = same and all(math.isclose(ratio, 1.0, rel_tol=SAME) for ratio in ratios)
    if not parts:
        raise MissingDataError(f"models {bench.name} and {road.name} have no axis with white noise in common")
    if same:
        raise MissingDataError(
            f"--in-motion: {road.name} has the white noise of {bench.name}, so it is not that of a drive; "
            "a replay of a drive writes it with --save-model ROAD.toml, or its filter with --models motion --save-filter"
        )
    axes = {name: _turned_on_as(axis, bench.axes.get(name)) for name, axis in road.axes.items()}
    kept = {key: text for key, text in bench.provenance.items() if key == "rate"} | dict(road.provenance)
    moved = replace(road, name=bench.name, axes=axes, provenance=kept)
    return moved, f"in motion: N over that of the bench: {', '.join(parts)}"


def _turned_on_as(axis: AxisModel, bench: AxisModel | None) -> AxisModel:
    """Return an axis in motion with the biases at turn-on of the bench."""
    own = tuple(term for term in bench.processes.terms if isinstance(term, Constant)) if bench else ()
    rest = tuple(term for term in axis.processes.terms if not isinstance(term, Constant))
    return axis.with_processes(Sum((*rest, *own)))

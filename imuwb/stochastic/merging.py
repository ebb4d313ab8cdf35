"""One error model of the terms of several."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.error_model import ImuErrorModel
from imuwb.stochastic.flicker import FlickerNoise
from imuwb.stochastic.gauss_markov import GaussMarkov
from imuwb.stochastic.processes import Constant, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise
from imuwb.stochastic.sums import Process, Sum

#: what can be taken from a model -> the kind of process
KINDS: Mapping[str, type] = {
    "Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk, "R": RateRamp, "GM": GaussMarkov,
    "AR": Autoregressive, "lines": Sinusoid, "turn-on": Constant,
}  # fmt: skip
#: deterministic terms, which are taken together
CALIBRATION = (
    "bias",
    "scale_factor",
    "scale_factor_nonlinear",
    "cross_coupling",
    "g_sensitivity",
    "thermal_bias",
    "thermal_scale_factor",
)
SENSOR = ("bandwidth", "group_delay", "lsb", "range")
AR = "AR"
_TOGETHER: Mapping[str, Sequence[str]] = {"calibration": CALIBRATION, "sensor": SENSOR}
PARTS = (*KINDS, *_TOGETHER)
_NEUTRAL = AxisModel()


def merge(models: Sequence[ImuErrorModel], taken: Mapping[str, int]) -> ImuErrorModel:
    """Return a model with each kind of term from the model that is named for it; other kinds are those of the first.

    AR processes that are taken from another model become those of the filters 15AR and 27AR: the sum of the first describes the
    noise already, and a second description in the sum would count it twice.

    Where that model lacks an axis, as one of a single triad does, the first of the others that has it gives the terms.

    Args:
        models: two or more.
        taken: one of ``PARTS`` -> place of a model.

    Raises:
        UsageError: a part that is unknown, or that a model is to give and does not have.
    """
    for part, place in taken.items():
        if part not in PARTS:
            raise UsageError(f"--take {part}: it must be one of {', '.join(PARTS)}")
        if part in KINDS and not any(_has(models[place], axis, part) for axis in AXES):
            raise UsageError(f"--take {part}: model {models[place].name} has none")
    axes: dict[str, AxisModel] = {}
    for axis in AXES:
        if any(axis in model.axes for model in models):
            axes[axis] = _axis([model.axes.get(axis) for model in models], taken)
    provenance = {f"{key} of {model.name}": text for model in models for key, text in model.provenance.items()} | {
        "merged": "; ".join(f"{part} from {models[place].name}" for part, place in taken.items())
    }
    doubts = tuple(dict.fromkeys(doubt for model in models for doubt in model.doubts))
    return ImuErrorModel(models[0].name, axes, provenance, doubts)


def _axis(models: Sequence[AxisModel | None], taken: Mapping[str, int]) -> AxisModel:
    terms: list[Process] = []
    intervals: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    for part, kind in KINDS.items():
        source = _giver(models, 0 if part == AR else taken.get(part, 0))
        for i, term in enumerate(source.processes.terms):
            if isinstance(term, kind):
                kept = {
                    key.partition(".")[2]: ends
                    for key, ends in source.intervals.items()
                    if key.partition(".")[0] == str(i)
                }
                intervals |= {f"{len(terms)}.{name}": ends for name, ends in kept.items()}
                terms.append(term)
        if part in source.limits and not any(isinstance(term, kind) for term in terms):
            limits[part] = source.limits[part]
    calibration, sensor = (_giver(models, taken.get(part, 0), names) for part, names in _TOGETHER.items())
    rest = {name: getattr(calibration, name) for name in CALIBRATION} | {name: getattr(sensor, name) for name in SENSOR}
    apart = _autoregressive(models, taken.get(AR, 0))
    sums = Sum(tuple(terms))
    return replace(AxisModel(), processes=sums, intervals=intervals, limits=limits, autoregressive=apart, **rest)


def _giver(models: Sequence[AxisModel | None], place: int, names: Sequence[str] = ()) -> AxisModel:
    """Return the model of an axis that gives a part: the named one, or the first that has the axis, and the terms, if any has."""
    named = models[place]
    if named is not None:
        return named
    others = [model for model in models if model is not None]
    return next((m for m in others if any(getattr(m, name) != getattr(_NEUTRAL, name) for name in names)), others[0])


def _autoregressive(models: Sequence[AxisModel | None], place: int) -> tuple[Autoregressive, ...]:
    """Return the processes of 15AR and 27AR: those of the first model, replaced by those of the model that gives them."""
    first, given = (_giver(models, number) for number in (0, place))
    found = {len(process.alpha): process for process in first.autoregressive}
    if place:
        found |= {len(term.alpha): term for term in given.processes.terms if isinstance(term, Autoregressive)}
    found |= {len(process.alpha): process for process in given.autoregressive}
    return tuple(found[order] for order in sorted(found))


def _has(model: ImuErrorModel, axis: str, part: str) -> bool:
    if part == AR and axis in model.axes and model.axes[axis].autoregressive:
        return True
    return axis in model.axes and any(isinstance(term, KINDS[part]) for term in model.axes[axis].processes.terms)

"""The filters of a replay, by name, and what was estimated for them."""

import math
from dataclasses import dataclass, replace

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES
from imuwb.navigation import FilterModel
from imuwb.navigation.shaping import Reading
from imuwb.notes import Note
from imuwb.replay import (
    TURN_ON,
    MotionNoise,
    Prepared,
    Tuned,
    estimate_motion_noise,
    in_motion,
    model_named,
    tune,
    with_unidentified,
)
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.outage.parameters import PAPER, Parameters
from imuwb_plugins.outage.static import origin_notes, origin_of, without_white

READINGS: dict[str, Reading] = {
    "corrected": "corrected", "printed-variances": "printed variances", "printed-densities": "printed densities",
}  # fmt: skip


GROUPED: dict[tuple[str, ...], tuple[str, ...]] = {("paper",): PAPER, ("table6",): ()}
#: levels of table 6, gyros first: three levels are one fewer on the axes y and z (5.6), seven are those of table 7
NINE_STATES = {"0": (), "3": (3, 2, 2, 3, 2, 2), "7": (7, 7, 7, 7, 6, 6)}


@dataclass(frozen=True, slots=True)
class Filters:
    """The filters of a replay; None: not wanted, or not possible."""

    log: str
    rate: float  #: Hz, of the log's IMU
    models: tuple[FilterModel, ...]
    failed: dict[str, str]  #: filter that cannot be made from the error model -> reason
    motion: MotionNoise | None
    tuned: Tuned | None
    notes: tuple[Note, ...]
    autoregressive: str | None  #: where the AR processes come from; None: no filter has one

    @property
    def error_model(self) -> ImuErrorModel | None:
        """Return the error model in motion, or the tuned one; None: no such filter."""
        found = {model.name: model for model in self.models}
        if "tuned" in found:
            own, analysis = found["tuned"].error_model, "imuwb outage --tune: noise by the errors in outages of a drive"
        elif "motion" in found and self.motion is not None:
            own, analysis = (
                in_motion(found["motion"], self.motion),
                "imuwb outage: noise in motion, by the innovations of a drive",
            )
        else:
            return None
        before = {f"bench {key}": text for key, text in own.provenance.items()}
        return replace(own, provenance={"log": self.log, "analysis": analysis, "rate": f"{self.rate:.6g} Hz", **before})


def named(name: str, base: FilterModel, interval: float, parameters: Parameters) -> tuple[FilterModel, tuple[str, ...]]:
    """Return a filter, and the axes on which it carries a random walk that the bench record does not identify.

    The paper's filters have what the error model has; the others also have turn-on biases and what the record leaves open.

    Raises:
        UsageError: the error model lacks an axis, or has a process that cannot be written with states.
    """
    paper = parameters.models == ("paper",)
    turn_on = None if paper else TURN_ON
    if parameters.turn_on != "auto":
        turn_on = math.radians(parameters.turn_on[0]), parameters.turn_on[1]
    try:
        model = model_named(name, base, reading=READINGS[parameters.reading], interval=interval, turn_on=turn_on)
    except ValueError as error:
        raise UsageError(str(error)) from error
    if paper or name == "none":
        return model, ()
    error_model, carried = with_unidentified(model.error_model, base.error_model)
    return replace(model, error_model=error_model), carried


def filters_of(base: FilterModel, prepared: Prepared, parameters: Parameters) -> Filters:
    """Return the filters that the options name, in their order; a given filter and a tuned one come last.

    Raises:
        UsageError: no filter can be made from the error model.
        MissingDataError: the log is too short for tuning.
    """
    interval = prepared.measurement.interval
    models: list[FilterModel] = []
    failed: dict[str, str] = {}
    motion: MotionNoise | None = None
    carried: dict[str, tuple[str, ...]] = {}
    for name in GROUPED.get(parameters.models, parameters.models):
        try:
            model, axes = named("full" if name == "motion" else name, base, interval, parameters)
            if name == "motion":
                model, motion = estimate_motion_noise(prepared, model, parameters.level)
        except (UsageError, MissingDataError) as error:
            failed[name] = str(error)
            continue
        models.append(model)
        carried[name] = axes
    models.extend(_denoised(base, interval, parameters))
    if parameters.models == ("table6",):
        models.extend(_without_biases(base, interval, parameters))
    if parameters.filter is not None:
        models.append(base)
    if not models:
        raise UsageError(next(iter(failed.values())))
    tuned: Tuned | None = None
    if parameters.tune:
        try:
            better, tuned = tune(prepared, models[-1], parameters.reference)
        except ValueError as error:
            raise MissingDataError(str(error)) from error
        models.append(replace(better, name="tuned"))
    origin = origin_of(base, tuple(model.name for model in models), interval, parameters)
    return Filters(
        f"{prepared.log.provenance.path} {prepared.log.provenance.hash}",
        1.0 / interval,
        tuple(models),
        failed,
        motion,
        tuned,
        (*without_white(tuple(models)), *origin_notes(origin), *_carried(carried)),
        origin,
    )


def _denoised(base: FilterModel, interval: float, parameters: Parameters) -> list[FilterModel]:
    if not parameters.wavelet:
        return []
    model, _ = named("18AVWD", base, interval, parameters)
    return [
        replace(model, name=f"18AVWD at {level}", wavelet_levels=(level,) * len(AXES))
        for level in dict.fromkeys(parameters.wavelet)
    ]


def _without_biases(base: FilterModel, interval: float, parameters: Parameters) -> list[FilterModel]:
    """Return the filters of table 6: nine states, after levels of denoising with the paper's thresholds."""
    bare, _ = named("none", base, interval, parameters)
    return [
        replace(bare, name=f"{word} levels", wavelet_levels=levels, wavelet_scale="none")
        for word, levels in NINE_STATES.items()
    ]


def _carried(carried: dict[str, tuple[str, ...]]) -> tuple[Note, ...]:
    axes = next((axes for axes in carried.values() if axes), ())
    if not axes:
        return ()
    names = ", ".join(name for name, own in carried.items() if own)
    text = (
        f"the bench record identifies no slow noise on {', '.join(axes)}; {names} carry a random walk at its upper limit there, "
        "because what a record does not show is not zero"
    )
    return (Note("unidentified-carried", text),)

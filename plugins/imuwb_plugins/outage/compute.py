"""From a log to the result of an outage replay."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.conditioning import corrected_log
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES, Log
from imuwb.navigation import Aids, FilterModel, Installation, Settings, read_filter
from imuwb.replay import (
    HORIZONS,
    Clocks,
    Degradation,
    Mounting,
    Outage,
    Prepared,
    Replay,
    Tuned,
    estimate_clocks,
    estimate_mounting,
    model_named,
    own_outages,
    prepare,
    replay,
    sweep,
    tune,
    verdict,
)
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.outage import filters, notes, summary, tracks
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import Result
from imuwb_plugins.outage.starts import started
from imuwb_plugins.outage.truth import with_truth


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the drift of each filter in the outages.

    Raises:
        UsageError: no error model; an outage that is not possible.
        MissingDataError: the log lacks something.
    """
    base = _base(parameters)
    log, _ = corrected_log(logs[0], base.error_model)
    base, mounting = _mounted(log, base, parameters)
    base, of_start = started(log, base, parameters)
    base, clocks = _timed(log, base, parameters)
    log, of_truth = with_truth(log, base, parameters)
    worse = Degradation(**parameters.degrade, seed=parameters.seed) if parameters.degrade else None
    prepared = prepare(log, base, parameters.receiver, worse)
    prepared = replace(prepared, notes=(*prepared.notes, *of_start, *of_truth))
    models, failed = _models(base, prepared, parameters)
    tuned = None
    if parameters.tune:
        try:
            better, tuned = tune(prepared, models[-1], parameters.reference)
        except ValueError as error:
            raise MissingDataError(str(error)) from error
        models.append(replace(better, name="tuned"))
    if base.aids.speed and not log.speeds:
        raise MissingDataError(f"{log.provenance.path}: the log has no speed, which --speed needs; leave --speed out")
    try:
        replayed = replay(prepared, models, _outages(prepared, base, parameters), reference=parameters.reference)
    except ValueError as error:
        raise MissingDataError(f"{log.provenance.path}: {error}") from error
    replayed = replace(replayed, failed={**failed, **replayed.failed})
    return _result(replayed, parameters, clocks, mounting, tuned)


def _result(
    replayed: Replay, parameters: Parameters, clocks: Clocks | None, mounting: Mounting | None, tuned: Tuned | None
) -> Result:
    outages = summary.outage_results(replayed)
    statistics = {duration: summary.summaries(replayed, duration, parameters.level) for duration in replayed.scored}
    durations = tuple(
        summary.duration_summary(replayed, duration, by_filter, parameters.level)
        for duration, by_filter in statistics.items()
    )
    causal = replayed.prepared.log.causal
    infos = tuple(filters.info(own, causal=causal) for own in replayed.runs.values())
    verdicts = [
        notes.prefixed(f"{d:g} s", verdict(s)) for d, by_filter in statistics.items() for s in by_filter.values()
    ]
    return Result(
        outages, summary.listed(outages), durations, summary.samples(replayed), summary.published(outages), infos,
        filters.budget(replayed), replayed.reference.name, tuple(dict.fromkeys(verdicts)),
        notes.notes(replayed, durations, infos, clocks, mounting, tuned), clocks, mounting, tuned,
        filters.sensor_errors(replayed), replayed.reference.position, tracks.tracks(replayed), parameters.map,
        tracks.navigation(replayed), replayed.failed,
    )  # fmt: skip


def _base(parameters: Parameters) -> FilterModel:
    """Return the given filter, or a filter with the given error model and settings.

    Raises:
        UsageError: neither an error model nor a filter.
    """
    if parameters.filter is not None:
        base = read_filter(parameters.filter)
        if base.name in (*parameters.models, "tuned"):
            base = replace(base, name=f"{base.name} of {parameters.filter.name}")
        if parameters.error_model is not None:
            base = replace(base, error_model=ImuErrorModel.read(parameters.error_model))
        return base
    if parameters.error_model is None:
        raise UsageError("outage needs --error-model MODEL.toml; imuwb noise writes one from a static record")
    gyro, accel = parameters.scale_factor
    return FilterModel(
        "base", ImuErrorModel.read(parameters.error_model), scale_factor=(gyro / 100, accel / 100),
        installation=Installation(
            (0.0, 0.0, 0.0) if parameters.mounting == "auto" else parameters.mounting, parameters.lever_arm,
            0.0 if parameters.gnss_delay == "auto" else parameters.gnss_delay, parameters.velocity_delay,
            1.0 if parameters.clock_rate == "auto" else parameters.clock_rate, parameters.skew,
        ),
        settings=Settings(every=parameters.every, settling=parameters.settling, horizons=_horizons(parameters)),
        aids=Aids(parameters.straight, parameters.still, parameters.speed),
    )  # fmt: skip


def _horizons(parameters: Parameters) -> tuple[float, float]:
    """Return the shortest and the longest outage, s; drift is also judged at the first of the usual horizons."""
    durations = (*parameters.durations, *(d for _, d in (() if parameters.at == "own" else parameters.at)))
    return min(HORIZONS[0], *durations), max(durations)


def _mounted(log: Log, base: FilterModel, parameters: Parameters) -> tuple[FilterModel, Mounting | None]:
    """Return the filter with the mounting, and the estimate of it if one is wanted."""
    if parameters.mounting != "auto":
        return base, None
    mounting = estimate_mounting(log, parameters.receiver, parameters.level)
    return replace(base, installation=replace(base.installation, mounting=mounting.angles)), mounting


def _timed(log: Log, base: FilterModel, parameters: Parameters) -> tuple[FilterModel, Clocks | None]:
    """Return the filter with delays and clock rate, and the estimate of them if one is wanted."""
    with_delay, with_rate = parameters.gnss_delay == "auto", parameters.clock_rate == "auto"
    if not (with_delay or with_rate):
        return base, None
    full = _largest(base, prepare(log, base, parameters.receiver), parameters)
    clocks = estimate_clocks(
        log, full, parameters.receiver, parameters.level, with_delay=with_delay, with_rate=with_rate
    )
    estimates = {"gnss_delay": clocks.delay, "velocity_delay": clocks.velocity_delay, "clock_rate": clocks.rate}
    known = {name: estimate.value for name, estimate in estimates.items() if estimate is not None}
    return replace(base, installation=replace(base.installation, **known)), clocks


def _largest(base: FilterModel, prepared: Prepared, parameters: Parameters) -> FilterModel:
    """Return the filter with the most processes that can run with this error model.

    Raises:
        UsageError: none can run.
    """
    for name in ("full", "18AV"):
        try:
            model = _named(name, base, prepared, parameters)
            model.tables(prepared.measurement.interval)
        except UsageError:
            continue
        return model
    return _named("none", base, prepared, parameters)


def _models(base: FilterModel, prepared: Prepared, parameters: Parameters) -> tuple[list[FilterModel], dict[str, str]]:
    """Return the filters, and the reasons of those that cannot be made from this error model.

    Raises:
        UsageError: no filter can be made.
    """
    models: list[FilterModel] = []
    failed: dict[str, str] = {}
    for name in parameters.models:
        try:
            models.append(_named(name, base, prepared, parameters))
        except UsageError as error:
            failed[name] = str(error)
    if not models:
        raise UsageError(next(iter(failed.values())))
    if parameters.wavelet:
        denoised = _named("18AVWD", base, prepared, parameters)
        models.extend(
            replace(denoised, name=f"18AVWD at {level}", wavelet_levels=(level,) * len(AXES))
            for level in dict.fromkeys(parameters.wavelet)
        )
    return [*models, base] if parameters.filter is not None else models, failed


def _named(name: str, base: FilterModel, prepared: Prepared, parameters: Parameters) -> FilterModel:
    reading = "as printed" if parameters.reading == "as-printed" else "corrected"
    turn_on = None
    if parameters.turn_on != "auto":
        turn_on = math.radians(parameters.turn_on[0]), parameters.turn_on[1]
    try:
        return model_named(name, base, reading=reading, interval=prepared.measurement.interval, turn_on=turn_on)
    except ValueError as error:
        raise UsageError(str(error)) from error


def _outages(prepared: Prepared, base: FilterModel, parameters: Parameters) -> Sequence[Outage]:
    if parameters.at == "own":
        return own_outages(prepared, base)
    if parameters.at:
        return [Outage(start, duration) for start, duration in sorted(set(parameters.at))]
    outages: list[Outage] = []
    for duration in sorted(set(parameters.durations)):
        swept = sweep(prepared, base, duration)
        if parameters.random and len(swept) > parameters.random:
            rng = np.random.default_rng(parameters.seed)
            rows = np.sort(rng.choice(len(swept), parameters.random, replace=False))
            swept = tuple(swept[i] for i in rows)
        outages.extend(swept)
    return outages

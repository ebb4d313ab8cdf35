"""The filter that all others are made from: error model, settings, and an installation that is given or estimated from the log."""

from dataclasses import dataclass, fields, replace

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Log
from imuwb.navigation import Aids, FilterModel, Installation, Settings, read_filter
from imuwb.notes import Note
from imuwb.replay import (
    HORIZONS,
    Clocks,
    GnssCorrelation,
    Mounting,
    estimate_clocks,
    estimate_gnss_correlation,
    estimate_mounting,
    prepare,
    usual_in_motion,
)
from imuwb.simulation import sensor_model
from imuwb_plugins.outage.models import named
from imuwb_plugins.outage.outage_list import given
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.starts import started
from imuwb_plugins.outage.static import with_static

ALIGNED = 1.5  #: deg; roll and pitch below which axes that agree in heading count as those of the vehicle
#: options that are settings of a given filter
OF_A_FILTER = (
    "mounting", "lever_arm", "vehicle_arm", "gnss_delay", "velocity_delay", "clock_rate", "skew", "scale_factor", "settling", "every",
    "straight", "still", "speed", "gnss_sigma", "gnss_scale", "gnss_floor", "gnss_correlation", "spacing",
)  # fmt: skip
CLEAR_RATE = 2e-4  #: half the width of the interval of a clock rate that is used
HEADING = 3.0  #: deg, usual sigma of the heading at the start


@dataclass(frozen=True, slots=True)
class Installed:
    """A filter with its installation, and what was estimated for it; None: given, or not shown by the log."""

    base: FilterModel
    mounting: Mounting | None
    clocks: Clocks | None
    correlation: GnssCorrelation | None
    notes: tuple[Note, ...]


def installed(log: Log, parameters: Parameters) -> Installed:
    """Return the filter that the options give, with mounting, delays and clock rate from the log where they are not given.

    Raises:
        UsageError: neither an error model nor a filter.
        MissingDataError: the log has no IMU, no receiver, or too few fixes.
    """
    base = base_of(parameters)
    if parameters.filter is not None:
        base, of_start = started(log, base, parameters)
        return Installed(base, None, None, None, (*_without_effect(parameters), *of_start))
    base, mounting, of_mounting = _mounted(log, base, parameters)
    base, of_start = started(log, base, parameters)
    base, clocks, of_clocks = _timed(log, base, parameters)
    base, correlation, of_receiver = _correlated(log, base, parameters)
    return Installed(base, mounting, clocks, correlation, (*of_mounting, *of_start, *of_clocks, *of_receiver))


def _without_effect(parameters: Parameters) -> tuple[Note, ...]:
    """Return a note on the options that are given although a filter's own settings apply."""
    given = [f.name for f in fields(parameters) if f.name in OF_A_FILTER and getattr(parameters, f.name) != f.default]
    if not given:
        return ()
    names = ", ".join(f"--{name.replace('_', '-')}" for name in given)
    return (
        Note("filter-settings", f"{names} have no effect: the settings of {parameters.filter} apply to all filters"),
    )


def base_of(parameters: Parameters) -> FilterModel:
    """Return the given filter, or a filter with the given error model and settings.

    Raises:
        UsageError: neither an error model nor a filter.
    """
    if parameters.filter is not None:
        base = read_filter(parameters.filter)
        if base.name in (*parameters.models, "tuned"):
            base = replace(base, name=f"{base.name} of {parameters.filter.name}")
        if parameters.error_model is not None:
            base = replace(base, error_model=sensor_model(parameters.error_model))
        return replace(base, error_model=with_static(base.error_model, parameters))
    if parameters.error_model is None:
        raise UsageError("outage needs --error-model MODEL.toml; imuwb noise writes one from a static record")
    gyro, accel = parameters.scale_factor
    return FilterModel(
        "base", with_static(sensor_model(parameters.error_model), parameters), scale_factor=(gyro / 100, accel / 100),
        installation=Installation(
            (0.0, 0.0, 0.0) if parameters.mounting == "auto" else parameters.mounting, parameters.lever_arm,
            0.0 if parameters.gnss_delay == "auto" else parameters.gnss_delay, parameters.velocity_delay,
            1.0 if parameters.clock_rate == "auto" else parameters.clock_rate, parameters.skew,
            parameters.vehicle_arm,
        ),
        settings=Settings(
            every=parameters.every, settling=parameters.settling, horizons=_horizons(parameters), sigma_stated=parameters.gnss_sigma,
            sigma_scale=parameters.gnss_scale, sigma_floor=parameters.gnss_floor, spacing=parameters.spacing,
            gnss_correlation=(0.0, 0.0) if parameters.gnss_correlation == "auto" else parameters.gnss_correlation,
        ),
        aids=Aids(parameters.straight, parameters.still, parameters.speed),
    )  # fmt: skip


def _horizons(parameters: Parameters) -> tuple[float, float]:
    """Return the shortest and the longest outage, s; drift is also judged at the first of the usual horizons."""
    durations = (*parameters.durations, *(outage.duration for outage in given(parameters.at)))
    return min(HORIZONS[0], *durations), max(durations)


def _mounted(
    log: Log, base: FilterModel, parameters: Parameters
) -> tuple[FilterModel, Mounting | None, tuple[Note, ...]]:
    """Return the filter with the mounting, the estimate of it if the log shows one, and a note."""
    if parameters.mounting != "auto":
        return base, None, ()
    try:
        mounting = estimate_mounting(log, parameters.receiver, parameters.level)
    except MissingDataError as error:
        text = f"the IMU's axes are taken as those of the vehicle, forward, right and down: {error}"
        return base, None, (Note("mounting-assumed", text),)
    roll, pitch, heading = mounting.angles
    half = mounting.heading.upper - mounting.heading.value
    text = f"the log shows a mounting of roll {roll:.2f}, pitch {pitch:.2f}, heading {heading:.2f} ± {half:.2f} deg"
    if abs(heading) <= max(half, ALIGNED) and max(abs(roll), abs(pitch)) < ALIGNED:
        return base, mounting, (Note("mounting-aligned", f"{text}: the IMU's axes are those of the vehicle"),)
    installation = replace(base.installation, mounting=mounting.angles)
    wider = (HEADING**2 + (mounting.heading.sigma or 0.0) ** 2) ** 0.5
    settings = replace(base.settings, heading=wider)
    return replace(base, installation=installation, settings=settings), mounting, (Note("mounting", text),)


def _timed(log: Log, base: FilterModel, parameters: Parameters) -> tuple[FilterModel, Clocks | None, tuple[Note, ...]]:
    """Return the filter with delays and clock rate, the estimate of them if the log shows them, and a note."""
    with_delay, with_rate = parameters.gnss_delay == "auto", parameters.clock_rate == "auto"
    if not (with_delay or with_rate):
        return base, None, ()
    # The noise of a bench would refuse the fixes that show a delay.
    small = usual_in_motion(_small(base, prepare(log, base, parameters.receiver).measurement.interval, parameters))

    def estimated(start: FilterModel, *, rate: bool) -> Clocks:
        return estimate_clocks(log, start, parameters.receiver, parameters.level, with_delay=with_delay, with_rate=rate)

    clocks = estimated(small, rate=False) if with_delay else None
    if clocks is not None and not clocks.shown:
        clocks = None
    if with_rate:
        # A rate is used where it is clear: over a short or slow drive, it stands in for other errors.
        both = estimated(_with_clocks(small, clocks), rate=True)
        rate = both.rate
        clear = rate is not None and rate.upper - rate.lower < 2 * CLEAR_RATE and not rate.lower <= 1.0 <= rate.upper
        clocks = both if clear and both.shown else clocks
    if clocks is None:
        text = "the innovations show no delay of the fixes and no error of the IMU's clock; none is assumed"
        return base, None, (Note("clocks-agree", text),)
    return _with_clocks(base, clocks), clocks, ()


def _correlated(
    log: Log, base: FilterModel, parameters: Parameters
) -> tuple[FilterModel, GnssCorrelation | None, tuple[Note, ...]]:
    """Return the filter with the receiver's correlated error, the estimate of it if the log shows one, and a note."""
    if parameters.gnss_correlation != "auto":
        return base, None, ()
    prepared = prepare(log, base, parameters.receiver)
    small = _small(base, prepared.measurement.interval, parameters)
    try:
        found = estimate_gnss_correlation(prepared, (small, usual_in_motion(small)), parameters.level)
    except MissingDataError as error:
        text = f"errors of the fixes are taken as independent of each other: {error}"
        return base, None, (Note("gnss-correlation-unknown", text),)
    if not found.shown:
        text = (
            "the innovations show no correlated error of the positions (the log-likelihood rises by "
            f"{max(found.gain, 0.0):.1f}, not by more than 5); none is assumed"
        )
        return base, None, (Note("gnss-uncorrelated", text),)
    text = (
        f"the errors of the positions are correlated in time: a Gauss-Markov error of {found.sigma} (horizontal; vertical twice "
        f"that) with a correlation time of {found.time} raises the log-likelihood of the innovations by {found.gain:.0f}; the filters "
        "have three states for it"
    )
    settings = replace(base.settings, gnss_correlation=(found.sigma.value, found.time.value))
    return replace(base, settings=settings), found, (Note("gnss-correlated", text),)


def _with_clocks(model: FilterModel, clocks: Clocks | None) -> FilterModel:
    """Return a filter with the delays and the clock rate that are estimated; None: as it is."""
    if clocks is None:
        return model
    estimates = {"gnss_delay": clocks.delay, "velocity_delay": clocks.velocity_delay, "clock_rate": clocks.rate}
    known = {name: estimate.value for name, estimate in estimates.items() if estimate is not None}
    return replace(model, installation=replace(model.installation, **known))


def _small(base: FilterModel, interval: float, parameters: Parameters) -> FilterModel:
    """Return a filter of few states that can run with this error model: a delay needs no more.

    Raises:
        UsageError: none can run.
    """
    for name in ("15AV", "18AV"):
        try:
            model, _ = named(name, base, interval, parameters)
            model.tables(interval)
        except UsageError:
            continue
        return model
    return named("none", base, interval, parameters)[0]

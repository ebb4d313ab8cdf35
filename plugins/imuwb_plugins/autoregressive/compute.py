"""From a log to autoregressive models."""

from collections.abc import Iterator, Sequence

import numpy as np

from imuwb import __version__
from imuwb.analysis import Finding
from imuwb.arrays import alone
from imuwb.axes import Axis, axes_of, for_each
from imuwb.errors import MissingDataError, UsageError
from imuwb.health import record_doubts, stillness_of
from imuwb.identification import AutoregressiveFit, fit_autoregressive
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import Log, source_of
from imuwb.noise_results import missing_notes
from imuwb.notes import Note
from imuwb.stochastic import Autoregressive, AxisModel, ImuErrorModel, Sum
from imuwb.units import coefficient_units
from imuwb_plugins.autoregressive.parameters import Parameters
from imuwb_plugins.autoregressive.result import AutoregressiveAxis, Result

CONVENTION = "x(n) = -sum alpha_k x(n-k) + beta0 w(n); libraries that print phi mean -alpha"
FEWEST = 128  #: samples
ROUNDING = 1e-3  #: relative error of a ratio of rates that counts as a whole number


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the models of the log's (first) IMU.

    Raises:
        MissingDataError: no axis has a model.
        UsageError: the log's rate is no multiple of ``resample``.
    """
    log = logs[0]
    imu = log.imu()
    results = for_each(axes_of(imu), lambda axis: _axis(axis, parameters))
    notes = missing_notes(log, {axis: r.why_none for axis, r in results.items()}, "no-model", "a model")
    doubts = record_doubts(log, stillness_of(log))
    return Result(
        imu.name, source_of(log), parameters.level, CONVENTION, bool(log.conditioning), results, (*doubts.all, *notes), doubts
    )  # fmt: skip


def _axis(axis: Axis, parameters: Parameters) -> AutoregressiveAxis:
    unit, clock = coefficient_units(axis.name, "rate")[0].name, axis.clock
    series = axis.values
    why = unsuitable(series, max(4 * parameters.orders + 16, FEWEST))
    if why is None:
        try:
            with alone(series.size):
                fit = fit_autoregressive(
                    series, clock.interval, parameters.orders, level=parameters.level, breaks=clock.breaks
                )
        except ValueError as error:
            why = str(error)
        else:
            model, why = _model(fit, parameters)
            poles = tuple(complex(p) for p in np.roots([1.0, *model.alpha])) if model is not None else ()
            return AutoregressiveAxis(
                fit.orders, fit.chosen, fit.whiteness, fit.reading, model, poles, clock.interval, unit, why
            )
    return AutoregressiveAxis((), None, (), "", None, (), clock.interval, unit, why)


def _model(fit: AutoregressiveFit, parameters: Parameters) -> tuple[Autoregressive | None, str | None]:
    order = parameters.order or fit.chosen
    try:
        model = fit.process(order)
    except ValueError as error:
        return None, f"the model of order {order} is not saved: {error}"
    if parameters.resample is None:
        return model, None
    factor = 1 / (parameters.resample * fit.dt)
    if round(factor) < 1 or abs(factor / round(factor) - 1) > ROUNDING:
        raise UsageError(
            f"resample is {parameters.resample:g} Hz; it must be the log's rate, {1 / fit.dt:.6g} Hz, divided by a whole number"
        )
    return model.resampled(round(factor)), None


def findings(result: Result) -> tuple[Finding, ...]:
    """Return remarks on the models of each axis."""
    return tuple(Finding(axis, "autoregressive", {}, tuple(_remarks(r))) for axis, r in result.axes.items())


def _remarks(r: AutoregressiveAxis) -> Iterator[Note]:
    if not r.orders:
        return
    first = r.orders[0]
    reading = r.reading.partition(": ")[2]
    yield Note("first-order", f"AR(1): alpha {first.alpha[0]:.4g} ± {first.alpha_sigma[0]:.1g}, {reading}")
    tenable = [w.order for w in r.whiteness if w.white]
    tested = ", ".join(str(w.order) for w in r.whiteness)
    yield (
        Note("tenable", f"AR({tenable[0]}) is tenable")
        if tenable
        else Note("untenable", f"no tested order ({tested}) leaves white innovations")
    )


def error_model(result: Result) -> ImuErrorModel:
    """Return the saved models of all axes.

    Raises:
        MissingDataError: no axis has a stable model.
    """
    axes = {axis: AxisModel(Sum((r.model,))) for axis, r in result.axes.items() if r.model is not None}
    if not axes:
        raise MissingDataError(f"{result.imu}: no axis has a stable model, so there is no error model to save")
    provenance = {"log": result.source, "analysis": f"imuwb {__version__} autoregressive"}
    return ImuErrorModel(result.imu, axes, provenance, result.doubts.all)


def objections(result: Result) -> tuple[Note, ...]:
    """Return why no error model should be made of this record."""
    return result.doubts.grave

"""The filters that a replay compares, by name: all are made from one error model (Quinchia, tables 5 and 8, appendix A.1).

``none``     white noise only: 9 states
``15AV``     white noise, and a Gauss-Markov bias on every axis, from its bias instability
``18AV``     15AV, and a random walk on the accelerometers
``18AVWD``   18AV, on samples after wavelet denoising with the levels of table 7 and thresholds without a scale, as for table 2
``15AR``     white noise, and an autoregressive process of order 1 on every axis, of denoised static samples: the one that the error
             model keeps, or else the one that follows from its processes (``imuwb.replay.noise.denoised_ar``)
``27AR``     white noise, and an autoregressive process of order 3 on every axis, by the same method
``full``     all processes of the error model, flicker noise as several Gauss-Markov states; and turn-on biases

Where the error model has a turn-on bias (``Constant``), all filters but ``none`` have six more states for it.
"""

from dataclasses import replace

import numpy as np

from imuwb.errors import UsageError
from imuwb.identification.allan_variance.flat import FlatPart, flat_part
from imuwb.log import AXES
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.shaping import Reading
from imuwb.replay.noise.denoised_ar import LEVELS, ORDERS, at_interval, expected, levels
from imuwb.stochastic import (
    FLICKER_LEVEL,
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    Process,
    RandomWalk,
    Sum,
    WhiteNoise,
)

NAMES = ("none", "15AV", "18AV", "18AVWD", "15AR", "27AR", "full")
#: For a Gauss-Markov process: ratio of the largest Allan deviation to sigma, and of its averaging time to Tc.
PEAK, PEAK_AT = 0.6174, 1.892
LONGEST, SHORTEST = 2000.0, 1.0  #: s, range of averaging times in which the flat part of an Allan curve is searched
AR_ORDERS = {"15AR": 1, "27AR": 3}
TURN_ON = (float(np.radians(0.2)), 0.1)  #: rad/s, m/s²: usual for MEMS that were calibrated once


def model_named(
    name: str,
    base: FilterModel,
    *,
    reading: Reading = "corrected",
    interval: float,
    turn_on: tuple[float, float] | None = None,
) -> FilterModel:
    """Return one of the filters.

    Args:
        name: one of ``NAMES``.
        base: a filter with the error model and all settings.
        reading: how the paper's formulas are read, for Gauss-Markov parameters and for the filter.
        interval: s, sampling interval of the log.
        turn_on: sigmas of turn-on biases of gyros (rad/s) and accelerometers (m/s²), for an error model without them;
            None: ``TURN_ON`` for ``full``, none for the others.

    Raises:
        UsageError: no such name, or an axis that the error model lacks.
        ValueError: an AR process that is not stable.
    """
    if name not in NAMES:
        raise UsageError(f"there is no filter {name!r}; choose among {', '.join(NAMES)}")
    source = base.error_model
    missing = [axis for axis in AXES if axis not in source.axes]
    if missing:
        raise UsageError(f"the error model {source.name!r} has no axis {', '.join(missing)}; add it")
    if turn_on is None and name == "full":
        turn_on = TURN_ON
    axes = {axis: _axis(name, axis, source.axes[axis], reading, interval) for axis in AXES}
    if name != "none":
        axes = {
            axis: _with_turn_on(axes[axis], source.axes[axis], None if turn_on is None else turn_on[axis[0] == "a"])
            for axis in AXES
        }
    error_model = ImuErrorModel(f"{source.name} as {name}", axes, source.provenance, source.doubts)
    if name == "18AVWD":
        base = replace(base, wavelet_levels=levels(), wavelet_scale="none")
    return replace(base, name=name, error_model=error_model, reading=reading)


def _axis(name: str, axis: str, model: AxisModel, reading: Reading, interval: float) -> AxisModel:
    """Return an axis's model with the processes of a filter, at all temperatures."""
    if name == "full":
        return model
    points = tuple((t, _of(name, axis, model, s, reading, interval)) for t, s in model.thermal)
    return model.with_processes(_of(name, axis, model, model.processes, reading, interval), points)


def _of(name: str, axis: str, model: AxisModel, processes: Sum, reading: Reading, interval: float) -> Sum:
    white = tuple(term for term in processes.terms if isinstance(term, WhiteNoise))
    if name == "none":
        return Sum(white)
    if name.endswith("AR"):
        order = AR_ORDERS[name]
        return Sum(
            (*white, kept(model, order, interval) or expected(processes, LEVELS[axis], interval)[ORDERS.index(order)])
        )
    walk: tuple[Process, ...] = ()
    if name.startswith("18") and axis.startswith("accel"):
        walk = tuple(term for term in processes.terms if isinstance(term, RandomWalk))
    return Sum((*white, *gauss_markov(processes, reading), *walk))


def gauss_markov(processes: Sum, reading: Reading) -> tuple[GaussMarkov, ...]:
    """Return the Gauss-Markov processes that represent bias instability: the model's own, or one made from its flicker noise.

    As printed (eq. 29, table 5): sigma is the flat Allan deviation 0.664 B, and Tc is the arithmetic middle of the flat part. "corrected": the largest Allan deviation of the process has this value, in the middle of the flat part on a logarithmic axis.
    """
    own = tuple(term for term in processes.terms if isinstance(term, GaussMarkov))
    flicker = [term for term in processes.terms if isinstance(term, FlickerNoise) and term.B > 0]
    if own or not flicker:
        return own
    level, flat = FLICKER_LEVEL * flicker[0].B, flat_of(processes)
    if reading != "corrected":
        return (GaussMarkov(level, flat.centre),)
    return (GaussMarkov(level / PEAK, (flat.begin * flat.end) ** 0.5 / PEAK_AT),)


def flat_of(processes: Sum) -> FlatPart:
    """Return the averaging times at which a model's Allan deviation is within 5 % of its smallest."""
    tau = np.geomspace(SHORTEST, LONGEST, 400)
    kept = Sum(tuple(t for t in processes.terms if isinstance(t, WhiteNoise | FlickerNoise | RandomWalk)))
    return flat_part(tau, np.sqrt(kept.allan_variance(tau, 1e-3)))


def kept(model: AxisModel, order: int, interval: float) -> Autoregressive | None:
    """Return the AR process of an order that an error model keeps for the filters, or has in its sum; None: it has none."""
    own = (*model.autoregressive, *(term for term in model.processes.terms if isinstance(term, Autoregressive)))
    return next((at_interval(process, interval) for process in own if len(process.alpha) == order), None)


def _with_turn_on(model: AxisModel, source: AxisModel, sigma: float | None) -> AxisModel:
    """Return a model with the turn-on bias of the source, or, if the source has none, with one of a given sigma."""
    if any(isinstance(term, Constant) for term in model.processes.terms):
        return model
    stated = tuple(term for term in source.processes.terms if isinstance(term, Constant))
    added = stated or ((Constant(float(sigma)),) if sigma else ())

    def more(s: Sum) -> Sum:
        return Sum((*s.terms, *added))

    return replace(model, processes=more(model.processes), thermal=tuple((t, more(s)) for t, s in model.thermal))

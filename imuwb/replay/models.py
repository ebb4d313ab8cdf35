"""The filters that are compared, by name: values made of one error model (Quinchia, tables 5 and 8, appendix A.1).

``none``     9 states: white noise alone
``15AV``     and a Gauss-Markov bias on every axis, from its bias instability
``18AV``     and a random walk on the accelerometers
``18AVWD``   18AV on samples that went through wavelet denoising
``15AR``     an autoregressive process of first order on every axis instead, Burg's of denoised static samples
``27AR``     likewise of third order
``full``     everything that the error model says, flicker as several Gauss-Markov states; and turn-on biases

Where an error model states a turn-on bias (``Constant``), all but ``none`` carry it, and have six states more than named.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.conditioning import denoise
from imuwb.errors import UsageError
from imuwb.identification.correlation.burg import burg
from imuwb.log import AXES
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from imuwb.log import Floats
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.navigation.shaping import Reading
    from imuwb.stochastic import Process

NAMES = ("none", "15AV", "18AV", "18AVWD", "15AR", "27AR", "full")
FLOOR = float(np.sqrt(2 * np.log(2) / np.pi))  #: flat Allan deviation of flicker over its B
PEAK, PEAK_AT = (
    0.6174,
    1.892,
)  #: largest Allan deviation of a Gauss-Markov process over its sigma, and where, over its Tc
LONGEST, SHORTEST = 2000.0, 1.0  #: s, between which the flat part of an Allan curve is looked for
STATIC = 1800.0  #: s of static samples that an AR process is fitted to, where no static log is given
TURN_ON = (float(np.radians(0.2)), 0.1)  #: rad/s, m/s²: usual of MEMS that were calibrated once
WAVELET, SEED = "db4", 0
LEVELS = {"gyro_x": 7, "gyro_y": 7, "gyro_z": 7, "accel_x": 7, "accel_y": 6, "accel_z": 6}  #: Quinchia, table 7


def model_named(
    name: str,
    base: FilterModel,
    *,
    reading: Reading = "corrected",
    interval: float,
    turn_on: tuple[float, float] | None = None,
    static: Mapping[str, Floats] | None = None,
) -> FilterModel:
    """Return one of the filters.

    Args:
        name: one of ``NAMES``.
        base: the error model, and all settings.
        reading: of the paper's formulas, for Gauss-Markov parameters and for the filter's own.
        interval: s, the log's.
        turn_on: sigmas of turn-on biases of gyros (rad/s) and accelerometers (m/s²) to add where the error model has none;
            None: only to ``full``, which gets ``TURN_ON``.
        static: axis -> samples at that interval, to which AR processes are fitted; None: simulated from the error model.

    Raises:
        UsageError: no such name.
        ValueError: an axis that is missing, an AR process that is not stable.
    """
    if name not in NAMES:
        message = f"no filter {name!r}; there are {', '.join(NAMES)}"
        raise UsageError(message)
    source = base.error_model
    missing = [axis for axis in AXES if axis not in source.axes]
    if missing:
        message = f"the error model {source.name!r} says nothing of {', '.join(missing)}"
        raise UsageError(message)
    if turn_on is None and name == "full":
        turn_on = TURN_ON
    axes = {axis: _axis(name, axis, source.axes[axis], reading, interval, static) for axis in AXES}
    if name != "none":
        axes = {
            axis: _with_turn_on(axes[axis], source.axes[axis], None if turn_on is None else turn_on[axis[0] == "a"])
            for axis in AXES
        }
    error_model = ImuErrorModel(f"{source.name} as {name}", axes, source.provenance)
    levels = tuple(LEVELS[axis] for axis in AXES) if name == "18AVWD" else base.wavelet_levels
    return replace(base, name=name, error_model=error_model, reading=reading, wavelet_levels=levels)


def _axis(
    name: str, axis: str, model: AxisModel, reading: Reading, interval: float, static: Mapping[str, Floats] | None
) -> AxisModel:
    if name == "full":
        return model
    if model.thermal:
        points = tuple((t, _of(name, axis, s, reading, interval, static)) for t, s in model.thermal)
        return replace(model, processes=_of(name, axis, model.processes, reading, interval, static), thermal=points)
    return replace(model, processes=_of(name, axis, model.processes, reading, interval, static))


def _of(
    name: str, axis: str, processes: Sum, reading: Reading, interval: float, static: Mapping[str, Floats] | None
) -> Sum:
    white = tuple(term for term in processes.terms if isinstance(term, WhiteNoise))
    if name == "none":
        return Sum(white)
    if name.endswith("AR"):
        return Sum((*white, _autoregressive(1 if name == "15AR" else 3, axis, processes, interval, static)))
    walk: tuple[Process, ...] = ()
    if name.startswith("18") and axis.startswith("accel"):
        walk = tuple(term for term in processes.terms if isinstance(term, RandomWalk))
    return Sum((*white, *gauss_markov(processes, reading), *walk))


def gauss_markov(processes: Sum, reading: Reading) -> tuple[GaussMarkov, ...]:
    """Return the Gauss-Markov process that stands for a bias instability: that of the model, or one made of its flicker.

    As printed (eq. 29, table 5), sigma is the flat level 0.664 B and Tc its middle; corrected, both are chosen so that the
    process's own Allan peak is that level, there.
    """
    own = tuple(term for term in processes.terms if isinstance(term, GaussMarkov))
    flicker = [term for term in processes.terms if isinstance(term, FlickerNoise) and term.B > 0]
    if own or not flicker:
        return own
    level, middle = FLOOR * flicker[0].B, flat_middle(processes)
    if reading == "as printed":
        return (GaussMarkov(level, middle),)
    return (GaussMarkov(level / PEAK, middle / PEAK_AT),)


def flat_middle(processes: Sum) -> float:
    """Return the averaging time in the middle of a model's flat part, s: where its Allan deviation is within 5 % of its least."""
    tau = np.geomspace(SHORTEST, LONGEST, 400)
    kept = Sum(tuple(t for t in processes.terms if isinstance(t, WhiteNoise | FlickerNoise | RandomWalk)))
    deviation = np.sqrt(kept.allan_variance(tau, 1e-3))
    flat = tau[deviation <= 1.05 * deviation.min()]
    return float(np.sqrt(flat[0] * flat[-1]))


def _autoregressive(
    order: int, axis: str, processes: Sum, interval: float, static: Mapping[str, Floats] | None
) -> Autoregressive:
    for term in processes.terms:
        if isinstance(term, Autoregressive) and len(term.alpha) == order:
            return term
    if static is not None and axis in static:
        samples = static[axis]
    else:
        drawn = Sum(tuple(term for term in processes.terms if not isinstance(term, Constant)))
        rng = np.random.default_rng([SEED, AXES.index(axis)])
        samples = drawn.sample(round(STATIC / interval), interval, rng)
    found = burg(denoise(samples, LEVELS[axis], WAVELET).values, order)
    return Autoregressive(tuple(found.alpha[order]), float(np.sqrt(found.variance[order])), interval)


def _with_turn_on(model: AxisModel, source: AxisModel, sigma: float | None) -> AxisModel:
    stated = tuple(term for term in source.processes.terms if isinstance(term, Constant))
    if any(isinstance(term, Constant) for term in model.processes.terms):
        return model
    added = stated or (() if not sigma else (Constant(float(sigma)),))
    if not added:
        return model

    def more(s: Sum) -> Sum:
        return Sum((*s.terms, *added))

    return replace(model, processes=more(model.processes), thermal=tuple((t, more(s)) for t, s in model.thermal))

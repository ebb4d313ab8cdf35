"""The still record of Quinchia and others: tables 2 to 5, figures 10 to 17."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from imuwb.analysis import Bars, Figure
from imuwb.arrays import Floats
from imuwb.axes import axes_of
from imuwb.identification import fit_autoregressive
from imuwb.log import Log
from imuwb.statistics import Estimate
from imuwb.units import coefficient_units
from imuwb_plugins.allan.compute import run as allan
from imuwb_plugins.allan.parameters import Parameters as AllanParameters
from imuwb_plugins.allan.result import Result as AllanResult
from imuwb_plugins.allan.show import draw as draw_allan
from imuwb_plugins.autocorrelation.compute import run as autocorrelation
from imuwb_plugins.autocorrelation.parameters import Parameters as CorrelationParameters
from imuwb_plugins.autocorrelation.result import Result as CorrelationResult
from imuwb_plugins.autocorrelation.show import draw as draw_autocorrelation
from imuwb_plugins.noise import show_denoising
from imuwb_plugins.noise.denoising import denoising
from imuwb_plugins.psd.compute import run as psd
from imuwb_plugins.psd.parameters import Parameters as SpectrumParameters
from imuwb_plugins.psd.result import Result as SpectrumResult
from imuwb_plugins.psd.show import draw as draw_psd
from imuwb_plugins.reproduce.collected import figures_of, titled
from imuwb_plugins.reproduce.comparison import Found
from imuwb_plugins.reproduce.estimates import by_parts, in_unit
from imuwb_plugins.reproduce.printed import Key
from imuwb_plugins.wavelet.apply import condition
from imuwb_plugins.wavelet.parameters import Parameters as WaveletParameters

LEVELS = (7, 7, 7, 7, 6, 6)  #: table 7, in the order of AXES
DENOISED = 6  #: levels of figures 10 and 11
ORDERS = (1, 3)
MOST = 8  #: levels of figure 17
GYRO, ACCEL = "Gyroscopes", "Accelerometers"


def still(log: Log) -> Found:
    """Return the tables and figures of a still record."""
    curve = allan([log], AllanParameters(estimators=False))
    spectrum = psd([log], SpectrumParameters(raw=True))
    correlation = autocorrelation([log], CorrelationParameters(denoise=DENOISED))
    values: dict[Key, Estimate | str] = {}
    for table, result in (("4", curve), ("3", spectrum)):
        for axis, own in result.axes.items():
            for letter, coefficient in own.coefficients.items():
                values[Key(table, letter, axis)] = in_unit(coefficient, coefficient_units(axis, letter)[1].name)
    values |= dict(_times(curve)) | dict(_deviations(log)) | dict(_models(log))
    return Found(values, _figures(curve, spectrum, correlation) | {"17": _before_and_after(log)})


def _times(result: AllanResult) -> Iterator[tuple[Key, Estimate | str]]:
    for axis, own in result.axes.items():
        yield Key("5", "Tc", axis), own.correlation_time or "the record shows no bias instability on this axis"


def _deviations(log: Log) -> Iterator[tuple[Key, Estimate]]:
    for axis in axes_of(log.imu()).values():
        x, unit = axis.values, coefficient_units(axis.name, "rate")[0].name
        second = round(1 / axis.clock.interval)

        def fast(x: Floats, second: int = second) -> Floats:
            return np.array([np.sqrt(x[: x.size // second * second].reshape(-1, second).var(axis=1, ddof=1).mean())])

        ((value, low, high),) = by_parts(x, fast(x), fast)
        yield Key("5", "σ", axis.name), Estimate(value, low, high, unit=unit)


def _models(log: Log) -> Iterator[tuple[Key, Estimate]]:
    """Yield table 2: the autoregressive models of orders 1 and 3 after denoising as the paper can have done it."""
    denoised, _ = condition(log, WaveletParameters(levels=LEVELS, scale="none"))
    for axis in axes_of(denoised.imu()).values():
        unit = coefficient_units(axis.name, "rate")[0].name
        names = [*((p, f"α{k + 1}") for p in ORDERS for k in range(p)), *((p, "β0²") for p in ORDERS)]

        def fitted(x: Floats, dt: float = axis.clock.interval) -> Floats:
            orders = fit_autoregressive(x, dt, max(ORDERS)).orders
            chosen = [orders[p - 1] for p in ORDERS]
            return np.concatenate([*(order.alpha for order in chosen), [order.beta0**2 for order in chosen]])

        ends = by_parts(axis.values, fitted(axis.values), fitted)
        for (order, name), (value, low, high) in zip(names, ends, strict=True):
            yield (
                Key("2", f"AR({order}) {name}", axis.name),
                Estimate(value, low, high, unit=f"({unit})²" if name == "β0²" else "1"),
            )


def _figures(
    curve: AllanResult, spectrum: SpectrumResult, correlation: CorrelationResult
) -> dict[str, tuple[Figure | Bars, ...]]:
    deviations, densities = figures_of(draw_allan, curve), figures_of(draw_psd, spectrum)
    correlations = figures_of(draw_autocorrelation, correlation)
    drawn = {
        "10": titled(correlations, ACCEL), "11": titled(correlations, GYRO), "12": titled(densities, ACCEL),
        "14": titled(densities, GYRO), "15": titled(deviations, ACCEL), "16": titled(deviations, GYRO),
    }  # fmt: skip
    z = {name: replace(result, axes={"accel_z": result.axes["accel_z"]}) for name, result in (("13", spectrum),)}
    return drawn | {number: titled(figures_of(draw_psd, result), ACCEL) for number, result in z.items()}


def _before_and_after(log: Log) -> tuple[Figure | Bars, ...]:
    """Return figure 17: the Allan deviation of accelerometer z before and after denoising."""
    shown = denoising(log, MOST)
    if shown is None:
        return ()
    return titled(figures_of(show_denoising.draw, shown), "Accelerometer z: Allan")

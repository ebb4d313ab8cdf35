"""Figures and tables of the autoregressive models. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.identification.correlation.autoregressive import Order
    from imuwb_plugins.autoregressive.result import AxisResult, Result

SHOWN = (1, 2, 3)  #: orders of the table, and the chosen one
CIRCLE = (200, 200, 205)
POLES = (2.6, 1.22)  #: half width and height of the pole figure, which makes the circle round


def draw(result: Result, review: Review) -> None:
    """Show orders, poles and coefficients."""
    for note in result.notes:
        review.note(note)
    axes = {axis: found for axis, found in result.axes.items() if found.orders}
    for sensor, name in (("gyro", "Gyroscopes"), ("accel", "Accelerometers")):
        some = {axis: found for axis, found in axes.items() if axis.startswith(sensor)}
        if some:
            review.figure(_orders(name, some))
            review.figure(_poles(name, {axis: found for axis, found in some.items() if found.poles}))
    review.table(_coefficients(result, axes))
    review.table(_verdicts(axes))


def _orders(name: str, axes: dict[str, AxisResult]) -> Figure:
    curves = [
        Curve(
            axis.replace("_", " "), np.array([float(o.order) for o in found.orders]),
            np.array([o.beta0 for o in found.orders]) / found.orders[0].beta0, AXIS_COLORS[axis[-1]],
        )
        for axis, found in axes.items()
    ]  # fmt: skip
    return Figure(
        f"{name}: standard deviation of the innovations by order", "order [1]", "beta0 / beta0 of order 1 [1]", tuple(curves),
        x_scale="linear", y_scale="linear",
    )  # fmt: skip


def _poles(name: str, axes: dict[str, AxisResult]) -> Figure:
    turn = np.linspace(0, 2 * np.pi, 361)
    curves = [Curve("unit circle", np.cos(turn), np.sin(turn), CIRCLE, style="fit")]
    for axis, found in axes.items():
        poles = np.array(found.poles, dtype=np.complex128)
        curves.append(Curve(axis.replace("_", " "), poles.real, poles.imag, AXIS_COLORS[axis[-1]], style="points"))
    return Figure(
        f"{name}: poles of the models that are saved, stable inside the circle", "real part [1]", "imaginary part [1]", tuple(curves),
        x_scale="linear", y_scale="linear", x_limits=(-POLES[0], POLES[0]), y_limits=(-POLES[1], POLES[1]),
    )  # fmt: skip


def _coefficients(result: Result, axes: dict[str, AxisResult]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, found in axes.items():
        unit = coefficient_units(axis, "rate")[1]
        for order in found.orders:
            if order.order not in (*SHOWN, found.chosen):
                continue
            mark = " (least BIC)" if order.order == found.chosen else ""
            rows.append((
                axis, f"{order.order}{mark}", _alphas(order), f"{unit.from_si(order.beta0):.6g} {unit.name}",
                f"{order.largest_pole:.6f}" + ("" if order.stable else " NOT stable"), f"{order.bic - found.orders[0].bic:+.4g}",
                f"{order.aicc - found.orders[0].aicc:+.4g}",
            ))  # fmt: skip
    caption = (
        f"{result.convention}. Alpha ± standard error by Bartlett's formula, which holds for any series (in brackets: if the series is "
        f"autoregressive of this order); * differs from 0 at {100 * result.level:g} %. BIC and AICc against order 1."
    )
    headings = ("axis", "order", "alpha", "beta0", "largest pole", "BIC", "AICc")
    return Table(f"Autoregressive models of {result.imu}", headings, tuple(rows), caption)


def _alphas(order: Order) -> str:
    shown = [
        f"{a:.6g} ± {s:.1g} ({i:.1g}){'*' if sure else ''}"
        for a, s, i, sure in zip(
            order.alpha, order.alpha_sigma, order.alpha_sigma_if_ar, order.significant, strict=True
        )
    ]
    more = f"; ... {len(shown) - 3} more" if len(shown) > 3 else ""  # noqa: PLR2004 - one line
    return "; ".join(shown[:3]) + more


def _verdicts(axes: dict[str, AxisResult]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, found in axes.items():
        for w in found.whiteness:
            tenable = "white: tenable" if w.probability > 0.01 else "not white: the order is not tenable"  # noqa: PLR2004 - 99 %
            rows.append((axis, str(w.order), f"{w.statistic:.4g}", f"{w.probability:.2g}", f"{w.largest:.2g}", tenable))
        rows.append((axis, "1", "", "", "", found.reading))
    headings = ("axis", "order", "Ljung-Box, order + 20 lags", "p", "largest correlation", "verdict")
    return Table(
        "Are the innovations white?",
        headings,
        tuple(rows),
        "Tested at 1 %. A long record shows the smallest correlation: see how large it is.",
    )

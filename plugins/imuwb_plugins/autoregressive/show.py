"""Figures and tables of the autoregressive models."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.colors import AXIS_COLORS, PALE
from imuwb.identification.correlation.autoregressive import Order
from imuwb.noise_results import SENSORS, by_sensor
from imuwb.units import coefficient_units
from imuwb_plugins.autoregressive.result import AutoregressiveAxis, Result

SHOWN = (1, 2, 3)  #: orders in the table, beside the chosen one
ALPHAS = 3  #: coefficients of an order in the table
POLES = (2.6, 1.22)  #: half width and half height of the pole figure, in which the unit circle is round


def draw(result: Result, review: Review) -> None:
    """Show notes, orders, poles and coefficients."""
    for note in result.notes:
        review.note(note)
    axes = {axis: r for axis, r in result.axes.items() if r.orders}
    for sensor, own in by_sensor(axes).items():
        review.figure(_orders(SENSORS[sensor], own))
        review.figure(_poles(SENSORS[sensor], {axis: r for axis, r in own.items() if r.poles}))
    review.table(_coefficients(result, axes))
    review.table(_verdicts(axes))


def _orders(name: str, axes: dict[str, AutoregressiveAxis]) -> Figure:
    curves = tuple(
        Curve(
            axis.replace("_", " "), np.array([float(o.order) for o in r.orders]), np.array([o.beta0_ratio for o in r.orders]),
            AXIS_COLORS[axis[-1]],
        )
        for axis, r in axes.items()
    )  # fmt: skip
    return Figure(
        f"{name}: standard deviation of the innovations by order", "order [1]", "beta0 over beta0 of order 1 [1]", curves,
        x_scale="linear", y_scale="linear",
    )  # fmt: skip


def _poles(name: str, axes: dict[str, AutoregressiveAxis]) -> Figure:
    turn = np.linspace(0, 2 * np.pi, 361)
    curves = [Curve("unit circle", np.cos(turn), np.sin(turn), PALE, style="fit")]
    for axis, r in axes.items():
        poles = np.array(r.poles, dtype=np.complex128)
        curves.append(Curve(axis.replace("_", " "), poles.real, poles.imag, AXIS_COLORS[axis[-1]], style="points"))
    return Figure(
        f"{name}: poles of the saved models, stable inside the unit circle", "real part [1]", "imaginary part [1]", tuple(curves),
        x_scale="linear", y_scale="linear", x_limits=(-POLES[0], POLES[0]), y_limits=(-POLES[1], POLES[1]),
    )  # fmt: skip


def _coefficients(result: Result, axes: dict[str, AutoregressiveAxis]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, r in axes.items():
        unit = coefficient_units(axis, "rate")[1]
        for order in r.orders:
            if order.order in (*SHOWN, r.chosen):
                mark = " (least BIC)" if order.order == r.chosen else ""
                rows.append((
                    axis, f"{order.order}{mark}", _alphas(order), f"{unit.from_si(order.beta0):.6g} {unit.name}",
                    f"{order.largest_pole:.6f}" + ("" if order.stable else " NOT stable"), f"{order.bic_excess:+.4g}",
                    f"{order.aicc_excess:+.4g}",
                ))  # fmt: skip
    caption = (
        f"{result.convention}. Alpha ± standard error by Bartlett's formula, valid for any series (in brackets: valid if the series is "
        f"autoregressive of this order); * differs from 0 at {100 * result.level:g} %."
    )
    headings = (
        "axis", "order", "alpha [1]", "beta0", "magnitude of the largest pole [1]", "BIC over order 1 [1]", "AICc over order 1 [1]"
    )  # fmt: skip
    return Table(f"Autoregressive models of {result.imu}", headings, tuple(rows), caption)


def _alphas(order: Order) -> str:
    shown = [
        f"{a:.6g} ± {s:.1g} ({i:.1g}){'*' if sure else ''}"
        for a, s, i, sure in zip(
            order.alpha, order.alpha_sigma, order.alpha_sigma_if_ar, order.significant, strict=True
        )
    ]
    more = f"; ... {len(shown) - ALPHAS} more" if len(shown) > ALPHAS else ""
    return "; ".join(shown[:ALPHAS]) + more


def _verdicts(axes: dict[str, AutoregressiveAxis]) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, r in axes.items():
        for w in r.whiteness:
            verdict = "white: the order is tenable" if w.white else "not white: the order is not tenable"
            rows.append((axis, str(w.order), f"{w.statistic:.4g}", f"{w.probability:.2g}", f"{w.largest:.2g}", verdict))
        rows.append((axis, "1", "—", "—", "—", r.reading))
    headings = (
        "axis",
        "order",
        "Ljung-Box statistic, order + 20 lags [1]",
        "probability [1]",
        "largest correlation [1]",
        "verdict",
    )
    caption = "Tested at 1 %. A long record shows the smallest correlation, so look at its size too."
    return Table("Are the innovations white?", headings, tuple(rows), caption)

"""Figures 18 and 20 to 26: the drives, and the filters in their outages."""

from collections.abc import Sequence

import numpy as np

from imuwb.analysis import Bars, Curve, Figure, Mark
from imuwb.colors import BLUE, INK, RED
from imuwb_plugins.outage.figures import color_of
from imuwb_plugins.reproduce.quinchia.road import FILTERS, Driven, Outages

EAST, NORTH = "east of the start [m]", "north of the start [m]"
WIDTH = 0.8  #: of the bars of one outage in figure 26
SHOWN = {"21": 1, "22": 2, "24": 5, "25": 7}  #: figure -> outage


def drawn(drives: Sequence[Driven]) -> dict[str, tuple[Figure | Bars, ...]]:
    """Return the figures by number; a figure of an outage that is not scored has no drawing."""
    by_number = {outage.number: outage for drive in drives for outage in drive.filters}
    figures: dict[str, tuple[Figure | Bars, ...]] = {
        "18": tuple(_trajectory(d, d.levels, "*") for d in drives),
        "20": tuple(_trajectory(d, d.filters, "") for d in drives if d.plan.table == "9"),
        "23": tuple(_trajectory(d, d.filters, "") for d in drives if d.plan.table == "10"),
        "26": tuple(_all(list(by_number.values()), kind) for kind in ("largest", "mean")),
    }
    for number, outage in SHOWN.items():
        own = by_number.get(outage)
        figures[number] = () if own is None else (_plane(own), _over_time(own))
    return figures


def _trajectory(drive: Driven, outages: Sequence[Outages], mark: str) -> Figure:
    north, east = drive.track.T
    curves = [Curve("trajectory", east, north, RED, style="curve")]
    curves += [
        Curve("outages" if i == 0 else "", o.track[:, 1], o.track[:, 0], BLUE, style="line")
        for i, o in enumerate(outages)
    ]
    marks = tuple(Mark(float(o.track[0, 1]), float(o.track[0, 0]), f"outage {o.number}{mark}", BLUE) for o in outages)
    title = f"Trajectory {'1' if drive.plan.table == '9' else '2'} with its outages"
    return Figure(title, EAST, NORTH, tuple(curves), marks, x_scale="linear", y_scale="linear")


def _plane(outage: Outages) -> Figure:
    curves = [Curve("own run without outages", outage.track[:, 1], outage.track[:, 0], INK, style="curve")]
    for name in FILTERS:
        north, east = (outage.track + outage.apart[name]).T
        curves.append(Curve(name, east, north, color_of(name), style="curve"))
    title = f"Outage {outage.number}: positions of each filter"
    return Figure(title, EAST, NORTH, tuple(curves), x_scale="linear", y_scale="linear")


def _over_time(outage: Outages) -> Figure:
    curves = tuple(Curve(name, outage.elapsed, outage.error(name), color_of(name), style="curve") for name in FILTERS)
    title = f"Outage {outage.number}: horizontal error of each filter"
    return Figure(title, "time without GNSS [s]", "horizontal error [m]", curves, x_scale="linear", y_scale="linear")


def _all(outages: Sequence[Outages], kind: str) -> Figure:
    """Return one panel of figure 26: a bar for each filter in each outage, side by side."""
    of = np.max if kind == "largest" else np.mean
    numbers = np.array([o.number for o in outages], dtype=float)
    steps = WIDTH * ((np.arange(len(FILTERS)) + 0.5) / len(FILTERS) - 0.5)
    curves = tuple(
        Curve(name, numbers + step, np.array([float(of(o.error(name))) for o in outages]), color_of(name), style="bar")
        for name, step in zip(FILTERS, steps, strict=True)
    )
    title = f"{kind.capitalize()} horizontal error in each outage"
    return Figure(
        title, "number of the outage [1]", "horizontal error [m]", curves, x_scale="linear", y_scale="linear",
        x_limits=(0.5, max(numbers, default=1.0) + 0.5),
        y_limits=(0.0, 1.08 * max((float(curve.y.max()) for curve in curves if curve.y.size), default=1.0)),
    )  # fmt: skip

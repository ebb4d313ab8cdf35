"""Tables and figures of a log's health. Nothing is computed here."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Table
from imuwb.health import is_of
from imuwb.texts import seconds_text

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.health import Fault, Health

COLORS = (
    (228, 87, 86),
    (76, 120, 168),
    (84, 162, 75),
    (242, 142, 43),
    (118, 183, 178),
    (176, 122, 161),
    (156, 117, 95),
    (186, 176, 172),
)
MARKED = 6  #: faults whose place is shown
STREAMS = 8  #: that are drawn; more cannot be told apart


def draw(result: Health, review: Review) -> None:
    """Show the verdicts first."""
    rows = tuple((s.name, s.verdict, str(sum(is_of(f, s.name) for f in result.faults))) for s in result.streams)
    review.table(Table("Verdict", ("stream", "verdict", "remarks"), rows))
    review.table(Table(
        "What was found", ("stream", "severity", "what", "count", "first or longest at", "lasts", "what follows"),
        tuple(_row(f) for f in result.faults) or (("all", "—", "nothing", "—", "—", "—", "—"),),
        "Times are seconds from the log's start.", wide=True,
    ))  # fmt: skip
    if result.streams:
        review.figure(_rates(result))
    if result.segments:
        review.figure(_motion(result))
        total = sum(s.end - s.start for s in result.segments)
        moving = sum(s.end - s.start for s in result.segments if s.moving)
        review.note(
            f"{result.segments_of} is still for {seconds_text(total - moving)} and moves for {seconds_text(moving)}"
        )
    elif result.segments_of is not None:
        review.note(f"{result.segments_of}: too short, or too slow, to tell whether it is still or moves")


def _row(fault: Fault) -> tuple[str, ...]:
    return (
        fault.stream, fault.severity, fault.what, f"{fault.count:,}".replace(",", " "),
        "—" if fault.start is None else f"{fault.start:.2f} s", "—" if fault.length is None else seconds_text(fault.length),
        fault.consequence or "—",
    )  # fmt: skip


def _rates(result: Health) -> Figure:
    curves = tuple(
        Curve(s.name, s.time, s.rate, COLORS[i % len(COLORS)], style="curve")
        for i, s in enumerate(result.streams[:STREAMS])
    )
    placed = [f for f in result.faults if f.start is not None and f.severity != "note"][:MARKED]
    usual = [max(float(np.median(s.rate)), 1e-3) for s in result.streams[:STREAMS]]
    scale = "log" if max(usual) > 5 * min(usual) else "linear"  # five times: one axis shows both
    height, step = (
        max(float(s.rate.max(initial=1.0)) for s in result.streams[:STREAMS]),
        1.6 if scale == "log" else 1.12,
    )
    marks = tuple(
        Mark(f.start or 0.0, height * step ** (i + 1), f.what.partition(":")[0], (228, 87, 86))
        for i, f in enumerate(placed)
    )
    return Figure(
        "Rate over time",
        "time from the log's start [s]",
        "rows a second [Hz]",
        curves,
        marks,
        x_scale="linear",
        y_scale=scale,
    )


def _motion(result: Health) -> Figure:
    x = np.array([edge for s in result.segments for edge in (s.start, s.end)])
    y = np.array([1.0 if s.moving else 0.0 for s in result.segments for _ in range(2)])
    return Figure(
        "Still (0) and moving (1)", "time from the log's start [s]", "moving [1]", (Curve(result.segments_of or "IMU", x, y, (76, 120, 168), style="curve"),),
        x_scale="linear", y_scale="linear", y_limits=(-0.2, 1.2),
    )  # fmt: skip

"""Tables and figures of a log's health."""

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Review, Table
from imuwb.colors import BLUE, RED, color_at
from imuwb.health import Fault, Health
from imuwb.notes import Note
from imuwb.texts import seconds_text

MARKED = 6  #: faults whose place is marked in the figure
STREAMS = 8  #: in the figure: as many as there are colours
APART = 5.0  #: smallest ratio of the rates of two streams that makes their axis logarithmic
EVEN = 0.5  #: height of even motion in the figure of motion, between still and moving
ABOVE = {"log": 1.6, "linear": 1.12}  #: each mark over the one before


def draw(result: Health, review: Review) -> None:
    """Show verdicts, faults, rates over time, and when the IMU moves."""
    rows = tuple((s.name, s.verdict, str(s.faults)) for s in result.streams)
    review.table(Table("Verdict", ("stream", "verdict", "faults and notes"), rows))
    review.table(Table(
        "Faults and notes", ("stream", "severity", "kind", "fault", "count", "time of the first or longest", "duration", "consequence"),
        tuple(_row(f) for f in result.faults) or (("all", "—", "—", "nothing", "—", "—", "—", "—"),),
        "Times are seconds from the log's start. imuwb explain KIND says what a kind of fault means.", wide=True,
    ))  # fmt: skip
    if result.streams:
        review.figure(_rates(result))
    if result.segments:
        review.figure(_motion(result))
        text = f"{result.segments_of} is still for {seconds_text(result.still)} and moves for {seconds_text(result.moving)}"
        if result.even:
            text += f": {seconds_text(result.even)} of it are even motion, which only a receiver or an odometer shows"
        review.note(Note("motion", text))
    elif result.segments_of is not None:
        text = f"{result.segments_of}: the record is too short or too slow to show whether the IMU is still or moves"
        review.note(Note("motion unknown", text))


def _row(fault: Fault) -> tuple[str, ...]:
    return (
        fault.stream, fault.severity, fault.kind, fault.what, f"{fault.count:,}".replace(",", " "),
        "—" if fault.start is None else f"{fault.start:.2f} s", "—" if fault.length is None else seconds_text(fault.length),
        fault.consequence or "—",
    )  # fmt: skip


def _rates(result: Health) -> Figure:
    streams = result.streams[:STREAMS]
    curves = tuple(Curve(s.name, s.time, s.rate, color_at(i), style="curve") for i, s in enumerate(streams))
    placed = [f for f in result.faults if f.start is not None and f.severity != "note"][:MARKED]
    usual = [max(s.usual_rate, 1e-3) for s in streams]
    scale = "log" if max(usual) > APART * min(usual) else "linear"
    top = max(float(s.rate.max(initial=1.0)) for s in streams)
    marks = tuple(
        Mark(f.start or 0.0, top * ABOVE[scale] ** (i + 1), f.what.partition(":")[0], RED) for i, f in enumerate(placed)
    )
    return Figure(
        "Rate over time", "time from the log's start [s]", "rate [Hz]", curves, marks, x_scale="linear", y_scale=scale
    )  # fmt: skip


def _motion(result: Health) -> Figure:
    x = np.array([edge for s in result.segments for edge in (s.start, s.end)])
    y = np.array([EVEN if s.even else float(s.moving) for s in result.segments for _ in range(2)])
    return Figure(
        "Still (0), moving (1), and moving evenly (0.5)", "time from the log's start [s]", "moving [1]",
        (Curve(result.segments_of or "IMU", x, y, BLUE, style="curve"),),
        x_scale="linear", y_scale="linear", y_limits=(-0.2, 1.2),
    )  # fmt: skip

"""The tabs behind the first: what sigma is made of, what sensors are taken to err, tracks, single outages, filters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from imuwb.analysis import Curve, Figure, Series, Table
from imuwb.colors import AXIS_COLORS
from imuwb.navigation.filter import axis_errors
from imuwb.navigation.filter_document import write_filter
from imuwb.replay import HORIZONS
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.outage.colors import PALETTE, REFERENCE, color_of
from imuwb_plugins.outage.words import number

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb_plugins.outage.result import OneOutage, Result

COMMON = "in common"
TRACKS, ROWS = 6, 20  #: outages drawn on the map of each duration, and listed


def budget(result: Result, review: Review) -> None:
    """Show the error budget of the last filter."""
    review.tab("Budget")
    b = result.budget
    order = sorted(range(len(b.sources)), key=lambda i: (b.sources[i] == COMMON, -b.variance[i, -1]))
    curves = [Curve("all", b.elapsed, np.sqrt(b.total), REFERENCE, style="curve")]
    for color, i in zip(PALETTE, [i for i in order if b.sources[i] != COMMON], strict=False):
        curves.append(Curve(b.sources[i], b.elapsed, np.sqrt(b.variance[i]), color, style="curve"))
    review.figure(
        Figure(
            f"What the sigma of {result.budget_of} is made of", "time without GNSS [s]", "horizontal sigma [m]", tuple(curves),
            x_scale="log", y_scale="log", y_limits=(1e-2, 1.3 * float(np.sqrt(b.total[-1]))),
        )
    )  # fmt: skip
    at = [i for i, t in enumerate(b.elapsed) if t in HORIZONS or i == b.elapsed.size - 1]
    rows = tuple((b.sources[i], *(f"{b.variance[i, k] / b.total[k] * 100:.1f} %" for k in at)) for i in order)
    headings = ("source", *(f"after {b.elapsed[k]:g} s" for k in at))
    caption = (
        "Shares of the horizontal variance, mean over outages that do not overlap. Sources that hide behind each other at the "
        "start, such as a tilt and an accelerometer's bias, cancel in common."
    )
    review.table(Table(f"Error budget of {result.budget_of}", headings, rows, caption, wide=True))


def biases(result: Result, review: Review) -> None:
    """Show what the last filter takes its sensors' errors for, with three sigma."""
    review.tab("Biases")
    name, last = list(result.replay.runs.items())[-1]
    found, sigma = axis_errors(last.solution)
    log = result.replay.prepared.log
    time = (log.zero or 0) + np.rint(last.solution.time * 1e9).astype(np.int64)
    epoch = log.imu().origin.epoch
    for sensor, unit, factor, rows in (
        ("gyros", "deg/h", np.degrees(3600.0), slice(0, 3)), ("accelerometers", "mg", 1e3 / STANDARD_GRAVITY, slice(3, 6)),
    ):  # fmt: skip
        values = np.stack(
            [
                part[:, i] * factor
                for i in range(rows.start, rows.stop)
                for part in (found, found - 3 * sigma, found + 3 * sigma)
            ],
            axis=1,
        )
        names = tuple(f"{axis}{end}" for axis in "xyz" for end in ("", " -3 sigma", " +3 sigma"))
        colors = tuple((*AXIS_COLORS[axis], alpha) for axis in "xyz" for alpha in (255, 90, 90))
        review.series(Series(f"Errors of the {sensor} by {name}", unit, time, values, names, colors, epoch))
        if result.true_errors is not None:
            when, errors = result.true_errors
            review.series(
                Series(
                    f"True errors of the {sensor}, means over half a minute", unit, (log.zero or 0) + np.rint(when * 1e9).astype(np.int64),
                    errors[:, rows] * factor, ("x", "y", "z"), tuple((*AXIS_COLORS[axis], 255) for axis in "xyz"), epoch,
                )
            )  # fmt: skip


def tracks(result: Result, review: Review) -> None:
    """Show the reference and every filter's tracks in some outages."""
    review.tab("Tracks")
    review.track("reference", result.replay.reference.position, REFERENCE)
    if result.on_map:
        review.map_track("reference", result.replay.reference.position, (60, 60, 66))
    few = len(result.outages) <= ROWS
    for duration in [one.duration for one in (result.summary if few else result.summary[-1:])]:
        _tracks_of(result, review, duration)


def _tracks_of(result: Result, review: Review, duration: float) -> None:
    rows = np.flatnonzero(result.replay.scored[duration])
    if not rows.size:
        return
    first = next(iter(result.replay.runs.values())).outages[duration]
    apart = _apart(first.scores.start[rows], duration)
    chosen = rows[apart][np.unique(np.linspace(0, apart.size - 1, min(TRACKS, apart.size)).astype(int))]
    ends = {name: one.outages[duration].scores.horizontal[:, -1] for name, one in result.replay.runs.items()}
    for i in chosen:
        best, worst = (choose(ends, key=lambda name: ends[name][i]) for choose in (min, max))
        for name in sorted(ends, key=lambda name: name == best):
            found = result.replay.runs[name].outages[duration]
            label = (
                f"{best} {number(float(ends[best][i]))} m, {worst} {number(float(ends[worst][i]))} m"
                if name == best
                else ""
            )
            if result.on_map:
                review.map_track(
                    f"{name} at {found.scores.start[i]:.0f} s", found.drift.state[i, :, :3], color_of(name)
                )
            path = f"{name}_at_{found.scores.start[i]:.0f}_s".replace(" ", "_")
            review.track(path, found.drift.state[i, :, :3], color_of(name), label)
    review.note(
        f"tracks of {chosen.size} of {rows.size} outages of {duration:g} s; labels: least and largest error at the end"
    )


def _apart(
    start: np.ndarray[tuple[int], np.dtype[np.float64]], duration: float
) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return outages that do not overlap."""
    kept, free = [], -np.inf
    for i, one in enumerate(start):
        if one >= free:
            kept.append(i)
            free = one + duration
    return np.array(kept)


def outages(result: Result, review: Review) -> None:
    """List outages, and Quinchia's views of them."""
    review.tab("Outages")
    names = list(result.replay.runs)
    listed = sorted(result.outages, key=lambda o: -min(m.end for m in o.models.values()))
    shown = listed
    if len(listed) > ROWS:
        shown = []
        for one in listed:
            if len(shown) < ROWS and all(
                one.start + one.duration <= o.start or one.start >= o.start + o.duration for o in shown
            ):
                shown.append(one)
    shown = sorted(shown, key=lambda o: (o.duration, o.start))
    rows = tuple(_outage_row(one, names) for one in shown)
    which = (
        f"the {len(shown)} worst of {len(listed)} that do not overlap, by the best filter"
        if len(listed) > ROWS
        else "all"
    )
    review.table(Table(
        f"Outages ({which}): mean / largest / end, horizontal", ("start", "lasts", "mean speed", "motion", *names), rows,
        f"Against {result.reference}.", wide=True,
    ))  # fmt: skip
    if len(result.outages) <= ROWS:
        review.figure(_compared(result, names))
        review.table(_printed_table(result, names))


def _compared(result: Result, names: list[str]) -> Figure:
    """Return Quinchia's figure 26: largest and mean error of each outage, by filter."""
    x = np.arange(1.0, len(result.outages) + 1)
    curves = [
        Curve(name, x, np.array([o.models[name].max for o in result.outages]), color_of(name), style="line")
        for name in names
    ]
    return Figure(
        "Largest horizontal error of each outage (as Quinchia's figure 26)", "outage, in the order of the table",
        "horizontal error [m]", tuple(curves), x_scale="linear", y_scale="log", x_limits=(0.5, len(result.outages) + 0.5),
    )  # fmt: skip


def _outage_row(one: OneOutage, names: list[str]) -> tuple[str, ...]:
    return (
        f"{one.start:.1f} s", f"{one.duration:g} s", f"{one.mean_speed * 3.6:.1f} km/h", one.motion,
        *(f"{number(one.models[n].mean)} / {number(one.models[n].max)} / {number(one.models[n].end)} m" for n in names),
    )  # fmt: skip


def _printed_table(result: Result, names: list[str]) -> Table:
    """Return Quinchia's tables 9 and 10: each filter against its own run without outage."""
    rows = [
        (f"{o.start:.1f} s", f"{o.duration:g} s", f"{o.mean_speed * 3.6:.2f} km/h",
         *(f"{o.models[n].own_mean:.2f} / {o.models[n].own_max:.2f} m" for n in names))
        for o in result.outages
    ]  # fmt: skip
    caption = ""
    if "18AVWD" in names:
        caption = "Last row: mean over the outages of 1 - 18AVWD/filter, as the paper reckons it."
        gains = [
            tuple(
                float(
                    np.mean(
                        [
                            1 - getattr(o.models["18AVWD"], part) / max(getattr(o.models[n], part), 1e-9)
                            for o in result.outages
                        ]
                    )
                )
                for part in ("own_mean", "own_max")
            )
            for n in names
        ]
        rows.append(("18AVWD better by", "", "", *(f"{a * 100:.1f} / {b * 100:.1f} %" for a, b in gains)))
    return Table(
        "As Quinchia's tables 9 and 10: mean / largest, against each filter's own run", ("start", "lasts", "mean speed", *names),
        tuple(rows), caption, wide=True,
    )  # fmt: skip


def filters(result: Result, review: Review) -> None:
    """Tell the filters and their states, and keep them in the recording."""
    review.tab("Filters")
    rows = tuple(
        (
            f.name, str(len(f.states)), f.gyros, f.accelerometers, f.reading, f"{f.nis_position:.2f}",
            "—" if f.nis_velocity is None else f"{f.nis_velocity:.2f}", str(f.refused), "yes" if f.causal else "no",
            ", ".join(f.left_out) or "—",
        )
        for f in result.filters
    )  # fmt: skip
    headings = (
        "filter", "states", "gyro x", "accelerometer x", "formulas", "NIS/3 of positions", "of velocities", "fixes refused",
        "causal", "no state for",
    )  # fmt: skip
    caption = "Nine states are position, velocity and attitude; white noise needs none (Quinchia, table 8). The JSON lists all."
    review.table(Table("Filters and their states", headings, rows, caption, wide=True))
    for name, one in result.replay.runs.items():
        text = write_filter(one.solution.model)
        review.recording.log(f"filter_models/{name.replace(' ', '_')}", rr.TextDocument(text), static=True)

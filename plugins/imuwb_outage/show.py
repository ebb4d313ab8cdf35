"""Tables, figures and tracks of an outage replay. Nothing is computed here but what is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from imuwb.analysis import AXIS_COLORS, Curve, Figure, Series, Table, Vertical
from imuwb.navigation.filter import axis_errors
from imuwb.navigation.filter_document import write_filter
from imuwb.replay import HORIZONS, Interval, drift_curve
from imuwb.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.analysis import Review
    from imuwb.replay import Choice, Clocks, Run, Scores, Tuned
    from imuwb_outage.result import OfDuration, OneOutage, Result

COLORS = {
    "none": (150, 150, 158), "15AV": (76, 120, 168), "18AV": (84, 162, 75), "18AVWD": (228, 87, 86), "15AR": (242, 142, 43),
    "27AR": (176, 122, 161), "full": (118, 183, 178), "tuned": (237, 201, 72),
}  # fmt: skip
OTHER = (255, 157, 167)
REFERENCE = (225, 225, 228)
PALETTE = (
    (228, 87, 86), (76, 120, 168), (84, 162, 75), (242, 142, 43), (176, 122, 161), (118, 183, 178), (237, 201, 72),
)  # fmt: skip
COMMON = "in common"
MISFIT, REFUSED = (
    3.0,
    0.1,
)  #: NIS over its degrees of freedom, and share of fixes refused, of a filter that does not fit
TRACKS, ROWS, FAINT = 6, 20, 60  #: outages drawn on the map, listed, and drawn as errors


def _color(name: str) -> tuple[int, int, int]:
    return COLORS.get(name, OTHER)


def draw(result: Result, review: Review) -> None:
    """Show what a user asks first: how far, by which filter, and is its sigma right."""
    for one in result.summary:
        review.table(_drift_table(one, result))
    for one in result.summary:
        review.figure(_drift_figure(one, result))
    _notes(result, review)
    _consistency(result, review)
    _errors(result, review)
    _budget(result, review)
    _biases(result, review)
    _tracks(result, review)
    _outages(result, review)
    review.tab("Comparison")
    for one in result.summary:
        if one.choice is not None:
            review.table(_choice_table(one.choice))
        if one.paired:
            review.table(_paired_table(one))
        kinds = tuple((kind, *(f"{number(m)} m" for m in medians.values())) for kind, medians in one.by_motion.items())
        review.table(
            Table(f"Median at the end by motion, {one.duration:g} s", ("motion", *result.replay.runs), kinds, wide=True)
        )
    _filters(result, review)


def _notes(result: Result, review: Review) -> None:
    for words in result.verdicts:
        review.note(words)
    for f in result.filters:
        worst = max(f.nis_position, f.nis_velocity or 0.0)
        if worst > MISFIT or f.refused > REFUSED * f.fixes:
            review.note(
                f"{f.name} does not fit this log: its innovations are {np.sqrt(worst):.1f} times larger than it thinks, "
                f"{f.refused} of {f.fixes} fixes are refused at the gate"
            )
    for one in result.summary:
        if one.choice is not None:
            best = one.choice.candidates[0]
            review.note(
                f"{one.duration:g} s: {best.model} makes the errors likeliest, chosen in {best.folds} of {one.choice.folds} blocks"
            )
    review.note(f"drift is measured against {result.reference}")
    for note in result.notes:
        review.note(note)
    review.note(_aids_text(result.replay.runs))
    if result.clocks is not None:
        review.note(_clocks_text(result.clocks))
    if result.mounting is not None:
        roll, pitch, heading = result.mounting.angles
        review.note(
            f"mounting, from the log itself: roll {roll:.2f}, pitch {pitch:.2f}, heading {heading:.2f} "
            f"± {result.mounting.heading_half_width:.2f} deg"
        )
    if result.tuned is not None:
        review.note(_tuned_text(result.tuned))


def _aids_text(runs: dict[str, Run]) -> str:
    aids = next(iter(runs.values())).solution.model.aids
    said = [
        f"{what} (sigma {sigma:g} m/s)"
        for what, sigma in (("no slip", aids.straight), ("standing still", aids.still), ("the log's speed", aids.speed))
        if sigma
    ]
    return f"besides fixes the filters use {', '.join(said)}" if said else "filters use fixes alone: no other aid"


def _clocks_text(c: Clocks) -> str:
    said: list[str] = []
    if c.delay is not None and c.velocity_delay is not None:
        said.append(f"fixes are {_signed(c.delay, 1e3, 'ms late', 'ms early')}")
        said.append(
            f"their velocities are {_signed(c.velocity_delay, 1e3, 'ms older', 'ms younger')} than their positions"
        )
    if c.rate is not None:
        longer = Interval(c.rate.value - 1, c.rate.lower - 1, c.rate.upper - 1)
        said.append(f"a second of the IMU is {_signed(longer, 1e6, 'millionths longer', 'millionths shorter')}")
    return f"{', '.join(said)}: by the likelihood of the innovations, with white noise {c.noise:.2g} times the model's"


def _signed(x: Interval, factor: float, above: str, below: str) -> str:
    """Return a value of either sign with its interval in words."""
    sign = 1 if x.value >= 0 else -1
    ends = sorted((sign * x.lower * factor, sign * x.upper * factor))
    told = f" [{ends[0]:.0f}, {ends[1]:.0f}]" if np.isfinite(ends).all() else " (nothing bounds it)"
    return f"{abs(x.value) * factor:.0f}{told} {above if sign > 0 else below}"


def _tuned_text(t: Tuned) -> str:
    return (
        f"tuned on {t.fitted} outages before {t.split:.0f} s: white noise of gyros x {t.white[0]:.2g}, of accelerometers "
        f"x {t.white[1]:.2g}, slower noise x {t.slow[0]:.2g} and x {t.slow[1]:.2g}; on the {t.judged} outages behind, which it "
        f"has not seen, NEES/2 at the end goes from {t.nees_per_dof[0]:.2f} to {t.nees_per_dof[1]:.2f} and the median error "
        f"from {number(t.median_end[0])} to {number(t.median_end[1])} m"
    )


def _drift_table(one: OfDuration, result: Result) -> Table:
    causal = {f.name: f.causal for f in result.filters}
    rows = tuple(
        (
            s.model, f"{s.count} ({s.effective_count})", _metres(s.median_end), _metres(s.p68_end), _metres(s.p95_end),
            _metres(s.median_max), f"{number(s.median_vertical)} m", f"{number(s.median_velocity)} m/s",
            "—" if s.median_heading is None else f"{np.degrees(s.median_heading):.2g} deg",
            "—" if s.median_percent is None else f"{number(s.median_percent)} %", "yes" if causal[s.model] else "no",
        )
        for s in one.summaries
    )  # fmt: skip
    headings = (
        "filter", "outages (that do not overlap)", "median at the end", "68 %", "95 %", "median of the largest", "vertical",
        "velocity", "heading", "of the distance", "causal",
    )  # fmt: skip
    caption = "Horizontal errors with intervals of a moving-block bootstrap; vertical, velocity and heading: medians at the end."
    return Table(f"Drift after {one.duration:g} s without GNSS", headings, rows, caption, wide=True)


def _metres(interval: Interval) -> str:
    if not np.isfinite(interval.lower):
        return f"{number(interval.value)} m"
    return f"{number(interval.value)} [{number(interval.lower)}, {number(interval.upper)}] m"


def _percent(interval: Interval) -> str:
    told = f"{interval.value * 100:.1f}"
    if np.isfinite(interval.lower):
        told += f" [{interval.lower * 100:.1f}, {interval.upper * 100:.1f}]"
    return f"{told} %"


def number(value: float) -> str:
    """Return a figure with three digits, never as a power of ten."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"  # noqa: PLR2004 - three digits


def _scores(result: Result, duration: float) -> Iterator[tuple[str, Scores]]:
    rows = result.replay.scored[duration]
    for name, one in result.replay.runs.items():
        yield name, one.outages[duration].scores.of(rows, duration)


def _drift_figure(one: OfDuration, result: Result) -> Figure:
    curves: list[Curve] = []
    for name, s in _scores(result, one.duration):
        if s.start.size:
            drift = drift_curve(s)
            curves.append(Curve(name, s.elapsed, drift["median"], _color(name), style="curve"))
            curves.append(Curve("", s.elapsed, drift["p95"], _color(name), style="faint"))
    return Figure(
        f"Drift in outages of {one.duration:g} s: median, and 95 % (faint)", "time without GNSS [s]", "horizontal error [m]",
        tuple(curves), x_scale="linear", y_scale="log",
    )  # fmt: skip


def _paired_table(one: OfDuration) -> Table:
    rows = tuple(
        (
            p.model, p.against, _metres(p.median_difference),
            _percent(p.improvement),
            f"{p.win_rate * 100:.0f} %", f"{p.p_value:.2g}",
        )
        for p in one.paired
    )  # fmt: skip
    return Table(
        f"Pairs over the same outages of {one.duration:g} s",
        ("filter", "against", "median difference at the end", "mean of 1 - filter/against", "better in", "p of no difference (of log ratios)"),
        rows, "Negative differences: the first is better. p: signs of blocks of neighbours flipped.", wide=True,
    )  # fmt: skip


def _choice_table(c: Choice) -> Table:
    rows = tuple(
        (x.model, f"{x.log_likelihood:.2f}", f"{number(x.median_end)} m", f"{x.folds} of {c.folds}")
        for x in c.candidates
    )
    caption = (
        f"By cross-validation over {c.folds} blocks of time: a filter chosen on the other blocks has log-likelihood "
        f"{c.unseen_log_likelihood:.2f} and median error {number(c.unseen_median_end)} m on outages it was not chosen on. "
        "The likelihood counts both: small errors, and a sigma that fits them."
    )
    headings = ("filter", "log-likelihood of an outage", "median at the end", "chosen in")
    return Table(f"Which filter, for outages of {c.duration:g} s", headings, rows, caption, wide=True)


def _consistency(result: Result, review: Review) -> None:
    review.tab("Consistency")
    for one in result.summary:
        curves = [
            Curve(name, s.elapsed, s.nees.mean(axis=0) / 2, _color(name), style="curve")
            for name, s in _scores(result, one.duration)
            if s.start.size
        ]
        review.figure(
            Figure(
                f"Is sigma right? NEES over its two degrees of freedom, outages of {one.duration:g} s", "time without GNSS [s]",
                "mean NEES/2 [1]; 1 is right, above: sigma too small", tuple(curves), x_scale="linear", y_scale="log",
                verticals=tuple(Vertical(h, f"{h:g} s") for h in HORIZONS if h < one.duration),
            )
        )  # fmt: skip
        review.table(_consistency_table(one))


def _consistency_table(one: OfDuration) -> Table:
    rows = tuple(
        (
            s.model, f"{c.elapsed:g} s", f"{c.nees_per_dof:.2f}", f"{c.lower:.2f} to {c.upper:.2f}", f"{c.coverage95 * 100:.0f} %",
            f"{c.ratio:.2f}", f"{s.nis_per_dof:.2f}",
        )
        for s in one.summaries
        for c in s.consistency
    )  # fmt: skip
    return Table(
        f"Consistency in outages of {one.duration:g} s",
        ("filter", "after", "NEES/2", "would be, if sigma is right", "within 95 % ellipse", "error over sigma", "NIS/dof of the run"),
        rows,
    )  # fmt: skip


def _errors(result: Result, review: Review) -> None:
    review.tab("Errors")
    one = result.summary[-1]
    for name, s in _scores(result, one.duration):
        if not s.start.size:
            continue
        few = np.unique(np.linspace(0, s.start.size - 1, min(FAINT, s.start.size)).astype(int))
        x = np.concatenate([np.append(s.elapsed, np.nan) for _ in few])
        y = np.concatenate([np.append(s.horizontal[i], np.nan) for i in few])
        sigma = np.median(s.sigma, axis=0)
        top = 1.15 * max(float(3 * sigma[-1]), float(np.quantile(s.horizontal[:, -1], 0.9)))
        review.figure(
            Figure(
                f"{name}: errors of {few.size} outages, and the filter's own sigma", "time without GNSS [s]", "horizontal error [m]",
                (
                    Curve("errors", x, y, _color(name), style="faint"),
                    Curve("1 sigma", s.elapsed, sigma, (225, 225, 228), style="curve"),
                    Curve("3 sigma", s.elapsed, 3 * sigma, (150, 150, 158), style="curve"),
                ),
                x_scale="linear", y_scale="linear", y_limits=(0.0, top),
            )
        )  # fmt: skip


def _budget(result: Result, review: Review) -> None:
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


def _biases(result: Result, review: Review) -> None:
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


def _tracks(result: Result, review: Review) -> None:
    review.tab("Tracks")
    review.track("reference", result.replay.reference.position, REFERENCE)
    if result.on_map:
        review.chart("reference", result.replay.reference.position, (60, 60, 66))
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
                review.chart(f"{name} at {found.scores.start[i]:.0f} s", found.drift.state[i, :, :3], _color(name))
            path = f"{name}_at_{found.scores.start[i]:.0f}_s".replace(" ", "_")
            review.track(path, found.drift.state[i, :, :3], _color(name), label)
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


def _outages(result: Result, review: Review) -> None:
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
        Curve(name, x, np.array([o.models[name].max for o in result.outages]), _color(name), style="line")
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


def _filters(result: Result, review: Review) -> None:
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

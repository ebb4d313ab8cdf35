"""Tables and figures of an outage replay: how far, by which filter, and is its sigma right. Nothing is computed here."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.replay import drift_curve
from imuwb_plugins.outage import details
from imuwb_plugins.outage.colors import color_of
from imuwb_plugins.outage.words import metres, notes, number, percent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.analysis import Review
    from imuwb.replay import Choice, Scores
    from imuwb_plugins.outage.result import OfDuration, Result

FAINT = 60  #: outages drawn as errors


def draw(result: Result, review: Review) -> None:
    """Show what a user asks first: how far, by which filter, and is its sigma right."""
    for one in result.summary:
        review.table(_drift_table(one, result))
    for one in result.summary:
        review.figure(_drift_figure(one, result))
    notes(result, review)
    _consistency(result, review)
    _errors(result, review)
    details.budget(result, review)
    details.biases(result, review)
    details.tracks(result, review)
    details.outages(result, review)
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
    details.filters(result, review)


def _drift_table(one: OfDuration, result: Result) -> Table:
    causal = {f.name: f.causal for f in result.filters}
    rows = tuple(
        (
            s.model, f"{s.count} ({s.effective_count})", metres(s.median_end), metres(s.p68_end), metres(s.p95_end),
            metres(s.median_max), f"{number(s.median_vertical)} m", f"{number(s.median_velocity)} m/s",
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


def _scores(result: Result, duration: float) -> Iterator[tuple[str, Scores]]:
    rows = result.replay.scored[duration]
    for name, one in result.replay.runs.items():
        yield name, one.outages[duration].scores.of(rows, duration)


def _drift_figure(one: OfDuration, result: Result) -> Figure:
    curves: list[Curve] = []
    for name, s in _scores(result, one.duration):
        if s.start.size:
            drift = drift_curve(s)
            curves.append(Curve(name, s.elapsed, drift["median"], color_of(name), style="curve"))
            curves.append(Curve("", s.elapsed, drift["p95"], color_of(name), style="faint"))
    return Figure(
        f"Drift in outages of {one.duration:g} s: median, and 95 % (faint)", "time without GNSS [s]", "horizontal error [m]",
        tuple(curves), x_scale="linear", y_scale="log",
    )  # fmt: skip


def _paired_table(one: OfDuration) -> Table:
    rows = tuple(
        (
            p.model, p.against, metres(p.median_difference),
            percent(p.improvement),
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
            Curve(name, s.elapsed, s.nees.mean(axis=0) / 2, color_of(name), style="curve")
            for name, s in _scores(result, one.duration)
            if s.start.size
        ]
        review.figure(
            Figure(
                f"Is sigma right? NEES over its two degrees of freedom, outages of {one.duration:g} s", "time without GNSS [s]",
                "mean NEES/2 [1]; 1 is right, above: sigma too small", tuple(curves), x_scale="linear", y_scale="log",
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
                    Curve("errors", x, y, color_of(name), style="faint"),
                    Curve("1 sigma", s.elapsed, sigma, (225, 225, 228), style="curve"),
                    Curve("3 sigma", s.elapsed, 3 * sigma, (150, 150, 158), style="curve"),
                ),
                x_scale="linear", y_scale="linear", y_limits=(0.0, top),
            )
        )  # fmt: skip

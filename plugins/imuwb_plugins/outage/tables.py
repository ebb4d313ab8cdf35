"""The tables of an outage replay."""

import math

import numpy as np

from imuwb.analysis import Table
from imuwb.replay import Choice, MotionNoise
from imuwb.statistics import Estimate
from imuwb.texts import converted_text, interval_text, number_text, quantity_text
from imuwb.units import coefficient_units
from imuwb_plugins.outage.result import DurationSummary, ErrorBudget, OutageResult, Result


def _yes(value: bool) -> str:  # noqa: FBT001 - a cell of a table
    return "yes" if value else "no"


def drift(own: DurationSummary, result: Result) -> Table:
    """Return the errors of each filter at the end of the outages."""
    causal = {f.name: f.causal for f in result.filters}
    rows = tuple(
        (
            name, f"{s.count} ({s.effective_count})",
            *(interval_text(s.estimate(part)) for part in ("median_end", "p68_end", "p95_end", "median_max")),
            f"{number_text(s.median_vertical)} m", f"{number_text(s.median_velocity)} m/s",
            quantity_text(None if s.median_heading is None else float(np.degrees(s.median_heading)), "deg", 2),
            "—" if s.median_percent is None else f"{number_text(s.median_percent)} %", _yes(causal[name]) if name in causal else "—",
        )
        for name, s in ((name, own.models[name]) for name in own.ranked)
    )  # fmt: skip
    rows += tuple((name, "cannot run", *("—",) * 9) for name in result.failed)
    headings = (
        "filter", "outages (without overlap)", "median", "68 % quantile", "95 % quantile", "median of the largest error",
        "vertical", "velocity", "heading", "share of the distance", "causal",
    )  # fmt: skip
    caption = (
        "Horizontal errors at the end, with intervals by a moving-block bootstrap. Vertical, velocity, heading and share of the "
        "distance driven: medians at the end."
    )
    return Table(f"Drift after {own.duration:g} s without GNSS", headings, rows, caption)


def paired(own: DurationSummary) -> Table:
    """Return the comparisons of filters in the same outages."""
    rows = tuple(
        (
            p.model, p.against, interval_text(p.median_difference), interval_text(p.improvement.scaled(100, "%")),
            f"{p.win_rate * 100:.0f} %", f"{p.p_value:.2g}",
        )
        for p in own.paired
    )  # fmt: skip
    headings = (
        "filter", "against", "median difference at the end", "mean improvement", "outages in which it is better",
        "p-value of no difference",
    )  # fmt: skip
    caption = (
        "Negative differences: the first filter is better. Improvement: 1 - filter/against. p-value: of log ratios, by random "
        "signs of blocks of neighbours."
    )
    return Table(f"Pairs in the same outages of {own.duration:g} s", headings, rows, caption)


def choice(c: Choice) -> Table:
    """Return the filters in order of their likelihood."""
    rows = tuple(
        (x.model, f"{x.log_likelihood:.2f}", f"{number_text(x.median_end)} m", f"{x.folds} of {c.folds}")
        for x in c.candidates
    )
    caption = (
        f"Cross-validation over {c.folds} blocks of time: the filter chosen in the other blocks has the log-likelihood "
        f"{c.unseen_log_likelihood:.2f} and the median error {number_text(c.unseen_median_end)} m. The likelihood is large for "
        "small errors with a sigma that is right."
    )
    headings = (
        "filter",
        "log-likelihood of an outage",
        "median error at the end",
        "blocks for which it is the best in the other blocks",
    )
    return Table(f"Choice of a filter for outages of {c.duration:g} s", headings, rows, caption)


def by_motion(own: DurationSummary) -> Table:
    """Return the median error of each filter by motion."""
    rows = tuple(
        (kind, *(f"{number_text(m)} m" if np.isfinite(m) else "—" for m in (medians[name] for name in own.ranked)))
        for kind, medians in own.by_motion.items()
    )
    title = f"Median error at the end by motion, outages of {own.duration:g} s"
    return Table(title, ("motion", *own.ranked), rows)


def consistency(own: DurationSummary) -> Table:
    """Return whether each filter's sigma is right, at some times."""
    rows = tuple(
        (
            name, f"{c.elapsed:g} s", f"{c.nees_per_dof:.2f}", f"{c.lower:.2f} to {c.upper:.2f}", f"{c.coverage95 * 100:.0f} %",
            f"{c.ratio:.2f}", f"{s.nis_per_dof:.2f}" if np.isfinite(s.nis_per_dof) else "—",
        )
        for name in own.ranked
        for s in (own.models[name],)
        for c in s.consistency
    )  # fmt: skip
    headings = (
        "filter", "time without GNSS", "NEES/2", "NEES/2 if sigma is right", "outages within the 95 % ellipse", "error/sigma",
        "NIS/dof of the whole run",
    )  # fmt: skip
    return Table(f"Consistency in outages of {own.duration:g} s", headings, rows)


def budget(b: ErrorBudget) -> Table:
    """Return the shares of the sources in a filter's horizontal variance."""
    rows = tuple(
        (source, *(f"{share:.1f} %" for share in shares)) for source, shares in zip(b.sources, b.percent, strict=True)
    )
    caption = (
        "Shares of the horizontal variance, mean over outages that do not overlap. In common: correlations at the start; a tilt "
        "and an accelerometer's bias, for example, cancel until the vehicle turns, and lower the variance."
    )
    return Table(
        f"Error budget of {b.filter}", ("source", *(f"after {h:g} s" for h in b.horizons)), rows, caption, wide=True
    )


def outages(result: Result) -> Table:
    """Return the errors of each filter in each listed outage."""
    names = [*result.ranked(f.name for f in result.filters), *(e.name for e in result.engines if e.scored == "outages")]
    rows = tuple(
        (*outage_cells(own), own.motion, *(
            "—" if m is None else f"{number_text(m.mean)} / {number_text(m.max)} / {number_text(m.end)} m"
            for m in map(own.models.get, names)
        ))
        for own in (result.outages[i] for i in result.listed)
    )  # fmt: skip
    which = "all"
    if len(result.outages) > len(result.listed):
        which = f"the {len(result.listed)} worst of {len(result.outages)} that do not overlap, by the best filter"
    title = f"Outages ({which}): mean / largest / final horizontal error"
    headings = ("start", "duration", "mean speed", "motion", *names)
    return Table(title, headings, rows, f"Against {result.reference}.")


def whole_run(result: Result) -> Table:
    """Return the errors of filters and engines over the whole run with all fixes."""
    rows = tuple(
        (
            name, f"{s.count} ({s.effective_count})",
            *(interval_text(s.estimate(part)) for part in ("median_end", "p68_end", "p95_end")),
            f"{number_text(s.median_vertical)} m", f"{number_text(s.median_velocity)} m/s",
            "—" if s.nees_per_dof is None else f"{s.nees_per_dof:.2f}",
            "—" if s.coverage95 is None else f"{s.coverage95 * 100:.0f} %",
        )
        for name, s in result.whole_run.items()
    )  # fmt: skip
    headings = (
        "filter", "seconds (minutes)", "median", "68 % quantile", "95 % quantile", "vertical", "velocity", "NEES/2",
        "within the 95 % ellipse",
    )  # fmt: skip
    caption = f"Horizontal errors once a second against {result.reference}, with all fixes; they are no drift."
    return Table("Errors over the whole run", headings, rows, caption)


def outage_cells(own: OutageResult, decimals: int = 1) -> tuple[str, str, str]:
    """Return name and start, duration, and mean speed of an outage."""
    return f"{own.name} {own.start:.1f} s".strip(), f"{own.duration:g} s", f"{own.mean_speed * 3.6:.{decimals}f} km/h"


def _left_out(processes: tuple[str, ...]) -> str:
    """Return the processes without a state; lines are only counted."""
    lines = sum(": line at " in process for process in processes)
    named = [process for process in processes if ": line at " not in process]
    return ", ".join([*named, *([f"{lines} line{'s' if lines > 1 else ''}"] if lines else [])]) or "—"


def filters(result: Result) -> Table:
    """Return the filters with their states and innovations."""
    known = {f.name: f for f in result.filters}
    rows = tuple(
        (
            f.name, str(len(f.states)), f.gyros, f.accelerometers, f.reading, f"{f.nis_position:.2f}",
            "—" if f.nis_velocity is None else f"{f.nis_velocity:.2f}", str(f.refused), _yes(f.causal),
            _left_out(f.left_out),
        )
        for f in (known[name] for name in result.ranked(known))
    )  # fmt: skip
    rows += tuple((name, "cannot run", *("—",) * 7, reason) for name, reason in result.failed.items())
    headings = (
        "filter", "states", "processes of gyro x", "processes of accelerometer x", "formulas", "NIS/dof of positions",
        "NIS/dof of velocities", "refused positions and velocities", "causal", "processes without a state",
    )  # fmt: skip
    caption = "Nine states are position, velocity and attitude; white noise needs no state (Quinchia, table 8). The JSON names all states."
    return Table("Filters and their states", headings, rows, caption)


def motion(noise: MotionNoise) -> Table:
    """Return the noise of the bench record beside that in motion, line by line."""
    rows: list[tuple[str, ...]] = []
    for axis, bench in noise.bench.items():
        unit = coefficient_units(axis, "N")[1]
        factor = noise.factors[axis]
        added = noise.white[int(axis.startswith("accel"))]
        value, lower, upper = (math.hypot(x, bench) for x in (added.value, added.lower, added.upper))
        moving = Estimate(value, lower, upper)
        own = f"{number_text(bench / unit.factor)} {unit.name}" if bench else "—"
        rows.append((f"{axis} N", own, converted_text(moving, unit), interval_text(factor) if bench else "—"))
    for name, axis, walk in zip(("gyros K", "accelerometers K"), ("gyro_x", "accel_x"), noise.walk, strict=True):
        rows.append((f"{name}, added", "—", converted_text(walk, coefficient_units(axis, "K")[1]), "—"))
    for name, floor in zip(("positions", "velocities"), noise.floor, strict=True):
        rows.append((f"sigma of {name}, added", "—", interval_text(floor), "—"))
    caption = (
        f"From {noise.fixes} fixes in {noise.blocks} blocks of a minute. N of different axes of a triad has the same addition. N, K "
        "of the accelerometers and K of the gyros stand in for one another: their sum is known better than each."
    )
    return Table("Noise on the bench and in motion", ("coefficient", "bench", "motion", "ratio"), tuple(rows), caption)

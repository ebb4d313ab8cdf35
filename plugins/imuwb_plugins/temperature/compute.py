"""From logs to noise and bias over temperature."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from imuwb.axes import THREADS, axes_of, rates
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.temperature import heterogeneity, identify, log_sigma, over_temperature
from imuwb.log import AXES, source_of
from imuwb.progress import tracked
from imuwb_plugins.temperature.gather import FEWEST, check_thermometers, check_together, grouped, parts_of
from imuwb_plugins.temperature.result import Result
from imuwb_plugins.temperature.tell import axis_result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.identification.temperature import AxisTemperatures, SetPoint
    from imuwb.log import Log
    from imuwb_plugins.temperature.gather import Part
    from imuwb_plugins.temperature.parameters import Parameters

CONVENTION = "AR(1): x(n) = -alpha x(n-1) + beta0 w(n); the paper's text has b(k+1) = C b(k) + e, C = -alpha"
DIFFERENT = 1e-3  #: probability of N of two logs at one temperature that differ so much by chance
NOTICEABLE = 0.02  #: of N, likewise


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return what each axis does over temperature."""
    notes = [*check_together(logs, parameters), *check_thermometers(logs, parameters)]
    given = parameters.temperatures()
    parts: list[Part] = []
    cuts: list[str] = []
    for i, log in enumerate(logs):
        cut, found, said = parts_of(i, log, given[i] if given else None, parameters)
        parts += found
        cuts.append(cut)
        notes += said
    groups = [(group, any(part.has_enough() for part in group)) for group in grouped(parts)]
    notes += _short_notes(groups)
    usable = [group for group, enough in groups if enough]
    _require_two(logs, usable, bool(groups))
    names = [axis for axis in AXES if any(axis in p.axes for p in parts)]
    jobs = [(axis, group) for axis in names for group in usable]

    def identified(job: tuple[str, list[Part]]) -> tuple[SetPoint | None, str]:
        return _point(*job, parameters)

    with ThreadPoolExecutor(THREADS) as pool:
        points = list(tracked(pool.map(identified, jobs), len(jobs)))
    found_axes: dict[str, AxisTemperatures] = {}
    for axis in names:
        done = [(group, point, text) for (name, group), (point, text) in zip(jobs, points, strict=True) if name == axis]
        notes += _axis_notes(axis, [(group[0].stretch.nominal, text) for group, _, text in done if text])
        here = [point for _, point, _ in done if point is not None]
        if len(here) > 1:
            found_axes[axis] = _over(here, parameters)
    if not found_axes:
        message = f"{logs[0].provenance.path}: no axis has noise at two temperatures: {'; '.join(notes)}"
        raise MissingDataError(message)
    lowest, highest = (end(p.celsius for found in found_axes.values() for p in found.points) for end in (min, max))
    reference = min(max(parameters.reference, lowest), highest)
    if reference != parameters.reference:
        notes.append(
            f"no log is at {parameters.reference:g} °C: the nearest temperature, {reference:.4g} °C, is the reference"
        )
    sources = "; ".join(source_of(log) for log in logs)
    first = axes_of(logs[0].imu())
    axes = {axis: axis_result(axis, found, reference) for axis, found in found_axes.items()}
    return Result(
        logs[0].imu().name, sources, parameters.level, reference, CONVENTION, tuple(cuts), rates(first), axes,
        (*dict.fromkeys(notes), *_remarks(logs, found_axes)),
    )  # fmt: skip


def _short_notes(groups: Sequence[tuple[list[Part], bool]]) -> list[str]:
    short = [group[0].stretch.nominal for group, enough in groups if not enough]
    if not short:
        return []
    where = ", ".join(f"{t:.4g}" for t in short[:6]) + (" ..." if len(short) > 6 else "")  # noqa: PLR2004 - a line
    return [f"left out, with fewer than {FEWEST} samples: {len(short)} of {len(groups)} temperatures ({where} °C)"]


def _require_two(logs: Sequence[Log], groups: Sequence[list[Part]], found: bool) -> None:  # noqa: FBT001 - said, or not
    if len(groups) > 1:
        return
    where = logs[0].provenance.path + (f" and {len(logs) - 1} more" if len(logs) > 1 else "")
    if not groups:
        why = f"no temperature holds {FEWEST} samples" if found else "no stretch of one temperature"
        message = f"{where}: {why}; take wider bins with --bins, or longer logs"
        raise MissingDataError(message)
    celsius = groups[0][0].stretch.celsius
    message = (
        f"{where}: one temperature only ({celsius:.1f} °C): nothing can be said of what depends on it; give logs of other temperatures, "
        f"or say them with --celsius if the thermometer is stuck; for the noise itself: imuwb noise"
    )
    raise MissingDataError(message)


def _point(axis: str, group: Sequence[Part], parameters: Parameters) -> tuple[SetPoint | None, str]:
    """Return an axis at one temperature, and what must be said of it."""
    taken = [(part, r) for part in group if (r := part.record(axis)) is not None]
    if not taken:
        return None, ""
    part = taken[0][0]
    dt, band = part.axes[axis].clock.interval, part.log.band
    records = [record for _, record in taken]
    try:
        point = identify(records, dt, level=parameters.level, band=band)
    except ValueError as error:
        return None, str(error)
    if len({record.log for record in records}) < 2:  # noqa: PLR2004 - nothing to compare
        return point, ""
    each = [identify([record], dt, level=parameters.level, band=band).coefficients["N"] for record in records]
    known = [(c.value, s) for c in each if c.value is not None and (s := log_sigma(c, parameters.level))]
    if len(known) < 2:  # noqa: PLR2004 - as above
        return point, ""
    sizes, sigmas = (np.array(column) for column in zip(*known, strict=True))
    apart, same = sizes.max() / sizes.min() - 1, heterogeneity(np.log(sizes), sigmas)
    if same is None or (same.p_value or 0.0) > DIFFERENT or apart < NOTICEABLE:
        return point, ""
    return point, (
        f"N differs by {100 * apart:.0f} % between logs ({', '.join(p.log.provenance.path for p, _ in taken)}): are they of one sensor?"
    )


def _axis_notes(axis: str, said: Sequence[tuple[float, str]]) -> list[str]:
    """Return what is said of an axis, each thing once, with the temperatures."""
    by_text: dict[str, list[float]] = {}
    for celsius, text in said:
        by_text.setdefault(text, []).append(celsius)
    return [
        f"{axis}, {f'{len(t)} temperatures from {min(t):.4g} to {max(t):.4g}' if len(t) > 1 else f'at {t[0]:.4g}'} °C: {text}"
        for text, t in by_text.items()
    ]


def _over(points: Sequence[SetPoint], parameters: Parameters) -> AxisTemperatures:
    wanted = None if parameters.function == "auto" else parameters.function
    try:
        return over_temperature(points, level=parameters.level, size=parameters.size, wanted=wanted)
    except ValueError as error:
        message = f"--function {parameters.function}: {error}"
        raise UsageError(message) from error


def _remarks(logs: Sequence[Log], found_axes: dict[str, AxisTemperatures]) -> list[str]:
    said: list[str] = []
    if len(logs) > 1 and all(found.biases.turn_on is None for found in found_axes.values()):
        said.append(
            "every temperature has one log: a bias that is new at each turn-on cannot be told from one that follows the temperature; "
            "several logs at one temperature would tell"
        )
    return said

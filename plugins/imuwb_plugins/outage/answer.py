"""The answer of an outage replay: how far each filter drifts, whether its sigma can be believed, and which filter to take."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite, nan

from imuwb.analysis import Answer, Step
from imuwb.replay import ENOUGH, Consistency, MotionNoise
from imuwb.statistics import Estimate
from imuwb.texts import counted, number_text
from imuwb_plugins.outage import figures
from imuwb_plugins.outage.drives import Drives
from imuwb_plugins.outage.result import DurationSummary, FilterSummary, Result

SHOWN = (30.0, 60.0)  #: s; outages as long as these are shown, else the two longest
FILTERS = 6  #: rows
CAUSES = ("misfit", "refused-positions", "reference-against-fixes")  #: ids of notes that say why a sigma is wrong
LEFT_OUT = ("reference-refused", "drive-left-out")  #: ids of notes on what the figures are without
TUNE = Step("{command} --tune", "fit the noise to this drive")
AIDS = Step("{command} --straight 0.2 --still 0.05", "if it is on wheels: bounds the drift")


def answer(result: Result | Drives) -> Answer:
    """Return the drift of each filter after 30 and 60 s, the best filter first.

    The best filter is the one with which the errors at the end of the longest outages are most likely (``imuwb.replay.choose``);
    where too few outages show that, the one with the smallest median. The likelihood counts how far a filter drifts and also
    whether it knows how far.
    """
    drives = isinstance(result, Drives)
    durations = _shown(result.pooled if drives else result.summary)
    if not durations:
        return Answer("no outage is scored", sentences=tuple(result.notes[:3]))
    last = durations[-1]
    names = last.ranked
    rows = tuple(
        (name, *(_drift(own.models.get(name)) for own in durations), sigma_text(last.models[name]))
        for name in names[:FILTERS]
    )
    failed = _failed(result)
    right = believed(last.models[names[0]])
    return Answer(
        _about(result, durations), ("filter", *(f"{own.duration:g} s without GNSS" for own in durations), "its sigma is"),
        (*rows, *((name, _cannot(result, reasons)) for name, reasons in failed.items())), tuple(_sentences(result, durations, names)),
        (TUNE, AIDS) if right is False else (AIDS,), "median, 95 % interval", figures.drift(last), _numbers(durations, names[0]),
    )  # fmt: skip


def _numbers(durations: Sequence[DurationSummary], best: str) -> dict[str, Estimate]:
    """Return the drift of the best filter, and by how much its errors exceed its sigma."""
    numbers: dict[str, Estimate] = {}
    for own in (d for d in durations if best in d.models):
        summary, after = own.models[best], f"after {own.duration:g} s"
        numbers[f"drift {after}"] = Estimate(summary.median_end, *summary.median_end_interval, unit="m")
        if (last := _last(summary)) is not None:
            numbers[f"error over sigma {after}"] = Estimate(last.ratio, nan, nan)
    return numbers


def believed(own: FilterSummary) -> bool | None:
    """Return whether a filter's sigma at the end is right, by the interval of NEES for outages that do not overlap; None: unknown."""
    last = _last(own)
    return None if last is None else last.lower <= last.nees_per_dof <= last.upper


def sigma_text(own: FilterSummary) -> str:
    """Return what follows "its sigma is": right, or how many times too small or too large."""
    last, right = _last(own), believed(own)
    if not own.consistency:
        return "not stated"
    if last is None or right is None:
        return "not to be judged"
    if right:
        return "right"
    ratio, word = (last.ratio, "small") if last.ratio > 1 else (1 / last.ratio, "large")
    return f"{ratio:.1f} times too {word}"


def _last(own: FilterSummary) -> Consistency | None:
    return own.consistency[-1] if own.consistency and own.effective_count >= ENOUGH else None


def _shown(summaries: Sequence[DurationSummary]) -> list[DurationSummary]:
    known = [own for own in summaries if own.models]
    usual = [own for own in known if own.duration in SHOWN]
    return usual or sorted(known, key=lambda own: own.duration)[-2:]


def _drift(own: FilterSummary | None) -> str:
    if own is None:
        return "—"
    low, high = own.median_end_interval
    value = f"{number_text(own.median_end)} m"
    return (
        f"{value} [{number_text(low)}, {number_text(high)}]" if isfinite(low) else value
    )  # too few outages: no interval


def _about(result: Result | Drives, durations: Sequence[DurationSummary]) -> str:
    first = [next(iter(own.models.values())) for own in durations]
    counts = " and ".join(f"{_outages(s.count)} of {own.duration:g} s" for own, s in zip(durations, first, strict=True))
    return f"{len(result.drives)} drives, {counts}" if isinstance(result, Drives) else counts


def _failed(result: Result | Drives) -> dict[str, dict[str, str]]:
    """Return the filters and engines that cannot run: {name: {drive: why}}; the only drive has an empty name."""
    drives = result.drives if isinstance(result, Drives) else {"": result}
    names = dict.fromkeys(name for one in drives.values() for name in one.failed)
    return {name: {drive: one.failed[name] for drive, one in drives.items() if name in one.failed} for name in names}


def _cannot(result: Result | Drives, reasons: Mapping[str, str]) -> str:
    """Return that a filter cannot run, and in which drives if it runs in others."""
    everywhere = not isinstance(result, Drives) or len(reasons) == len(result.drives)
    return "cannot run" if everywhere else f"cannot run in {_listed(list(reasons))}"


def _why(name: str, reasons: Mapping[str, str]) -> Iterator[str]:
    """Yield why a filter cannot run, drives with the same reason together."""
    for reason in dict.fromkeys(reasons.values()):
        drives = [drive for drive, why in reasons.items() if why == reason and drive]
        yield f"{name} cannot run{f' in {_listed(drives)}' if drives else ''}: {reason}."


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _outages(count: int) -> str:
    return counted(count, "outage")


def _sentences(result: Result | Drives, durations: Sequence[DurationSummary], names: Sequence[str]) -> Iterator[str]:
    last, best = durations[-1], names[0]
    own = last.models[best]
    if len(names) > 1 and last.choice is not None:
        folds = f"in {last.choice.candidates[0].folds} of {last.choice.folds} parts of the drive"
        yield f"Choose {best}: its errors are the most likely ones {folds}. {_verdict(own)}"
    else:
        yield f"{best}: {_verdict(own)}"
    if own.effective_count >= ENOUGH:
        yield f"1 in 20 outages of {last.duration:g} s ends beyond {number_text(own.p95_end)} m."
    yield from (f"{note}." for note in result.notes if getattr(note, "id", "") in LEFT_OUT)
    for name, reasons in _failed(result).items():
        yield from _why(name, reasons)
    yield from _causes(result, own)
    first = next(iter(result.drives.values())) if isinstance(result, Drives) else result
    yield from (f"{note}." for note in first.notes if getattr(note, "id", "") == "no-white-noise")
    if first.autoregressive_origin is not None:
        yield f"AR processes: {first.autoregressive_origin}."
    if isinstance(result, Result):
        counts = " and ".join(_outages(next(iter(d.models.values())).effective_count) for d in durations)
        yield f"Measured against {result.reference}; without overlap: {counts}."


def _causes(result: Result | Drives, own: FilterSummary) -> Iterator[str]:
    """Yield why a bench's sigma is wrong on the road: how much noisier the sensors are in motion, or that a filter does not fit."""
    noisier = [] if isinstance(result, Drives) or result.motion is None else list(_noisier(result.motion))
    if noisier:
        yield f"On this drive {' and '.join(noisier)} noisier than on the bench."
    elif not believed(own):
        yield from (f"{note}." for note in result.notes if getattr(note, "id", "") in CAUSES)


def _noisier(motion: MotionNoise) -> Iterator[str]:
    for kind, name in (("gyro", "gyros"), ("accel", "accelerometers")):
        factor = motion.noisier(kind)
        if factor is not None and isfinite(factor.value):
            yield f"the {name} are {number_text(factor.value)} times"


def _verdict(own: FilterSummary) -> str:
    right = believed(own)
    if not own.consistency:
        return "It states no sigma."
    if right is None:
        return f"Its sigma cannot be judged: {_outages(own.effective_count)} without overlap; {ENOUGH} are needed."
    return "Believe its sigma." if right else f"Do not believe its sigma: it is {sigma_text(own)}."

"""The noise of several IMUs of one log side by side: which is quieter, where their intervals show it."""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from imuwb.analysis import Finding, Review, Table
from imuwb.errors import MissingDataError
from imuwb.log import AXES, Log
from imuwb.noise_results import SENSORS
from imuwb.notes import Note
from imuwb.progress import tracked
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.texts import coefficient_text, names_text
from imuwb.units import coefficient_units
from imuwb_plugins.allan.compute import run
from imuwb_plugins.allan.parameters import Parameters
from imuwb_plugins.allan.remarks import findings

LETTERS = "NBK"
NAMES = {"N": "random walk", "B": "bias instability", "K": "rate random walk"}
SAME_RATE = 0.1  #: relative difference of sampling rates, from which a note names them


@dataclass(frozen=True, slots=True)
class ImuNoise:
    """The noise of one IMU."""

    imu: str
    rate_hz: dict[str, float]  #: by sensor
    duration: float  #: s
    axes: dict[str, Mapping[str, Coefficient]]  #: axis -> coefficients of the headline estimator, SI
    doubted: bool = (
        False  #: whether the record does not suit a noise, such as that of a moving IMU; nothing is claimed of it
    )


@dataclass(frozen=True, slots=True)
class Quieter:
    """A coefficient of an IMU whose interval lies below those of others."""

    axis: str
    coefficient: str  #: N, B or K
    imu: str
    than: tuple[str, ...]  #: names of the other IMUs


@dataclass(frozen=True, slots=True)
class ImuComparison:
    """The noise of the IMUs of one log, and where one is quieter than another."""

    level: float  #: of all intervals and limits
    imus: tuple[ImuNoise, ...]
    quieter: tuple[Quieter, ...]
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        """Return where an IMU is quieter than others, one line each."""
        return "\n".join(f"{q.axis} {q.coefficient}: {q.imu} is quieter than {', '.join(q.than)}" for q in self.quieter)


def compare_imus(logs: Sequence[Log], parameters: Parameters) -> ImuComparison:
    """Return the noise of each IMU, and which is quieter where intervals do not overlap.

    Args:
        logs: one log for each IMU.
        parameters: of the Allan analysis.

    Raises:
        MissingDataError: fewer than two IMUs have a noise.
    """
    found: list[ImuNoise] = []
    notes: list[Note] = []
    doubts: dict[Note, list[str]] = defaultdict(list)
    reasons: list[str] = []
    for log in tracked(logs, len(logs)):
        name = log.imu().name
        try:
            result = run([log], parameters)
        except MissingDataError as error:
            reasons.append(str(error))
            notes.append(Note("no-analysis", f"{name} is left out: {error}"))
            continue
        for note in result.doubts.all:
            doubts[note].append(name)
        coefficients = _coefficients(findings(result))
        found.append(ImuNoise(name, result.rate_hz, result.duration, coefficients, bool(result.doubts.grave)))
    if len(found) < 2:  # noqa: PLR2004 - a comparison
        why = f": {'; '.join(reasons)}" if reasons else ""
        raise MissingDataError(
            f"{logs[0].provenance.path}: {len(found)} of {len(logs)} IMUs has a noise to compare, and a comparison needs two{why}"
        )
    notes += [Note(note.id, f"{', '.join(names)}: {note}") for note, names in doubts.items()]
    if doubted := [imu.imu for imu in found if imu.doubted]:
        text = "their records do not suit a noise, so it is not said which is quieter"
        notes.append(Note("not-compared", f"{', '.join(doubted)}: {text}"))
    sound = [imu for imu in found if not imu.doubted]
    quieter = tuple(_quieter(sound))
    return ImuComparison(
        parameters.level, tuple(found), quieter, (*notes, *_rate_notes(found), *_verdicts(sound, quieter))
    )


def _coefficients(all_findings: Sequence[Finding]) -> dict[str, Mapping[str, Coefficient]]:
    return {finding.axis: finding.coefficients for finding in all_findings if finding.headline}


def _quieter(imus: Sequence[ImuNoise]) -> Iterator[Quieter]:
    for axis in AXES:
        for letter in LETTERS:
            own = {imu.imu: imu.axes[axis].get(letter, UNKNOWN) for imu in imus if axis in imu.axes}
            for name, coefficient in own.items():
                than = tuple(other for other, theirs in own.items() if other != name and _below(coefficient, theirs))
                if than:
                    yield Quieter(axis, letter, name, than)


def _below(one: Coefficient, other: Coefficient) -> bool:
    """Return whether the whole interval of one lies below that of the other."""
    return math.isfinite(one.upper) and other.value is not None and one.upper < (other.lower or 0.0)


def _rate_notes(imus: Sequence[ImuNoise]) -> Iterator[Note]:
    for sensor, title in SENSORS.items():
        own = {imu.imu: imu.rate_hz[sensor] for imu in imus if sensor in imu.rate_hz}
        if own and max(own.values()) > (1 + SAME_RATE) * min(own.values()):
            listed = ", ".join(f"{name} {rate:.4g} Hz" for name, rate in own.items())
            text = (
                f"{title} are logged at different rates ({listed}): a log that keeps one of several samples without a filter folds their "
                "noise into its N, so N compares the logs, not the sensors alone"
            )
            yield Note("rates-differ", text)


def _verdicts(imus: Sequence[ImuNoise], quieter: Sequence[Quieter]) -> Iterator[Note]:
    """Yield, for each sensor and coefficient, the IMU that is quieter than all others on all their axes; or that none is."""
    for sensor, title in SENSORS.items():
        having = [imu for imu in imus if any(axis.startswith(sensor) for axis in imu.axes)]
        if len(having) < 2:  # noqa: PLR2004 - a comparison
            continue
        best = {
            letter: [imu.imu for imu in having if _leads(imu, having, quieter, sensor, letter)] for letter in LETTERS
        }
        told = [f"{names[0]} in {letter} ({NAMES[letter]})" for letter, names in best.items() if names]
        rest = ", ".join(letter for letter, names in best.items() if not names)
        if told:
            none = f"; no IMU in {rest}" if rest else ""
            yield Note("quieter", f"{title}, quieter than all others on every axis: {', '.join(told)}{none}")
        else:
            yield Note("not-quieter", f"{title}: no IMU is quieter than all others on every axis in {rest}")


def _leads(imu: ImuNoise, having: Sequence[ImuNoise], quieter: Sequence[Quieter], sensor: str, letter: str) -> bool:
    shown = {(q.axis, q.coefficient, q.imu): q.than for q in quieter}
    others = [other for other in having if other is not imu]
    shared = [
        (axis, other.imu) for axis in imu.axes if axis.startswith(sensor) for other in others if axis in other.axes
    ]
    return bool(shared) and all(other in shown.get((axis, letter, imu.imu), ()) for axis, other in shared)


def draw_imus(result: ImuComparison, review: Review) -> None:
    """Show the noise of all IMUs in one table."""
    than: dict[tuple[str, str], list[str]] = defaultdict(list)
    for q in result.quieter:
        than[q.axis, q.imu].append(f"{q.coefficient}: {names_text(q.than, 4)}")
    rows: list[tuple[str, ...]] = []
    for axis in AXES:
        for imu in result.imus:
            if axis not in imu.axes:
                continue
            cells = (coefficient_text(imu.axes[axis].get(x, UNKNOWN), coefficient_units(axis, x)[1]) for x in LETTERS)
            rows.append((axis, imu.imu, *cells, "; ".join(than[axis, imu.imu]) or "—"))
    headings = ("axis", "IMU", "N random walk", "B bias instability", "K rate random walk", "quieter than")
    caption = (
        f"Value [{100 * result.level:g} % interval]; < is an upper limit. An IMU is called quieter only where its whole interval lies below "
        "that of the other."
    )
    review.table(Table("Noise of the IMUs", headings, tuple(rows), caption))
    for note in result.notes:
        review.note(note)

"""The answer of a comparison of IMUs: N of each IMU on each axis, and which is quieter."""

from imuwb.analysis import Answer, Step
from imuwb.log import AXES
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.texts import duration_text, number_text
from imuwb.units import coefficient_units
from imuwb_plugins.allan.imus import ImuComparison, ImuNoise

BEST = "*"
MEANING = f"{BEST} quieter than all others on that axis: the whole {{}} % interval lies below theirs."
SAID_FIRST = ("not-compared", "quieter", "not-quieter", "rates-differ")  #: ids of notes, in the order of their weight


def answer_imus(result: ImuComparison) -> Answer:
    """Return N of each IMU in a row; the table with N, B, K and their intervals is the first that is drawn."""
    axes = [axis for axis in AXES if any(axis in imu.axes for imu in result.imus)]
    won = {(axis, imu.imu) for axis in axes for imu in result.imus if _wins(result, axis, imu)}
    rows = [(imu.imu, *(_cell(axis, imu, best=(axis, imu.imu) in won) for axis in axes)) for imu in result.imus]
    units = ("", *(coefficient_units(axis, "N")[1].name for axis in axes))
    sentences = [str(note) for id_ in SAID_FIRST for note in result.notes if note.id == id_]
    counts = {imu.imu: sum(name == imu.imu for _, name in won) for imu in result.imus}
    best = max(counts, key=lambda name: counts[name])
    quietest = Step(f"imuwb noise {{log}} --imu {best}", "its error model") if counts[best] else None
    full = Step("{command} --full", "N, B and K with their intervals")
    return Answer(
        f"{len(result.imus)} IMUs, {duration_text(max(imu.duration for imu in result.imus))}",
        ("N", *(axis.replace("_", " ") for axis in axes)), (*rows, units),
        (*((MEANING.format(f"{100 * result.level:g}"),) if won else ()), *sentences),
        (full, quietest) if quietest else (full,),
    )  # fmt: skip


def _wins(result: ImuComparison, axis: str, imu: ImuNoise) -> bool:
    others = {one.imu for one in result.imus if one is not imu and axis in one.axes and not one.doubted}
    than = {name for q in result.quieter if (q.axis, q.coefficient, q.imu) == (axis, "N", imu.imu) for name in q.than}
    return bool(others) and others <= than


def _cell(axis: str, imu: ImuNoise, *, best: bool) -> str:
    if axis not in imu.axes:
        return "—"
    coefficient: Coefficient = imu.axes[axis].get("N", UNKNOWN)
    unit = coefficient_units(axis, "N")[1]
    if coefficient.value is None:
        return f"< {number_text(unit.from_si(coefficient.upper))}" if coefficient.upper < float("inf") else "—"
    return f"{number_text(unit.from_si(coefficient.value))}{BEST if best else ''}"

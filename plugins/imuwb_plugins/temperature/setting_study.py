"""AR(1) by temperature in each setting of a study, such as a filter's cut-off (El-Diasty, tables 3 to 5)."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from imuwb.analysis import Case, setting_text
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.temperature import FirstOrder, first_order
from imuwb.log import AXES
from imuwb_plugins.temperature.parameters import Parameters
from imuwb_plugins.temperature.records import grouped, parts_of
from imuwb_plugins.temperature.result import CONVENTION, Study, StudyCase

ByTemperature = list[tuple[float, FirstOrder]]  # °C, AR(1)


def study(cases: Iterable[Case], parameters: Parameters) -> Study:
    """Return AR(1) in each setting; that of several logs at one temperature is their weighted mean."""
    by_setting: dict[tuple[tuple[str, str], ...], dict[str, ByTemperature]] = {}
    logs: list[str] = []
    units: Mapping[str, str] = {}
    for case in cases:
        path = case.log.provenance.path
        if path not in logs:
            logs.append(path)
        units = case.units
        settings = tuple((k, v) for k, v in case.settings.items() if k != "log")
        axes = by_setting.setdefault(settings, {})
        for axis, pairs in _first_orders(case, logs.index(path), parameters).items():
            axes.setdefault(axis, []).extend(pairs)
    return Study(CONVENTION, tuple(
        StudyCase(
            dict(settings), {axis: _merged(axes[axis]) for axis in AXES if axis in axes},
            setting_text(dict(settings), units),
        )
        for settings, axes in by_setting.items()
    ))  # fmt: skip


def _first_orders(case: Case, number: int, parameters: Parameters) -> dict[str, ByTemperature]:
    """Return AR(1) of each axis at each temperature of a case."""
    given = parameters.celsius
    if given and number >= len(given):
        raise UsageError(
            f"--celsius has {len(given)} temperatures for {number + 1} logs or more; give one for each, in their order"
        )
    _, parts, _ = parts_of(number, case.log, given[number] if given else None, parameters)
    axes: dict[str, ByTemperature] = {}
    for part in parts:
        for name, axis in part.axes.items():
            record = part.record(name)
            if record is None:
                continue
            try:
                first = first_order([record], axis.clock.interval)
            except ValueError as error:
                raise MissingDataError(f"{case.log.provenance.path}, {name}: {error}") from error
            axes.setdefault(name, []).append((part.stretch.nominal, first))
    return axes


def _merged(pairs: ByTemperature) -> tuple[tuple[float, FirstOrder], ...]:
    groups = grouped(pairs, lambda pair: pair[0])
    return tuple((float(np.mean([t for t, _ in g])), _mean([first for _, first in g])) for g in groups)


def _mean(orders: Sequence[FirstOrder]) -> FirstOrder:
    weights = np.array([1 / f.sigma**2 for f in orders])
    alpha = float(weights @ [f.alpha for f in orders] / weights.sum())
    ideal = float(np.sum([1 / f.sigma_if_ar**2 for f in orders])) ** -0.5
    return FirstOrder(alpha, float(weights.sum()) ** -0.5, ideal)

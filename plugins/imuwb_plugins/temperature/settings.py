"""AR(1) by temperature in each setting of a study, such as a filter's cut-off (El-Diasty, tables 3 to 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.temperature import FirstOrder, first_order
from imuwb.log import AXES
from imuwb_plugins.temperature.compute import CONVENTION
from imuwb_plugins.temperature.gather import TOGETHER, parts_of
from imuwb_plugins.temperature.result import Study, StudyCase
from imuwb_plugins.temperature.tell import first_order_result

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from imuwb.analysis import Case
    from imuwb_plugins.temperature.parameters import Parameters
    from imuwb_plugins.temperature.result import FirstOrderResult

    Found = dict[str, list[tuple[float, FirstOrder]]]  # axis -> (°C, AR(1))


def study(cases: Iterable[Case], parameters: Parameters) -> Study:
    """Return AR(1) in each setting; that of several logs at one temperature is their mean, weighted."""
    given = parameters.temperatures()
    found: dict[tuple[tuple[str, str], ...], Found] = {}
    logs: list[str] = []
    for case in cases:
        path = case.log.provenance.path
        if path not in logs:
            logs.append(path)
        settings = tuple((k, v) for k, v in case.settings.items() if k != "log")
        here = found.setdefault(settings, {})
        for axis, pairs in _case(case, logs.index(path), given, parameters).items():
            here.setdefault(axis, []).extend(pairs)
    return Study(CONVENTION, tuple(
        StudyCase(dict(settings), {axis: _merged(here[axis]) for axis in AXES if axis in here})
        for settings, here in found.items()
    ))  # fmt: skip


def _case(case: Case, number: int, given: tuple[float, ...] | None, parameters: Parameters) -> Found:
    if given is not None and number >= len(given):
        message = (
            f"--celsius has {len(given)} temperatures for {number + 1} logs or more; give one for each, in their order"
        )
        raise UsageError(message)
    _, parts, _ = parts_of(number, case.log, given[number] if given else None, parameters)
    found: Found = {}
    for part in parts:
        for name, axis in part.axes.items():
            record = part.record(name)
            if record is None:
                continue
            try:
                first = first_order([record], axis.clock.interval)
            except ValueError as error:
                message = f"{case.log.provenance.path}, {name}: {error}"
                raise MissingDataError(message) from error
            found.setdefault(name, []).append((part.stretch.nominal, first))
    return found


def _merged(pairs: Sequence[tuple[float, FirstOrder]]) -> tuple[tuple[float, FirstOrderResult], ...]:
    groups: list[list[tuple[float, FirstOrder]]] = []
    for pair in sorted(pairs, key=lambda p: p[0]):
        if groups and pair[0] - groups[-1][0][0] <= TOGETHER:
            groups[-1].append(pair)
        else:
            groups.append([pair])
    return tuple((float(np.mean([t for t, _ in g])), first_order_result(_mean([f for _, f in g]))) for g in groups)


def _mean(found: Sequence[FirstOrder]) -> FirstOrder:
    weights = np.array([1 / f.sigma**2 for f in found])
    alpha = float(weights @ [f.alpha for f in found] / weights.sum())
    ideal = float(np.sum([1 / f.sigma_if_ar**2 for f in found])) ** -0.5
    return FirstOrder(alpha, float(weights.sum()) ** -0.5, ideal)

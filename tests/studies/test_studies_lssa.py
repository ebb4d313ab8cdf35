"""The studies of least-squares spectra with few records: their figures must lie within what chance allows."""

import numpy as np
import pytest
from scipy import stats

RARE = 1e-4


def as_often_as(count, of, probability):
    return stats.binom.cdf(count, of, probability) > RARE and stats.binom.sf(count - 1, of, probability) > RARE


def test_false_alarms_are_as_many_as_said(load):
    module = load("lssa_false_alarms")
    for case in module.CASES:
        looked, one, records, record = module.false_alarms(case, 0, 60)
        assert records == 60
        # every second frequency is independent of the others
        assert one / looked == pytest.approx(0.01, abs=4 * np.sqrt(0.01 / (looked / 2))), case
        assert as_often_as(record, records, 0.01), case


def test_structures_are_told_apart(load):
    module = load("lssa_false_alarms")
    count, walk, coloured, other, mixed = module.refusals(0, 40)
    assert as_often_as(walk, count, 0.01)
    assert as_often_as(coloured, count, 0.01)
    assert other == mixed == count


def test_a_line_is_found_the_oftener_the_stronger_it_is(load):
    module = load("lssa_false_alarms")
    for case in ("white", "local, of AR(1), 0.9"):
        found = [module.finds(case, strength, 0, 15)[1] for strength in (4.0, 32.0)]
        assert found[0] < 8, case
        assert found[1] >= 13, case


def test_intervals_hold_the_lines(load):
    module = load("lssa_lines")
    (table,) = module.study(records=8, workers=1)
    assert table.column("record") == tuple(module.CASES)
    for row in table.rows:
        weak = "weak" in row[0]
        assert row[1] >= (1 if weak else 7), row[0]
        assert stats.binom.cdf(row[5].count, row[5].of, 0.94) > RARE, row[0]
        assert row[7] <= 2, row[0]

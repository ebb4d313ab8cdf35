"""The studies of least-squares spectra with few records: their figures must lie within the limits of chance."""

import numpy as np
import pytest
from scipy import stats

pytestmark = pytest.mark.slow
RARE = 1e-4


def as_often_as(count, of, probability):
    return stats.binom.cdf(count, of, probability) > RARE and stats.binom.sf(count - 1, of, probability) > RARE


def test_false_alarms_are_as_many_as_stated(load):
    module = load("lssa_false_alarms")
    for case in module.CASES:
        tested, above, records, record = module.false_alarms(case, 0, 60)
        assert records == 60
        # Every second frequency is independent of the others.
        assert above / tested == pytest.approx(0.01, abs=4 * np.sqrt(0.01 / (tested / 2))), case
        assert as_often_as(record, records, 0.01), case


def test_structures_are_distinguished(load):
    module = load("lssa_false_alarms")
    count, walk, coloured, other, mixed = module.refusals(0, 40)
    assert as_often_as(walk, count, 0.01)
    assert as_often_as(coloured, count, 0.01)
    assert other == mixed == count


def test_a_stronger_line_is_found_more_often(load):
    module = load("lssa_false_alarms")
    for case in ("white", "local, of AR(1), 0.9"):
        weak, strong = (module.finds(case, strength, 0, 15)[1] for strength in (4.0, 32.0))
        assert weak < 8, case
        assert strong >= 13, case


def test_intervals_contain_the_lines(load):
    module = load("lssa_lines")
    (table,) = module.study(records=8, workers=1)
    assert table.column("record") == tuple(module.CASES)
    for row in table.rows:
        weak = "weak" in row[0]
        assert row[1] >= (1 if weak else 7), row[0]
        assert stats.binom.cdf(row[5].count, row[5].of, 0.94) > RARE, row[0]
        assert row[7] <= 2, row[0]

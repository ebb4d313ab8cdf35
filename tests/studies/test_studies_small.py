"""The studies with few records: their figures must lie within what chance allows (about 1 in 10 000)."""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest
from scipy import stats

HERE = Path(__file__).parent
RARE = 1e-4


@pytest.fixture(scope="module")
def load():
    """Load a study by its path, as ``python tests/studies/NAME.py`` would find its neighbours."""
    sys.path.insert(0, str(HERE))

    def loaded(name):
        spec = spec_from_file_location(f"study_{name}", HERE / f"{name}.py")
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    yield loaded
    sys.path.remove(str(HERE))


def at_least(share, probability):
    """Say whether so few of so many are no rarer than chance makes them."""
    return stats.binom.cdf(share.count, share.of, probability) > RARE


def at_most(share, probability):
    return stats.binom.sf(share.count - 1, share.of, probability) > RARE


def pooled(module, shares):
    return module.Share(sum(s.count for s in shares), sum(s.of for s in shares))


def test_intervals_hold_the_truth(load):
    module = load("coverage_table4")
    _, present, absent, curve = module.study(records=4, hours=1.0, workers=1)
    # accel z's K is near the limit of what an hour shows; a null counts as not covered
    sure = [row for row in present.rows if row[:2] != ("accel_z", "K")]
    covered = pooled(module, [row[4] for row in sure])
    assert covered.of == 4 * 14
    assert at_least(covered, 0.95)
    for axis, letter, _, identified, *_, mean, _rms in sure:
        if letter in "NB":
            assert identified.value == 1, (axis, letter)
            assert abs(mean) < {"N": 1, "B": 15}[letter], (axis, letter)
    nulls = pooled(module, absent.column("not identified"))
    assert at_least(nulls, 0.95)
    assert all(share.value == 1 for share in absent.column("upper limit above 0") if share.of)
    # the six axes of a record are independent; so are its octaves, nearly
    assert at_least(pooled(module, curve.column("edf")), 0.95)


def test_printed_intervals_cover_less_than_edf_at_long_times(load):
    module = load("coverage_table4")
    curve = module.study(records=10, hours=0.1, workers=1)[3]
    edf, printed = (pooled(module, curve.column(kind)[-2:]) for kind in ("edf", "printed"))
    assert edf.count > printed.count
    assert at_least(edf, 0.93)


def test_samples_follow_their_processes(load):
    module = load("samples_follow_processes")
    _, _, allan, density = module.study(records=60, workers=1)
    assert allan.column("process") == tuple(module.PROCESSES)
    for table in (allan, density):
        for name, _, *means in table.rows:
            for heading, mean in zip(table.headings[2:], means, strict=True):
                assert abs(mean.off) < 5, (name, heading, mean)
                assert abs(mean.value - 1) < 0.3, (name, heading, mean)
    flicker = next(row for row in allan.rows if row[0] == "flicker")
    assert all(abs(mean.value - 1) < 0.02 for mean in flicker[2:8])  # m up to 32


def test_limits_are_not_exceeded(load):
    module = load("limits")
    _, k, others = module.study(records=12, minutes=10.0, workers=1)
    none, least, *_ = k.rows
    assert at_most(none[2], 0.05)
    assert none[4].value == 1
    assert at_least(least[3], 0.95)
    assert k.rows[-1][2].count > none[2].count  # three times the detection size is found more often
    assert all(at_most(share, 0.05) for share in others.column("identified"))
    assert all(share.value == 1 for share in others.column("limit above 0"))

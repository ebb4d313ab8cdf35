"""Outages of several logs as one: nothing crosses the logs."""

import numpy as np
import pytest

from imuwb.replay import effective_count, pooled, summarize
from imuwb.replay.scoring.pooling import logs_of
from imuwb.replay.scoring.statistics import _rows, compare, sign_flip

from .. import made  # noqa: TID252 - tests are no package that has a name


def parts():
    rng = np.random.default_rng(1)
    return [made.scores(rng.normal(size=n) * size, start=np.arange(n) + 200.0) for n, size in ((60, 1.0), (20, 10.0))]


def test_logs_stay_apart():
    one = pooled(parts())
    assert [log.size for log in logs_of(one.start)] == [60, 20]
    assert effective_count(one.start, 10.0) == 8  # 6 and 2
    assert effective_count(np.concatenate([p.start for p in parts()]), 10.0) < 8
    assert one.horizontal[60:, -1] == pytest.approx(parts()[1].horizontal[:, -1])


def test_blocks_do_not_cross_logs_and_each_log_keeps_its_number():
    one = pooled(parts())
    rows, effective, block = _rows(one, 10.0)
    assert (effective, block) == (8, 10)
    assert ((rows < 60).sum(axis=1) == 60).all()
    steps = np.diff(rows, axis=1)
    inside = (np.arange(rows.shape[1] - 1) + 1) % block != 0
    assert (steps[:, inside] == 1).all()


def test_a_log_alone_is_as_before():
    own = parts()[0]
    assert np.array_equal(_rows(pooled([own]), 10.0)[0], _rows(own, 10.0)[0])


def test_the_pooled_statistics_are_over_all_outages():
    one = pooled(parts())
    found = summarize("a", 1.0, one, (1.0,), 1.0, 0.95)
    assert found.count == 80
    assert found.median_end.value == pytest.approx(np.median(np.abs(one.north_east[:, -1, 0])))


def test_signs_do_not_cross_logs():
    one, other = pooled(parts()), pooled(parts())
    assert compare("a", one, "b", other, 10.0, 0.95).p_value == 1.0
    start = np.concatenate([np.arange(3.0), 1e8 + np.arange(3.0)])
    # One block of three for each log: the signs agree in 2 of 4 cases.
    assert sign_flip(np.ones(6), 3, start) == pytest.approx(0.5)
    assert sign_flip(np.ones(6), 6) == 1.0

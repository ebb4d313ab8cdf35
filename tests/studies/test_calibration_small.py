"""The study of calibration with few sensors: its figures must lie within the limits of chance."""

import pytest
from scipy import stats

pytestmark = pytest.mark.slow
RARE = 1e-4


@pytest.fixture(scope="module")
def tables(load):
    return load("calibration").study(records=4, workers=1)


def test_intervals_contain_the_truth(tables):
    summary = tables[0]
    assert summary.column("method") == (
        "six-position", "rate-table", "multi-position, attitudes known", "multi-position, attitudes unknown",
    )  # fmt: skip
    for share, count in zip(summary.column("coverage, pooled"), summary.column("parameters"), strict=True):
        assert share.of == 4 * count
        # The parameters of a record share one variance of residuals, so misses come together: a third of the parameters count.
        assert stats.binom.cdf(share.count // 3, share.of // 3, 0.95) > RARE


def test_a_corrected_record_has_the_sensors_noise(tables):
    *_, whole = tables[1].rows
    share, *ratios = whole[1:]
    assert stats.binom.cdf(share.count, share.of, 0.95) > RARE
    for mean in ratios:
        assert abs(mean.off) < 4

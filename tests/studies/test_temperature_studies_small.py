"""The studies of temperature with few, short records: their figures must lie within the limits of chance."""

import pytest
from scipy import stats

from imuwb.notes import ids

pytestmark = pytest.mark.slow
RARE = 1e-4


def test_the_test_of_dependence_keeps_its_size_and_finds_a_tenth(load):
    module = load("temperature_dependence")
    summary, sizes, powers = module.study(records=2, ramps=0, minutes=0.5, workers=1)
    together = summary.rows[4][2]
    assert together.of == 6
    assert stats.binom.sf(together.count - 1, together.of, 0.05) > RARE
    assert len(sizes.rows) == 4
    assert powers.rows[-1][1].value == 1


def test_a_chamber_recovers_the_published_figures(load, monkeypatch):
    module = load("chamber")
    monkeypatch.setattr(module, "PRESETS", ("motionpakii",))
    monkeypatch.setattr(module, "CELSIUS", (-30, 30))
    monkeypatch.setattr(module, "TABULATED", (-30, 30))
    summary, white, *ar1 = module.study(seeds=1, hours=0.02)
    inside = summary.rows[0][2]
    assert inside.of == 12
    assert stats.binom.cdf(inside.count, 12, 0.95) > RARE
    assert white.rows[0][1] == "2.2292"  # table 1
    assert len(ar1) == 4


def test_a_ramp_reaches_its_bound(load):
    module = load("ramp")
    summary, bins = module.study(records=2, hours=0.3)
    ratio = float(summary.rows[0][2])
    assert 0.3 < ratio < 2
    coverage = summary.rows[3][2]
    assert stats.binom.cdf(coverage.count, coverage.of, 0.95) > RARE
    assert len(bins.rows) >= 4


def test_only_a_model_with_temperature_knows_its_errors_on_a_drive_that_warms_up(load, monkeypatch):
    module = load("thermal_drive")
    monkeypatch.setattr(module, "MODELS", {name: module.MODELS[name] for name in ("thermal", "constant, of 25 °C")})
    thermal, constant = module.record(0, 12.0).values()
    assert stats.chi2.cdf(thermal.nees[:, -1].sum(), thermal.nees.shape[0] * 2) < 1 - RARE
    assert stats.chi2.sf(constant.nees[:, -1].sum(), constant.nees.shape[0] * 2) < RARE
    assert [("corrected" in ids(of.notes)) for of in (thermal, constant)] == [True, False]


def test_an_exported_warm_up_leaves_little_of_the_bias(load):
    goals, records = load("thermal_export").study(records=1, minutes=3.0)
    assert len(records.rows) == 2
    for row in records.rows:
        assert float(row[2].removesuffix(" %")) < 10
        assert row[-1].of > 200
    assert [row[0].partition(":")[0] for row in goals.rows] == ["ArduPilot", "ArduPilot", "PX4", "PX4"]

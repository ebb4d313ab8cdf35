"""The tools of the comparison on one record each: every tool finds N, none is given another sensor, and the bound is the known one."""

from importlib.util import find_spec

import numpy as np
import pytest

NEEDS = {
    "allan-variance": "allan_variance", "allantools, read as IEEE 952": "allantools", "MATLAB's procedure": "allantools",
    "NaveGo's procedure": "allantools", "statsmodels, Burg": "statsmodels", "astropy, LombScargle": "astropy",
}  # fmt: skip


def test_the_bound_of_white_noise_alone_is_that_of_a_standard_deviation(load):
    comparison = load("comparison")
    assert comparison.bounds("N", 2**14)["N"] == pytest.approx(1 / np.sqrt(2 * 2**14), rel=0.01)
    assert comparison.bounds("NBK", 2**14)["N"] > comparison.bounds("N", 2**14)["N"]


def test_every_tool_finds_the_white_noise(load):
    comparison = load("comparison")
    x = comparison.simulated("N", 0, 2**14)
    for name, (estimate, _) in comparison.TOOLS.items():
        if name in NEEDS and find_spec(NEEDS[name]) is None:
            continue
        value, low, high = estimate(x)["N"]
        assert value == pytest.approx(comparison.TRUTH["N"], rel=0.12), name
        assert (low is None) == (high is None), name


def test_the_published_readings_are_exact_on_a_curve_without_scatter(load, monkeypatch):
    allantools = pytest.importorskip("allantools")
    comparison = load("comparison")
    n, b, k = (comparison.TRUTH[letter] for letter in "NBK")

    def curve(x, *, rate, data_type, taus):
        del x, rate, data_type
        tau = np.geomspace(0.1, 1000, 200) if isinstance(taus, str) else np.asarray(taus)
        deviation = np.maximum.reduce([n / np.sqrt(tau), np.full(tau.size, comparison.FLAT * b), k * np.sqrt(tau / 3)])
        return tau, deviation, None, None

    monkeypatch.setattr(allantools, "oadev", curve)
    found = comparison.of_matlab(np.zeros(2**17))
    assert [found[letter][0] for letter in "NBK"] == pytest.approx([n, b, k], rel=1e-6)
    found = comparison.of_navego(np.zeros(2**17))
    assert [found[letter][0] for letter in "NB"] == pytest.approx([n, b], rel=0.03)
    assert found["K"] == comparison.NONE

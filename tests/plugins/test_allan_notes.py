from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.identification import allan, fit_allan, stationarity
from imuwb.notes import ids
from imuwb.sampling import Sampling
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise
from imuwb_plugins.allan.compute import _read_outs
from imuwb_plugins.allan.notes import _clock_notes, _fit_notes
from imuwb_plugins.allan.remarks import _comparison, _long_enough
from imuwb_plugins.allan.result import AllanAxis, EstimatorComparison, FitQuality

NOTHING = np.empty(0)
AXIS = AllanAxis(NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, None, dict.fromkeys("QNBKR", UNKNOWN))


@pytest.mark.parametrize(("jitter", "noted"), [(0.19, ()), (0.21, ("jitter",))])
def test_stamps_that_scatter_by_more_than_a_fifth_are_noted(jitter, noted):
    assert ids(_clock_notes("gyro", Sampling(0.01, (), (), jitter))) == noted


@pytest.mark.parametrize(
    ("first", "probability", "noted"),
    [(0.014, 0.5, ()), (0.016, 0.5, ("shortened",)), (0.01, 1.1e-3, ()), (0.01, 0.9e-3, ("unexplained",))],
)
def test_a_shortened_or_unexplained_fit_is_noted(first, probability, noted):
    axis = replace(AXIS, fit=FitQuality(first, 4.0, probability))
    notes = list(_fit_notes({"gyro_x": SimpleNamespace(clock=Sampling(0.01, (), (), 0.0))}, {"gyro_x": axis}))
    assert ids(notes) == noted
    assert all("2" in note for note in notes if note.id == "unexplained")  # √4


def test_coefficients_are_marked_at_the_height_of_the_curve():
    tau = 2.0 ** np.arange(12)
    for letter, process, at in (
        ("N", WhiteNoise(0.3), 1.0),
        ("K", RandomWalk(0.3), 3.0),
        ("B", FlickerNoise(0.3), 64.0),
    ):
        coefficients = {**dict.fromkeys("QNBKR", UNKNOWN), letter: Coefficient(0.3, 0.2, 0.4, at=at)}
        (mark,) = _read_outs(coefficients, tau)
        assert (mark.letter, mark.averaging_time) == (letter, at)
        assert mark.deviation == pytest.approx(float(process.allan_variance(np.array([at]), 0.01)[0]) ** 0.5, rel=1e-3)
    assert _read_outs({**coefficients, "B": Coefficient(0.3, 0.2, 0.4, at=1e9)}, tau) == ()


def test_the_length_that_would_show_a_random_walk_makes_it_three_times_the_other_terms():
    coefficients = {
        "N": Coefficient(0.01, 0.0099, 0.0101), "B": Coefficient(0.001, 0.0009, 0.0011), "K": Coefficient(None, None, 1e-5)
    }  # fmt: skip
    wish = _long_enough(coefficients, 600.0)
    hours = float(wish.removesuffix(" h"))
    tau = np.array([360 * hours])  # a tenth
    walk = RandomWalk(1e-5).allan_variance(tau, 0.01)
    others = WhiteNoise(0.01).allan_variance(tau, 0.01) + FlickerNoise(0.001).allan_variance(tau, 0.01)
    assert walk[0] / others[0] == pytest.approx(9, rel=0.05)
    assert _long_enough(coefficients, hours * 3600 / 1.55) is not None
    assert _long_enough(coefficients, hours * 3600 / 1.45) is None


@pytest.mark.parametrize(("ratio", "suspicious"), [(1.2, False), (0.85, False), (1.24, True), (0.8, True)])
def test_a_change_by_more_than_a_fifth_puts_the_coefficients_in_doubt(ratio, suspicious):
    values = np.random.default_rng(0).standard_normal(2000)
    unsteady = replace(stationarity(values, 0.01), stationary=False, worst_ratio=ratio)
    fit = fit_allan(allan(values, 0.01))
    estimates = EstimatorComparison("allan", {}, fit.processes, True, None, True, (), unsteady, None, 0.0, ())
    (remark,) = _comparison(estimates)
    assert remark.id == "not-stationary"
    assert remark.startswith("SUSPICIOUS") == suspicious

"""What is known of an axis after a standstill, against the joint law of all its samples."""

from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import AXES
from imuwb.navigation.filter import _axes_at_start
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.initial import axis_start
from imuwb.navigation.shaping import shaping
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
)

DT = 0.01
SUMS = [
    Sum((WhiteNoise(1e-3),)),
    Sum((Constant(0.3),)),
    Sum((GaussMarkov(0.2, 0.5), Constant(0.3))),
    Sum((RandomWalk(0.4), GaussMarkov(0.2, 0.05))),
    Sum((Autoregressive((-1.5, 0.7, -0.1), 0.1, DT), RandomWalk(0.1))),
]


@pytest.mark.parametrize("processes", SUMS, ids=str)
@pytest.mark.parametrize(("before", "still", "after"), [(0, 40, 0), (7, 40, 13), (30, 0, 5), (20, 1, 1)])
def test_a_start_is_the_joint_law_of_all_samples(processes, before, still, after):
    one = shaping(processes, DT)
    p, n = one.order, before + still + after
    # x(k) = A^k x(0) + sum of A^(k-j) w(j), all k from 0 on as one vector.
    powers = [np.linalg.matrix_power(one.A, k) for k in range(n + 1)]
    whole = np.zeros(((n + 1) * p, (n + 1) * p))
    for k in range(n + 1):
        for j in range(k + 1):
            whole[k * p : (k + 1) * p, j * p : (j + 1) * p] = powers[k - j]
    drive = np.kron(np.eye(n + 1), one.Q)
    drive[:p, :p] = one.P0
    joint = whole @ drive @ whole.T
    mean = np.zeros((n + 1, p))
    mean[before + 1 : before + still + 1] = one.c / max(still, 1)
    found = axis_start(one, before, still, after)
    last = np.eye((n + 1) * p)[n * p :]
    assert found.covariance == pytest.approx(last @ joint @ last.T, rel=1e-9, abs=1e-14)
    assert found.cross == pytest.approx(last @ joint @ mean.ravel(), rel=1e-9, abs=1e-14)
    assert found.variance == pytest.approx(mean.ravel() @ joint @ mean.ravel(), rel=1e-9, abs=1e-14)


def test_a_standstill_measures_a_gyros_bias_down_to_the_earths_rate():
    """The Earth's rate of 7.292115e-5 rad/s has, on one axis and on average over all attitudes, a third of its square."""
    prior, white, seconds = 2e-3, 1e-4, 20.0
    axis = AxisModel(Sum((WhiteNoise(white), Constant(prior))))
    model = FilterModel("m", ImuErrorModel("m", dict.fromkeys(AXES, axis)), scale_factor=(0.01, 0.02))
    tables, _ = model.tables(DT)
    measurement = SimpleNamespace(interval=DT, celsius=(None,), samples=SimpleNamespace(regime=np.zeros(3000, int)))
    alignment = SimpleNamespace(
        covariance=np.eye(9),
        standstill=(100, 100 + round(seconds / DT)),
        sample=2500,
        gyro_bias=np.array([1e-3, 0, -2e-3]),
    )
    states, covariance = _axes_at_start(model, measurement, tables, alignment)
    noise = white**2 / seconds + 7.292115e-5**2 / 3
    gain = prior**2 / (prior**2 + noise)
    assert states[[0, 2, 4]] == pytest.approx(gain * alignment.gyro_bias)
    assert not states[[1, 3, 5, 6, 7, 8, 9, 10, 11]].any()
    variance = np.diagonal(covariance)
    assert variance[:9] == pytest.approx(1.0)
    assert variance[[9, 11, 13]] == pytest.approx(noise * gain)
    assert variance[[15, 17, 19]] == pytest.approx(prior**2)
    assert variance[[10, 12, 14]] == pytest.approx(0.01**2)
    assert variance[[16, 18, 20]] == pytest.approx(0.02**2)

"""Which lines a filter carries: their share of the drift against integrated sinusoids, and the choice."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import AXES
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.lines import LEAST, left_out, line_drift, white_drift
from imuwb.navigation.workspace import MOST_STATES
from imuwb.stochastic import (
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sinusoid,
    Sum,
    WhiteNoise,
)

G = 9.80665
WHITE = (2e-4, 2e-3)  # rad/s/√Hz, m/s²/√Hz


SLOW = (FlickerNoise(1e-4), RandomWalk(1e-6), Constant(1e-3))


def error_model(lines, axis="accel_x"):
    def own(name):
        white = WhiteNoise(WHITE[name.startswith("accel")])
        return AxisModel(Sum((white, *SLOW, *(lines if name == axis else ()))))

    return ImuErrorModel("lines", {name: own(name) for name in AXES})


@pytest.mark.parametrize(("gyro", "amplitude"), [(False, 0.02), (True, 1e-3)], ids=["accelerometer", "gyro"])
@pytest.mark.parametrize("frequency", [0.003, 0.05, 0.56, 2.7])
def test_the_drift_of_a_line_is_that_of_integrated_sinusoids(gyro, amplitude, frequency):
    dt, seconds = 2e-3, 20.0
    t = (np.arange(round(seconds / dt)) + 0.5) * dt
    phases = np.arange(16) * np.pi / 8
    rate = amplitude * np.sin(2 * np.pi * frequency * t + phases[:, None])
    acceleration = G * np.cumsum(rate, axis=1) * dt if gyro else rate
    position = np.cumsum(np.cumsum(acceleration, axis=1) * dt, axis=1)[:, -1] * dt
    expected = line_drift(amplitude, frequency, np.array([seconds]), gyro=gyro)[0]
    assert np.mean(position**2) == pytest.approx(expected, rel=5e-3)


def test_a_slow_line_drifts_like_a_constant_bias():
    time = np.array([10.0, 60.0])
    assert line_drift(0.1, 1e-6, time, gyro=False) == pytest.approx((0.1 * time**2 / 2) ** 2 / 2, rel=1e-3)
    assert line_drift(0.1, 1e-6, time, gyro=True) == pytest.approx((G * 0.1 * time**3 / 6) ** 2 / 2, rel=1e-3)


@pytest.mark.parametrize("gyro", [False, True])
def test_the_drift_of_white_noise_is_that_of_integrated_samples(gyro):
    rng = np.random.default_rng(0)
    dt, n = 0.05, 200
    samples = rng.standard_normal((4000, n)) * 0.1 / np.sqrt(dt)
    acceleration = G * np.cumsum(samples, axis=1) * dt if gyro else samples
    position = np.cumsum(np.cumsum(acceleration, axis=1) * dt, axis=1)[:, -1] * dt
    assert np.mean(position**2) == pytest.approx(white_drift(0.1, np.array([n * dt]), gyro=gyro)[0], rel=0.1)


def test_lines_that_add_little_are_left_out_together_below_the_limit():
    white = [Sum((WhiteNoise(WHITE[k > 2]),)) for k in range(6)]
    weak = [Sinusoid(2e-3 * (1 + k / 10), 0.5 + k) for k in range(8)]
    strong = Sinusoid(0.3, 0.2)
    axes = [*white[:5], Sum((*white[5].terms, *weak, strong))]
    out = left_out(axes, 30, (5.0, 60.0))
    assert {line.frequency for line in out} == {line.frequency for line in weak}
    assert sum(line.share for line in out) < LEAST
    assert all(line.axis == "accel_z" and axes[5].terms[line.term].frequency == line.frequency for line in out)


def test_without_room_the_strongest_lines_are_carried():
    strong = [Sinusoid(0.1 * (1 + k), 0.3) for k in range(5)]
    axes = [Sum(()), Sum(()), Sum(()), Sum(tuple(strong)), Sum(()), Sum(())]
    assert [line.term for line in left_out(axes, 2, (10.0, 60.0))] == [0, 1, 2]
    assert left_out(axes, 9, (10.0, 60.0)) == ()


def test_a_gyros_line_counts_more_in_a_longer_outage():
    axes = [Sum((WhiteNoise(1e-9), Sinusoid(1e-3, 0.5))), *[Sum(())] * 2, Sum((Sinusoid(0.2, 0.5),)), *[Sum(())] * 2]
    assert left_out(axes, 1, (5.0, 6.0))[0].axis == "gyro_x"
    assert left_out(axes, 1, (500.0, 600.0))[0].axis == "accel_x"


def test_a_filter_carries_as_many_lines_as_it_has_room_for():
    lines = [Sinusoid(0.2 + k / 100, 0.1 + k / 20) for k in range(12)]
    model = FilterModel("full", error_model(lines))
    states = model.states(0.01)
    assert len(states) == 9 + 6 * 5 + 2 * 4 <= MOST_STATES
    out = model.lines_left_out(0.01)
    assert len(out) == 8
    assert {f"accel_x: line at {line.frequency:.4g} Hz" for line in out} == set(model.left_out(0.01))
    tables, start = model.tables(0.01)
    assert int(tables.first[6]) == len(states)
    assert start.shape == (len(states) - 9,) * 2


def test_horizons_decide_and_scale_factors_take_room():
    weak = [Sinusoid(0.015, 0.56)]
    model = FilterModel("full", error_model(weak), settings=Settings(horizons=(2.0, 5.0)))
    assert not model.lines_left_out(0.01)
    assert replace(model, settings=Settings(horizons=(300.0, 600.0))).lines_left_out(0.01)
    many = FilterModel("full", error_model([Sinusoid(0.2, 0.1 + k / 20) for k in range(9)]))
    assert len(many.states(0.01)) == 47
    assert len(replace(many, scale_factor=(0.01, 0.01)).states(0.01)) == 47 - 8 + 6 + 2


def test_a_line_is_chosen_alike_at_all_temperatures():
    processes = [Sum((WhiteNoise(2e-3 * f), GaussMarkov(0.01, 60.0), Sinusoid(0.3, 0.2))) for f in (1.0, 50.0)]
    warm = AxisModel(processes[0], thermal=((0.0, processes[0]), (40.0, processes[1])))
    model = FilterModel("warm", ImuErrorModel("warm", dict.fromkeys(AXES, warm)))
    tables, _ = model.tables(0.01, (0.0, 40.0))
    assert {line.axis for line in model.lines_left_out(0.01)} == {
        "accel_x",
        "accel_y",
        "accel_z",
    }  # the gyros' are larger
    assert tables.step.shape == (2, 6 + 3 * 2)

"""A receiver's delay, an IMU's clock, and noise that shows only in outages, found again in simulated drives."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, ImuStream, Triad
from imuwb.replay import estimate_clocks, prepare, scaled, tune

from . import made

pytestmark = pytest.mark.slow

LATENCY = 0.15


@pytest.fixture(scope="module")
def late():
    return made.town(150, 3, seed=2, receiver=made.Receiver(latency=LATENCY))


@pytest.fixture(scope="module")
def clocks(late):
    return estimate_clocks(late.log, late.model, None, 0.99, with_rate=False)


def test_the_delay_of_a_receiver(clocks):
    assert clocks.delay.value == pytest.approx(LATENCY, abs=0.08)
    assert clocks.delay.value + clocks.velocity_delay.value == pytest.approx(LATENCY, abs=0.03)  # from velocities
    assert clocks.rate is None
    assert 0.3 < clocks.noise < 3.0


def test_the_delay_of_a_receiver_is_within_its_interval(clocks):
    assert clocks.delay.lower < LATENCY < clocks.delay.upper
    assert clocks.velocity_delay.lower < 0 < clocks.velocity_delay.upper


def failing(monkeypatch, when):
    """Make filters invalid with some delays."""
    module = sys.modules["imuwb.replay.clocks"]
    real = module.run

    def run(model, prepared):
        if when(model.installation.gnss_delay):
            raise MissingDataError("a variance is negative")
        return real(model, prepared)

    monkeypatch.setattr(module, "run", run)


def test_a_delay_with_which_the_filter_becomes_invalid_is_not_taken(late, clocks, monkeypatch):
    failing(monkeypatch, lambda delay: abs(delay) > 0.35)
    found = estimate_clocks(late.log, late.model, None, 0.99, with_rate=False)
    assert found.delay.value == pytest.approx(clocks.delay.value, abs=1e-6)


def test_a_filter_that_is_invalid_with_all_delays_says_why(late, monkeypatch):
    failing(monkeypatch, np.isfinite)
    with pytest.raises(MissingDataError, match="a variance is negative"):
        estimate_clocks(late.log, late.model, None, 0.99, with_rate=False)


def faster(log, rate):
    """Return a log whose IMU's clock counts more seconds than there are."""
    imu = log.imus[0]
    triads = [
        Triad(np.rint(t.time[0] + (t.time - t.time[0]) * rate).astype(np.int64), t.value)
        for t in (imu.angular_rate, imu.specific_force)
    ]
    return replace(log, imus=(ImuStream(imu.name, *triads),))


def test_the_rate_of_the_imus_clock(late):
    """A second of an IMU whose stamps run 1.5 in a thousand fast lasts 1/1.0015 true ones."""
    found = estimate_clocks(faster(late.log, 1.0015), late.model, None, 0.99, with_rate=True)
    assert found.rate.lower < 1 / 1.0015 < found.rate.upper
    assert found.rate.value == pytest.approx(1 / 1.0015, abs=5e-4)


@pytest.fixture(scope="module")
def loud():
    """Return a drive with three times the white noise that the filter believes."""
    true = made.error_model(white=(1e-3, 1e-2), turn_on=(2e-4, 5e-3))
    drive = made.town(420, 3, seed=5, model=true)
    return replace_model(drive, scaled(true, (1 / 3, 1 / 3)))


def replace_model(drive, error_model):
    drive.model = replace(drive.model, error_model=error_model)
    return drive


def test_noise_is_found_by_outages_and_holds_in_others(loud):
    prepared = prepare(loud.log, loud.model)
    model, found = tune(prepared, loud.model, "best")
    assert found.fitted >= 4
    assert found.judged >= 4
    assert found.white[0] == pytest.approx(3.0, rel=0.3)
    before, after = found.nees_per_dof
    assert abs(np.log(after)) < abs(np.log(before))
    assert found.log_likelihood[1] > found.log_likelihood[0]
    assert found.median_end[1] < 1.2 * found.median_end[0]
    tuned, known = (m.error_model.axes["gyro_x"].processes.terms[0].N for m in (model, loud.model))
    assert tuned == pytest.approx(known * found.white[0])


def test_outages_over_a_gap_of_the_imu_are_not_tuned_to():
    drive = made.town(480, 3, seed=5, model=made.error_model(white=(1e-3, 1e-2), turn_on=(2e-4, 5e-3)))
    imu = drive.log.imus[0]
    second = (imu.angular_rate.time - drive.log.zero) / SECOND
    keep = (second < 150) | (second > 158)
    triads = [Triad(t.time[keep], t.value[keep]) for t in (imu.angular_rate, imu.specific_force)]
    prepared = prepare(replace(drive.log, imus=(ImuStream(imu.name, *triads),)), drive.model)
    _, found = tune(prepared, drive.model, "best")
    assert found.white[0] < 2.0
    assert found.log_likelihood[1] > found.log_likelihood[0] - 0.5


def test_too_short_for_tuning(late):
    prepared = prepare(late.log, late.model)
    with pytest.raises(
        ValueError,
        match=r"tuning needs 4 outages of 30 s that do not overlap in each half of the log; there are \d and \d",
    ):
        tune(prepared, late.model, "best")

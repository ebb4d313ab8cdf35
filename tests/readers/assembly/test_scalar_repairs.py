"""What befell a temperature or a speed alone is a repair of that stream."""

import numpy as np
import pytest

from imuwb.log import SECOND, Provenance
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch
from imuwb.summary import summarize

FILE = Provenance("made", "csv", "", 0)
TIME = np.arange(100) * (SECOND // 10)


def test_a_temperature_that_is_no_number_costs_the_imu_no_row():
    celsius = np.where(np.arange(100) < 40, np.nan, 20.0)
    rate = np.random.default_rng(0).standard_normal((100, 3))
    log = assemble([Batch("imu", "imu", TIME, {"angular_rate": rate, "temperature": celsius})], FILE)
    assert log.imus[0].origin.repairs == ()
    assert [(r.count, r.effect) for r in log.imus[0].temperature.repairs] == [(40, "lost")]
    assert [len(s.repairs) for s in summarize(log).streams] == [0, 1]


@pytest.mark.parametrize("lost", [0, 7])
def test_a_speed_has_its_repairs(lost):
    speed = np.where(np.arange(100) < lost, np.inf, 1.0)
    log = assemble([Batch("wheel", "speed", TIME, {"speed": speed})], FILE)
    assert [r.count for r in log.speeds[0].repairs] == ([lost] if lost else [])
    assert log.notes == ()

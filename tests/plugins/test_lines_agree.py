"""All commands that name periodic lines judge alike which of them are the sensor's."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.readers import read
from imuwb.readers.read_options import ReadOptions
from imuwb.stochastic import Sinusoid
from imuwb_plugins import allan, health, lssa, psd

N, RATE = 2**15, 100.0


@pytest.fixture(scope="module")
def gyro():
    """Return white noise with a line in the whole record, and another in its second half."""
    rng = np.random.default_rng(3)
    values = rng.standard_normal((N, 3)) * 1e-3
    t = np.arange(N) / RATE
    values[:, 0] += 3e-4 * np.sin(2 * np.pi * 7.3 * t)
    values[:, 0] += 3e-4 * np.sin(2 * np.pi * 19.0 * t) * (t > t[-1] / 2)
    return values


def test_a_line_of_one_half_is_claimed_by_none(make_log, gyro):
    log = make_log(gyro=gyro)
    by_lssa = {round(p.frequency.value, 1): p.claimed for p in lssa.run([log], lssa.Parameters()).axes["gyro_x"].peaks}
    assert by_lssa == {7.3: True, 19.0: False}
    result = allan.run([log], allan.Parameters(estimators=False))
    assert [round(line.frequency, 1) for line in result.axes["gyro_x"].lines] == [7.3]
    terms = allan.error_model(result).axes["gyro_x"].processes.terms
    assert [round(term.frequency, 1) for term in terms if isinstance(term, Sinusoid)] == [7.3]
    by_psd = psd.run([log], psd.Parameters()).axes["gyro_x"].lines
    assert [round(line.frequency, 1) for line in by_psd] == [7.3]
    faults = [f.what for f in health.run([log], health.Parameters()).faults if f.kind == "line"]
    assert ["not in both halves" in fault for fault in faults] == [" 19" in fault for fault in faults]
    assert len(faults) == 2


@pytest.mark.slow
def test_the_lines_of_a_real_accelerometer_are_the_same_for_all(shared):
    log = read(shared / "static" / "adis16405_imu1.csv.gz", ReadOptions(rate=100.0))
    log = replace(log, imus=(replace(log.imus[0], angular_rate=None),))
    by_allan = allan.run([log], allan.Parameters(estimators=False)).axes
    by_lssa = lssa.run([log], lssa.Parameters()).axes
    for axis in by_allan:
        claimed = sorted(p.frequency.value for p in by_lssa[axis].peaks if p.claimed)
        assert sorted(x.frequency for x in by_allan[axis].lines) == pytest.approx(claimed, abs=2e-3), axis
    assert len(by_allan["accel_x"].lines) > 2

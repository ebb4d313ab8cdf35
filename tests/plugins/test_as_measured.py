"""Temperature and calibration undo an autopilot's corrections first, or name them."""

from dataclasses import replace

import pytest

from imuwb.errors import MissingDataError
from imuwb.notes import ids
from imuwb.simulation import preset, static
from imuwb.simulation.thermal import Temperature
from imuwb_plugins.calibration import positions, rate_table
from imuwb_plugins.calibration.parameters import RateTable, SixPosition
from imuwb_plugins.temperature.compute import run
from imuwb_plugins.temperature.parameters import Parameters

OFFSET = 0.01  #: rad/s


@pytest.fixture(scope="module")
def warm():
    log = static(preset("adis16470"), 240, 25, 1, celsius=Temperature.ramp(10, 40, 240))
    imus = (replace(log.imu(), name="IMU.0"),)
    return replace(log, imus=imus, settings={"INS_GYROFFS_X": OFFSET, "INS_ACCSCAL_X": 1.0})


@pytest.mark.slow
def test_the_offset_is_named_or_added(warm):
    gyro = replace(warm, imus=(replace(warm.imu(), specific_force=None),))
    before, after = (run([gyro], Parameters(as_measured=undo, cut="bins", bins=10.0)) for undo in (False, True))
    assert "corrected-before" in ids(before.notes)
    assert "corrected-before" not in ids(after.notes)
    assert "through as measured:INS_GYROFFS_X" in after.source
    x, bare = (result.axes["gyro_x"].over.points[0].means for result in (before, after))
    assert bare[0].value - x[0].value == pytest.approx(OFFSET, rel=1e-6)


@pytest.mark.parametrize(
    ("work", "options"),
    [(run, Parameters), (positions.run, SixPosition), (rate_table.run, RateTable)],
)
def test_a_log_without_parameters_is_refused(warm, work, options):
    with pytest.raises(MissingDataError, match="with its parameters"):
        work([replace(warm, settings={})], options(as_measured=True))

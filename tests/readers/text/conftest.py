"""A function that writes a text log and reads its IMU."""

import pytest

from imuwb.readers import ReadOptions, read


@pytest.fixture
def imu_of(text_log):
    def imu(text, sidecar=None, **options):
        log = read(text_log(text, sidecar=sidecar), ReadOptions(**options))
        assert len(log.imus) == 1
        return log.imus[0]

    return imu

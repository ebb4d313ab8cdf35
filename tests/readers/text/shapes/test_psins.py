"""Text files of PSINS's IMUs."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from tests.readers.text.shapes.truth import ACCEL, DEG, GYRO, N, axes

G, STEP = 9.78, 0.01
GYRO_SCALE, ACCEL_SCALE = 0.0005, 0.01  # arcsec, µg s


def text(late=False, step=STEP * 1000):
    gyro = axes(GYRO, "RFU") * STEP / (GYRO_SCALE * DEG / 3600)
    accel = axes(ACCEL, "RFU") * STEP / (ACCEL_SCALE * 1e-6 * G)
    end = " 0" if late else ""
    lines = ["% PSINS-format SIMU log file. (DO NOT MODIFY!)", "% 2024-01-01", f"1 2 3 0.1 0.2 0.3{end}"]
    lines += [
        f"30.5 114.25 20.5 1000.5 {step} {G}{end}",
        " ".join([str(GYRO_SCALE)] * 3 + [str(ACCEL_SCALE)] * 3) + end,
        "",
    ]
    for i, row in enumerate(np.rint(np.hstack([gyro, accel])).astype(int).tolist()):
        lines.append(" ".join(map(str, row)) + (f" {100 if i == 10 else -100 if i == 11 else 0}" if late else ""))
    return "\n".join([*lines, ""])


@pytest.mark.parametrize("late", [False, True])
def test_increments_in_counts_become_rates(text_log, late):
    imu = read(text_log(text(late), name="imu.txt")).imus[0]
    expected = 1_000_500_000_000 + 10_000_000 * np.arange(1, N + 1)
    if late:
        expected[10] += 100_000
    assert imu.angular_rate.time.tolist() == expected.tolist()
    assert imu.origin.frame.startswith("RFU")
    np.testing.assert_allclose(imu.angular_rate.value, GYRO, rtol=0, atol=1e-6)
    np.testing.assert_allclose(imu.specific_force.value, ACCEL, rtol=0, atol=1e-5)


@pytest.mark.parametrize("damaged", [text(step=0), text().replace("1000.5", "x"), "% PSINS SIMU\n1 2 3 4 5 6\n"])
def test_a_damaged_file_is_refused(text_log, damaged):
    with pytest.raises(UnreadableLogError):
        read(text_log(damaged, name="imu.txt"))

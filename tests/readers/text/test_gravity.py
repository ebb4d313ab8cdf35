"""What the size of the specific force says: a wrong unit, counts, or no specific force at all."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers import ReadOptions, read

ROWS = 400
G = 9.80665
RNG = np.random.default_rng(3)
RATES = RNG.normal(0, 0.5, (ROWS, 3))  # deg/s
FORCES = RNG.normal((0.02, -0.01, 1.0), 0.002, (ROWS, 3))  # g


def log(forces, unit="", rates=RATES, temperature=None, whole=False):
    """Return a log with a gyro in deg/s or counts, and an accelerometer in a unit that its names state or not."""
    end = f" [{unit}]" if unit else ""
    header = ["time_ms", *(f"gyro_{a}" + ("" if whole else "_dps") for a in "xyz"), *(f"accel_{a}{end}" for a in "xyz")]
    form = "{:.0f}" if whole else "{:.6f}"
    lines = [",".join([*header, *(() if temperature is None else ("temperature",))])]
    for i, row in enumerate(np.concatenate([rates, forces], axis=1)):
        more = [] if temperature is None else [form.format(temperature[i])]
        lines.append(",".join([str(5 * i), *map(form.format, row), *more]))
    return "\n".join([*lines, ""])


LINEAR = RNG.normal(0, 0.6, (ROWS, 3))  # m/s², without gravity: its median is about 1
INCREMENTS = FORCES * G * 0.005  # m/s in 5 ms


@pytest.mark.parametrize("forces", [LINEAR, LINEAR * 0.05, INCREMENTS])
@pytest.mark.parametrize("unit", ["m/s²", "g", ""])
def test_what_is_no_specific_force_is_refused_without_another_unit(text_log, forces, unit):
    if unit == "g":
        forces = forces / G
    with pytest.raises((UnreadableLogError, UsageError)) as caught:
        read(text_log(log(forces, unit)))
    assert "no specific force" in str(caught.value)
    assert "accel=g" not in str(caught.value)
    assert "likely" not in str(caught.value)


@pytest.mark.parametrize(("factor", "stated", "likely"), [(1, "m/s²", "g"), (1000, "g", "mg"), (G, "mg", "m/s²")])
def test_one_gravity_in_another_unit_is_told(text_log, factor, stated, likely):
    with pytest.raises(UnreadableLogError, match=f"--units accel={likely}$"):
        read(text_log(log(FORCES * factor, stated)))


@pytest.mark.parametrize("unit", ["m/s²", ""])
def test_a_horizontal_axis_alone_is_no_contradiction(text_log, unit):
    lines = [line.rpartition(",")[0].rpartition(",")[0] for line in log(FORCES * G, unit).splitlines()]
    (imu,) = read(text_log("\n".join([*lines, ""])), ReadOptions(units={"accel": "m/s²"})).imus
    assert imu.specific_force.axes == "x"


MPU_6050 = {"gyro": "131LSB/(deg/s)", "accel": "16384LSB/g", "temperature": "340LSB/C+36.53"}


class TestCounts:
    RATES = np.rint(RATES * 131)
    FORCES = np.rint(FORCES * 16384)
    RAW = np.rint(RNG.normal(-3900, 20, ROWS))
    TEXT = log(FORCES, rates=RATES, temperature=RAW, whole=True)

    @pytest.mark.parametrize(
        "units",
        [
            MPU_6050,
            {"gyro": "131 LSB/deg/s", "accel": "16384 LSB/g", "temperature": "340 LSB/°C + 36.53"},
            {"gyro": "1/131 deg/s", "accel": "1/16384 g", "temperature": "1/340 °C + 36.53"},
            {"gyro": "131 counts/dps", "accel": "0.06103515625 mg/LSB", "temperature": "340counts/degC+36.53"},
        ],
    )
    def test_counts_with_their_scale_are_read(self, text_log, units):
        (imu,) = read(text_log(self.TEXT), ReadOptions(units=units)).imus
        np.testing.assert_allclose(imu.angular_rate.value, np.radians(self.RATES / 131), rtol=1e-13)
        np.testing.assert_allclose(imu.specific_force.value, self.FORCES / 16384 * G, rtol=1e-13)
        np.testing.assert_allclose(imu.temperature.value, self.RAW / 340 + 36.53, rtol=1e-13)
        assert "131" in imu.origin.units

    def test_the_command_line_s_text_is_read(self, text_log):
        text = ",".join(f"{quantity}={unit}" for quantity, unit in MPU_6050.items())
        (imu,) = read(text_log(self.TEXT), ReadOptions(units=text)).imus
        np.testing.assert_allclose(imu.temperature.value, self.RAW / 340 + 36.53, rtol=1e-13)

    def test_a_sidecar_states_them_too(self, text_log):
        sidecar = "[units]\n" + "".join(f'{quantity} = "{unit}"\n' for quantity, unit in MPU_6050.items())
        (imu,) = read(text_log(self.TEXT, sidecar=sidecar)).imus
        np.testing.assert_allclose(imu.specific_force.value, self.FORCES / 16384 * G, rtol=1e-13)

    @pytest.mark.parametrize(
        ("left_out", "proposed"), [("gyro", "131LSB"), ("accel", "16384LSB/g"), ("temperature", "340LSB/C+36.53")]
    )
    def test_an_error_proposes_a_scale(self, text_log, left_out, proposed):
        units = {quantity: unit for quantity, unit in MPU_6050.items() if quantity != left_out}
        with pytest.raises(UsageError) as caught:
            read(text_log(self.TEXT), ReadOptions(units=units))
        assert proposed in str(caught.value)
        assert f"--units {left_out}=" in str(caught.value)

    @pytest.mark.parametrize("unit", ["0LSB/g", "12LSB/apples", "LSB/g", "131LSB/(deg/s"])
    def test_a_scale_that_is_none_is_refused(self, text_log, unit):
        with pytest.raises(UsageError, match="LSB"):
            read(text_log(self.TEXT), ReadOptions(units={**MPU_6050, "accel": unit}))

    @pytest.mark.parametrize("scale", ["8192LSB/g", "4096 LSB/g", "0.12207 mg/LSB"])
    def test_the_scale_of_another_range_is_caught_by_gravity(self, text_log, scale):
        with pytest.raises(UnreadableLogError, match="accel=163[78][0-9]LSB/g$"):
            read(text_log(self.TEXT), ReadOptions(units={**MPU_6050, "accel": scale}))

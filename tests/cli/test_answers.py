"""The answer of every analysis: at most 15 lines of 80 columns, the first line says what was read, the last what was written."""

import pytest

from imuwb.simulation import preset, static
from imuwb.writers import write

pytestmark = pytest.mark.slow
ANALYSES = ("noise", "allan", "psd", "lssa", "autocorrelation", "autoregressive", "health")


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    path = tmp_path_factory.mktemp("record") / "static.mcap"
    write(static(preset("3dm-gx3-25"), 300, 50, 4), path)
    return path


def panel(done):
    lines = done.out.splitlines()
    assert len(lines) <= 15
    assert all(len(line) <= 80 for line in lines if "imuwb " not in line and not line.startswith("Wrote"))
    assert lines[-1].split()[0] == "Wrote" or lines[-2].split()[0] == "Wrote"
    return lines


@pytest.mark.parametrize("analysis", ANALYSES)
def test_the_panel_is_small_and_begins_with_what_was_read(imuwb, record, analysis):
    done = imuwb(analysis, record, "-o", "x.rrd")
    assert done.code == 0
    lines = panel(done)
    assert lines[0].startswith(f"{analysis.upper()}  static.mcap: ")
    if analysis not in ("health", "lssa"):  # a record without lines
        assert [line[:6] for line in lines if line.startswith(("gyro", "accel"))][:2] == ["gyro x", "gyro y"]
    assert any(line.startswith("Next") for line in lines)
    assert not done.err


def test_everything_else_stands_before_it_if_asked_for(imuwb, record):
    short, full = imuwb("psd", record, "-o", "x.rrd").out, imuwb("psd", record, "-o", "y.rrd", "--full").out
    assert len(full.splitlines()) > 2 * len(short.splitlines())
    assert full.splitlines()[-2:-1] == short.splitlines()[-2:-1]


def test_with_the_json_on_stdout_the_panel_goes_to_stderr(imuwb, record):
    done = imuwb("psd", record, "-o", "x.rrd", "--json", "-")
    assert done.out.startswith("{")
    assert done.err.startswith("PSD  static.mcap: ")


def test_a_calibration_and_temperatures(imuwb, tmp_path):
    assert imuwb("simulate", "six-position", "--preset", "mpu-6050", "-o", "six").code == 0
    lines = panel(imuwb("calibration", "six-position", *sorted((tmp_path / "six").glob("*.mcap")), "-o", "six.rrd"))
    assert any("± " in line and " mg" in line for line in lines)
    assert any("correction:model=six.calibration.toml" in line for line in lines)
    assert (
        imuwb("simulate", "chamber", "--preset", "motionpakii", "--hours", "0.1", "--step", "45", "-o", "ch").code == 0
    )
    lines = panel(imuwb("temperature", *sorted((tmp_path / "ch").glob("*.mcap")), "-o", "ch.rrd"))
    assert "N at -30 °C" in lines[1]

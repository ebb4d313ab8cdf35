"""From a bench record to a drive, filters of the bench: the error model of a real still sensor replays a simulated and a real drive."""

import json
from pathlib import Path

import pytest

from imuwb.stochastic import ImuErrorModel, Sinusoid

pytestmark = pytest.mark.slow


def test_the_model_of_a_real_bench_record_replays_a_drive(command, shared):
    bench = shared / "static" / "adis16405_imu1.csv.gz"
    code, _, err = command("noise", bench, "--rate", "100", "--start", "7", "--end", "1807", "-o", "bench.rrd")
    assert code == 0, err
    model = ImuErrorModel.read("bench.error-model.toml")
    assert len(model.axes) == 6
    lines = {axis: [t for t in own.processes.terms if isinstance(t, Sinusoid)] for axis, own in model.axes.items()}
    assert not lines["gyro_x"]  # only the accelerometers feel the swaying bench in both halves of the record
    assert len(lines["accel_x"]) >= 2
    car = shared / "drive"
    log = (car / "derived_imu_si_gpst.csv.gz", "--gnss", car / "gnss_1934_sf.pos", "--random", "20", "--end", "600")
    code, _, err = command(
        "outage",
        *log,
        "--durations",
        "30",
        "--models",
        "15AV,full",
        "--gnss-delay",
        "0",
        "--clock-rate",
        "1",
        "--error-model",
        "bench.error-model.toml",
        "-o",
        "car.rrd",
        "--json",
        "car.json",
    )
    assert code == 0, err
    result = json.loads(Path("car.json").read_text("utf-8"))["result"]
    assert not result["failed"]
    assert result["filters"]
    for own in result["summary"]:
        assert own["models"], own["duration"]
        for found in own["models"].values():
            assert found["count"] > 15
            assert 0 < found["median_end"] < 1e4

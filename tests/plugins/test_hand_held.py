"""Calibration of a sensor that is turned by hand: positions, holds and motions from one log."""

import gzip
from dataclasses import replace

import numpy as np
import pytest

from imuwb import simulation
from imuwb.errors import MissingDataError
from imuwb.log import ImuStream, Log, Provenance, Triad
from imuwb.notes import ids
from imuwb_plugins.calibration import METHODS
from tests.recordings import recording


def run(log, **options):
    method = METHODS["multi-position"]
    return method.run([log], method.Parameters(**options))


def changed(log, sensor="accel", apply=None):
    imu = log.imu()
    field = "specific_force" if sensor == "accel" else "angular_rate"
    triad = getattr(imu, field)
    return replace(log, imus=(replace(imu, **{field: Triad(triad.time, apply(triad.value))}),))


@pytest.fixture(scope="module")
def by_hand():
    sensor = simulation.specimen(simulation.preset("mpu-6050"), 5, simulation.Tolerances())
    straight = {k: replace(a, scale_factor_nonlinear=0.0) for k, a in sensor.axes.items()}
    made = simulation.hand_held(replace(sensor, axes=straight), 5, positions=14, seconds=4.0, table=8.0, rate=50)
    return made.truth, replace(made.log, provenance=replace(made.log.provenance, path="hand.mcap"))


@pytest.mark.parametrize("raw", ["", "count"])
def test_a_sensor_turned_by_hand_has_its_gyros_calibrated_by_the_motions(by_hand, raw):
    truth, log = by_hand
    gain = 1.0
    if raw:
        gain = 7000.0
        log = changed(changed(log, apply=lambda f: 400 * f + 3e4), "gyro", lambda w: gain * w + 3e4)
    found = run(log, raw=raw)
    assert len(found.positions) == 15
    assert len(found.motions.apart) == 14
    assert np.degrees(max(found.motions.apart)) < 0.3
    assert "gyros-moved" in ids(found.notes)
    for k in "xyz":
        p = found.parameters[f"gyro_{k}"]
        scale = p["sensitivity"].scaled(1 / gain, "1").shifted(-1.0) if raw else p["scale_factor"]
        # The frame differs from the truth's by the accelerometers' couplings, up to 20 mrad, which change it by their products.
        assert abs(scale.value - truth.axes[f"gyro_{k}"].scale_factor) < 3e-3, k
        assert found.model.axes[f"gyro_{k}"].scale_factor != 0.0
    if raw:
        assert p["sensitivity"].unit == "count/(rad/s)"


def test_motions_that_a_gyro_does_not_reach_and_logs_without_any(by_hand):
    _, log = by_hand
    cut = changed(log, "gyro", lambda w: np.clip(w, -1.0, 1.0))
    found = run(cut)
    assert found.motions is None
    assert {"motions-left-out", "motions-unused"} <= set(ids(found.notes))
    assert "scale_factor" not in found.parameters["gyro_x"]
    assert "gyros" in ids(found.notes)


def test_holds_are_found_and_a_limit_is_kept(by_hand):
    _, log = by_hand
    assert "holds" in ids(run(log).notes)
    with pytest.raises(MissingDataError, match="never still for 60 s|1 position"):
        run(log, shortest=60.0)


def test_a_hand_that_sways_more_than_usual(by_hand):
    truth, _ = by_hand
    made = simulation.hand_held(truth, 5, positions=12, table=8.0, rate=50, tremor=np.radians(0.5))
    found = run(made.log)
    assert "sways" in ids(found.notes)
    assert len(found.positions) >= 9
    for k in "xyz":
        p = found.parameters[f"accel_{k}"]["bias"]
        assert abs(p.value - truth.axes[f"accel_{k}"].bias) < 5 * p.sigma


def test_the_record_of_the_published_method_needs_no_option():
    folder = recording("data", "hand_held")
    parts = []
    for sensor in ("gyro", "acc"):
        with gzip.open(folder / f"xsens_{sensor}.txt.gz", "rt") as file:
            parts.append(np.loadtxt(file))
    time = np.rint(parts[0][:, 0] * 1e9).astype(np.int64)
    imu = ImuStream("imu", *(Triad(time, part[:, 1:]) for part in parts))
    found = run(Log(Provenance("xsens", "text", "sha256:0", 0), imus=(imu,)), raw="count", gravity=9.81744)
    assert len(found.positions) == 38
    published = {"x": (33123.8, 4064.4), "y": (33275.1, 4041.6), "z": (32364.5, 4064.9)}
    for k, (bias, gain) in published.items():
        p = found.parameters[f"accel_{k}"]
        assert p["bias"].lower < bias < p["bias"].upper
        assert p["sensitivity"].lower < gain / 9.80665 < p["sensitivity"].upper
    z = found.parameters["accel_z"]
    assert z["cross_coupling_x"].lower < 9.4e-3 < z["cross_coupling_x"].upper
    assert z["cross_coupling_y"].lower < 21.4e-3 < z["cross_coupling_y"].upper
    # The factory's; the published fit has no g-sensitivity and lies up to 8 count/(rad/s) from them.
    for k, factory in (("x", 4778), ("y", 4758), ("z", 4766)):
        assert found.parameters[f"gyro_{k}"]["sensitivity"].value == pytest.approx(factory, abs=10)

"""The error model that an analysis makes of a random record is read as it is written."""

import os
import sys
from dataclasses import replace

import numpy as np
import pytest

from imuwb.stochastic import ImuErrorModel, RateRamp
from imuwb_plugins import allan, autoregressive, noise

N, RATE = 6000, 100.0


def record(seed):
    """Return six axes that have white noise, and each something else, of a random size and sign."""
    rng = np.random.default_rng(seed)
    t = np.arange(N) / RATE

    def kinds(size):
        white = rng.standard_normal(N) * size
        return (
            white * 0.0, white + t * size * rng.uniform(-1, 1), white - t * size * 0.1,
            white + np.cumsum(rng.standard_normal(N)) * size * 0.1, np.round(white * 0.6 / size) * size,
            white + size * np.sin(2 * np.pi * rng.uniform(0.5, 40) * t), np.diff(white, prepend=0.0),
            white + (t > rng.uniform(10, 50)) * size, np.round(white * 0.1 / size) * size,
        )  # fmt: skip

    chosen = [kinds(10 ** rng.uniform(-5, 0))[k] for k in rng.choice(9, 6, replace=False)]
    return np.stack(chosen[:3], axis=1), np.stack(chosen[3:], axis=1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("analysis", "options"),
    [(allan, {}), (allan, {"model": "headline", "choose": True}), (autoregressive, {})],
    ids=["allan", "headline", "autoregressive"],
)
def test_the_model_of_any_record_is_read_as_it_is_written(make_log, analysis, options, seed):
    model = analysis.error_model(analysis.run([make_log(*record(seed))], analysis.Parameters(**options)))
    assert ImuErrorModel.from_toml(model.to_toml()) == model


def test_a_ramp_keeps_its_sign(make_log):
    rng = np.random.default_rng(1)
    n = 60_000
    accel = rng.standard_normal((n, 3)) * 1e-2
    accel[:, 0] -= 2e-5 * np.arange(n) / RATE
    log = make_log(accel=accel)
    model = noise.error_model(noise.run([log], noise.Parameters(denoise=0, choose=False)))
    again = ImuErrorModel.from_toml(model.to_toml())
    assert again == model
    place, ramp = next((i, t) for i, t in enumerate(again.axes["accel_x"].processes.terms) if isinstance(t, RateRamp))
    lower, upper = again.axes["accel_x"].intervals[f"{place}.R"]
    assert lower < ramp.R < upper < 0
    assert lower < -2e-5 < upper


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_no_utf_8_is_no_obstacle(command, tmp_path):
    rows = np.random.default_rng(0).normal(0, 1e-3, (500, 3))
    text = "\n".join(f"{i / 100},{x},{y},{z}" for i, (x, y, z) in enumerate(rows))
    name = os.fsdecode(b"log\xe9.csv")
    (tmp_path / name).write_text("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n" + text, "utf-8")
    code, _, err = command("allan", name, "--save-model", "m.toml", "--json", "m.json", "-o", "m.rrd")
    assert code == 0, err
    assert ImuErrorModel.read(tmp_path / "m.toml").axes


def test_the_model_of_several_logs_is_read_as_it_is_written(make_log):
    logs = [make_log(*record(seed)) for seed in (1, 2, 3)]
    logs = [replace(x, provenance=replace(x.provenance, path=f"{i}.csv", hash=f"{i}")) for i, x in enumerate(logs)]
    model = noise.error_model(noise.run(logs, noise.Parameters(choose=False)))
    assert ImuErrorModel.from_toml(model.to_toml()) == model

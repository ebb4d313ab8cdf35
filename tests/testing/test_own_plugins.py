"""Every plugin of imuwb keeps the contract that others are asked to keep."""

from dataclasses import replace
from importlib.metadata import entry_points

import numpy as np
import pytest

from imuwb.simulation import Temperature, preset, rate_table, six_position, static
from imuwb.testing import check, methods_of
from imuwb.testing import logs as made
from imuwb.writers import write
from tests.fuzz import seeds

#: options without which a plugin does not run, or runs long
OPTIONS = {
    "allan": {"estimators": "false", "lines": "false"},
    "autoregressive": {"orders": "3"},
    "lssa": {"highest": "2", "peaks": "1"},
    "temperature": {"function": "linear", "lag": "0"},
    "bandwidth": {"cutoff": "10"},
    "decimate": {"factor": "2"},
    "kaiser": {"fc": "10"},
    "noise": {"choose": "false"},
    "calibration rate-table": {"rates": "-20,20"},
}
#: reader -> a sound small log of its format
LOGS = {"bag": "lz4.bag", "csv": "imu.csv", "mcap": "zstd.mcap", "rtklib": "fixes.pos", "ubx": "log.ubx"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("own")


def plugins(group):
    return {
        name: plugin
        for point in entry_points(group=f"imuwb.{group}")
        if point.value.startswith(("imuwb.", "imuwb_plugins."))
        for name, plugin in methods_of(point.load(), point.name).items()
    }


def required(name, **given):
    plugin = {**plugins("analyses"), **plugins("conditioners")}[name]
    report = check(plugin, name, **{"parameters": OPTIONS.get(name), **given})
    report.require()
    return {one.rule: one.state for one in report.outcomes}


@pytest.mark.parametrize("name", sorted(set(plugins("conditioners")) - {"correction"}))
def test_conditioners(name):
    assert required(name)["causality"] == "passed"


def test_the_correction(folder):
    path, model = folder / "model.toml", preset("adis16465")
    axes = {name: replace(axis, bias=0.01, scale_factor=1e-3) for name, axis in model.axes.items()}
    path.write_text(replace(model, axes=axes).to_toml(), "utf-8")
    assert required("correction", parameters={"model": str(path)})["causality"] == "passed"


@pytest.mark.parametrize(
    "name", ["allan", "autocorrelation", "autoregressive", "calibration multi-position", "health", "lssa", "psd"]
)
def test_analyses(name):
    assert required(name)["units"] == "passed"


@pytest.mark.slow
def test_the_noise_analysis(folder):
    log = write_one(made.one_axis(made.still()), folder / "still.csv")
    assert required("noise", logs=[log])["units"] == "passed"


@pytest.fixture(scope="module")
def positions(folder):
    turned = six_position(preset("adis16465"), 1, seconds=5, rate=50, one_log=True).logs
    return write_one(next(iter(turned.values())), folder / "six.mcap")


def write_one(log, path):
    write(log, path)
    return path


def test_six_positions(positions):
    assert required("calibration six-position", logs=[positions])["units"] == "passed"


def test_the_rate_table(folder):
    turned = rate_table(preset("adis16465"), 1, np.radians([-20.0, 20.0]), seconds=4, rate=50).logs
    logs = [write_one(log, folder / f"table{i}.mcap") for i, log in enumerate(turned.values())]
    assert required("calibration rate-table", logs=logs)["units"] == "passed"


@pytest.mark.slow
def test_the_temperature(folder):
    logs = [
        write_one(
            made.one_axis(static(preset("adis16465"), 110, 10, i, celsius=Temperature(((0.0, c),)))),
            folder / f"{c:g}.csv",
        )
        for i, c in enumerate((0.0, 20.0, 40.0))
    ]
    assert required("temperature", logs=logs)["units"] == "passed"


def test_the_replay_lacks_a_log_that_is_simulated():
    """Its simulated drive is too short for an outage; the samples' drive is replayed in the tests of the demo."""
    states = required("outage", parameters={"durations": "10", "models": "15AV"})
    assert states["parameters"] == "passed"


def test_the_papers_make_their_own_logs():
    for name in plugins("analyses"):
        if name.startswith("reproduce "):
            assert required(name)["runs"] == "not applicable"


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    for name, content in seeds.write(tmp_path_factory.mktemp("seeds")).items():
        (folder / name).write_bytes(content)
    return folder


@pytest.mark.parametrize("name", sorted(plugins("readers")))
def test_readers(name, logs):
    given = [logs / LOGS[name]] if name in LOGS else []
    report = check(plugins("readers")[name], name, logs=given)
    report.require()
    assert len(report.outcomes) == (7 if given else 4)

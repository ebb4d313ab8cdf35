"""How a run over a fleet ends where no log gives a result."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

SHORT_LOG = "time [s],gx [rad/s],gy [rad/s],gz [rad/s],ax [m/s2],ay [m/s2],az [m/s2]\n" + "".join(
    f"{t / 100},0,0,0.1,0,0,9.8\n" for t in range(4)
)


@pytest.mark.parametrize(
    ("content", "code"), [("no log at all", 4), ("", 4), (SHORT_LOG, 3), (SHORT_LOG.replace(" [rad/s]", ""), 2)]
)
def test_a_fleet_without_any_result_is_an_error(imuwb, tmp_path, monkeypatch, content, code):
    monkeypatch.chdir(tmp_path)
    Path("logs").mkdir()
    for name in "ab":
        Path("logs", f"{name}.csv").write_text(content + "\n" * (name == "b"))
    done = imuwb("fleet", "noise", "logs", "-o", "results", "--workers", "0")
    assert done.code == code, done.err
    assert "imuwb: no log gave a result; results/quarantine.parquet has the reason of each" in done.err
    assert "fleet report" not in done.err
    assert pq.read_table("results/quarantine.parquet").num_rows == 2
    assert imuwb("fleet", "noise", "logs", "-o", "results", "--workers", "0").code == code


def test_a_fleet_of_unknown_sensors_suggests_no_report(imuwb, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("logs").mkdir()
    rng = np.random.default_rng(1)
    for name in "ab":
        table = np.c_[np.arange(3000) / 100, 0.1 * rng.standard_normal((3000, 6)) + [0, 0, 0, 0, 0, 9.8]]
        np.savetxt(f"logs/{name}.csv", table, delimiter=",", comments="", header=SHORT_LOG.partition("\n")[0])
    done = imuwb("fleet", "allan", "logs", "-o", "results", "--workers", "0")
    assert (done.code, "fleet report results\n" in done.err) == (0, False), done.err
    done = imuwb("fleet", "allan", "logs", "-o", "results", "--workers", "0", "--group", r"(?P<serial>[ab])\.csv")
    assert (done.code, "imuwb fleet report results" in done.err) == (0, True), done.err


def test_wrong_options_end_a_fleet_after_a_few_logs(imuwb, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("logs").mkdir()
    for number in range(8):
        Path(f"logs/{number}.csv").write_text(SHORT_LOG + "\n" * number)
    done = imuwb("fleet", "outage", "logs", "-o", "results", "--workers", "0", "--error-model", "models/{serail}.toml")
    assert (done.code, "{serail} is no part of an identity" in done.err) == (2, True), done.err
    assert not Path("results").exists()
    done = imuwb("fleet", "outage", "logs", "-o", "results", "--workers", "0")
    assert (done.code, "--error-model" in done.err, "first 5 logs" in done.err) == (2, True, True), done.err


def test_bounds_are_finite_and_results_are_no_file(imuwb, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text(SHORT_LOG)
    for given, rule in ((("--task-time", "inf"), "above 0, and finite"), (("--task-memory", "0.001"), "0.1 or more")):
        done = imuwb("fleet", "noise", "a.csv", "-o", "results", *given)
        assert (done.code, f"must be {rule}" in done.err) == (2, True), done.err
    done = imuwb("fleet", "noise", "a.csv", "-o", "a.csv")
    assert (done.code, "a.csv: this is a file; give a folder" in done.err) == (2, True), done.err
    done = imuwb("fleet", "noise", "a.csv", "-o", "results", "--workers", "9")
    assert "1 process" in done.err

"""--truth: the drift against trajectories of other files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.geodesy import quaternion_of_rotation, rotation_of_euler
from imuwb.log import GnssStream, Log, Provenance
from imuwb.notes import ids
from imuwb.writers import write
from imuwb.writers.trajectory import write_trajectory
from imuwb_plugins import outage

from .made import KNOWN, stated

pytestmark = pytest.mark.slow

AT = {"models": "none", "at": "130:10,150:10"}


@pytest.fixture(scope="module")
def own(log, toml):
    return outage.run([log], stated(error_model=toml, **AT))


@pytest.fixture(scope="module")
def without(log):
    return replace(log, references=())


def ends(result):
    return [o.models["none"].end for o in result.outages]


def judged(without, toml, path, **options):
    return outage.run([without], stated(error_model=toml, **AT, truth=path, **options))


@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_a_file_of_imuwb_is_the_logs_own_truth(log, without, own, toml, tmp_path, suffix):
    path = tmp_path / f"truth{suffix}"
    write(Log(Provenance("t", "t", "", 0), references=log.references), path)
    found = judged(without, toml, path)
    assert ends(found) == pytest.approx(ends(own), rel=1e-9)
    assert found.reference == f"{'reference' if suffix == '.csv' else 'truth'} of {path.name}"
    assert "truth" in ids(found.notes)


def test_tum_in_its_own_frame(log, without, own, toml, tmp_path):
    truth = log.references[0]
    quaternion = np.array([quaternion_of_rotation(c) for c in rotation_of_euler(truth.attitude)])
    write_trajectory(truth, quaternion, tmp_path / "t.tum")
    found = judged(without, toml, tmp_path / "t.tum")
    assert "placed" in ids(found.notes)
    assert ends(found) == pytest.approx(ends(own), abs=1.5)


def test_sigmas_of_the_reference_widen_the_covariance(log, without, own, toml, tmp_path):
    truth = log.references[0]
    g = GnssStream("gnss", truth.time, truth.position, truth.velocity, np.full((len(truth), 3), 5.0))
    write(Log(Provenance("t", "t", "", 0), gnss=(g,)), tmp_path / "t.csv")
    found = judged(without, toml, tmp_path / "t.csv")
    assert ends(found) == pytest.approx(ends(own), rel=1e-9)
    for a, b in zip(found.outages, own.outages, strict=True):
        assert a.models["none"].sigma ** 2 == pytest.approx(b.models["none"].sigma ** 2 + 50, rel=1e-6)


def test_the_delay_of_the_truth(log, without, own, toml, tmp_path):
    truth = log.references[0]
    late = replace(truth, time=truth.time + 300_000_000)
    write(Log(Provenance("t", "t", "", 0), references=(late,)), tmp_path / "t.csv")
    assert ends(judged(without, toml, tmp_path / "t.csv", truth_delay=0.3)) == pytest.approx(ends(own), rel=1e-6)
    assert ends(judged(without, toml, tmp_path / "t.csv")) != pytest.approx(ends(own), rel=1e-3)


def test_the_logs_own_truth_may_be_late_too(log, without, own, toml):
    truth = log.references[0]
    late = replace(log, references=(replace(truth, time=truth.time + 300_000_000),))
    found = outage.run([late], stated(error_model=toml, **AT, truth_delay=0.3))
    assert ends(found) == pytest.approx(ends(own), rel=1e-6)
    with pytest.raises(UsageError, match="no truth of its own"):
        outage.run([without], stated(error_model=toml, **AT, truth_delay=0.3))


def test_a_stated_truth_that_cannot_judge_is_an_error(log, without, toml, tmp_path):
    """Its steps of 300 m contradict its own velocities; the default reference would fall back to a smoothed run."""
    truth = log.references[0]
    position = truth.position.copy()
    position[:, 0] += 5e-5 * ((truth.time - truth.time[0]) // 9_000_000_000 % 2)  # 300 m to the north and back
    path = tmp_path / "broken.csv"
    write(Log(Provenance("t", "t", "", 0), references=(replace(truth, position=position),)), path)
    with pytest.raises(MissingDataError, match=r"broken\.csv is refused as a reference.*--reference smoothed"):
        judged(without, toml, path)
    assert judged(without, toml, path, reference="own").reference == "none without outage"


def test_an_estimate_of_the_vehicle_is_named_as_such(log, toml):
    truth = log.references[0]
    ekf = replace(truth, name="POS", origin=replace(truth.origin, frame="NED, estimated by the vehicle's own filter"))
    found = outage.run([replace(log, references=(ekf,))], stated(error_model=toml, **AT, reference="ekf"))
    assert found.reference.startswith("POS, an estimate")
    assert "reference-is-estimate" in ids(found.notes)


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--truth-origin", "1,2,3"), 2, "--truth FILE"),
        (("--truth", "early.csv", "--truth-delay", "-1704067300", "--truth-origin", "1,2,3"), 2, "--truth-origin out"),
        (("--truth", "no.csv"), 4, "no such file"),
        (("--truth", "three.txt"), 2, "3 numbers"),
        (("--truth", "early.csv"), 3, "--truth-delay"),
        (("--truth-axes", "flu"), 2, "enu"),
        (("--reference", "nobody"), 2, "--reference nobody"),
    ],
)
def test_exit_codes(command, mcap, toml, options, code, words):
    Path("three.txt").write_text("1 2 3\n4 5 6\n", "utf-8")
    Path("early.csv").write_text("time_s,latitude_deg,longitude_deg,height_m\n1,45,7,0\n2,45,7,0\n", "utf-8")
    found, _, err = command(
        "outage", mcap, "--error-model", toml, "--models", "none", "--at", "150:10", *KNOWN, *options, "-o", "o.rrd"
    )
    assert (found, words in err) == (code, True), err
    assert "Traceback" not in err
    assert not Path("o.rrd").exists()


def test_the_command(command, mcap, toml, log):
    write(Log(Provenance("t", "t", "", 0), references=log.references), "t.csv")
    code, out, err = command(
        "outage", mcap, "--error-model", toml, "--models", "none", "--at", "150:10", "--truth", "t.csv", *KNOWN, "-o", "o.rrd",
        "--json", "o.json",
    )  # fmt: skip
    assert code == 0, err
    assert "reference of t.csv" in out
    content = json.loads(Path("o.json").read_text("utf-8"), parse_constant=pytest.fail)
    assert content["result"]["reference"] == "reference of t.csv"
    assert content["params"]["truth"] == "t.csv"

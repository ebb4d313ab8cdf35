"""Other engines in the tables of a replay: solutions in files, and commands."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.geodesy import ned_scale
from imuwb.log import GnssStream, Log, Provenance
from imuwb.notes import ids
from imuwb.replay import Outage, fixes_outside
from imuwb.writers import write
from imuwb_plugins import outage

from .made import KNOWN, Shown, stated

pytestmark = pytest.mark.slow

AT = "130:10,150:10,170:10"
#: Repeats the last fix with its velocity; its sigma grows by 1 m/s. The last argument is a text that makes it fail.
ENGINE = """
import csv, math, sys, time
imu, gnss, output, fault = sys.argv[1:]
if fault == "slow": time.sleep(60)
if fault == "silent": sys.exit(0)
if fault == "broken":
    sys.stderr.write("first\\n\\x1b[31mno covariance\\x07 is positive\\n\\n")
    sys.exit(3)
last = list(csv.DictReader(open(gnss)))[-1]
start = int(last["time_ns"])
end = int(open(imu).read().splitlines()[-1].split(",")[0])
if fault == "late" and start % 10**12 // 10**9 % 100 > 40: sys.exit(9)
lat, lon, height, vn, ve = (float(last[k]) for k in
    ("latitude_rad", "longitude_rad", "height_m", "velocity_north_m_s", "velocity_east_m_s"))
names = "time_ns,latitude_rad,longitude_rad,height_m,velocity_north_m_s,velocity_east_m_s,velocity_down_m_s"
with open(output, "w") as file:
    print(names + (",sigma_north_m,sigma_east_m,sigma_down_m" if fault != "bare" else ""), file=file)
    for t in range(start, end, 200_000_000):
        s = (t - start) / 1e9
        row = [t, lat + vn * s / 6378137, lon + ve * s / 6378137 / math.cos(lat), height, vn, ve, 0]
        print(*(row + ([1 + s] * 3 if fault != "bare" else [])), sep=",", file=file)
"""


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    path = tmp_path_factory.mktemp("engine") / "straight.py"
    path.write_text(ENGINE, "utf-8")
    return lambda fault="none": f"{sys.executable} {path} {{imu}} {{gnss}} {{output}} {fault}"


def judged(log, toml, at=AT, models="full", **options):
    return outage.run([log], stated(error_model=toml, models=models, at=at, **options))


def off(log, north, seconds=None):
    """Return the truth, off by some metres north, and with sigmas of 1 m."""
    truth = log.references[0]
    shift = np.array([north, 0, 0]) / ned_scale(truth.position[:, 0], truth.position[:, 2])
    if seconds is not None:
        time = (truth.time - log.zero) / 1e9
        shift *= ((time > seconds[0]) & (time < seconds[1]))[:, None]
    return replace(truth, position=truth.position + shift, position_sigma=np.ones((len(truth), 3)))


def save(stream, path):
    kind = {"gnss": (stream,)} if isinstance(stream, GnssStream) else {"references": (stream,)}
    write(Log(Provenance("s", "s", "", 0), **kind), path)
    return path


def test_a_solution_in_the_same_outages(log, toml, tmp_path):
    found = judged(log, toml, solution={"other": save(off(log, 3.0), tmp_path / "o.csv")})
    own = found.summary[0].models["other"]
    assert (own.count, own.effective_count) == (3, 3)
    assert own.median_end == pytest.approx(3.0, abs=1e-3)
    # 3 m off north with a sigma of 1 m.
    assert own.nees_per_dof == pytest.approx(4.5, rel=1e-3)
    assert own.coverage95 == 0
    assert [o.models["other"].end for o in found.outages] == pytest.approx([3.0] * 3, abs=1e-3)
    assert found.summary[0].paired[-1].model == "other"
    assert found.engines[0].scored == "outages"
    assert "engine-one-run" in ids(found.notes)
    shown = Shown()
    outage.draw(found, shown)
    assert "other" in [row[0] for row in shown.tables[0].rows]


def test_without_sigmas_there_is_no_nees(log, toml, tmp_path):
    truth = replace(off(log, 3.0), position_sigma=None, attitude=None)
    bare = GnssStream("g", truth.time, truth.position, truth.velocity)
    found = judged(log, toml, solution={"other": save(bare, tmp_path / "o.csv")})
    own = found.summary[0].models["other"]
    assert (own.nees_per_dof, own.coverage95, own.median_heading, own.consistency) == (None, None, None, ())
    assert "engine-without-sigmas" in ids(found.notes)
    assert not any("other" in v for v in found.verdicts)


def test_a_file_for_each_outage(log, toml, tmp_path):
    for number, (start, north) in enumerate(((130, 1.0), (150, 2.0)), 1):
        save(off(log, north, (start - 0.5, start + 11)), tmp_path / f"s{number}.csv")
    found = judged(log, toml, solution={"other": tmp_path / "s{outage}.csv"})
    assert [o.models["other"].end if "other" in o.models else None for o in found.outages] == [
        pytest.approx(1.0, abs=1e-3), pytest.approx(2.0, abs=1e-3), None,
    ]  # fmt: skip
    (info,) = found.engines
    assert (info.tried, len(info.failures)) == (3, 1)
    assert "outage at 170 s" in info.failures[0]
    named = judged(log, toml, at="150:10", solution={"other": tmp_path / "s{start}.csv"})
    assert named.failed["other"].startswith("1 of 1 without a solution")


def test_over_the_whole_run_where_outages_overlap_or_the_user_says_so(log, toml, tmp_path):
    path = save(off(log, 2.0), tmp_path / "o.csv")
    swept = outage.run([log], stated(error_model=toml, models="full", durations="10", solution={"other": path}))
    asked = judged(log, toml, solution={"other": Path(f"whole:{path}")})
    for found in (swept, asked):
        assert found.engines[0].scored == "whole run"
        assert found.whole_run["other"].median_end == pytest.approx(2.0, abs=1e-3)
        assert found.whole_run["other"].nees_per_dof == pytest.approx(2.0, rel=1e-2)
        assert 0 < found.whole_run["full"].median_end < 3
        assert "other" not in found.summary[0].models
        assert "engine-whole-run" in ids(found.notes)
    shown = Shown()
    outage.draw(asked, shown)
    assert "Errors over the whole run" in [table.title for table in shown.tables]


def test_a_local_frame_is_fitted_to_the_fixes_outside_the_outages(log, toml, tmp_path):
    from imuwb.geodesy import quaternion_of_rotation, rotation_of_euler
    from imuwb.writers.trajectory import write_trajectory

    truth = off(log, 40.0, (129.9, 141))
    quaternion = np.array([quaternion_of_rotation(c) for c in rotation_of_euler(truth.attitude)])
    write_trajectory(truth, quaternion, tmp_path / "t.tum")
    found = judged(log, toml, solution={"slam": tmp_path / "t.tum"})
    assert [o.models["slam"].end for o in found.outages] == pytest.approx([40.0, 0, 0], abs=2.0)


def test_a_command_outage_by_outage(log, toml, script):
    found = judged(log, toml, filter_command=script())
    own = found.summary[0].models["straight"]
    assert own.count == 3
    assert own.median_end > 1
    assert own.nees_per_dof is not None
    assert found.engines[0].tried == 3
    bare = judged(log, toml, filter_command=script("bare"), filter_runs=2)
    assert (bare.summary[0].models["straight"].count, bare.engines[0].tried) == (2, 2)
    assert bare.summary[0].models["straight"].nees_per_dof is None


def test_the_engine_does_not_see_the_outage(log, toml, tmp_path):
    script = tmp_path / "look.py"
    script.write_text(
        "import csv, shutil, sys\n"
        f"shutil.copy(sys.argv[1], r'{tmp_path}/imu.csv'); shutil.copy(sys.argv[2], r'{tmp_path}/gnss.csv')\n", "utf-8"
    )  # fmt: skip
    judged(log, toml, at="150:10", filter_command=f"{sys.executable} {script} {{imu}} {{gnss}} {{output}}")
    ends = {
        name: (int((tmp_path / f"{name}.csv").read_text("utf-8").splitlines()[-1].split(",")[0]) - log.zero) / 1e9
        for name in ("imu", "gnss")
    }
    assert ends["imu"] == pytest.approx(161.0, abs=0.05)
    assert ends["gnss"] == pytest.approx(150.0, abs=0.05)


def test_the_last_fix_before_the_outage_is_kept_though_its_stamp_is_late(log):
    gnss = log.gnss[0]
    late = replace(gnss, time=gnss.time + 300_000_000)
    ends = [(fixes_outside(late, log.zero, [Outage(150.0, 1e9)], d).time[-1] - log.zero) / 1e9 for d in (0.0, 0.3)]
    assert ends == pytest.approx([149.3, 150.3], abs=0.05)


@pytest.mark.parametrize(
    ("fault", "options", "words"),
    [
        ("broken", {}, "exit code 3: [31mno covariance is positive"),
        ("silent", {}, "wrote no output"),
        ("slow", {"filter_timeout": 0.5}, "stopped after 0.5 s"),
    ],
)
def test_a_failing_engine_is_a_row_that_says_so(log, toml, script, fault, options, words):
    found = judged(log, toml, at="150:10", filter_command=script(fault), **options)
    assert words in found.failed["straight"]
    assert "engine-failed" in ids(found.notes)
    assert "\x1b" not in "".join(found.notes)
    assert "full" in found.summary[0].models
    shown = Shown()
    outage.draw(found, shown)
    assert ("straight", "cannot run") in [row[:2] for row in shown.tables[0].rows]


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("mine {imu} {gnss}", "each of {imu}, {gnss} and {output} once"),
        ("mine {imu} {imu} {gnss} {output}", "once"),
        ("mine {imu} {gnss} {output} {other}", "once"),
        ("no-such-program {imu} {gnss} {output}", "there is no program 'no-such-program'"),
        ("mine '{imu} {gnss} {output}", "No closing quotation"),
    ],
)
def test_commands_that_cannot_be_run(log, toml, command, words):
    with pytest.raises(UsageError, match=words):
        judged(log, toml, filter_command=command)


def test_no_shell_reads_the_command(log, toml, tmp_path):
    command = f"{sys.executable} -c pass {{imu}} {{gnss}} {{output}} ; touch {tmp_path}/made"
    judged(log, toml, at="150:10", filter_command=command)
    assert not (tmp_path / "made").exists()


def test_names_of_filters_are_taken(log, toml, tmp_path):
    with pytest.raises(UsageError, match="a filter has this name"):
        judged(log, toml, solution={"full": save(off(log, 3.0), tmp_path / "o.csv")})


def test_the_command_line(command, mcap, toml, log, script):
    save(off(log, 2.0), Path("o.csv"))
    code, out, err = command(
        "outage", mcap, "--error-model", toml, "--models", "full", "--at", "150:10", "--solution", "kf=o.csv,no=none.nav",
        "--filter-command", script(), "-o", "o.rrd", "--json", "o.json", "--full", *KNOWN,
    )  # fmt: skip
    assert code == 0, err
    assert "straight" in out
    assert "none.nav: there is no such file" in out + err
    result = json.loads(Path("o.json").read_text("utf-8"), parse_constant=pytest.fail)["result"]
    assert set(result["summary"][0]["models"]) == {"full", "kf", "straight"}
    assert [e["name"] for e in result["engines"]] == ["kf", "no", "straight"]
    code, _, err = command("outage", mcap, "--error-model", toml, "--solution", "o.csv", "-o", "p.rrd")
    assert (code, "--solution" in err) == (2, True)

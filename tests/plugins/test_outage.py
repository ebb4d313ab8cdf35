"""Outage replay as a plugin: its options, its JSON against the contract, what it draws, and the command line."""

import json
import math
import re
import shlex
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.cli import main
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES
from imuwb.review.document import document, plain
from imuwb.simulation import Receiver, drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, FlickerNoise, GaussMarkov, ImuErrorModel, RandomWalk, Sum, WhiteNoise
from imuwb.writers import write
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text("utf-8")


def sensor(flicker=False):
    """Return an error model of a cheap sensor, with turn-on biases."""
    axes = {}
    for axis in AXES:
        a = axis[0] == "a"
        slow = FlickerNoise(1e-3 if a else 1e-4) if flicker else GaussMarkov(2e-3 if a else 1e-4, 60.0)
        axes[axis] = AxisModel(
            Sum((WhiteNoise(2e-3 if a else 2e-4), slow, RandomWalk(1e-5 if a else 1e-7), Constant(0.03 if a else 1e-3)))
        )
    return ImuErrorModel("cheap", axes)


@pytest.fixture(scope="module")
def toml(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "m.toml"
    path.write_text(sensor().to_toml(), "utf-8")
    return path


@pytest.fixture(scope="module")
def log():
    return drive(sensor(), mixed_route(240, 3), 1, rate=50.0)


@pytest.fixture(scope="module")
def mcap(log, tmp_path_factory):
    path = tmp_path_factory.mktemp("drive") / "drive.mcap"
    write(log, path)
    return path


@pytest.fixture(scope="module")
def few(log, toml):
    """Return seven outages of the paper's filters without AR, and those of a sweep."""
    at = ",".join(f"{t}:10" for t in range(130, 200, 10))
    return outage.run([log], Parameters(error_model=toml, models="none,15AV,18AV,18AVWD,full", at=at))


@pytest.fixture(scope="module")
def swept(log, toml):
    return outage.run([log], Parameters(error_model=toml, models="none,full", durations="5,10", settling=40.0))


class Shown:
    """A review that remembers what it was shown."""

    def __init__(self) -> None:
        self.tabs, self.figures, self.tables, self.notes, self.tracks, self.logged = [], [], [], [], [], []
        self.all_series, self.charts = [], []
        self.recording = SimpleNamespace(log=lambda path, *_, **__: self.logged.append(path))

    def tab(self, name):
        self.tabs.append(name)

    def figure(self, figure):
        self.figures.append(figure)

    def table(self, table):
        self.tables.append(table)

    def note(self, text):
        self.notes.append(text)

    def series(self, series):
        self.all_series.append(series)

    def map_track(self, name, *_):
        self.charts.append(name)

    def track(self, name, position, _color, label=""):
        self.tracks.append((name, np.array(position), label))


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Run ``imuwb`` in an empty folder; return its exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")

    def run(*arguments):
        monkeypatch.setattr("sys.argv", ["imuwb", *map(str, arguments)])
        code = 0
        try:
            main()
        except SystemExit as leaving:
            code = leaving.code or 0
        return code, *capsys.readouterr()

    return run


# What may be asked


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"models": "none,18av"}, r"models: no filter '18av'; there are none,15AV,18AV,18AVWD,15AR,27AR,full"),
        ({"models": "none,none"}, r"models: one is named twice; there are none,15AV,"),
        ({"models": " , "}, r"models: none is named; there are none,15AV,"),
        ({"durations": "30;60"}, r"durations is '30;60'; write numbers with commas between"),
        ({"durations": ""}, r"durations is ''; it must be one or more finite numbers"),
        ({"durations": "inf"}, r"durations is 'inf'; it must be one or more finite numbers"),
        ({"durations": "1.9"}, r"durations: an outage of 1.9 s; it must be 2 to 600 s long"),
        ({"durations": "30,601"}, r"durations: an outage of 601 s; it must be 2 to 600 s long"),
        ({"at": "120"}, r"at: '120' is no START:DURATION \(a colon is missing\); write 200:30,430:60"),
        ({"at": "120:30:5"}, r"at: '120:30:5' is no START:DURATION; write 200:30,430:60"),
        ({"at": "a:30"}, r"at: 'a:30' is no START:DURATION; write"),
        ({"at": "nan:30"}, r"at: a start is no number"),
        ({"at": "10:nan"}, r"at: an outage of nan s; it must be 2 to 600 s long"),
        ({"at": "10:30,20:1"}, r"at: an outage of 1 s; it must be 2 to 600 s long"),
        ({"mounting": "0,0"}, r"mounting is '0,0'; it must be 3 finite numbers"),
        ({"mounting": "0,0,north"}, r"mounting is '0,0,north'; write numbers with commas between"),
        ({"lever_arm": "0,0,nan"}, r"lever_arm is '0,0,nan'; it must be 3 finite numbers"),
        ({"gnss_delay": "soon"}, r"gnss_delay is 'soon'; write numbers with commas between"),
        ({"gnss_delay": "0.1,0.2"}, r"gnss_delay is '0.1,0.2'; it must be 1 finite number$"),
        ({"clock_rate": "2"}, r"clock_rate is 2; it must be near 1"),
        ({"clock_rate": "nan"}, r"clock_rate is 'nan'; it must be 1 finite number$"),
        ({"scale_factor": "2"}, r"scale_factor is '2'; it must be 2 finite numbers"),
        ({"scale_factor": "2,51"}, r"scale_factor is '2,51' %; sigmas are 0 to 50"),
        ({"scale_factor": "-1,2"}, r"scale_factor is '-1,2' %; sigmas are 0 to 50"),
        ({"turn_on": "0.1"}, r"turn_on is '0.1'; it must be 2 finite numbers"),
        ({"turn_on": "-0.1,1"}, r"turn_on is '-0.1,1'; sigmas are 0 to 1000 deg/s and 0 to 100 m/s²"),
        ({"turn_on": "0,101"}, r"turn_on is '0,101'; sigmas are 0 to 1000 deg/s and 0 to 100 m/s²"),
        ({"at": ","}, r"at is ','; write START:DURATION,... such as 200:30,430:60"),
        ({"velocity_delay": math.nan}, r"velocity_delay is nan s; it must be within 10 s of 0"),
        ({"skew": -1.1}, r"skew is -1.1 s; it must be within 1 s of 0"),
        ({"gnss_delay": "10.5"}, r"gnss_delay is 10.5 s; it must be within 10 s of 0"),
        ({"lever_arm": "0,-501,0"}, r"lever_arm is 0,-501,0 m; no vehicle is longer than 500 m"),
        ({"wavelet": "0..3"}, r"wavelet is '0..3'; write levels from 1 to 12, as 3..8 or 4,6"),
        ({"wavelet": "8..3"}, r"wavelet is '8..3'; write levels"),
        ({"wavelet": "4,x"}, r"wavelet is '4,x'; write levels"),
        ({"degrade": "shake=3"}, r"degrade: 'shake=3'; write noise=M,jump=M,every=S"),
        ({"degrade": "noise=-1"}, r"degrade: 'noise=-1' cannot be"),
        ({"level": 95.0}, r"level is 95.0; it must be at least 0.5 and below 1"),
        ({"level": 0.4}, r"level is 0.4; it must be at least 0.5 and below 1"),
        ({"straight": -0.1}, r"straight is -0.1; it must be 0 or more"),
        ({"still": math.nan}, r"still is nan; it must be 0 or more"),
        ({"speed": math.inf}, r"speed is inf; it must be 0 or more"),
        ({"settling": -1.0}, r"settling is -1.0; it must be 0 or more"),
        ({"every": 0}, r"every is 0 samples; it must be 1 to 100"),
        ({"every": 101}, r"every is 101 samples; it must be 1 to 100"),
        ({"random": -1}, r"random is -1 starts; it must be 0 or more"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked(options, words):
    with pytest.raises(ValueError, match=words):
        Parameters(**options)


@pytest.mark.parametrize(
    "options",
    [
        {"velocity_delay": math.nan}, {"velocity_delay": math.inf}, {"skew": math.inf}, {"skew": math.nan},
        {"turn_on": "1e300,1"}, {"lever_arm": "1e9,0,0"}, {"gnss_delay": "1e9"}, {"at": ","},
    ],
)  # fmt: skip
def test_what_should_not_be_asked(options):
    with pytest.raises(ValueError, match=next(iter(options))):
        Parameters(**options)


def test_what_is_asked():
    asked = Parameters(
        models=" none, full ", durations="60,30,60", at="300:60, 120:30,120:30,", mounting="180,6.79,-185.35",
        lever_arm="0,-.05,0", gnss_delay="0.15", clock_rate="1.000275", scale_factor="2,1", turn_on="0.2,0.1",
    )  # fmt: skip
    assert asked.names() == ("none", "full")
    assert asked.lengths() == (30.0, 60.0)
    assert asked.outages() == ((120.0, 30.0), (300.0, 60.0))
    assert asked.angles() == (180.0, 6.79, -185.35)
    assert asked.lever() == (0.0, -0.05, 0.0)
    assert (asked.delay(), asked.rate()) == (0.15, 1.000275)
    assert asked.scale_factors() == (0.02, 0.01)
    assert asked.turn_on_sigmas() == (pytest.approx(math.radians(0.2)), 0.1)
    auto = Parameters(gnss_delay="auto", clock_rate="auto")
    assert (auto.delay(), auto.rate(), auto.turn_on_sigmas(), auto.outages()) == (None, None, None, ())


# JSON


def test_json_is_the_contract(few, log):
    text = document("outage", "0", Parameters(), few, [log], [])
    result = json.loads(text, parse_constant=pytest.fail)["result"]
    assert len(result["outages"]) == 7
    for one in result["outages"]:
        assert {"start", "duration", "mean_speed", "models"} <= set(one)
        assert set(one["models"]) == {"none", "15AV", "18AV", "18AVWD", "full"}
        for name, found in one["models"].items():
            assert {"mean", "max", "end", "nees", "causal"} <= set(found)
            assert found["causal"] == (name != "18AVWD")
            assert 0 <= found["mean"] <= found["max"]
            assert found["end"] <= found["max"]
    (of,) = result["summary"]
    assert of["duration"] == 10.0
    for found in of["models"].values():
        assert set(found) == {
            "count", "effective_count", "median_end", "median_end_interval", "p95_end", "nees_per_dof", "coverage95", "nis_per_dof",
        }  # fmt: skip
        assert (found["count"], found["effective_count"]) == (7, 7)
        low, high = found["median_end_interval"]
        assert low <= found["median_end"] <= high <= found["p95_end"] * 1.001
        assert 0 <= found["coverage95"] <= 1
    assert result["reference"] == "truth"
    assert "replay" not in result
    assert (result["clocks"], result["tuned"]) == (None, None)


def test_figures_in_json_are_the_scores(few):
    """Mean, largest and end, speed and NEES of each outage, from the replay's arrays and from truth's own track."""
    truth = few.replay.prepared.log.references[0]
    t = (truth.time - few.replay.prepared.log.zero) / 1e9
    speed = np.hypot(truth.velocity[:, 0], truth.velocity[:, 1])
    for i, one in enumerate(few.outages):
        inside = (t >= one.start) & (t <= one.start + one.duration)
        assert one.mean_speed == pytest.approx(np.mean(speed[inside]), rel=0.05, abs=0.1)
        for name, found in one.models.items():
            s = few.replay.runs[name].outages[10.0].scores
            error = np.linalg.norm(s.north_east[i], axis=1)
            assert (found.mean, found.max, found.end) == pytest.approx((error.mean(), error.max(), error[-1]))
            assert found.nees == pytest.approx(
                s.north_east[i, -1] @ np.linalg.solve(s.covariance[i, -1], s.north_east[i, -1])
            )
            assert (
                found.percent == pytest.approx(100 * error[-1] / (one.mean_speed * 10), rel=1e-6)
                or found.percent is None
            )


def test_summary_is_of_the_outages(swept):
    for of in swept.summary:
        for name, found in of.models.items():
            end = [o.models[name].end for o in swept.outages if o.duration == of.duration]
            assert found["count"] == len(end)
            assert found["median_end"] == pytest.approx(np.median(end))
            assert found["p95_end"] == pytest.approx(np.percentile(end, 95))
            nees = [o.models[name].nees for o in swept.outages if o.duration == of.duration]
            assert found["nees_per_dof"] == pytest.approx(np.mean(nees) / 2)
            assert found["coverage95"] == pytest.approx(np.mean(np.array(nees) <= 5.991))


def test_kinds_of_motion_count_all(swept):
    for of in swept.summary:
        kinds = {o.motion for o in swept.outages if o.duration == of.duration}
        assert set(of.by_motion) == kinds <= {"stop", "turn", "fast", "straight"}
        for kind, medians in of.by_motion.items():
            for name, median in medians.items():
                end = [o.models[name].end for o in swept.outages if o.duration == of.duration and o.motion == kind]
                assert median == pytest.approx(np.median(end))


def test_pairs_are_with_denoising_or_with_the_first(few, swept):
    assert [(p.model, p.against) for p in few.summary[0].paired] == [
        ("18AVWD", n) for n in ("none", "15AV", "18AV", "full")
    ]
    assert [(p.model, p.against) for p in swept.summary[0].paired] == [("full", "none")]


def test_no_nan_where_a_filter_has_no_figure(few, log):
    (one, *_) = few.outages
    odd = replace(one, models={n: replace(m, nees=math.nan, end=math.inf, heading=None) for n, m in one.models.items()})
    found = plain(replace(few, outages=(odd,)))["outages"][0]["models"]["none"]
    assert (found["nees"], found["end"], found["heading"]) == (None, None, None)


# What is drawn


def test_tables_and_notes(few):
    shown = Shown()
    outage.draw(few, shown)
    tables = {t.title: t for t in shown.tables}
    drift = tables["Drift after 10 s without GNSS"]
    assert [row[0] for row in drift.rows] == ["none", "15AV", "18AV", "18AVWD", "full"]
    assert [row[-1] for row in drift.rows] == ["yes", "yes", "yes", "no", "yes"]
    assert {row[1] for row in drift.rows} == {"7 (7)"}
    median = few.summary[0].models["full"]["median_end"]
    assert drift.rows[-1][2].startswith(f"{median:.3g} [")
    assert drift.rows[-1][2].endswith("] m")
    assert {"Consistency in outages of 10 s", "Pairs over the same outages of 10 s", "Filters and their states"} <= set(
        tables
    )
    states = {row[0]: row[1] for row in tables["Filters and their states"].rows}
    assert states == {"none": "9", "15AV": "21", "18AV": "24", "18AVWD": "24", "full": "27"}  # six turn-on biases
    printed = tables["As Quinchia's tables 9 and 10: mean / largest, against each filter's own run"]
    gains = [1 - o.models["18AVWD"].own_max / o.models["15AV"].own_max for o in few.outages]
    assert printed.rows[-1][0] == "18AVWD better by"
    assert printed.rows[-1][4].endswith(f"/ {100 * np.mean(gains):.1f} %")
    assert "drift is measured against truth" in shown.notes
    assert any(n.startswith("10 s: full: sigma ") for n in shown.notes)
    assert any("the filter starts at" in n and "km/h" not in n for n in shown.notes)


def test_every_figure_has_units_and_finite_curves(swept):
    shown = Shown()
    outage.draw(swept, shown)
    assert len(shown.figures) >= 5
    for figure in shown.figures:
        for label in (figure.x_title, figure.y_title):
            assert "[" in label
        assert figure.curves
    assert {"Consistency", "Errors", "Tracks", "Outages", "Comparison", "Filters"} <= set(shown.tabs)
    assert any(name == "reference" for name, _, _ in shown.tracks)
    assert any(name.startswith("full_at_") for name, _, _ in shown.tracks)


def test_a_sweep_lists_the_worst(swept):
    shown = Shown()
    outage.draw(swept, shown)
    (table,) = [t for t in shown.tables if t.title.startswith("Outages (the ")]
    named = {(f"{o.start:.1f} s", f"{o.duration:g} s"): o for o in swept.outages}
    listed = [named[row[:2]] for row in table.rows]
    assert f"the {len(listed)} worst of {len(swept.outages)} that do not overlap, by the best filter" in table.title
    assert 5 < len(listed) <= 20

    def best(one):
        return min(m.end for m in one.models.values())

    def overlap(one, other):
        return one.start < other.start + other.duration and other.start < one.start + one.duration

    for i, one in enumerate(listed):
        assert not any(overlap(one, other) for other in listed[:i])
        ends = [float(cell.split(" / ")[2].split()[0]) for cell in table.rows[i][4:]]
        assert ends == pytest.approx([m.end for m in one.models.values()], rel=6e-3)
    least = min(map(best, listed)) if len(listed) == 20 else 0.0
    for one in swept.outages:  # what is left out is no worse, or overlaps with something worse
        if one not in listed:
            assert best(one) <= least or any(overlap(one, o) and best(o) >= best(one) for o in listed)


# Logs that lack something


def test_no_error_model(log):
    with pytest.raises(UsageError, match=r"outage needs --error-model MODEL.toml: imuwb noise makes one"):
        outage.run([log], Parameters())


def test_a_reference_that_the_log_has_not(log, toml):
    with pytest.raises(MissingDataError, match="no receiver of the log has RTK-fixed positions"):
        outage.run([log], Parameters(error_model=toml, models="none", at="150:10", reference="fixed"))


def test_an_odometer_that_the_log_has_not(log, toml):
    with pytest.raises(MissingDataError, match="no speed in this log: --speed has nothing to use"):
        outage.run([log], Parameters(error_model=toml, models="none", at="150:10", speed=0.1))


def test_nothing_scored_is_said(log, toml):
    truth = log.references[0]
    short = replace(truth, **{n: getattr(truth, n)[:900] for n in ("time", "position", "velocity", "attitude")})
    with pytest.raises(MissingDataError, match="truth"):
        outage.run([replace(log, references=(short,))], Parameters(error_model=toml, models="none", at="150:10"))


def test_too_short_to_tune(log, toml):
    with pytest.raises(MissingDataError, match=r"tuning needs 4 outages of 30 s"):
        outage.run([log], Parameters(error_model=toml, models="none", tune=True))


def test_samples_that_know_what_comes_are_not_causal(command, mcap, toml):
    options = ("--error-model", toml, "--models", "none", "--at", "150:10", "-o", "o.rrd", "--json", "o.json")
    code, _, err = command("outage", mcap, *options, "--through", "wavelet:levels=6")
    assert code == 0, err
    (one,) = json.loads(Path("o.json").read_text("utf-8"))["result"]["outages"]
    assert one["models"]["none"]["causal"] is False


def test_one_outage_is_no_verdict(log, toml):
    found = outage.run([log], Parameters(error_model=toml, models="full", at="150:30"))
    assert found.verdicts == ("30 s: outages that do not overlap are too few to judge a sigma: 1",)
    of = plain(found)["summary"][0]["models"]["full"]
    assert of["median_end"] > 0
    assert of["median_end_interval"] == [None, None]
    shown = Shown()
    outage.draw(found, shown)
    (drift,) = [t for t in shown.tables if t.title.startswith("Drift after 30 s")]
    assert drift.rows[0][2] == f"{of['median_end']:.3g} m"


def test_too_few_outages_show_no_nan(log, toml):
    found = outage.run([log], Parameters(error_model=toml, models="none,full", at="140:10,160:10,180:10"))
    shown = Shown()
    outage.draw(found, shown)
    assert not [cell for t in shown.tables for row in t.rows for cell in row if "nan" in cell]


def test_a_caption_is_of_what_is_there(swept):
    shown = Shown()
    outage.draw(replace(swept, outages=swept.outages[:5]), shown)
    (table,) = [t for t in shown.tables if "Quinchia's tables 9 and 10" in t.title]
    assert "Last row" not in table.caption


def test_figures_are_written_without_powers_of_ten(log, toml):
    shown = Shown()
    outage.draw(outage.run([log], Parameters(error_model=toml, models="none", at="125:100", mounting="3,3,0")), shown)
    cells = [cell for t in shown.tables for row in t.rows for cell in row]
    assert not [cell for cell in cells if re.search(r"\de[+-]\d", cell)]


def test_random_starts(log, toml):
    found = [
        outage.run([log], Parameters(error_model=toml, models="none", durations="5", random=6, seed=seed))
        for seed in (1, 1, 2)
    ]
    starts = [[o.start for o in one.outages] for one in found]
    assert len(starts[0]) == 6
    assert starts[0] == sorted(starts[0]) == starts[1] != starts[2]


# The command line


def test_a_recording_and_json_are_written(command, mcap, toml):
    code, out, err = command(
        "outage", mcap, "--error-model", toml, "--models", "none,full", "--durations", "10", "--random", "25",
        "-o", "o.rrd", "--json", "o.json",
    )  # fmt: skip
    assert code == 0, err
    assert "Drift after 10 s without GNSS" in out
    assert Path("o.rrd").stat().st_size > 100_000
    content = json.loads(Path("o.json").read_text("utf-8"), parse_constant=pytest.fail)
    assert content["analysis"] == "outage"
    assert content["result"]["summary"][0]["models"]["full"]["count"] == 25
    assert content["params"]["durations"] == "10"
    code, _, err = command("outage", mcap, "--error-model", toml, "--models", "none", "--at", "150:10", "-o", "o.rrd")
    assert code == 2
    assert "o.rrd exists" in err


def test_json_on_stdout_is_all_there_is(command, mcap, toml):
    code, out, _ = command(
        "outage", mcap, "--error-model", toml, "--models", "none", "--at", "150:10", "-o", "o.rrd", "--json", "-"
    )
    assert code == 0
    assert json.loads(out)["result"]["outages"][0]["start"] == pytest.approx(150.0)


def test_seconds_count_from_the_logs_start_in_a_cut(command, mcap, toml):
    options = (
        "--error-model",
        toml,
        "--models",
        "none",
        "--at",
        "190:10",
        "--settling",
        "20",
        "--force",
        "-o",
        "o.rrd",
        "--json",
    )
    code, _, err = command("outage", mcap, *options, "cut.json", "--start", "80", "--end", "230")
    assert code == 0, err
    (one,) = json.loads(Path("cut.json").read_text("utf-8"))["result"]["outages"]
    assert one["start"] == pytest.approx(190.0)


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--at", "20:10"), 2, "begins before the filter has settled"),
        (("--at", "235:10"), 2, "ends behind the log"),
        (("--durations", "600"), 3, "no outage fits"),
        (("--models", "x"), 2, "no filter 'x'"),
        (("--receiver", "x"), 2, "no receiver 'x'; there are /gnss/fix"),
        (("--error-model", "not.toml"), 2, "not.toml"),
    ],
)
def test_exit_codes(command, mcap, toml, options, code, words):
    model = () if "--error-model" in options else ("--error-model", toml)
    found, _, err = command("outage", mcap, *model, *options, "-o", "o.rrd")
    assert (found, words in err) == (code, True), err
    assert "Traceback" not in err
    assert not Path("o.rrd").exists()


def test_a_still_log_is_no_drive(command, toml):
    code, _, err = command("outage", ROOT / "samples" / "static.mcap", "--error-model", toml, "-o", "o.rrd")
    assert code == 3
    assert "no GNSS receiver in this log; name a file with its fixes with --gnss" in err


EXAMPLES = [line.split("#")[0].strip() for line in re.findall(r"^\$ (imuwb outage .*)$", README, re.MULTILINE)]


@pytest.mark.parametrize("example", EXAMPLES)
def test_readmes_examples_are_options_there_are(example):
    """Each is parsed to where its values are checked."""
    words = shlex.split(example)[2:]
    options = {}
    names = {name.replace("_", "-"): name for name in Parameters.__dataclass_fields__}
    while words:
        word = words.pop(0)
        if word.startswith("--") and word[2:] in names:
            name = names[word[2:]]
            kind = type(getattr(Parameters(), name))
            options[name] = True if kind is bool else {type(None): Path}.get(kind, kind)(words.pop(0))
        elif word.startswith("--"):
            assert word == "--gnss"
            words.pop(0)
    assert options["error_model"].suffix == ".toml"
    Parameters(**options)


def test_readmes_example_is_one_of_several():
    assert len(EXAMPLES) >= 4


def test_readmes_outages_can_be_run_on_readmes_drive(toml):
    from imuwb.simulation import planned_route

    (at,) = {m for e in EXAMPLES for m in re.findall(r"--at (\d\S*)", e)}
    log = drive(sensor(), planned_route("turin-1"), 1, rate=20.0, receiver=Receiver())
    found = outage.run([log], Parameters(error_model=toml, models="none", at=at))
    assert len(found.outages) == 2

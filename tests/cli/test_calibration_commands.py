import json
from pathlib import Path

import pytest

from imuwb.stochastic import ImuErrorModel

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
BENCH = ("--preset", "mpu-6050", "--rate", "50", "--seed", "3")


@pytest.fixture
def cube(imuwb, tmp_path):
    done = imuwb("simulate", "six-position", *BENCH, "--minutes", "0.4", "-o", "cube")
    assert done.code == 0, done.err
    return sorted((tmp_path / "cube").glob("*.mcap"))


@pytest.fixture
def turns(imuwb, tmp_path):
    done = imuwb("simulate", "rate-table", *BENCH, "--seconds", "8", "--rates", "20,100", "-o", "turns")
    assert done.code == 0, done.err
    return sorted((tmp_path / "turns").glob("*.mcap"))


@pytest.mark.slow
def test_from_a_bench_to_a_model_that_corrects(imuwb, cube, turns, tmp_path):
    assert [p.name for p in cube] == [f"{way}_{k}.mcap" for way in ("down", "up") for k in "xyz"]
    truth = ImuErrorModel.read(tmp_path / "cube" / "truth.toml")
    assert truth.axes["accel_x"].scale_factor
    done = imuwb("calibration", "six-position", *cube, "-o", "six.rrd", "--json", "six.json")
    assert done.code == 0, done.err
    assert "six.calibration.toml" in done.out
    document = json.loads((tmp_path / "six.json").read_text("utf-8"))
    assert (document["analysis"], document["params"]["method"], document["level"]) == (
        "calibration",
        "six-position",
        0.95,
    )
    bias = document["result"]["parameters"]["accel_x"]["bias"]
    assert bias["lower"] < truth.axes["accel_x"].bias < bias["upper"]
    assert bias["unit"] == "m/s²"
    assert "traces" not in document["result"]
    done = imuwb(
        "calibration", "rate-table", *turns, "--rates", "20,100", "--into", "six.calibration.toml", "-o", "all.rrd"
    )
    assert done.code == 0, done.err
    model = ImuErrorModel.read(tmp_path / "all.calibration.toml")
    assert model.axes["gyro_x"].scale_factor == pytest.approx(truth.axes["gyro_x"].scale_factor, abs=1e-3)
    assert model.axes["accel_x"].bias == bias["value"]
    done = imuwb("health", cube[-1], "--through", "correction:model=all.calibration.toml", "-o", "a.rrd", "--full")
    assert done.code == 0, done.err
    assert "causal" in done.err
    assert "g-sensitivity" in done.err
    assert "went through correction" in done.out


def test_a_model_is_named_as_it_is_asked_for(imuwb, cube, tmp_path):
    done = imuwb("calibration", "six-position", *cube, "-o", "six.rrd", "--save-model", "mine.toml")
    assert done.code == 0, done.err
    assert (tmp_path / "mine.toml").exists()
    assert not (tmp_path / "six.calibration.toml").exists()


@pytest.mark.slow
def test_one_log_in_csv_and_its_attitudes(imuwb, tmp_path):
    done = imuwb(
        "simulate",
        "six-position",
        *BENCH,
        "--minutes",
        "0.3",
        "--positions",
        "9",
        "--one-log",
        "--format",
        "csv",
        "-o",
        "one",
    )
    assert done.code == 0, done.err
    log = tmp_path / "one" / "positions.csv"
    for options in ((), ("--attitudes", tmp_path / "one" / "attitudes.txt")):
        done = imuwb("calibration", "multi-position", log, *options, "-o", "m.rrd", "--force")
        assert done.code == 0, done.err


def test_a_folder_that_holds_files_is_left_alone(imuwb, cube):
    done = imuwb("simulate", "six-position", *BENCH, "-o", "cube")
    assert (done.code, "--force" in done.err) == (2, True)
    assert imuwb("simulate", "six-position", *BENCH, "--minutes", "0.1", "-o", "cube", "--force").code == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("six-position", "-o", "x"), "either --preset NAME or --error-model"),
        (("six-position", *BENCH, "-o", "x.mcap"), "--output x.mcap"),
        (("six-position", *BENCH, "-o", "x", "--positions", "8"), "8 positions"),
        (("six-position", *BENCH, "-o", "x", "--latitude", "95"), "--latitude is 95"),
        (("six-position", *BENCH, "-o", "x", "--minutes", "0"), "--minutes is 0"),
        (("rate-table", *BENCH, "-o", "x", "--rates", "ten"), "--rates is 'ten'"),
        (("rate-table", *BENCH, "-o", "x", "--rates", "0"), "rates are 0 deg/s"),
        (("rate-table", *BENCH, "-o", "x", "--rates", "10", "--axis", "w"), "axis is 'w'"),
    ],
)
def test_a_bench_that_cannot_be(imuwb, tmp_path, arguments, message):
    done = imuwb("simulate", *arguments)
    assert (done.code, message in done.err) == (2, True), done.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("six-position", SAMPLES / "static.mcap"), 3, "none with x up, x down, y up, y down, z up"),
        (("six-position", SAMPLES / "drive.mcap"), 3, "it is not still"),
        (("rate-table", SAMPLES / "static.mcap", "--rates", "10"), 3, "never turns"),
        (("rate-table", SAMPLES / "drive.mcap", "--rates", "10"), 2, "match the given rates"),
        (("six-position", "gone.csv"), 4, "no such file"),
        (("six-position", SAMPLES / "static.mcap", "--into", "gone.toml"), 2, "gone.toml: cannot be read"),
    ],
)
def test_logs_that_do_not_do(imuwb, tmp_path, arguments, code, message):
    done = imuwb("calibration", *arguments, "-o", "x.rrd")
    assert (done.code, message in done.err) == (code, True), done.err
    assert not list(tmp_path.iterdir())


def test_help_of_the_group_and_of_a_method(imuwb):
    done = imuwb("calibration", "--help")
    assert done.code == 0
    for method in ("six-position", "multi-position", "rate-table"):
        assert method in done.out
        assert "LOG" in imuwb("calibration", method, "--help").out
    assert imuwb("calibration", "seven-position").code == 2


PLUGIN = """
\"\"\"Two ways to count.\"\"\"

from dataclasses import dataclass
from types import SimpleNamespace


@dataclass(frozen=True)
class Parameters:
    level: float = 0.9


def way(number):
    return SimpleNamespace(
        Parameters=Parameters, run=lambda logs, parameters: {"found": number}, draw=lambda result, review: None,
        __doc__=f"The way {number}.",
    )


METHODS = {"one": way(1), "two": way(2)}
"""


def test_a_plugin_of_ones_own_may_have_methods(imuwb, tmp_path):
    (tmp_path / "mine.py").write_text(PLUGIN, "utf-8")
    done = imuwb("./mine.py", "two", SAMPLES / "static.mcap", "-o", "x.rrd", "--json", "-")
    assert done.code == 0, done.err
    document = json.loads(done.out)
    assert (document["analysis"], document["params"], document["result"]) == (
        "mine", {"method": "two", "level": 0.9}, {"found": 2},
    )  # fmt: skip
    assert "The way 1." in imuwb("./mine.py", "--help").out


@pytest.mark.parametrize(
    ("methods", "message"),
    [
        ("{}", "METHODS must be a mapping"),
        ("[1]", "METHODS must be a mapping"),
        ("{'a': 1}", "mine.py, a: a plugin must have Parameters"),
    ],
)
def test_methods_that_are_none(imuwb, tmp_path, methods, message):
    (tmp_path / "mine.py").write_text(f"METHODS = {methods}\n", "utf-8")
    done = imuwb("./mine.py", "a", SAMPLES / "static.mcap")
    assert (done.code, message in done.err) == (2, True), done.err

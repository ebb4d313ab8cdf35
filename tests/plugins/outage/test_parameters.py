"""The options of the outage replay."""

import math
import re
import shlex
from pathlib import Path

import pytest

from imuwb.errors import UsageError
from imuwb.replay import NAMES
from imuwb.selection import select
from imuwb.simulation import Receiver, drive, planned_route, preset_names
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters
from imuwb_plugins.outage.parameters import MODELS, PAPER

from .made import sensor, stated

ROOT = Path(__file__).resolve().parents[3]
PAGES = ("README.md", "docs/how-to/tour.md")
README = "".join((ROOT / page).read_text("utf-8") for page in PAGES)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"models": "none,18av"}, r"models is 'none,18av'; .* none,15AV,18AV,18AVWD,15AR,27AR,full"),
        ({"models": "none,none"}, r"models is 'none,none'"),
        ({"models": ""}, r"models is ''"),
        ({"models": "paper,full"}, r"paper stands for"),
        ({"gnss_scale": "0,1"}, r"gnss_scale"),
        ({"gnss_floor": "-1,0"}, r"gnss_floor"),
        ({"gnss_correlation": "1"}, r"gnss_correlation"),
        ({"gnss_correlation": "1,0"}, r"gnss_correlation is 1,0; .* both"),
        ({"gnss_correlation": "-1,10"}, r"gnss_correlation"),
        ({"gnss_sigma": "1"}, r"gnss_sigma"),
        ({"spacing": -1.0}, r"spacing"),
        ({"models": ()}, r"models is ''"),
        ({"durations": "30;60"}, r"durations is '30;60'; .* 30,60"),
        ({"durations": ""}, r"durations is empty"),
        ({"durations": "inf"}, r"durations is inf; it must be 2 or more and 600 or less"),
        ({"durations": "1.9"}, r"durations is 1.9; it must be 2 or more"),
        ({"durations": "30,601"}, r"durations is 30,601; it must be 2 or more and 600 or less"),
        ({"at": "120"}, r"at is '120'; .* 200:30,430:60"),
        ({"at": "120:30:5"}, r"at is '120:30:5'"),
        ({"at": "a:30"}, r"at is 'a:30'"),
        ({"at": "nan:30"}, r"at is 'nan:30'"),
        ({"at": ((math.nan, 30.0),)}, r"at is nan:30"),
        ({"at": "inf:30"}, r"at is inf:30; it must be a finite number"),
        ({"at": "10:30,20:1"}, r"at: an outage lasts 1 s, from 20 s; it must last 2 or more and 600 or less"),
        ({"at": ","}, r"at is ','"),
        ({"mounting": "0,0"}, r"mounting is '0,0'; it must be auto or three numbers"),
        ({"mounting": "0,0,north"}, r"mounting is '0,0,north'"),
        ({"lever_arm": "0,0,nan"}, r"lever_arm is '0,0,nan'"),
        ({"lever_arm": "0,-501,0"}, r"lever_arm is 0,-501,0; it must be -500 or more and 500 or less"),
        ({"lever_arm": "1e9,0,0"}, r"lever_arm is"),
        ({"gnss_delay": "soon"}, r"gnss_delay is 'soon'; it must be auto or a number"),
        ({"gnss_delay": "0.1,0.2"}, r"gnss_delay is '0.1,0.2'"),
        ({"gnss_delay": "10.5"}, r"gnss_delay is 10.5; it must be -10 or more and 10 or less"),
        ({"gnss_delay": "1e9"}, r"gnss_delay is"),
        ({"vehicle_arm": "1,2"}, r"vehicle_arm is '1,2'; it must be three numbers"),
        ({"vehicle_arm": "0,0,501"}, r"vehicle_arm is 0,0,501; it must be -500 or more and 500 or less"),
        ({"heading": "north"}, r"heading is 'north'; it must be auto or search or course or log or a number"),
        ({"heading": "361"}, r"heading is 361; it must be -360 or more and 360 or less"),
        ({"heading_sigma": 0.0}, r"heading_sigma is 0; it must be 0.01 or more"),
        ({"start_speed": -1.0}, r"start_speed is -1; it must be 0.01 or more"),
        ({"clock_rate": "2"}, r"clock_rate is 2; it must be above 0.9 and below 1.1"),
        ({"clock_rate": "nan"}, r"clock_rate is 'nan'"),
        ({"scale_factor": "2"}, r"scale_factor is '2'; it must be two numbers"),
        ({"scale_factor": "2,51"}, r"scale_factor is 2,51; it must be 0 or more and 50 or less"),
        ({"scale_factor": "-1,2"}, r"scale_factor is -1,2; it must be 0 or more"),
        ({"turn_on": "0.1"}, r"turn_on is '0.1'; it must be auto or two numbers"),
        ({"turn_on": "-0.1,1"}, r"turn_on is -0.1,1; it must be 0 or more"),
        ({"turn_on": "1001,1"}, r"turn_on is 1001 deg/s; it must be 0 or more and 1000 or less"),
        ({"turn_on": "0,101"}, r"turn_on is 101 m/s²; it must be 0 or more and 100 or less"),
        ({"velocity_delay": math.nan}, r"velocity_delay is nan; it must be -10 or more and 10 or less"),
        ({"velocity_delay": math.inf}, r"velocity_delay is inf"),
        ({"skew": -1.1}, r"skew is -1.1; it must be -1 or more and 1 or less"),
        ({"skew": math.inf}, r"skew is inf"),
        ({"wavelet": "0..3"}, r"wavelet is 0,1,2,3; it must be 1 or more and 12 or less"),
        ({"wavelet": "8..3"}, r"wavelet is '8..3'; .* 3..8"),
        ({"wavelet": "4,x"}, r"wavelet is '4,x'"),
        ({"degrade": "shake=3"}, r"degrade has shake; it must be noise=M,jump=M,every=S"),
        ({"degrade": "noise=-1"}, r"degrade is noise=-1; it must be 0 or more"),
        ({"degrade": "every=0.5"}, r"degrade: every is 0.5 s; it must be 5 or more"),
        ({"level": 95.0}, r"level is 95; it must be 0.6 or more and below 1"),
        ({"level": 0.4}, r"level is 0.4; it must be 0.6 or more and below 1"),
        ({"straight": -0.1}, r"straight is -0.1; it must be 0 or more"),
        ({"still": math.nan}, r"still is nan; it must be 0 or more"),
        ({"speed": math.inf}, r"speed is inf; it must be 0 or more"),
        ({"settling": -1.0}, r"settling is -1; it must be 0 or more"),
        ({"every": 0}, r"every is 0; it must be 1 or more and 100 or less"),
        ({"every": 101}, r"every is 101; it must be 1 or more and 100 or less"),
        ({"random": -1}, r"random is -1; it must be 0 or more"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked(options, words):
    with pytest.raises(ValueError, match=words):
        Parameters(**options)


def test_texts_become_values():
    asked = Parameters(
        models=" none, full ", durations="60,30,60", at="300:60, 120:30,120:30", mounting="180,6.79,-185.35",
        lever_arm="0,-.05,0", gnss_delay="0.15", clock_rate="1.000275", scale_factor="2,1", turn_on="0.2,0.1",
        wavelet="3..5", degrade="noise=2,jump=10",
    )  # fmt: skip
    assert asked.models == ("none", "full")
    assert asked.durations == (60.0, 30.0, 60.0)
    assert asked.at == ((300.0, 60.0), (120.0, 30.0), (120.0, 30.0))
    assert asked.mounting == (180.0, 6.79, -185.35)
    assert asked.lever_arm == (0.0, -0.05, 0.0)
    assert (asked.gnss_delay, asked.clock_rate) == (0.15, 1.000275)
    assert (asked.scale_factor, asked.turn_on) == ((2.0, 1.0), (0.2, 0.1))
    assert asked.wavelet == (3, 4, 5)
    assert asked.degrade == {"noise": 2.0, "jump": 10.0}
    auto = Parameters(gnss_delay="auto", clock_rate="auto", mounting="auto", at="own")
    assert (auto.gnss_delay, auto.clock_rate, auto.mounting, auto.turn_on, auto.at) == (*["auto"] * 4, "own")


def test_the_models_are_those_of_the_replay():
    assert (*NAMES, "motion", "paper", "table6") == MODELS
    assert NAMES == PAPER
    assert set(Parameters().models) <= set(MODELS)


EXAMPLES = [line.split("#")[0].strip() for line in re.findall(r"^\$ (imuwb outage .*)$", README, re.MULTILINE)]


@pytest.mark.parametrize("example", EXAMPLES)
def test_readmes_examples_are_options_there_are(example, tmp_path, monkeypatch):
    (tmp_path / "tunnels.csv").write_text("start,duration\n200,30\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    words = shlex.split(example)[2:]
    options = {}
    names = {name.replace("_", "-"): name for name in Parameters.__dataclass_fields__}
    while words:
        word = words.pop(0)
        if word.startswith("--") and word[2:] in names:
            name = names[word[2:]]
            options[name] = True if isinstance(getattr(Parameters(), name), bool) else words.pop(0)
        elif word.startswith("--"):
            assert word in ("--gnss", "--save-model")
            words.pop(0)
    model = Parameters(**options).error_model
    assert model.suffix == ".toml" or str(model) in preset_names()


def test_readmes_example_is_one_of_several():
    assert len(EXAMPLES) >= 4


@pytest.mark.slow
def test_readmes_outages_can_be_run_on_readmes_drive(toml):
    (at,) = {m for e in EXAMPLES for m in re.findall(r"--at (\d\S*)", e)}
    log = drive(sensor(), planned_route("turin-1"), 1, rate=20.0, receiver=Receiver())
    found = outage.run([select(log, end="520")], stated(error_model=toml, models="none", at=at))
    assert len(found.outages) == 2


@pytest.mark.parametrize("at", ["20:10", "235:10"])
def test_an_outage_that_is_not_possible_is_refused_before_the_long_work(log, toml, at, monkeypatch):
    monkeypatch.setattr(
        "imuwb_plugins.outage.compute.filters_of", lambda *_: pytest.fail("the noise in motion was estimated first")
    )
    with pytest.raises(UsageError, match=at.partition(":")[0]):
        outage.run([log], stated(error_model=toml, at=at))

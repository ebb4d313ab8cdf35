import json

import pytest

from imuwb import read
from imuwb.cli.through import cases, grid, step, steps_of
from imuwb.errors import UsageError


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("nope", "no such conditioner; there are bandwidth, bias, correction, decimate, kaiser, wavelet"),
        (":", "no such conditioner"),
        ("wavelet:depth=3", "wavelet: no parameter 'depth'; there are levels"),
        ("bandwidth", "bandwidth: it needs cutoff"),
        ("bandwidth:order=2", "it needs cutoff"),
        ("bandwidth:cutoff", "'cutoff' has no value"),
        ("bandwidth:cutoff=5,", "'' has no value"),
        ("bandwidth:cutoff=fast", "cutoff is 'fast'"),
        ("bandwidth:cutoff=5,order=2.5", "order is '2.5'"),
        ("bandwidth:cutoff=5,kind=brick", "butterworth or moving-average"),
        ("bandwidth:cutoff=5,order=9", "order 9; it must be 1 to 8"),
        ("bandwidth:cutoff=-1", "must be positive"),
        ("bandwidth:cutoff=25", "below half the rate, 25 Hz"),
        ("kaiser", "give either f_pass and f_stop, or fc"),
        ("kaiser:f_pass=5,f_stop=8,fc=6", "give either f_pass and f_stop, or fc"),
        ("kaiser:f_pass=5,f_stop=26", "half the rate"),
        ("kaiser:f_pass=5,f_stop=8,width=3", "width is 3.0 Hz; it goes with fc"),
        ("decimate", "give either rate (Hz) or factor"),
        ("decimate:rate=10,factor=5", "give either rate (Hz) or factor"),
        ("decimate:rate=30", "50 divided by a whole number"),
        ("decimate:factor=5,anti_alias=perhaps", "anti_alias is 'perhaps'"),
        ("wavelet:levels=3/3", "levels is '3/3'"),
        ("wavelet:levels=20", "3000 samples have no 20 levels"),
        ("wavelet:wavelet=wave", "no discrete wavelet 'wave'"),
        ("wavelet:threshold=some", "threshold is 'some'"),
        ("bias:seconds=0", "seconds is 0.0; it must be positive"),
    ],
)
def test_a_wrong_conditioner_is_wrong_usage_that_is_named(imuwb, static_mcap, tmp_path, text, named):
    done = imuwb("autoregressive", static_mcap, "--through", text, "--json", "out.json")
    assert done.code == 2
    assert "--through" in done.err
    assert named in done.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["static.mcap"]


@pytest.mark.parametrize(
    ("text", "parameters"),
    [("bandwidth:cutoff=5,kind=moving-average", {"cutoff": 5.0, "kind": "moving-average", "order": 2}),
     ("decimate:factor=4,anti_alias=no,causal=TRUE", {"rate": None, "factor": 4, "anti_alias": False, "causal": True}),
     ("bias: seconds = 3 , sensors=gyro", {"seconds": 3.0, "sensors": "gyro"})],
)  # fmt: skip
def test_texts_become_parameters_of_their_types(text, parameters):
    from dataclasses import asdict

    assert asdict(step(text).parameters) == parameters


def test_what_was_done_is_in_the_json_the_recording_and_the_terminal(imuwb, static_mcap, tmp_path):
    from rerun.chunk import RrdReader

    through = ["--through", "bias", "--through", "kaiser:fc=8", "--through", "decimate:factor=2,anti_alias=false"]
    done = imuwb("autoregressive", static_mcap, *through, "--orders", 3, "--json", "out.json", "--save-model", "m.toml")
    assert done.code == 0, done.err
    document = json.loads((tmp_path / "out.json").read_text("utf-8"))
    log = document["logs"][0]
    assert [c["name"] for c in log["conditioning"]] == ["bias", "kaiser", "decimate"]
    assert set(log["conditioning"][1]) == {"name", "parameters", "causal", "delay", "note", "band"}
    assert [c["band"] for c in log["conditioning"]] == [None, 6.0, None]
    assert "f_pass=6,f_stop=10" in log["conditioning"][1]["parameters"]
    assert log["causal"] is False
    assert any("kaiser" in note and "not causal" in note for note in document["notes"])
    assert document["result"]["axes"]["gyro_x"]["dt"] == pytest.approx(0.04)
    assert document["result"]["conditioned"] is True
    assert "through bias:" in (tmp_path / "m.toml").read_text("utf-8")
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(tmp_path / "static.rrd")).stream()}
    assert any(e.startswith("/conditioning/figure_0") for e in entities)


def test_a_log_that_nothing_was_done_to_says_nothing(imuwb, static_mcap):
    (log,) = json.loads(imuwb("autoregressive", static_mcap, "--orders", 2, "--json", "-").out)["logs"]
    assert "conditioning" not in log


def test_causal_steps_are_a_causal_log(imuwb, static_mcap):
    through = ["--through", "bandwidth:cutoff=10", "--through", "decimate:factor=2,causal=true"]
    (log,) = json.loads(imuwb("autoregressive", static_mcap, "--orders", 2, *through, "--json", "-").out)["logs"]
    assert log["causal"] is True
    assert all(c["delay"] > 0 for c in log["conditioning"])


def test_order_counts(imuwb, static_mcap):
    one = imuwb("autoregressive", static_mcap, "--through", "decimate:rate=10", "--through", "bandwidth:cutoff=8")
    assert (one.code, "at a rate of 10 Hz" in one.err) == (2, True)
    other = imuwb("autoregressive", static_mcap, "--through", "bandwidth:cutoff=8", "--through", "decimate:rate=10")
    assert other.code == 0


def test_nothing_left_is_missing_data(imuwb, static_mcap):
    done = imuwb("autoregressive", static_mcap, "--through", "kaiser:fc=1,width=0.1")
    assert (done.code, "no part between gaps" in done.err) == (3, True)


def test_conditioners_are_listed(imuwb):
    done = imuwb("plugins")
    for name in ("bandwidth", "bias", "decimate", "kaiser", "wavelet"):
        assert f"imuwb_plugins.{name}" in done.out


def test_a_grid_has_every_combination():
    found = grid(["bandwidth=98,42", "wavelet.levels=3..5"])
    assert found == [{"bandwidth": b, "wavelet.levels": x} for b in ("98", "42") for x in ("3", "4", "5")]
    assert grid([]) == [{}]


def test_a_sensor_filters_before_it_puts_out_samples():
    for text in (["rate=50", "bandwidth=20"], ["bandwidth=20", "rate=50"]):
        steps = steps_of(grid(text)[0])
        assert [s.name for s in steps] == ["bandwidth", "decimate"]
        assert (steps[0].parameters.cutoff, steps[1].parameters.rate) == (20.0, 50.0)
        assert not steps[1].parameters.anti_alias
    assert [s.name for s in steps_of({"decimate.factor": "2", "wavelet.levels": "3", "bias.seconds": "1"})] == [
        "bias", "wavelet", "decimate"
    ]  # fmt: skip


def test_parameters_of_one_conditioner_go_together():
    (one,) = steps_of({"kaiser.f_pass": "5", "kaiser.f_stop": "9"})
    assert one.parameters.bands == (5.0, 9.0)


@pytest.mark.parametrize(
    ("texts", "named"),
    [(["rate"], "write NAME.key"), (["rate="], "write NAME.key"), (["speed=3"], "write NAME.key"), (["nope.x=3"], "no such conditioner"),
     (["wavelet.depth=3"], "no parameter 'depth'"), (["wavelet.levels=5..3"], "a range rises"), (["wavelet.levels=3..x"], "whole number"),
     (["wavelet.levels=1..300"], "less than 200"), (["rate=fast"], "must be a number"), (["rate=10,"], "must be a number"),
     (["wavelet.levels=1..20", "bandwidth=1,2,3,4,5,6,7,8,9,10,11"], "220 combinations; at most 200")],
)  # fmt: skip
def test_a_study_that_cannot_be_is_wrong_usage(texts, named):
    with pytest.raises(UsageError, match=named):
        grid(texts)


@pytest.mark.parametrize(
    ("study", "named"),
    [
        ("bandwidth=10,30", "30 Hz at a rate of 50 Hz"),
        ("rate=25,20", "50 divided by a whole number"),
        ("wavelet.levels=3..9", "no 9 levels"),
    ],
)
def test_a_setting_that_the_log_cannot_have_is_told(static_log, study, named):
    with pytest.raises(UsageError, match=named):
        list(cases([static_log], [study]))


def test_a_wrong_study_is_wrong_usage_and_leaves_nothing(imuwb, static_mcap, tmp_path):
    for study, named in (("speed=1", "--study speed=1"), ("bandwidth=30", "30 Hz at a rate of 50 Hz")):
        done = imuwb("noise", static_mcap, "--end", 20, "--no-choose", "--denoise", 0, "--study", study)
        assert (done.code, named in done.err) == (2, True)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["static.mcap"]


def test_only_analyses_that_can_have_studies(imuwb, static_mcap):
    assert imuwb("psd", static_mcap, "--study", "rate=25").code == 2


def test_the_log_itself_stays_as_it_is(static_mcap):
    log = read(static_mcap)
    before = log.imu().angular_rate.value.copy()
    for text in ("bias", "bandwidth:cutoff=5", "kaiser:fc=8", "wavelet:levels=3", "decimate:factor=2"):
        step(text).apply(log)
    assert (log.imu().angular_rate.value == before).all()
    assert log.conditioning == ()

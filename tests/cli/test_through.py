import json
from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

from imuwb import read
from imuwb.cli.through import Step, step


@dataclass(frozen=True)
class Own:
    factor: float = 2.0
    axes: tuple[int, ...] = (1, 2)
    name: str | None = None


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("nope", "bandwidth, bias, correction, decimate, kaiser, wavelet"),
        (":", "--through :"),
        ("wavelet:depth=3", "'depth'"),
        ("bandwidth", "bandwidth:cutoff="),
        ("bandwidth:order=2", "bandwidth:cutoff="),
        ("bandwidth:cutoff", "'cutoff'"),
        ("bandwidth:cutoff=5,", "''"),
        ("bandwidth:cutoff=fast", "cutoff is 'fast'"),
        ("bandwidth:cutoff=5,order=2.5", "order is '2.5'"),
        ("bandwidth:cutoff=5,kind=brick", "moving-average"),
        ("bandwidth:cutoff=5,order=9", "order is 9"),
        ("bandwidth:cutoff=-1", "cutoff is -1"),
        ("bandwidth:cutoff=25", "25 Hz"),
        ("kaiser", "f_pass and f_stop"),
        ("kaiser:f_pass=5,f_stop=8,fc=6", "f_pass and f_stop"),
        ("kaiser:f_pass=5,f_stop=26", "half the rate"),
        ("kaiser:f_pass=5,f_stop=8,width=3", "width is 3.0 Hz"),
        ("decimate", "rate (Hz)"),
        ("decimate:rate=10,factor=5", "rate (Hz)"),
        ("decimate:rate=30", "rate of 50 Hz"),
        ("decimate:factor=5,anti_alias=perhaps", "anti_alias is 'perhaps'"),
        ("wavelet:levels=3/3", "levels is 3/3"),
        ("wavelet:levels=20", "level is 20; for 3000 samples"),
        ("wavelet:wavelet=wave", "'wave'"),
        ("wavelet:threshold=some", "threshold is 'some'"),
        ("bias:seconds=0", "seconds is 0"),
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


@pytest.mark.slow
def test_conditioners_are_in_the_json_the_recording_and_the_terminal(imuwb, static_mcap, tmp_path):
    from rerun.chunk import RrdReader

    through = ["--through", "bias", "--through", "kaiser:fc=8", "--through", "decimate:factor=2,anti_alias=false"]
    done = imuwb("autoregressive", static_mcap, *through, "--orders", 3, "--json", "out.json", "--save-model", "m.toml")
    assert done.code == 0, done.err
    document = json.loads((tmp_path / "out.json").read_text("utf-8"))
    log = document["logs"][0]
    assert [c["name"] for c in log["conditioning"]] == ["bias", "kaiser", "decimate"]
    assert set(log["conditioning"][1]) == {"name", "parameters", "causal", "delay", "note", "band", "without_mean"}
    assert [c["band"] for c in log["conditioning"]] == [None, 6.0, None]
    assert "f_pass=6,f_stop=10" in log["conditioning"][1]["parameters"]
    assert log["causal"] is False
    assert any("kaiser" in note and "not causal" in note for note in document["notes"])
    assert document["result"]["axes"]["gyro_x"]["dt"] == pytest.approx(0.04)
    assert document["result"]["conditioned"] is True
    assert "through bias:" in (tmp_path / "m.toml").read_text("utf-8")
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(tmp_path / "static.rrd")).stream()}
    assert any(e.startswith("/conditioning/figure_0") for e in entities)


def test_a_log_without_conditioners_has_no_conditioning_in_the_json(imuwb, static_mcap):
    (log,) = json.loads(imuwb("autoregressive", static_mcap, "--orders", 2, "--json", "-").out)["logs"]
    assert "conditioning" not in log


def test_causal_steps_are_a_causal_log(imuwb, static_mcap):
    through = ["--through", "bandwidth:cutoff=10", "--through", "decimate:factor=2,causal=true"]
    (log,) = json.loads(imuwb("autoregressive", static_mcap, "--orders", 2, *through, "--json", "-").out)["logs"]
    assert log["causal"] is True
    assert all(c["delay"] > 0 for c in log["conditioning"])


@pytest.mark.slow
def test_order_counts(imuwb, static_mcap):
    early = imuwb("autoregressive", static_mcap, "--through", "decimate:rate=10", "--through", "bandwidth:cutoff=8")
    assert (early.code, "at a rate of 10 Hz" in early.err) == (2, True)
    other = imuwb("autoregressive", static_mcap, "--through", "bandwidth:cutoff=8", "--through", "decimate:rate=10")
    assert other.code == 0


def test_nothing_left_is_missing_data(imuwb, static_mcap):
    done = imuwb("autoregressive", static_mcap, "--through", "kaiser:fc=1,width=0.1")
    assert (done.code, "no part between gaps" in done.err) == (3, True)


def test_conditioners_are_listed(imuwb):
    done = imuwb("plugins")
    for name in ("bandwidth", "bias", "decimate", "kaiser", "wavelet"):
        assert f"imuwb_plugins.{name}" in done.out


def test_the_log_itself_stays_as_it_is(static_mcap):
    log = read(static_mcap)
    before = log.imu().angular_rate.value.copy()
    for text in ("bias", "bandwidth:cutoff=5", "kaiser:fc=8", "wavelet:levels=3", "decimate:factor=2"):
        step(text).apply(log)
    assert (log.imu().angular_rate.value == before).all()
    assert log.conditioning == ()


@pytest.mark.parametrize("drops", [False, True])
def test_a_conditioner_that_records_nothing_is_recorded_all_the_same(static_mcap, drops):
    """The host states every step, also those that a later conditioner drops."""
    log, _ = step("bias:seconds=3").apply(read(static_mcap))
    conditioner = SimpleNamespace(
        condition=lambda log, _: (replace(log, conditioning=()) if drops else log, None)  # it forgets
    )
    changed, _ = Step("own", conditioner, Own()).apply(log)
    assert [c.name for c in changed.conditioning] == ["bias", "own"]
    assert changed.conditioning[-1].parameters == "factor=2,axes=1/2"
    assert not changed.causal

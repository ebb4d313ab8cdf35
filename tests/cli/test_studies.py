"""Studies: the settings that a text stands for, and the order of their conditioners."""

from types import SimpleNamespace

import pytest

from imuwb import registry
from imuwb.analysis import setting_text
from imuwb.cli.studies import cases, grid, steps_of
from imuwb.errors import UsageError
from imuwb_plugins import bandwidth, bias, decimate


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
    (step,) = steps_of({"kaiser.f_pass": "5", "kaiser.f_stop": "9"})
    assert step.parameters.bands == (5.0, 9.0)


def test_a_grid_has_at_most_200_settings():
    assert len(grid(["decimate.factor=1..200"])) == 200
    assert len(grid(["decimate.factor=1..100", "bandwidth=1,2"])) == 200
    for texts in (["decimate.factor=1..201"], ["decimate.factor=1..67", "bandwidth=1,2,3"]):
        with pytest.raises(UsageError, match="200"):
            grid(texts)


def test_errors_name_the_option_that_the_user_writes():
    with pytest.raises(UsageError, match=r"^--study wavelet: levels is 31"):
        grid(["wavelet.levels=31"])
    with pytest.raises(UsageError, match=r"^--study bandwidth: .*bandwidth\.cutoff="):
        grid(["bandwidth.order=2"])


@pytest.mark.parametrize(
    ("texts", "named"),
    [(["rate"], "NAME.key"), (["rate="], "NAME.key"), (["speed=3"], "NAME.key"), (["nope.x=3"], "nope"),
     (["wavelet.depth=3"], "'depth'"), (["wavelet.levels=5..3"], "5..3"), (["wavelet.levels=3..x"], "3..x"),
     (["wavelet.levels=1..300"], "200"), (["rate=fast"], "'fast'"), (["rate=10,"], "rate is ''"),
     (["wavelet.levels=1..20", "bandwidth=1,2,3,4,5,6,7,8,9,10,11"], "220 .* 200")],
)  # fmt: skip
def test_a_study_that_cannot_be_is_wrong_usage(texts, named):
    with pytest.raises(UsageError, match=named):
        grid(texts)


@pytest.mark.parametrize(
    ("study", "named"),
    [
        ("bandwidth=10,30", "30 Hz at a rate of 50 Hz"),
        ("rate=25,20", "rate of 50 Hz"),
        ("wavelet.levels=3..9", "level is 9"),
    ],
)
def test_a_setting_that_the_log_cannot_have_is_named(static_log, study, named):
    with pytest.raises(UsageError, match=named):
        list(cases([static_log], [study]))


def test_a_setting_has_its_unit(static_log):
    texts = ["rate=25", "bandwidth=10", "wavelet.levels=3"]
    (case,) = cases([static_log], texts)
    assert setting_text(case.settings, case.units) == "rate 25 Hz, bandwidth 10 Hz, levels 3"
    assert setting_text({"a.x": "1", "b.x": "2"}, {"b.x": "s"}) == "a.x 1, b.x 2 s"


def test_a_wrong_study_is_wrong_usage_and_leaves_nothing(imuwb, static_mcap, tmp_path):
    for study, named in (("speed=1", "--study speed=1"), ("bandwidth=30", "30 Hz at a rate of 50 Hz")):
        done = imuwb("noise", static_mcap, "--end", 20, "--no-choose", "--denoise", 0, "--study", study)
        assert (done.code, named in done.err) == (2, True)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["static.mcap"]


def test_only_analyses_that_can_have_studies(imuwb, static_mcap):
    assert imuwb("psd", static_mcap, "--study", "rate=25").code == 2


@pytest.fixture
def installed(monkeypatch):
    """Replace the conditioners that are installed."""

    def install(**conditioners):
        monkeypatch.setattr(registry, "installed", lambda _: conditioners)
        monkeypatch.setattr(registry, "load", lambda point: point)

    return install


def test_conditioners_declare_their_short_names(installed):
    mine = SimpleNamespace(Parameters=bandwidth.Parameters, STUDY={"corner": ("cutoff", {"order": "4"})})
    installed(mine=mine)
    (step,) = steps_of(grid(["corner=7"])[0])
    assert (step.name, step.parameters.cutoff, step.parameters.order) == ("mine", 7.0, 4)
    with pytest.raises(UsageError, match=r"corner=\.\.\."):
        grid(["bandwidth=7"])


def test_two_conditioners_of_one_short_name_are_an_error_that_names_both(installed):
    first, second = (
        SimpleNamespace(Parameters=bandwidth.Parameters, STUDY={"corner": ("cutoff", {})}) for _ in range(2)
    )
    installed(first=first, second=second)
    with pytest.raises(UsageError, match="first and second"):
        grid(["corner=7"])


def test_conditioners_declare_their_order(installed):
    first, last = (SimpleNamespace(Parameters=bias.Parameters, ORDER=order) for order in (1, 99))
    installed(a_last=last, plain=SimpleNamespace(Parameters=decimate.Parameters), z_first=first)
    setting = {"plain.factor": "2", "a_last.seconds": "1", "z_first.seconds": "1"}
    assert [step.name for step in steps_of(setting)] == ["z_first", "a_last", "plain"]


def test_a_conditioner_of_a_study_may_be_a_file(tmp_path):
    text = "from imuwb_plugins.decimate import Parameters, condition\n"
    (tmp_path / "mine.py").write_text(text, "utf-8")
    (setting,) = grid([f"{tmp_path / 'mine.py'}.factor=2"])
    (step,) = steps_of(setting)
    assert (step.name, step.parameters.factor) == ("mine", 2)

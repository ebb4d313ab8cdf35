"""Each error model and each filter that can exist is read as it is written."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.navigation import Aids, FilterModel, Installation, Settings, filter_text, read_filter
from imuwb.replay import model_named
from imuwb.replay.models import NAMES
from imuwb.simulation import preset, preset_names
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Sum,
    WhiteNoise,
    of_either_sign,
)
from imuwb.stochastic.model_check import coefficient
from imuwb.texts import sentence_of

size = st.floats(0, 1e6)
positive = st.floats(1e-9, 1e9)
signed = st.floats(-1e6, 1e6)
alpha = st.lists(st.floats(-0.9, 0.9), max_size=3).map(
    lambda poles: tuple(np.poly(poles)[1:].tolist()) if poles else ()
)
process = st.one_of(
    *(st.builds(kind, size) for kind in (WhiteNoise, Quantization, FlickerNoise, RandomWalk, Constant)),
    st.builds(RateRamp, signed), st.builds(GaussMarkov, size, positive), st.builds(Sinusoid, size, positive),
    st.builds(Autoregressive, alpha, size, positive),
)  # fmt: skip
texts = st.text(st.characters(codec="utf-8")).map(sentence_of)  # as all words of a document are cleaned
temperatures = st.lists(st.floats(-60, 150), min_size=1, max_size=3, unique=True).map(sorted)


@st.composite
def axis_models(draw):
    terms = draw(st.lists(process, max_size=4))
    intervals = {}
    for i, term in enumerate(terms):
        for name in ("N", "R", "K", "sigma", "Tc"):
            if hasattr(term, name) and draw(st.booleans()):
                value, wider = getattr(term, name), draw(size)
                intervals[f"{i}.{name}"] = of_either_sign(value, max(abs(value) - wider, 0.0), abs(value) + wider)
    celsius = draw(temperatures)

    def curve():
        return tuple((t, draw(signed)) for t in celsius) if draw(st.booleans()) else ()

    return AxisModel(
        Sum(tuple(terms)), intervals, draw(st.dictionaries(st.sampled_from("QNBKR"), positive)),
        tuple((t, Sum(tuple(terms))) for t in celsius) if draw(st.booleans()) else (),
        draw(signed), draw(signed), curve(), curve(), draw(signed), (draw(signed), draw(signed)),
        (draw(signed), draw(signed), draw(signed)), *(draw(st.none() | positive) for _ in range(4)),
        draw(st.lists(st.builds(Autoregressive, alpha, size, positive), max_size=2, unique_by=lambda p: len(p.alpha)).map(tuple)),
    )  # fmt: skip


models = st.builds(
    ImuErrorModel, texts, st.dictionaries(st.sampled_from(AXES), axis_models(), min_size=1),
    st.dictionaries(texts, texts, max_size=3), st.lists(texts, max_size=3).map(tuple),
)  # fmt: skip


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(models)
def test_an_error_model_is_read_as_it_is_written(model):
    assert ImuErrorModel.from_toml(model.to_toml()) == model


def test_numbers_of_numpy_are_written_as_numbers():
    axis = AxisModel(Sum((RateRamp(np.float64(-2e-5)),)), bias=np.float64(0.1), thermal_bias=((0.0, np.float64(0.2)),))
    model = ImuErrorModel("mine", {"accel_x": axis})
    assert ImuErrorModel.from_toml(model.to_toml()) == model


def test_a_falling_ramp_has_the_interval_of_its_size():
    axis = AxisModel(Sum((RateRamp(-2.0),)), {"0.R": of_either_sign(-2.0, 1.5, 2.5)})
    assert axis.intervals == {"0.R": (-2.5, -1.5)}
    assert (coefficient(axis, "R").lower, coefficient(axis, "R").value, coefficient(axis, "R").upper) == (1.5, 2.0, 2.5)


@pytest.mark.parametrize(
    ("made", "named"),
    [
        ({"processes": Sum((RateRamp(-2.0),)), "intervals": {"0.R": (1.5, 2.5)}}, "interval"),
        ({"processes": Sum((WhiteNoise(1.0),)), "intervals": {"0.K": (0.5, 2.5)}}, "0.K"),
        ({"processes": Sum((WhiteNoise(1.0),)), "intervals": {"1.N": (0.5, 2.5)}}, "1.N"),
        ({"processes": Sum((WhiteNoise(1.0),)), "intervals": {"0.N": (0.5, np.inf)}}, "interval"),
        ({"limits": {"K": 0.0}}, "limit of K"),
        ({"limits": {"bias": 1.0}}, "limit of bias"),
        ({"bias": np.nan}, "bias"),
        ({"thermal_bias": ((0.0, np.inf),)}, "thermal_bias"),
        ({"cross_coupling": (0.0, 1e200)}, "cross_coupling"),
    ],
)
def test_what_could_not_be_read_cannot_be_made(made, named):
    with pytest.raises(ValueError, match=named):
        AxisModel(**made)


def test_an_interval_without_its_value_is_refused_with_its_place():
    text = '[[gyro_x.processes]]\nprocess = "rate_ramp"\nR = {value = -2, lower = 1, upper = 3}'
    with pytest.raises(UsageError, match=r"m\.toml, gyro_x: R .* interval"):
        ImuErrorModel.from_toml(text, "m.toml")


def test_processes_that_stay_keep_their_intervals():
    axis = AxisModel(WhiteNoise(1.0) + FlickerNoise(2.0) + RandomWalk(3.0), {"0.N": (0.5, 2.0), "2.K": (2.0, 4.0)})
    assert axis.with_processes(RandomWalk(3.0) + RandomWalk(4.0)).intervals == {"0.K": (2.0, 4.0)}


@pytest.mark.parametrize("name", preset_names())
def test_presets_are_read_as_they_are_written(name):
    model = preset(name)
    assert ImuErrorModel.from_toml(model.to_toml()) == model


#: one preset for each set of processes that presets have
KINDS = ("3dm-gx3-25", "3dm-gx3-25-paper", "adis16405", "adis16448", "navchip", "ahrs300cc-ar1", "mpu-6050")


@pytest.mark.parametrize("name", KINDS)
def test_filters_of_presets_are_read_as_they_are_written(name):
    model = preset(name)
    step = next((t.dt for t in model.axes["gyro_x"].processes.terms if isinstance(t, Autoregressive)), 0.01)
    bare = any(all(isinstance(t, Constant) for t in model.axes[axis].processes.terms) for axis in AXES)
    for filter_name in NAMES:
        if bare and "AR" in filter_name:
            with pytest.raises(ValueError, match="no noise"):
                model_named(filter_name, FilterModel("base", model), interval=step)
            continue
        _read_again(model_named(filter_name, FilterModel("base", model), interval=step))


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(-500, 500), min_size=10, max_size=10), st.integers(1, 100), texts)
def test_a_filter_is_read_as_it_is_written(numbers, every, name):
    a, b, c, d, e, f, g, h, i, j = numbers
    made = replace(
        FilterModel(name, preset("mpu-6050")), installation=Installation((a, b, c), (d, e, f), g, h, 1.0, i),
        settings=Settings(every=every, gate=abs(j)), aids=Aids(abs(a), abs(b), abs(c)), wavelet_levels=(1, 2, 3, 4, 5, 6),
    )  # fmt: skip
    _read_again(made)


def _read_again(model):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "filter.toml"
        file.write_text(filter_text(model), "utf-8")
        assert read_filter(file) == model

import pytest

from imuwb.recipes.model import combined
from imuwb.recipes.repeatability import Compared, Repeatability, TurnOn
from imuwb.stochastic import AxisModel, Constant, FlickerNoise, ImuErrorModel, Sinusoid, Sum, WhiteNoise


def model(*terms, name="m"):
    return ImuErrorModel(name, {"gyro_x": AxisModel(Sum(terms))}, {"log": f"{name}.mcap"})


def together(mean=2.5, interval=(2.4, 2.6)):
    n = Compared((2.0, 3.0), (1.9, 2.9), (2.1, 3.1), mean, interval, 1.0, 0.5, "")
    return Repeatability(
        0.95, ("a", "b"), {"gyro_x": {"N": n}}, {"gyro_x": TurnOn((1.0, 2.0), 0.7, 0.3, 20.0, "rad/s")}, ()
    )


def test_one_logs_model_stays_as_it_is():
    one = model(WhiteNoise(1.0))
    assert combined([one], None) is one


def test_several_logs_have_the_weighted_mean_and_the_turn_on_bias():
    found = combined([model(WhiteNoise(2.0), name="a"), model(WhiteNoise(3.0), name="b")], together())
    axis = found.axes["gyro_x"]
    assert axis.processes.terms == (WhiteNoise(2.5), Constant(0.7))
    assert axis.intervals == {"0.N": (2.4, 2.6), "1.sigma": (0.3, 20.0)}
    assert "a.mcap" in found.provenance["logs"]
    assert "b.mcap" in found.provenance["logs"]
    assert ImuErrorModel.from_toml(found.to_toml()) == found


def test_a_term_that_half_of_the_logs_show_is_in_the_model_as_a_root_mean_square():
    models = [
        model(WhiteNoise(2.0), FlickerNoise(1.0)),
        model(WhiteNoise(3.0), FlickerNoise(7.0)),
        model(WhiteNoise(3.0)),
        model(WhiteNoise(3.0)),
    ]
    terms = combined(models, together()).axes["gyro_x"].processes.terms
    assert FlickerNoise(5.0) in terms
    terms = combined([*models, model(WhiteNoise(3.0))], together()).axes["gyro_x"].processes.terms
    assert not any(isinstance(t, FlickerNoise) for t in terms)


def test_lines_are_left_to_the_single_logs():
    lines = [model(WhiteNoise(2.0), Sinusoid(1.0, 2.0)), model(WhiteNoise(3.0), Sinusoid(1.0, 2.0))]
    terms = combined(lines, together()).axes["gyro_x"].processes.terms
    assert not any(isinstance(t, Sinusoid) for t in terms)


def test_without_a_weighted_mean_it_is_the_root_mean_square():
    axis = combined([model(WhiteNoise(1.0)), model(WhiteNoise(7.0))], together(None, None)).axes["gyro_x"]
    assert axis.processes.terms[0] == WhiteNoise(5.0)
    assert "0.N" not in axis.intervals
    assert axis.intervals["1.sigma"] == pytest.approx((0.3, 20.0))

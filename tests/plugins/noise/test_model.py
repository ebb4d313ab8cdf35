import pytest

from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import AxisModel, Constant, GaussMarkov, ImuErrorModel, Sinusoid, Sum, WhiteNoise
from imuwb_plugins.noise.model import combined
from imuwb_plugins.noise.repeatability import Compared, Repeatability, TurnOn


def model(*terms, name="m"):
    return ImuErrorModel(name, {"gyro_x": AxisModel(Sum(terms))}, {"log": f"{name}.mcap"})


MEAN, TURN_ON = Coefficient(2.5, 2.4, 2.6), Coefficient(0.7, 0.3, 20.0)


def together(mean=MEAN, turn_on=TURN_ON):
    n = Compared((Coefficient(2.0, 1.9, 2.1), Coefficient(3.0, 2.9, 3.1)), mean, 1.0, 0.5)
    return Repeatability(0.95, ("a", "b"), {"gyro_x": {"N": n}}, {"gyro_x": TurnOn((1.0, 2.0), turn_on)}, ())


def test_one_logs_model_stays_as_it_is():
    one = model(WhiteNoise(1.0))
    assert combined([one], None) is one


def test_several_logs_have_their_common_value_and_the_turn_on_bias():
    found = combined([model(WhiteNoise(2.0), name="a"), model(WhiteNoise(3.0), name="b")], together())
    axis = found.axes["gyro_x"]
    assert axis.processes.terms == (WhiteNoise(2.5), Constant(0.7))
    assert axis.intervals == {"0.N": (2.4, 2.6), "1.sigma": (0.3, 20.0)}
    assert "a.mcap" in found.provenance["logs"]
    assert "b.mcap" in found.provenance["logs"]
    assert ImuErrorModel.from_toml(found.to_toml()) == found


def test_logs_that_prefer_different_sums_are_combined_in_one():
    models = [model(WhiteNoise(2.0), GaussMarkov(1.0, 10.0)), model(WhiteNoise(3.0), GaussMarkov(3.0, 1000.0))]
    axis = combined(models, together()).axes["gyro_x"]
    assert axis.processes.terms == (WhiteNoise(2.5), Constant(0.7))


def test_lines_are_left_to_the_single_logs():
    lines = [model(WhiteNoise(2.0), Sinusoid(1.0, 2.0)), model(WhiteNoise(3.0), Sinusoid(1.0, 2.0))]
    terms = combined(lines, together()).axes["gyro_x"].processes.terms
    assert not any(isinstance(t, Sinusoid) for t in terms)


@pytest.mark.parametrize(
    ("mean", "limits"),
    [(Coefficient(None, None, 2.1), {"N": 2.1}), (Coefficient(2.5, 0.0, 2.8), {"N": 2.8}), (UNKNOWN, {})],
)
def test_what_all_logs_together_do_not_show_is_a_limit(mean, limits):
    axis = combined([model(WhiteNoise(1.0)), model(WhiteNoise(7.0))], together(mean)).axes["gyro_x"]
    assert axis.processes.terms == (Constant(0.7),)
    assert axis.intervals == {"0.sigma": (0.3, 20.0)}
    assert axis.limits == limits


def test_a_turn_on_bias_that_is_not_there_is_not_in_the_model():
    found = together(turn_on=Coefficient(None, None, 0.2))
    terms = combined([model(WhiteNoise(1.0)), model(WhiteNoise(7.0))], found).axes["gyro_x"].processes.terms
    assert terms == (WhiteNoise(2.5),)

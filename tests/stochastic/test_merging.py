import pytest

from imuwb.errors import UsageError
from imuwb.stochastic import Autoregressive, AxisModel, FlickerNoise, ImuErrorModel, RandomWalk, Sum, WhiteNoise, merge


def model(name, *terms, **rest):
    return ImuErrorModel(
        name, {"gyro_x": AxisModel(Sum(terms), **rest)}, {"log": f"{name}.mcap"}, (f"{name} is in doubt",)
    )


A = model("a", WhiteNoise(1e-3), RandomWalk(2e-6), intervals={"0.N": (0.9e-3, 1.1e-3)}, bias=0.1, limits={"Q": 1e-9})
B = model(
    "b",
    FlickerNoise(1e-5),
    WhiteNoise(3e-3),
    intervals={"1.N": (2e-3, 4e-3)},
    bias=0.2,
    scale_factor=0.01,
    limits={"K": 1e-8},
)
C = model("c", Autoregressive((0.5,), 1e-4, 0.01))


def test_each_term_comes_from_the_model_that_is_named_and_others_from_the_first():
    merged = merge((A, B, C), {"N": 1, "B": 1, "AR": 2, "calibration": 1})
    axis = merged.axes["gyro_x"]
    assert set(axis.processes.terms) == {
        WhiteNoise(3e-3),
        RandomWalk(2e-6),
        FlickerNoise(1e-5),
    }
    assert axis.autoregressive == C.axes["gyro_x"].processes.terms  # for 15AR and 27AR, and not twice in the sum
    place = axis.processes.terms.index(WhiteNoise(3e-3))
    assert axis.intervals == {f"{place}.N": (2e-3, 4e-3)}
    assert (axis.bias, axis.scale_factor, axis.limits) == (0.2, 0.01, {"Q": 1e-9})
    assert merged.doubts == ("a is in doubt", "b is in doubt", "c is in doubt")
    assert "N from b" in merged.provenance["merged"]
    assert ImuErrorModel.from_toml(merged.to_toml()).axes == merged.axes


def test_processes_of_the_ar_filters_are_replaced_order_by_order():
    one, other, three = (Autoregressive(a, 1e-4, 0.01) for a in ((-0.5,), (-0.6,), (-0.5, 0.1, 0.1)))
    kept = model("kept", WhiteNoise(1e-3), autoregressive=(one, three))
    axis = merge((kept, model("ar", other)), {"AR": 1}).axes["gyro_x"]
    assert axis.autoregressive == (other, three)
    assert merge((kept, A), {"K": 1}).axes["gyro_x"].autoregressive == (one, three)
    merged = merge((A, kept), {"AR": 1})
    assert merged.axes["gyro_x"].autoregressive == (one, three)
    assert ImuErrorModel.from_toml(merged.to_toml()).axes == merged.axes


@pytest.mark.parametrize(("taken", "named"), [({"X": 0}, "--take X"), ({"AR": 0}, "model a has none")])
def test_what_cannot_be_taken_is_named(taken, named):
    with pytest.raises(UsageError, match=named):
        merge((A, B), taken)


def test_a_triad_that_one_model_alone_has_is_kept():
    noise = ImuErrorModel("n", {a: AxisModel(Sum((WhiteNoise(1.0),))) for a in ("gyro_x", "accel_x")})
    gyro, accel = (ImuErrorModel(a, {f"{a}_x": AxisModel(bias=b)}) for a, b in (("gyro", 0.5), ("accel", 2.0)))
    both = merge((gyro, accel), {"calibration": 0}).axes
    assert (both["gyro_x"].bias, both["accel_x"].bias) == (0.5, 2.0)
    axes = merge((noise, gyro, accel), {"calibration": 1}).axes
    assert [(a.bias, a.processes.terms) for a in axes.values()] == [(b, (WhiteNoise(1.0),)) for b in (0.5, 2.0)]

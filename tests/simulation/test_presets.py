"""The presets against the published tables."""

import tomllib

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import preset, preset_names
from imuwb.stochastic import Constant, FlickerNoise, GaussMarkov, RandomWalk, WhiteNoise
from imuwb.units import unit as unit_of

ORDER = ("accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z")


def from_si(value, name):
    return unit_of(name).from_si(value)


@pytest.fixture(scope="module")
def tables(shared):
    return tomllib.loads((shared.parent / "papers" / "tables.toml").read_text("utf-8"))


def term(model, axis, kind):
    return next(t for t in model.axes[axis].processes.terms if isinstance(t, kind))


def test_quinchia(tables):
    table = tables["quinchia2013"]["table4_allan"]
    model = preset("3dm-gx3-25")
    for i, axis in enumerate(ORDER):
        gyro = axis.startswith("gyro")
        assert from_si(term(model, axis, WhiteNoise).N, "deg/√h" if gyro else "m/s/√h") == pytest.approx(table["N"][i])
        assert from_si(term(model, axis, FlickerNoise).B, "deg/h" if gyro else "m/s/h") == pytest.approx(table["B"][i])
        if gyro:
            assert len(model.axes[axis].processes.terms) == 2
        else:
            assert from_si(term(model, axis, RandomWalk).K, "m/s/h^1.5") == pytest.approx(table["K_acc"][i])


def test_quinchia_with_gauss_markov(tables):
    flat, peaked = preset("3dm-gx3-25"), preset("3dm-gx3-25-gm")
    for i, axis in enumerate(ORDER):
        process = term(peaked, axis, GaussMarkov)
        assert process.Tc == tables["quinchia2013"]["table5"]["Tc_s"][i]
        peak = process.allan_variance(np.array([1.8926 * process.Tc]), 0.01)
        level = term(flat, axis, FlickerNoise).allan_variance(np.ones(1), 0.01)
        assert peak == pytest.approx(level, rel=1e-4)


@pytest.mark.parametrize(("name", "key"), [("motionpakii", "MotionPakII"), ("ahrs300cc", "AHRS300CC")])
def test_eldiasty(tables, name, key):
    paper = tables["eldiasty"]
    model = preset(name)
    for axis in ORDER:
        column, unit = ("ARW", "deg/√h") if axis.startswith("gyro") else ("VRW", "m/s/√h")
        for celsius, figure in zip(paper["tabulated_c"], paper["table1_allan"][f"{key}_{column}"], strict=True):
            assert from_si(model.axes[axis].at(celsius).terms[0].N, unit) == pytest.approx(figure)


@pytest.mark.parametrize(("name", "key"), [("motionpakii-ar1", "MotionPakII"), ("ahrs300cc-ar1", "AHRS300CC")])
def test_eldiasty_coloured(tables, name, key):
    """Table 2 is the correlation of neighbours, and table 1 the density at low frequencies."""
    paper = tables["eldiasty"]
    model = preset(name)
    for axis in ORDER:
        column, unit, sensor = ("ARW", "deg/√h", "gyro") if axis.startswith("gyro") else ("VRW", "m/s/√h", "acc")
        rows = zip(
            paper["tabulated_c"],
            paper["table1_allan"][f"{key}_{column}"],
            paper["ar1"][f"{key}_{sensor}"]["none"],
            strict=True,
        )
        for celsius, white, c in rows:
            process = model.axes[axis].at(celsius).terms[0]
            assert process.alpha == (-c,)
            density = process.power_spectral_density(np.array([1e-6]), process.dt)[0]
            assert from_si(density**0.5, unit) == pytest.approx(white, rel=1e-5)


def test_hassaballa(tables):
    sheet = tables["hassaballa"]["table1_datasheet"]
    model, measured = preset("mpu-6050"), preset("mpu-6050-measured")
    for axis in ORDER:
        gyro = axis.startswith("gyro")
        density = from_si(term(model, axis, WhiteNoise).N, "deg/s/√Hz" if gyro else "µg/√Hz")
        assert density == pytest.approx(
            sheet["gyro"]["noise_density_deg_s_rthz"] if gyro else sheet["accel"]["noise_density_ug_rthz"]
        )
        steps = 1 / from_si(model.axes[axis].lsb, "deg/s" if gyro else "g")
        assert steps == pytest.approx(sheet["gyro"]["lsb_per_deg_s"] if gyro else sheet["accel"]["lsb_per_g"], rel=1e-5)
    arw = from_si(term(measured, "gyro_z", WhiteNoise).N, "deg/√s")
    assert arw == pytest.approx(tables["hassaballa"]["table2_z_gyro"]["ARW"][0])


def test_a_tactical_grade():
    """The figures of the data sheet: random walks, the flat part of the Allan deviation, and the repeatability of the bias."""
    model = preset("stim300")
    for axis in ORDER:
        gyro = axis.startswith("gyro")
        flat = term(model, axis, FlickerNoise).allan_variance(np.array([100.0]), 0.01)[0] ** 0.5
        assert from_si(term(model, axis, WhiteNoise).N, "deg/√h" if gyro else "m/s/√h") == pytest.approx(
            0.15 if gyro else 0.06
        )
        assert from_si(flat, "deg/h" if gyro else "mg") == pytest.approx(0.5 if gyro else 0.05, rel=0.01)
        assert from_si(term(model, axis, Constant).sigma, "deg/h" if gyro else "mg") == pytest.approx(
            4 if gyro else 0.75
        )


def test_unknown_presets_are_answered_with_the_known():
    with pytest.raises(UsageError, match=", ".join(preset_names())):
        preset("adis")

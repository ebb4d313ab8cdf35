import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from imuwb.errors import UsageError
from imuwb.units import UNITS, coefficient_units, si_unit, unit

DEG = math.pi / 180
VALUES = st.floats(-1e6, 1e6, allow_nan=False)


@given(st.sampled_from(sorted(UNITS)), VALUES)
def test_there_and_back_is_the_identity(name, value):
    assert unit(name).to_si(unit(name).from_si(value)) == pytest.approx(value, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "si"),
    [
        ("deg/√h", DEG / 60),
        ("deg/h", DEG / 3600),
        ("deg/h^1.5", DEG / 3600 / 60),
        ("deg/h/√h", DEG / 216_000),
        ("deg/h²", DEG / 3600**2),
        ("m/s/√h", 1 / 60),
        ("m/s/h^1.5", 1 / 216_000),
        ("m/s/h", 1 / 3600),
        ("µg/√Hz", 9.80665e-6),
        ("mg/√Hz", 9.80665e-3),
        ("µg", 9.80665e-6),
        ("g", 9.80665),
        ("deg/s/√Hz", DEG),
        ("arcsec", DEG / 3600),
        ("degE7", 1e-7 * DEG),
        ("rpm", 2 * math.pi / 60),
        ("knot", 1852 / 3600),
        ("km/h", 1 / 3.6),
        ("%", 0.01),
    ],
)
def test_one_of_each(name, si):
    assert unit(name).to_si(1.0) == pytest.approx(si, rel=1e-15)


def test_kelvin_has_an_offset():
    assert unit("K").to_si(273.15) == 0.0
    assert unit("degF").to_si(32.0) == pytest.approx(0.0, abs=1e-12)
    assert unit("°F").from_si(100.0) == pytest.approx(212.0)
    assert unit("K").from_si(25.0) == 298.15
    assert unit("cdegC").to_si(2512) == pytest.approx(25.12)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("dps", "deg/s"), ("°/s", "deg/s"), ("DEG/S", "deg/s"), ("deg / s", "deg/s"), ("°/h", "deg/h"),
        ("deg/hr", "deg/h"), ("m/s^2", "m/s²"), ("m/s**2", "m/s²"), ("m/s/s", "m/s²"), ("m/s2", "m/s²"),
        ("deg/sqrt(h)", "deg/√h"), ("deg/sqrt(hr)", "deg/√h"), ("°/√h", "deg/√h"), ("deg/h^(3/2)", "deg/h^1.5"),
        ("m/s/sqrt(h)", "m/s/√h"), ("ug/sqrt(Hz)", "µg/√Hz"), ("μg/√Hz", "µg/√Hz"),
        ("degrees per minute", "deg/min"), ("°/hr", "deg/h"), ("rev/min", "rpm"), ("g·s", "g·s"), ("ug*s", "µg·s"),
        ("N/kg", "m/s²"), ("milli-g", "mg"), ("dph", "deg/h"), ('"/s', "arcsec/s"), ("ug", "µg"), ("G", "g"),
        ("µs", "us"), ("degC", "°C"), ("celsius", "°C"), ("k", "K"), ("rad/s/sqrt(s)", "rad/s/√s"),
        ("rad/s^2/sqrt(Hz)", "rad/s²/√Hz"), ("", "1"),
        ("dps/√Hz", "deg/s/√Hz"), ("mdps/rtHz", "mdeg/s/√Hz"), ("ug/rtHz", "µg/√Hz"),
    ],
)  # fmt: skip
def test_spellings(written, meant):
    assert unit(written) is UNITS[meant]


@pytest.mark.parametrize("name", sorted(UNITS))
def test_every_unit_is_found_by_its_own_name(name):
    assert unit(name) is UNITS[name]
    assert unit(f" {name} ") is UNITS[name]


def test_an_unknown_unit_is_named_and_the_known_are_listed():
    with pytest.raises(UsageError, match=r"unknown unit 'furlong'; write one of: .*deg/√h.*m/s²"):
        unit("furlong")


def test_the_si_unit_of_each_dimension_has_factor_one():
    for entry in UNITS.values():
        si = UNITS[si_unit(entry.dimension)]
        assert (si.dimension, si.factor, si.offset) == (entry.dimension, 1.0, 0.0)


@pytest.mark.parametrize("axis", ["gyro_x", "accel_z"])
@pytest.mark.parametrize("coefficient", ["Q", "N", "B", "K", "R", "rate"])
def test_coefficients_are_shown_in_a_unit_of_their_dimension(axis, coefficient):
    si, display = coefficient_units(axis, coefficient)
    assert si.dimension == display.dimension
    assert si.factor == 1.0
    assert display.factor != 1.0


def test_densities_and_walks_are_told_apart():
    assert unit("deg/√h").dimension != unit("deg/h").dimension != unit("deg/h^1.5").dimension


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("rad s^-1", "rad/s"), ("m s^-2", "m/s²"), ("m.s^-2", "m/s²"), ("deg.s^-1", "deg/s"), ("m/^s", "m/s²"), ("m·s⁻²", "m/s²"),
        ("degrees per second", "deg/s"), ("metre per second squared", "m/s²"), ("meters/second^2", "m/s²"), ("Mps2", "m/s²"),
        ("RadPerSec", "rad/s"), ("knots", "knot"), ("Kmh", "km/h"), ("1e-7 deg", "degE7"), ("mgal", "mGal"), ("rad s-1", "rad/s"),
    ],
)  # fmt: skip
def test_spellings_of_files(text, name):
    assert unit(text) is UNITS[name]


@pytest.mark.parametrize("text", ["m^2/s", "gs", "rad s^-3", "per second", "s^-1"])
def test_other_texts_are_no_units(text):
    with pytest.raises(UsageError):
        unit(text)

"""An IMU of one axis or two, such as a single fibre-optic gyro: what works does, the rest names the axes that exist."""

import json

import numpy as np
import pytest

from imuwb.axes import axes_of
from imuwb.conditioning.correction import correct
from imuwb.errors import MissingDataError
from imuwb.health import check
from imuwb.identification import allan
from imuwb.log import SECOND, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.navigation import Installation
from imuwb.navigation.measurement import measurement_of
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch
from imuwb.stochastic import AxisModel, ImuErrorModel, WhiteNoise
from imuwb.summary import summarize
from imuwb.writers import SUFFIXES, write

RATE = 100.0
N = {"gyro": 2e-4, "accel": 2e-3}  #: rad/s/√Hz and m/s²/√Hz
KINDS = {"gyro z": ("z", None), "gyro x, y": ("xy", None), "accel y": (None, "y"), "gyro z, accel": ("z", "xyz")}


def triad(axes, sensor, rows, seed):
    """Return white noise of known density on some axes; the accelerometer feels gravity on z."""
    if axes is None:
        return None
    value = np.random.default_rng(seed).standard_normal((rows, 3)) * N[sensor] * RATE**0.5
    value[:, 2] -= 9.8 if sensor == "accel" else 0.0
    value[:, [i for i, axis in enumerate("xyz") if axis not in axes]] = np.nan
    return Triad(np.arange(rows) * round(SECOND / RATE), value)


def log_of(kind, rows=12000):
    gyro, accel = (triad(axes, s, rows, 7) for axes, s in zip(KINDS[kind], ("gyro", "accel"), strict=True))
    time = np.arange(0, rows, 50) * round(SECOND / RATE)
    celsius = Scalars("/imu/temperature", time, 20 + 20 * np.sin(np.arange(time.size) / 40))
    return Log(Provenance("made.mcap", "mcap", "sha256:0", 0), (ImuStream("/imu", gyro, accel, celsius),))


def names_of(kind):
    return [f"{s}_{axis}" for s, axes in zip(("gyro", "accel"), KINDS[kind], strict=True) for axis in axes or ""]


@pytest.fixture(params=list(KINDS))
def kind(request):
    return request.param


@pytest.fixture
def written(kind, tmp_path):
    path = tmp_path / "log.csv"
    write(log_of(kind), path)
    return path


def test_a_triad_knows_its_axes():
    time, value = np.arange(3), np.arange(9.0).reshape(3, 3)
    assert (Triad(time, value).axes, Triad(time[:0], value[:0]).axes) == ("xyz", "xyz")
    value[:, 0] = np.nan
    assert Triad(time, value).axes == "yz"


@pytest.mark.parametrize("cells", [[(0, 0)], [(1, 1), (2, 1)], [(0, 0), (1, 0), (2, 0), (1, 2)]])
def test_a_triad_is_nan_in_an_axis_throughout_or_nowhere(cells):
    value = np.arange(9.0).reshape(3, 3)
    for cell in cells:
        value[cell] = np.nan
    with pytest.raises(ValueError, match="values that are not finite"):
        Triad(np.arange(3), value)


def test_a_triad_has_an_axis():
    with pytest.raises(ValueError, match="9 values that are not finite"):
        Triad(np.arange(3), np.full((3, 3), np.nan))


def test_streams_have_the_axes_that_exist(kind):
    (imu,) = log_of(kind).imus
    assert list(imu.axes()) == list(axes_of(imu)) == names_of(kind)
    assert f"only {', '.join(names_of(kind))}" in str(imu)
    assert [axis.clock.rate for axis in axes_of(imu).values()] == pytest.approx([RATE] * len(names_of(kind)))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read(kind, suffix, tmp_path):
    path, log = tmp_path / f"log{suffix}", log_of(kind)
    write(log, path)
    back = read(path)
    assert list(back.imu().axes()) == names_of(kind)
    for name, (_, values) in log.imu().axes().items():
        np.testing.assert_array_equal(back.imu().axes()[name][1], values)
    assert "axes_missing" in ids(back.notes)
    assert summarize(back).streams[0].count == 12000


def test_rows_without_a_value_in_an_axis_that_exists_are_left_out():
    value = np.full((6, 3), np.nan)
    value[:, 1] = 1.0
    value[3, 1] = np.nan
    batches = [
        Batch("imu", "imu", np.arange(6)[part], {"angular_rate": value[part]}) for part in (slice(3), slice(3, 6))
    ]
    log = assemble(batches, Provenance("", "test", "", 0))
    assert log.imu().angular_rate.time.tolist() == [0, 1, 2, 4, 5]
    assert [(r.what.id, r.count) for r in log.imu().origin.repairs] == [("not_finite", 1)]


def test_an_axis_that_begins_late_is_no_missing_axis():
    value = np.ones((4, 3))
    value[:2, 0] = np.nan
    parts = [Batch("imu", "imu", np.arange(4)[part], {"angular_rate": value[part]}) for part in (slice(2), slice(2, 4))]
    log = assemble(parts, Provenance("", "test", "", 0))
    assert (log.imu().angular_rate.axes, len(log.imu().angular_rate)) == ("xyz", 2)


def test_repeats_and_turns_are_found_in_one_axis_too():
    value = np.full((600, 3), np.nan)
    value[:, 2] = np.random.default_rng(0).standard_normal(600)
    rows = np.repeat(np.arange(600), np.where(np.arange(600) % 10 == 0, 2, 1))
    twice = assemble([Batch("imu", "imu", rows * 10**7, {"angular_rate": value[rows]})], Provenance("", "test", "", 0))
    assert [(r.what.id, r.count) for r in twice.imu().origin.repairs] == [("repeated_row", 60)]
    assert twice.imu().angular_rate.axes == "z"


def test_health_examines_the_axes_that_exist(kind):
    found = check(log_of(kind), lines=False)
    assert {stream.verdict for stream in found.streams} == {"good"}
    assert {fault.kind for fault in found.faults} <= {"step"}


def test_a_turning_single_gyro_is_a_fault():
    log = log_of("gyro z")
    gyro = Triad(log.imu().angular_rate.time, log.imu().angular_rate.value + 0.2)
    turning = Log(log.provenance, (ImuStream("/imu", gyro, None),))
    assert "rate" in {fault.kind for fault in check(turning, lines=False).faults}


def test_allan_finds_the_noise_of_the_axes_that_exist(kind, written, imuwb, tmp_path):
    done = imuwb("allan", written, "--no-estimators", "-o", "a.rrd", "--json", "a.json")
    assert done.code == 0, done.err
    axes = json.loads((tmp_path / "a.json").read_text())["result"]["axes"]
    assert list(axes) == names_of(kind)
    for name, own in axes.items():
        assert own["coefficients"]["N"]["value"] == pytest.approx(N[name.partition("_")[0]], rel=0.1)
    curve = allan(log_of(kind).imu().axes()[names_of(kind)[0]][1], 1 / RATE)
    np.testing.assert_allclose(axes[names_of(kind)[0]]["allan_deviation"][0], curve.deviation[0], rtol=1e-9)


@pytest.mark.parametrize(
    "analysis",
    [
        ("noise",), ("psd",), ("autocorrelation",), ("autoregressive",), ("lssa",), ("health",),
        ("temperature",),
        ("allan", "--no-estimators", "--through", "wavelet:levels=2", "--through", "bias:seconds=5", "--through", "kaiser:fc=20"),
        ("allan", "--no-estimators", "--through", "wavelet", "--through", "decimate:factor=2"),
    ],
    ids=lambda words: " ".join(words[:1] + words[3:4]),
)  # fmt: skip
@pytest.mark.parametrize("kind", ["gyro z"], indirect=True)
def test_analyses_and_conditioners_take_one_axis(written, imuwb, analysis, tmp_path):
    done = imuwb(*analysis[:1], written, *analysis[1:], "-o", "a.rrd", "--json", "a.json")
    assert done.code == 0, done.err
    text = (tmp_path / "a.json").read_text()
    assert "gyro_z" in text or analysis[0] == "health"
    assert "gyro_x" not in text


@pytest.mark.parametrize("method", ["six-position", "multi-position", "rate-table"])
@pytest.mark.parametrize("kind", ["gyro z, accel"], indirect=True)
def test_a_calibration_names_the_axes_that_exist(written, kind, imuwb, method):
    rates = ("--rates", "10,-10") if method == "rate-table" else ()
    done = imuwb("calibration", method, *[written] * (6 if method == "six-position" else 1), *rates, "-o", "a.rrd")
    assert (done.code, ", ".join(names_of(kind)) in done.err) == (3, True), done.err


@pytest.mark.parametrize("kind", ["gyro z, accel"])
def test_navigation_names_the_axes_that_exist(kind):
    with pytest.raises(MissingDataError, match="only gyro_z, accel_x, accel_y, accel_z"):
        measurement_of((log := log_of(kind)), log.imu(), Installation())


def corrected(kind, **terms):
    names = names_of(kind)
    axis = AxisModel(WhiteNoise(1e-3), **terms)
    return correct(log_of(kind), ImuErrorModel("m", dict.fromkeys(names, axis)))[0]


def test_a_bias_and_a_scale_are_corrected_in_the_axes_that_exist(kind):
    before, after = log_of(kind).imu().axes(), corrected(kind, bias=0.25, scale_factor=1.0).imu().axes()
    assert list(after) == names_of(kind)
    for name, (_, values) in after.items():
        np.testing.assert_allclose(values, (before[name][1] - 0.25) / 2, rtol=1e-12, atol=1e-15)


def test_a_cross_coupling_needs_the_other_axes(kind):
    with pytest.raises(MissingDataError, match=f"only {', '.join(names_of(kind))}"):
        corrected(kind, cross_coupling=(0.1, 0.1))

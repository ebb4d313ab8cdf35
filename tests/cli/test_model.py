import json

import numpy as np
import pytest

from imuwb.estimators import tools
from imuwb.navigation import FilterModel, Vibration, filter_text
from imuwb.simulation import preset, preset_names
from imuwb.stochastic import ImuErrorModel, WhiteNoise


@pytest.fixture
def gm(tmp_path):
    path = tmp_path / "gm.toml"
    path.write_text(preset("3dm-gx3-25-gm").to_toml(), "utf-8")
    return path


@pytest.fixture
def flicker(tmp_path):
    path = tmp_path / "flicker.toml"
    path.write_text(preset("3dm-gx3-25").to_toml(), "utf-8")
    return path


@pytest.fixture
def other(tmp_path):
    path = tmp_path / "other.toml"
    path.write_text(preset("3dm-gx3-25").to_toml().replace("3dm", "other"), "utf-8")
    return path


def entities(path):
    from rerun.chunk import RrdReader

    return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()}


def test_a_model_is_shown(imuwb, flicker, tmp_path):
    done = imuwb("model", "show", flicker, "-o", "flicker.rrd")
    assert done.code == 0, done.err
    assert "2.42" in done.out
    assert "deg/√h" in done.out
    found = entities(tmp_path / "flicker.rrd")
    for i in range(4):
        assert f"/model/figure_{i}" in found


def test_nothing_is_written_unless_it_is_asked_for(imuwb, flicker, other, tmp_path):
    before = sorted(tmp_path.iterdir())
    for _ in range(2):
        assert imuwb("model", "show", flicker).code == 0
        done = imuwb("model", "compare", flicker, other)
        assert done.code == 0, done.err
    assert "2.42" in done.out
    assert sorted(tmp_path.iterdir()) == before


def test_the_curves_are_those_of_the_processes():
    import numpy as np

    from imuwb.review.answers.models import draw_models

    figures = []

    class Review:
        figure = figures.append

        def table(self, table):
            pass

    draw_models({"m.toml": preset("3dm-gx3-25")}, 50.0, 3600.0, Review())
    curve = figures[0].curves[0]
    assert (curve.x[0], curve.x[-1]) == pytest.approx((0.02, 1800))
    expected = preset("3dm-gx3-25").axes["gyro_x"].processes.allan_variance(curve.x, 0.02) ** 0.5
    np.testing.assert_allclose(curve.y * np.pi / 180 / 3600, expected, rtol=1e-9)
    density = figures[1].curves[0]
    white = 2 * (2.42 / 60) ** 2  # one-sided, (deg/s)²/Hz
    assert density.y[-1] == pytest.approx(white, rel=0.01)


def test_answers_fit_a_screen_and_the_worst_comes_first(imuwb, gm, flicker, other, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text('[gyro]\nN = "0.3 deg/√h"\n[accel]\nN = "9 m/s/√h"\n', "utf-8")
    shown = imuwb("model", "compare", gm, flicker, other).out.splitlines()
    assert len(shown) <= 15
    assert "No coefficient differs" in " ".join(shown)
    checked = imuwb("model", "check", flicker, "--against", limits)
    lines = checked.out.splitlines()
    assert (checked.code, len(lines) <= 15, lines[2].split()[-1]) == (1, True, "beyond")
    assert max(len(line) for line in lines if "imuwb" not in line) <= 80
    whole = imuwb("model", "check", flicker, "--against", limits, "--full").out
    assert "verdict" in whole.partition("CHECK")[0]


def test_models_are_compared(imuwb, flicker, other, tmp_path):
    done = imuwb("model", "compare", flicker, other, "-o", "both.rrd")
    assert done.code == 0, done.err
    assert "flicker.toml" in done.out
    assert "other.toml" in done.out
    assert "/models/figure_0" in entities(tmp_path / "both.rrd")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [(["compare", "gm.toml"], "two or more"), (["show", "gm.toml", "-o", "x.html"], ".rrd"),
     (["show", "gm.toml", "--rate", "0"], "--rate is 0"), (["show", "gm.toml", "--hours", "-1"], "--hours -1"),
     (["show", "gone.toml"], "gone.toml: cannot be read"), (["export", "gm.toml", "--to", "excel"], "kalibr, openvins"),
     (["export", "gm.toml", "--to", "ros", "--rate", "0"], "must be above 0"),
     (["check", "gm.toml", "--against", "gone.toml"], "cannot be read"),
     (["check", "gm.toml", "--against", "gm.toml", "--factor", "0"], "--factor is 0")],
)  # fmt: skip
def test_wrong_usage_is_named(imuwb, gm, tmp_path, arguments, named):
    done = imuwb("model", *arguments)
    assert done.code == 2
    assert named in done.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["gm.toml"]


def test_what_is_no_model_is_refused(imuwb, tmp_path):
    (tmp_path / "bad.toml").write_text("[gyro_x]\nspeed = 3\n", "utf-8")
    done = imuwb("model", "show", "bad.toml")
    assert (done.code, "bad.toml" in done.err) == (2, True)


def test_existing_files_are_kept_without_force(imuwb, gm, tmp_path):
    (tmp_path / "gm.rrd").write_bytes(b"mine")
    (tmp_path / "imu.yaml").write_bytes(b"mine")
    assert imuwb("model", "show", gm, "-o", "gm.rrd").code == 2
    assert imuwb("model", "export", gm, "--to", "kalibr", "-o", "imu.yaml").code == 2
    assert imuwb("model", "show", gm, "-o", gm).code == 2
    assert (tmp_path / "gm.rrd").read_bytes() == (tmp_path / "imu.yaml").read_bytes() == b"mine"
    assert imuwb("model", "export", gm, "--to", "kalibr", "-o", "imu.yaml", "--force").code == 0
    assert b"gyroscope_noise_density" in (tmp_path / "imu.yaml").read_bytes()


def test_an_export_goes_to_stdout_alone(imuwb, gm):
    done = imuwb("model", "export", gm, "--to", "json")
    assert json.loads(done.out)["units"] == "SI"
    lines = imuwb("model", "export", gm, "--to", "kf-gins").out.splitlines()
    (arw,) = (line for line in lines if "arw:" in line)
    assert json.loads(arw.split(":")[1].split("#")[0]) == pytest.approx([2.42, 1.988, 2.164])


def test_an_export_that_lacks_a_sensor_is_missing_data(imuwb, tmp_path):
    (tmp_path / "white.toml").write_text('[[gyro_x.processes]]\nprocess = "white_noise"\nN = 0.001\n', "utf-8")
    for tool in ("kalibr", "ros", "kf-gins", "px4"):
        done = imuwb("model", "export", "white.toml", "--to", tool, "--rate", "100", "-o", "out.txt")
        assert (done.code, done.out) == (3, "")
        assert not (tmp_path / "out.txt").exists()


def test_a_file_goes_out_and_comes_back_in(imuwb, gm, tmp_path):
    assert imuwb("model", "export", gm, "--to", "vins", "--rate", "200", "-o", "vins.yaml").code == 0
    done = imuwb("model", "import", "vins.yaml", "--rate", "200", "-o", "back.toml")
    assert (done.code, "read as vins" in done.err) == (0, True)
    shown = imuwb("model", "export", "back.toml", "--to", "vins").out
    values = [line for line in (tmp_path / "vins.yaml").read_text("utf-8").splitlines() if not line.startswith("#")]
    assert [line for line in shown.splitlines() if not line.startswith("#")] == values
    assert imuwb("model", "import", "vins.yaml").code == 2  # no rate


def test_imu_tk_gets_a_file_for_each_triad(imuwb, tmp_path):
    curve = 'thermal_bias = [{celsius = 10.0, value = "0.1 m/s²"}, {celsius = 20.0, value = "0.3 m/s²"}]'
    (tmp_path / "warm.toml").write_text(f"[accel_x]\n{curve}\n", "utf-8")
    assert "--celsius T" in imuwb("model", "export", "warm.toml", "--to", "imu-tk").err
    done = imuwb("model", "export", "warm.toml", "--to", "imu-tk", "--celsius", "15")
    assert (done.out.split()[18], "at 15 °C" in done.err) == ("0.2", True)
    assert imuwb("model", "export", "warm.toml", "--to", "px4-tc", "--celsius", "15").code == 2
    (tmp_path / "cube.toml").write_text("[accel_x]\nbias = 0.1\n", "utf-8")
    done = imuwb("model", "export", "cube.toml", "--to", "imu-tk", "-o", "cube.calib")
    assert (done.code, "cube.acc.calib, cube.gyro.calib" in done.err) == (0, True), done.err
    assert len((tmp_path / "cube.gyro.calib").read_text("utf-8").split()) == 21
    assert not (tmp_path / "cube.calib").exists()
    assert imuwb("model", "export", "cube.toml", "--to", "imu-tk", "-o", "cube.calib").code == 2


def test_an_unknown_form_is_answered_with_all(imuwb, gm):
    done = imuwb("model", "export", gm, "--to", "nobody")
    assert (done.code, all(name in done.err for name in (*tools(), "imu-tk", "px4-tc", "json"))) == (2, True)


def test_an_explanation_and_noise_in_motion(imuwb, gm):
    done = imuwb("model", "explain", gm, "--for", "fast-lio", "--rate", "200")
    assert (done.code, "acc_cov" in done.out, "times 10" in done.out) == (0, True, True)
    assert len(done.out.splitlines()) <= 15
    assert "--for fast-lio --rate 200 --full" in done.out
    assert "{" not in done.out
    assert "no bias process" in imuwb("model", "explain", gm, "--for", "fast-lio", "--rate", "200", "--full").out
    assert "--for json" in imuwb("model", "explain", gm, "--for", "json").err
    assert imuwb("model", "export", gm, "--to", "kalibr", "--in-motion", gm).code == 3  # not of a drive
    assert imuwb("model", "export", gm, "--to", "kalibr", "--in-motion", "wheel=2").code == 2


def test_noise_that_grows_with_vibration_counts_in_a_saved_filter(imuwb, gm, tmp_path):
    bench = preset("3dm-gx3-25-gm")
    white = max(t.N for t in bench.axes["gyro_x"].processes.terms if isinstance(t, WhiteNoise))
    road = FilterModel("motion", bench, vibration=Vibration((np.sqrt(24.0) * white, 0.0), 1.0))
    (tmp_path / "road.toml").write_text(filter_text(road), "utf-8")
    done = imuwb("model", "export", gm, "--to", "kalibr", "--in-motion", "road.toml")
    assert "gyro 5.00" in done.out
    assert "accel 1.00" in done.out


@pytest.mark.parametrize(
    ("limit", "code", "outcome"),
    [
        ('[gyro_x]\nN = "2.5 deg/√h"', 0, "within"),
        ('[gyro_x]\nN = "2.4 deg/√h"', 1, "beyond"),
        ('[gyro_x]\nB = "9 deg/h"', 1, "not known"),
    ],
)
def test_a_check_passes_or_fails(imuwb, gm, tmp_path, limit, code, outcome):
    (tmp_path / "sheet.toml").write_text(limit, "utf-8")
    done = imuwb("model", "check", gm, "--against", "sheet.toml")
    assert done.code == code
    assert outcome in done.out
    assert ("not within sheet.toml: gyro_x" in done.err) == bool(code)
    done = imuwb("model", "check", gm, "--against", "sheet.toml", "--json")
    document = json.loads(done.out)
    assert done.code == code
    assert document["passed"] == (not code)
    assert document["limits"][0]["outcome"] == outcome


def test_a_limit_inside_the_interval_is_not_sure(imuwb, tmp_path):
    text = '[[gyro_x.processes]]\nprocess = "white_noise"\nN = { value = 0.001, lower = 0.0009, upper = 0.0012 }\n'
    (tmp_path / "m.toml").write_text(text, "utf-8")
    (tmp_path / "sheet.toml").write_text('[gyro_x]\nN = "0.0011 rad/s/√Hz"\n', "utf-8")
    done = imuwb("model", "check", "m.toml", "--against", "sheet.toml")
    assert (done.code, "not sure" in done.out) == (1, True)
    assert imuwb("model", "check", "m.toml", "--against", "sheet.toml", "--factor", 1.1).code == 0
    assert imuwb("model", "check", "m.toml", "--against", "m.toml").code == 0


@pytest.mark.parametrize("limit", ["N = 0.0011", 'N = "0.3"', 'N = "1 furlong"', 'N = "0.3 deg/h"'])
def test_a_limit_without_its_unit_is_wrong_usage_that_names_file_and_key(imuwb, gm, tmp_path, limit):
    (tmp_path / "sheet.toml").write_text(f"[gyro_x]\n{limit}\n", "utf-8")
    done = imuwb("model", "check", gm, "--against", "sheet.toml")
    assert (done.code, done.out) == (2, "")
    assert "sheet.toml: N = " in done.err
    assert "unit" in done.err


def test_a_model_survives_its_file(gm):
    assert ImuErrorModel.read(gm) == preset("3dm-gx3-25-gm")


def test_the_published_sensors_are_listed_one_line_each_in_eighty_columns(imuwb):
    done = imuwb("model", "list")
    lines = done.out.splitlines()
    assert done.code == 0, done.err
    assert all(max(map(len, (line for line in lines if line.startswith(c)))) <= 80 for c in "┏│└")
    assert sum(line.startswith("│") for line in lines) == len(preset_names())
    cells = next(line for line in lines if "adis16470" in line).split("│")[2:6]
    assert [cell.strip() for cell in cells] == ["industrial", "0.34", "≈84.1", "≤12"]
    assert "revision C: features" in imuwb("model", "list", "--full").out

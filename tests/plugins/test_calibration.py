from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from imuwb import simulation
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Triad
from imuwb.notes import ids
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise
from imuwb_plugins.calibration import METHODS
from imuwb_plugins.calibration.parameter_table import trace_figure

TILT = np.radians(0.05)
RATES = "10,50,100"


def named(logs):
    return [replace(log, provenance=replace(log.provenance, path=f"{name}.mcap")) for name, log in logs.items()]


def run(method, logs, **options):
    return METHODS[method].run(logs, METHODS[method].Parameters(**options))


@pytest.fixture(scope="module")
def sensor():
    return simulation.specimen(simulation.preset("mpu-6050"), 11, simulation.Tolerances())


@pytest.fixture(scope="module")
def cube(sensor):
    return named(simulation.six_position(sensor, 11, seconds=30, rate=50, misplacement=TILT).logs)


@pytest.fixture(scope="module")
def turns(sensor):
    rates = np.radians([10.0, 50.0, 100.0])
    return named(simulation.rate_table(sensor, 11, rates, seconds=10, rate=50, misplacement=TILT).logs)


@pytest.fixture(scope="module")
def six(cube):
    return run("six-position", cube)


def changed(log, sensor="accel", apply=None, drop=False):
    imu = log.imu()
    field = "specific_force" if sensor == "accel" else "angular_rate"
    triad = getattr(imu, field)
    new = None if drop else Triad(triad.time, apply(triad.value))
    return replace(log, imus=(replace(imu, **{field: new}),))


def near(p, true, sigmas=5):
    return abs(p.value - true) < sigmas * p.sigma + 1e-15 and p.lower < p.value < p.upper


def test_six_position_finds_the_sensor(six, sensor):
    for axis, found in six.parameters.items():
        true = sensor.axes[axis]
        assert near(found["bias"], true.bias), axis
        if axis.startswith("accel"):
            assert near(found["scale_factor"], true.scale_factor + true.scale_factor_nonlinear / 2), axis
            assert found["scale_factor"].unit == "1"
        else:
            for k, g in zip("xyz", true.g_sensitivity, strict=True):
                assert near(found[f"g_sensitivity_{k}"], g), (axis, k)
        for k, c in zip([k for k in "xyz" if k != axis[-1]], true.cross_coupling, strict=True):
            assert axis.startswith("gyro") or near(found[f"cross_coupling_{k}"], c), (axis, k)
    assert [p.up for p in six.positions] == ["x up", "x down", "y up", "y down", "z up", "z down"]
    assert six.misplacement == pytest.approx(TILT, rel=0.8)
    assert "gravity-unknown" in ids(six.notes)


def test_the_model_has_what_was_found(six):
    for axis, found in six.parameters.items():
        model = six.model.axes[axis]
        assert model.bias == found["bias"].value
        if axis.startswith("accel"):
            assert model.scale_factor == found["scale_factor"].value
    assert "six-position" in six.model.provenance["calibration"]
    assert "up_x.mcap" in six.model.provenance["calibration_logs"]


def test_corrected_traces_lie_on_the_reference(six):
    for trace in six.traces:
        scatter = np.std(trace.corrected - trace.reference)
        assert abs(np.mean(trace.corrected - trace.reference)) < 0.3 * scatter, trace.title
    assert sum(trace.title.startswith("Accelerometer") for trace in six.traces) == 3


def test_one_log_of_all_positions_gives_the_same(sensor, six):
    made = simulation.six_position(sensor, 12, seconds=20, rate=50, misplacement=TILT, one_log=True)
    found = run("six-position", named(made.logs))
    assert len(found.positions) == 6
    for axis in ("accel_x", "accel_y", "accel_z"):
        a, b = found.parameters[axis]["bias"], six.parameters[axis]["bias"]
        assert abs(a.value - b.value) < 5 * np.hypot(a.sigma, b.sigma)


def test_gravity_comes_from_latitude_and_height(cube):
    found = run("six-position", cube, latitude=45.0, height=0.0)
    assert found.gravity == pytest.approx(9.80620, abs=2e-5)
    assert run("six-position", cube, latitude=45.0, height=1000.0).gravity == pytest.approx(9.80311, abs=2e-5)
    given = run("six-position", cube, gravity=9.81)
    assert (given.gravity, given.gravity_from) == (9.81, "given")
    assert "gravity-unknown" not in ids(given.notes)


def test_rate_table_finds_the_gyros(turns, sensor):
    found = run("rate-table", turns, rates=RATES)
    for axis, p in found.parameters.items():
        true = sensor.axes[axis]
        assert near(p["scale_factor"], true.scale_factor), axis
        assert near(p["scale_factor_nonlinear"], true.scale_factor_nonlinear), axis
        assert p["bias"].lower < true.bias < p["bias"].upper
        for k, c in zip([k for k in "xyz" if k != axis[-1]], true.cross_coupling, strict=True):
            assert near(p[f"cross_coupling_{k}"], c), (axis, k)
    assert [r.axis for r in found.runs] == ["gyro_x", "gyro_y", "gyro_z"]
    assert [round(float(np.degrees(s.rate))) for s in found.runs[0].steps] == [0, 10, 50, 100, 0, -10, -50, -100, 0]
    assert found.full_range == pytest.approx(np.radians(250))
    for r in found.runs:
        for step in r.steps:
            assert step.error == pytest.approx(step.mean[r.axis] - step.rate - r.offset[r.axis].value)
            assert step.error - step.fitted_error == pytest.approx(step.residual[r.axis], abs=1e-12)
    assert str(found).count("\n") == 3


def test_into_a_model_keeps_its_noise_and_takes_its_g_sensitivity_off(six, turns, sensor, tmp_path):
    noisy = {k: replace(a, processes=Sum((WhiteNoise(1e-3),)), bandwidth=20.0) for k, a in six.model.axes.items()}
    path = tmp_path / "six.toml"
    path.write_text(ImuErrorModel("mine", noisy).to_toml(), "utf-8")
    found = run("rate-table", turns, rates=RATES, into=path)
    alone = run("rate-table", turns, rates=RATES)
    for axis, model in found.model.axes.items():
        assert model.processes == Sum((WhiteNoise(1e-3),))
        assert model.bandwidth == 20.0
        assert model.g_sensitivity == pytest.approx(six.model.axes[axis].g_sensitivity)
    assert found.model.axes["accel_x"].bias == six.model.axes["accel_x"].bias
    for k in "xyz":
        p = found.parameters[f"gyro_{k}"]["bias"]
        assert p.sigma < 0.2 * alone.parameters[f"gyro_{k}"]["bias"].sigma
        assert near(p, sensor.axes[f"gyro_{k}"].bias)


def test_into_a_model_with_curves_moves_them_to_the_logs_temperature(cube, tmp_path):
    path = tmp_path / "thermal.toml"
    axis = AxisModel(thermal_bias=((0.0, 1.0), (50.0, 2.0)))
    path.write_text(ImuErrorModel("mine", {"accel_x": axis}).to_toml(), "utf-8")
    found = run("six-position", cube, into=path)
    curve = dict(found.model.axes["accel_x"].thermal_bias)
    at_25 = (curve[0.0] + curve[50.0]) / 2
    assert at_25 == pytest.approx(found.parameters["accel_x"]["bias"].value)
    assert curve[50.0] - curve[0.0] == pytest.approx(1.0)
    cold = [replace(log, imus=(replace(log.imu(), temperature=None),)) for log in cube]
    with pytest.raises(UsageError, match="accel_x .*temperature"):
        run("six-position", cold, into=path)


def test_counts_give_units_per_count(cube, turns, sensor):
    raw = [
        changed(changed(log, apply=lambda v: np.rint(v * 1670.7 + 300)), "gyro", lambda v: np.rint(v * 7505.7 - 40))
        for log in cube
    ]
    found = run("six-position", raw, raw="count")
    p = found.parameters["accel_y"]
    true = sensor.axes["accel_y"]
    gain = 1670.7 * (1 + true.scale_factor + true.scale_factor_nonlinear / 2)
    assert near(p["sensitivity"], gain)
    assert p["sensitivity"].unit == "count/(m/s²)"
    assert p["value_of_one"].value == pytest.approx(1 / gain, rel=1e-3)
    assert p["value_of_one"].unit == "m/s² per count"
    assert near(p["bias"], 300 + 1670.7 * true.bias)
    assert near(p["cross_coupling_x"], true.cross_coupling[0] / (1 + true.scale_factor))
    turned = run(
        "rate-table",
        [changed(log, "gyro", lambda v: np.rint(v * 7505.7 - 40)) for log in turns],
        raw="count",
        rates=RATES,
    )
    assert near(turned.parameters["gyro_z"]["sensitivity"], 7505.7 * (1 + sensor.axes["gyro_z"].scale_factor))
    with pytest.raises(UsageError, match=r"accel_x shows .* times its input.*--raw"):
        run("six-position", raw)
    assert found.model.provenance["calibration_unit"] == "count"
    assert {t.scaled for t in found.traces if t.title.startswith("Gyro")} == {False}
    labels = [trace_figure(t, "count").y_title for t in found.traces]
    assert labels == ["specific force [m/s²]"] * 3 + ["gyro [count]"] * 3


def test_many_positions_with_and_without_attitudes(sensor, tmp_path):
    made = simulation.six_position(sensor, 13, positions=14, seconds=15, rate=50)
    logs = named(made.logs)
    free = run("multi-position", logs)
    assert near(free.parameters["accel_z"]["bias"], sensor.axes["accel_z"].bias, 8)  # the bend is no parameter here
    assert "cross_coupling_y" not in free.parameters["accel_x"]
    path = tmp_path / "attitudes.txt"
    rows = "\n".join(f"{r},{p}" for r, p in np.degrees(made.attitudes))
    path.write_text(f"roll_deg,pitch_deg\n{rows}\n", "utf-8")
    known = run("multi-position", logs, attitudes=path, range=2.0)
    true = sensor.axes["accel_x"]
    assert near(known.parameters["accel_x"]["scale_factor_nonlinear"], true.scale_factor_nonlinear)
    assert near(known.parameters["accel_x"]["cross_coupling_z"], true.cross_coupling[1])
    assert "three-quarters" in ids(free.notes)
    off = named(simulation.six_position(sensor, 13, positions=14, seconds=15, rate=50, misplacement=TILT).logs)
    sure = run("multi-position", off, attitudes=path, misplacement=0.0)
    assert "too-narrow" in ids(sure.notes)
    assert "too-narrow" not in ids(known.notes)
    path.write_text("roll_deg,pitch_deg\n0,0\n", "utf-8")
    with pytest.raises(UsageError, match="1 attitudes for 14 still positions"):
        run("multi-position", logs, attitudes=path)
    path.write_text("roll,pitch\n0,x\n", "utf-8")
    with pytest.raises(UsageError, match="columns roll_deg and pitch_deg"):
        run("multi-position", logs, attitudes=path)


def test_attitudes_of_other_positions_or_of_another_frame(sensor, tmp_path):
    made = simulation.six_position(sensor, 13, positions=14, seconds=15, rate=50)
    path, logs, told = tmp_path / "attitudes.txt", named(made.logs), np.degrees(made.attitudes)
    for rows, why in (
        (told[[1, 0, *range(2, 14)]], "% of the variation"),
        (told * [-1, 1], "accel y shows the opposite"),
    ):
        path.write_text("roll_deg,pitch_deg\n" + "\n".join(f"{r},{p}" for r, p in rows) + "\n", "utf-8")
        with pytest.raises(UsageError, match=f"attitudes.*{why}.*in order"):
            run("multi-position", logs, attitudes=path)


def test_many_positions_held_by_hand(sensor):
    made = simulation.six_position(sensor, 15, positions=14, seconds=12, rate=50, one_log=True)
    (log,) = named(made.logs)
    count = len(log.imu().specific_force)
    t = np.arange(count)[:, None] / 50
    wander = 0.003 * np.sin(2 * np.pi * t * [0.11, 0.17, 0.23])  # rad
    tremor = 0.03 * np.random.default_rng(0).standard_normal((count, 3))
    held = changed(log, apply=lambda f: f + np.cross(wander, f) + tremor)
    held = changed(held, "gyro", lambda w: w + 0.2 * tremor + np.gradient(wander, 0.02, axis=0))
    found = run("multi-position", [held])
    assert len(found.positions) == 14
    for axis in ("accel_x", "accel_y", "accel_z"):
        assert near(found.parameters[axis]["bias"], sensor.axes[axis].bias, 8), axis


def test_logs_that_do_not_do(cube, turns):
    with pytest.raises(MissingDataError, match="5 positions, and none with z down"):
        run("six-position", cube[:5])
    with pytest.raises(MissingDataError, match="none with x up; .*x down: down_x.mcap, down_x.mcap"):
        run("six-position", [cube[1], *cube[1:]])
    with pytest.raises(MissingDataError, match="6 positions; .* need 9 positions"):
        run("multi-position", cube)
    with pytest.raises(MissingDataError, match="no accelerometer; still positions"):
        run("six-position", [changed(cube[0], drop=True), *cube[1:]])
    with pytest.raises(MissingDataError, match="no gyro; a rate table"):
        run("rate-table", [changed(turns[0], "gyro", drop=True)], rates=RATES)
    with pytest.raises(UsageError, match=r"its steps are -.* deg/s; .*--rates"):
        run("rate-table", turns)
    with pytest.raises(UsageError, match="match the given rates.*found: .* deg/s; given: 10, 20 deg/s"):
        run("rate-table", turns, rates="10,20")


def test_a_log_that_moves(cube):
    t = np.linspace(0, 30, len(cube[0].imu().specific_force))[:, None]
    moving = changed(cube[0], apply=lambda v: v + 3 * np.sin(t * [0.7, 1.1, 1.9]))
    with pytest.raises(MissingDataError, match="up_x.mcap: .*still for 1 s"):
        run("six-position", [moving, *cube[1:]])
    rng = np.random.default_rng(0)
    shaking = changed(cube[0], apply=lambda v: v + 10 * rng.standard_normal(v.shape))
    with pytest.raises(MissingDataError, match="up_x.mcap: .* still"):
        run("six-position", [shaking, *cube[1:]])


def test_a_table_that_never_turns(cube, turns):
    with pytest.raises(MissingDataError, match=r"up_x.mcap: the sensor never turns: .* differ by 0.\d+ deg/s at most"):
        run("rate-table", [turns[0], cube[0]], rates=RATES)
    with pytest.raises(MissingDataError, match="0 steps of 90 s or more"):
        run("rate-table", turns, rates=RATES, shortest=90.0)


def test_clipped_samples(cube, turns):
    cut = [changed(log, apply=lambda v: np.clip(v, -9.5, 9.5)) for log in cube]
    with pytest.raises(MissingDataError, match=r"accel . is clipped at -?9.5"):
        run("six-position", cut)
    cut = [changed(log, "gyro", lambda v: np.clip(v, -1.2, 1.2)) for log in turns]
    with pytest.raises(MissingDataError, match=r"gyro . is clipped at -?1.2"):
        run("rate-table", cut, rates=RATES)


def test_a_gyro_that_stands_at_its_range_in_every_step_it_shows(turns):
    held = changed(turns[0], "gyro", apply=lambda w: np.column_stack([np.clip(w[:, 0], -0.05, 0.05), w[:, 1:]]))
    with pytest.raises(MissingDataError, match=r"gyro x is clipped at"):
        run("rate-table", [held], rates=RATES)


def test_logs_of_different_rates(cube, sensor):
    fast = named(simulation.six_position(sensor, 11, seconds=20, rate=100).logs)
    with pytest.raises(UsageError, match="rates differ: 50 Hz in .*, 100 Hz in up_x.mcap"):
        run("six-position", [fast[0], *cube[1:]])


def test_accelerometers_alone_and_a_stuck_gyro(cube):
    alone = run("six-position", [changed(log, "gyro", drop=True) for log in cube])
    assert list(alone.parameters) == ["accel_x", "accel_y", "accel_z"]
    part = run("six-position", [changed(cube[0], "gyro", drop=True), *cube[1:]])
    assert "no-gyro" in ids(part.notes)
    stuck = run("six-position", [changed(log, "gyro", lambda v: v * [1, 0, 1]) for log in cube])
    assert any("gyro y" in note and note.id == "gyro-constant" for note in stuck.notes)


def test_one_way_and_one_axis_are_said(turns):
    log = turns[2]
    time = log.imu().angular_rate.time
    keep = (time - time[0]) / 1e9 < 41
    imu = log.imu()
    half = replace(log, imus=(replace(
        imu, angular_rate=Triad(time[keep], imu.angular_rate.value[keep]),
        specific_force=Triad(time[keep], imu.specific_force.value[keep]),
    ),))  # fmt: skip
    found = run("rate-table", [half], rates=RATES)
    assert {"not-turned", "one-way", "bias-of-one-attitude"} <= set(ids(found.notes))
    assert any("x, y" in note for note in found.notes if note.id == "not-turned")
    assert "scale_factor" not in found.parameters["gyro_x"]


@pytest.mark.parametrize("method", ["six-position", "rate-table"])
def test_what_is_drawn(method, six, turns, shown):
    result = six if method == "six-position" else run("rate-table", turns, rates=RATES)
    METHODS[method].draw(result, shown)
    assert "Raw and corrected" in shown.tabs
    assert len(shown.figures) >= 5
    parameters = next(t for t in shown.tables if t.title.startswith("Gyros of"))
    assert any("deg/s" in cell for row in parameters.rows for cell in row)
    assert METHODS[method].error_model(result) is result.model


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("six-position", {"level": 1.0}, "level"),
        ("six-position", {"gravity": 1.0}, "gravity is 1;"),
        ("six-position", {"latitude": 91.0}, "latitude"),
        ("six-position", {"shortest": 0.0}, "shortest"),
        ("six-position", {"misplacement": -1.0}, "misplacement"),
        ("six-position", {"height": float("inf")}, "height"),
        ("multi-position", {"misplacement": 0.1}, "attitudes"),
        ("multi-position", {"range": 2.0}, "attitudes"),
        ("multi-position", {"range": -2.0, "attitudes": Path("x")}, "range"),
        ("rate-table", {"rates": "a"}, "rates is 'a'"),
        ("rate-table", {"rates": "0,10"}, "above 0"),
        ("rate-table", {"range": 0.0}, "range"),
        ("rate-table", {"level": 0.1}, "level"),
    ],
)
def test_parameters_that_cannot_be(method, options, message):
    with pytest.raises(ValueError, match=message):
        METHODS[method].Parameters(**options)

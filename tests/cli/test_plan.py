import json

import numpy as np
import pytest

from imuwb.simulation import preset_names


def test_a_plan_states_how_long_to_record(imuwb):
    done = imuwb("plan", "--preset", "stim300", "--want", "N:1%,B:30%,K:30%")
    assert (done.code, len(done.out.splitlines()) <= 15) == (0, True), done.err
    assert "K is not in the model" in done.out
    stated = imuwb("plan", "--preset", "stim300", "--want", "N:1%,K:30%", "--hours", "2", "--full")
    assert "±0." in stated.out
    assert "reached in 2 h" in stated.out


def test_a_plan_is_json_and_a_recording(imuwb, tmp_path):
    done = imuwb("plan", "--preset", "3dm-gx3-25", "--want", "N:2%", "--json", "-o", "plan.rrd")
    found = json.loads(done.out)
    assert found["wants"] == {"N": 0.02}
    assert {need["axis"] for need in found["plan"]["needs"]} >= {"gyro_x", "accel_z"}
    assert (tmp_path / "plan.rrd").stat().st_size > 0
    again = imuwb("plan", "--preset", "3dm-gx3-25", "--want", "N:2%", "-o", "plan.rrd")
    assert (again.code, "--force" in again.err) == (2, True)


def test_a_first_short_record_makes_a_plan(imuwb, tmp_path):
    rng = np.random.default_rng(0)
    rows = np.column_stack([np.arange(1200) / 100, rng.normal(0, 1e-3, (1200, 6)) - [0, 0, 0, 0, 0, 9.8]])
    head = "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2]"
    np.savetxt(tmp_path / "short.csv", rows, delimiter=",", header=head, comments="", fmt="%.9f")
    done = imuwb("plan", "--record", "short.csv", "--want", "N:1%,K:30%")
    assert (done.code, "100 Hz" in done.out, "≥" in done.out) == (0, True, True), done.err


def test_a_moving_record_makes_no_plan(imuwb):
    assert imuwb("simulate", "drive", "--sensor", "adis16470", "--duration", "600", "-o", "drive.mcap").code == 0
    done = imuwb("plan", "--record", "drive.mcap")
    assert (done.code, "moves" in done.err) == (3, True), done.err


def test_the_next_command_can_be_run(imuwb):
    spaced = imuwb("plan", "--preset", "stim300", "--want", "N:1%, B:30%")
    assert "--want 'N:1%, B:30%'" in " ".join(spaced.out.split())
    for options in (("--want", "N:1e-9%"), ("--want", "N:1%", "--hours", "1e4")):  # no length, and the longest
        done = imuwb("plan", "--preset", "stim300", *options)
        assert (done.code, "--hours" in done.out) == (0, False), done.out


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ((), "--record"),
        (("--preset", "stim300", "--model", "m.toml"), "one sensor"),
        (("--preset", "stim300", "--want", "N"), "--want"),
        (("--preset", "stim300", "--want", "N:1%,N:2%"), "once"),
        (("--preset", "stim300", "--want", "R:1%"), "'R:1%'"),
        (("--preset", "stim300", "--want", "B:99%"), "90 %"),
        (("--preset", "stim300", "--hours", "0.0001"), "256"),
        (("--preset", "stim300", "--rate", "-1"), "--rate"),
        (("--preset", "nobody"), preset_names()[0]),
        (("--preset", "stim300", "-o", "plan.txt"), ".rrd"),
    ],
)
def test_wrong_options_are_named(imuwb, options, named):
    done = imuwb("plan", *options)
    assert (done.code, named in done.err) == (2, True), done.err

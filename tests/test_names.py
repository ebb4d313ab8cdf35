import pytest

from imuwb.names import alike, distinct, listed, shortened


@pytest.mark.parametrize(
    ("names", "together"),
    [
        (["IMU.0", "IMU.1", "IMU.2"], ("IMU.0-2",)),
        (["ISB.0", "ISB.1", "ISB.3", "ISB.4"], ("ISB.0,1,3,4",)),
        (["a.1+g.1", "a.2+g.2", "combined"], ("a.1,2+g.1,2", "combined")),
        (["imu_01", "imu_02"], ("imu_01", "imu_02")),
        (["x", "x"], ("x",)),
    ],
)
def test_names_that_differ_in_a_number_are_one(names, together):
    assert alike(names) == together


def test_what_names_share_is_shortened_first():
    names = [f"2024-05-01_bench_run_number_{run}_adis16405.mcap" for run in ("one", "two", "three")]
    short = distinct(names, 24)
    assert all(len(name) <= 24 for name in short)
    assert len(set(short)) == 3
    assert all(run in name for run, name in zip(("one", "two", "three"), short, strict=True))
    assert distinct(["a.mcap", "b.mcap"], 10) == ("a.mcap", "b.mcap")
    assert distinct(["long" * 9], 10) == (shortened("long" * 9, 10),)


def test_a_list_says_how_many_names_are_left_out():
    assert listed(["alpha", "beta", "gamma"], 16) == "alpha and 2 more"
    assert listed([f"imu.{i}" for i in range(9)], 8) == "imu.0-8"
    assert len(listed(["a_very_long_name", "b_another_one"], 12)) <= 12

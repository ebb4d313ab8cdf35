import pytest

from imuwb.review.answers.panel import HEIGHT, Origin, panel
from imuwb.simulation import preset, static
from imuwb_plugins import noise

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def log():
    return static(preset("3dm-gx3-25"), 300, 50, 4)


def test_n_of_each_axis_stands_in_units_of_data_sheets(log):
    answer = noise.answer(noise.run([log], noise.Parameters()))
    assert answer.headings == ("", "N", "B", "K", "trust")
    names = [row[0] for row in answer.rows]
    assert names == ["gyro x", "gyro y", "gyro z", "", "accel x", "accel y", "accel z", ""]
    truth = preset("3dm-gx3-25").axes
    for row in answer.rows[:3]:
        white = truth[row[0].replace(" ", "_")].processes.terms[0].N
        low, high = (float(end) for end in row[1].partition("[")[2].strip("]").split(","))
        assert low * 0.99 < white * 180 / 3.14159265 * 60 < high * 1.01
    assert answer.rows[3][1:4] == ("deg/√h", "deg/h", "deg/h^1.5")
    assert answer.rows[7][1:4] == ("m/s/√h", "µg", "m/s/h^1.5")
    assert answer.about.startswith("5 min")
    lines = panel(answer, Origin("noise", ("static.mcap",), "static.toml", ("static.rrd",)))
    assert len(lines) <= HEIGHT
    assert not any(line.endswith("…") for line in lines)


def test_several_logs_are_compared(log):
    others = [log, static(preset("3dm-gx3-25"), 300, 50, 5)]
    answer = noise.answer(noise.run(others, noise.Parameters()))
    assert answer.about.startswith("2 logs")
    assert [row[0] for row in answer.rows] == ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"]

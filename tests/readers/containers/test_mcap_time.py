"""The time of an MCAP's messages: which stamp counts, and stamps that are missing or impossible."""

import pytest

from imuwb.readers import ReadOptions, read
from tests.readers.containers.imu_messages import FORCE, RATE, T, assert_imu, own
from tests.readers.repairs import repairs


@pytest.mark.parametrize(("time_source", "offset"), [("header", 0), ("log", 100), ("publish", 50)])
def test_each_of_three_stamps_can_count(mcap, ros, imus_of, time_source, offset):
    messages = [(T + i + 100, T + i + 50, ros.imu(T + i, RATE, FORCE)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages), time_source=time_source)
    assert (imu.angular_rate.time - T - offset).tolist() == [0, 1, 2]


def test_without_stamps_the_recorders_time_is_used_with_a_note(mcap, ros, imus_of):
    messages = [(T + i, ros.imu(0, RATE, FORCE)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages))
    assert_imu(imu)
    assert repairs(imu) == {"no_stamp": 3}


def test_stamps_that_count_from_power_up_are_not_unix(mcap, ros, imus_of):
    (imu,) = imus_of(mcap.Topic([(T, ros.imu(10**9 * i, RATE, FORCE)) for i in (1, 2)]))
    assert imu.angular_rate.time.tolist() == [10**9, 2 * 10**9]
    assert imu.origin.epoch == "log"


@pytest.mark.parametrize("at", [0, 4, 9])
def test_one_stamp_of_zero_takes_the_recorders_time(mcap, ros, imus_of, at):
    stamps = [T + i * 10**8 for i in range(10)]
    messages = [(t + 7, ros.imu(0 if i == at else t, RATE, FORCE)) for i, t in enumerate(stamps)]
    (imu,) = imus_of(mcap.Topic(messages))
    assert (imu.angular_rate.time - stamps).tolist() == [7 if i == at else 0 for i in range(10)]
    assert repairs(imu) == {"no_stamp": 1}


def test_a_simulations_clock_may_begin_at_zero(mcap, ros, imus_of):
    (imu,) = imus_of(mcap.Topic([(T + i, ros.imu(i * 10**8, RATE, FORCE)) for i in range(10)]))
    assert imu.angular_rate.time.tolist() == [i * 10**8 for i in range(10)]
    assert imu.origin.epoch == "log"
    assert repairs(imu) == {}


@pytest.mark.parametrize("damaged", [2**62, 2**63, 2**63 + 5, 2**64 - 1])
def test_a_log_time_no_clock_can_show_costs_its_message(mcap, ros, damaged):
    messages = [(T + i * 10**8, ros.imu(T, (i, 0, 0), FORCE)) for i in range(10)]
    messages[4] = damaged, messages[4][1]
    log = read(mcap.write(mcap.Topic(messages)), ReadOptions(time_source="log"))
    imu, others = log.imus[0], [i for i in range(10) if i != 4]
    assert imu.angular_rate.time.tolist() == [T + i * 10**8 for i in others]
    assert imu.angular_rate.value[:, 0].tolist() == others
    assert any(note.id == "impossible_time" and note.startswith("1 ") for note in log.notes)


@pytest.mark.parametrize(
    "stamp",
    [{"sec": 2**60}, {"sec": float("nan")}, {"sec": float("inf")}, {"nanosec": float("nan")}, {"nanosec": 10**9}],
)
def test_a_json_stamp_that_is_none_takes_the_recorders_time(mcap, imus_of, stamp):
    messages = [(T + i * 10**9 + 7, own(i, stamp=stamp if i == 1 else None)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages, "/imu", "Imu", "{}", "jsonschema", "json"))
    assert (imu.angular_rate.time - T).tolist() == [0, 10**9 + 7, 2 * 10**9]
    assert repairs(imu) == {"no_stamp": 1}

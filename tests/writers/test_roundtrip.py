import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from imuwb.errors import ImuwbError, MissingDataError, UsageError
from imuwb.log import ImuStream, Log, Provenance, Scalars, Triad
from imuwb.readers import read
from imuwb.simulation import preset, static
from imuwb.writers import SUFFIXES, places, write


@pytest.fixture(scope="module")
def simulated():
    return static(preset("3dm-gx3-25"), 60.0, 100.0, seed=3)


def log_of(*imus):
    return Log(Provenance("made", "test", "", 0), tuple(imus))


def still(time=(0, 1), name="/imu"):
    time = np.asarray(time, np.int64)
    triad = Triad(time, np.tile([0.0, 0.0, -9.8], (time.size, 1)))
    return ImuStream(name, triad, triad)


def assert_same(one, other):
    for a, b in ((one.angular_rate, other.angular_rate), (one.specific_force, other.specific_force)):
        assert a.time.tobytes() == b.time.tobytes()
        assert a.value.tobytes() == b.value.tobytes()
    assert one.temperature.time.tobytes() == other.temperature.time.tobytes()
    assert one.temperature.value.tobytes() == other.temperature.value.tobytes()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read_bit_for_bit(simulated, fresh, suffix):
    path = fresh(f"log{suffix}")
    write(simulated, str(path))
    assert all(place.is_file() for place in places(simulated, str(path)))
    (imu,) = read(path).imus
    assert len(imu.angular_rate) == 6000
    assert_same(imu, simulated.imus[0])
    assert imu.origin.epoch == "unix"
    assert imu.origin.repairs == ()


def test_the_name_survives_in_mcap(simulated, fresh):
    write(simulated, fresh_path := fresh("log.mcap"))
    (imu,) = read(fresh_path).imus
    assert (imu.name, imu.temperature.name) == ("/imu/data", "/imu/temperature")


def test_csv_of_mcap_of_csv_is_the_same_file(simulated, fresh):
    first, between, last = fresh("a.csv"), fresh("b.mcap"), fresh("c.csv")
    write(simulated, first)
    write(read(first), between)
    write(read(between), last)
    assert first.read_bytes() == last.read_bytes()


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 6), min_size=2, max_size=5),
    st.integers(0, 2**31 * 10**9 - 10**9),
    st.sampled_from(SUFFIXES),
)
def test_any_doubles_and_any_start_survive(fresh, rows, start, suffix):
    values = np.array(rows)
    values[:, 5] = -9.8  # a gravity, so that no row makes another unit likely
    time = start + np.arange(len(rows)) * 10_000_000
    imu = ImuStream("/imu", Triad(time, values[:, :3]), Triad(time, values[:, 3:]))
    path = fresh(f"log{suffix}")
    write(log_of(imu), path)
    (found,) = read(path).imus
    assert found.angular_rate.time.tolist() == time.tolist()
    np.testing.assert_array_equal(found.angular_rate.value, values[:, :3])
    np.testing.assert_array_equal(found.specific_force.value, values[:, 3:])


def test_a_log_of_many_chunks_is_whole(fresh):
    time = np.arange(30_000) * 1_000_000
    values = np.random.default_rng(5).normal(size=(30_000, 3))
    imu = ImuStream(
        "/imu", Triad(time, values), Triad(time, values - [0, 0, 9.8]), Scalars("/t", time[::1000], values[::1000, 0])
    )
    path, seen = fresh("log.mcap"), []
    write(log_of(imu), path, lambda done, total: seen.append((done, total)))
    assert_same(read(path).imus[0], imu)
    assert seen[-1] == (30_000, 30_000)


@pytest.mark.slow
def test_the_mcap_package_and_the_ros_decoder_read_it(simulated, fresh):
    path = fresh("log.mcap")
    write(simulated, path)
    (imu,) = simulated.imus
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        messages = [m for _, c, _, m in reader.iter_decoded_messages() if c.topic == "/imu/data"]
    assert summary.statistics.message_count == 6000 + 60
    assert len(messages) == 6000
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
    assert stamps == imu.angular_rate.time.tolist()
    flu = np.array([[v.x, -v.y, -v.z] for v in (m.angular_velocity for m in messages)])
    np.testing.assert_array_equal(flu, imu.angular_rate.value)
    assert messages[0].linear_acceleration.z > 9  # forward-left-up, as ROS has it
    assert messages[0].orientation_covariance[0] == -1
    assert messages[0].header.frame_id == "imu_link"


def test_the_index_leads_to_the_messages(simulated, fresh):
    path = fresh("log.mcap")
    write(simulated, path)
    with path.open("rb") as file:
        found = make_reader(file).iter_messages(["/imu/data"])  # a seekable file is read by its index
        assert [m.log_time for _, _, m in found] == simulated.imus[0].angular_rate.time.tolist()


def test_several_imus_go_into_one_mcap(fresh):
    path = fresh("log.mcap")
    write(log_of(still(name="/a"), still([5, 6, 7], name="/b")), path)
    assert {imu.name: len(imu.angular_rate) for imu in read(path).imus} == {"/a": 2, "/b": 3}


def test_csv_has_room_for_one_imu(fresh):
    with pytest.raises(MissingDataError, match="imu: /imu, /imu"):
        write(log_of(still(), still()), fresh("log.csv"))


def test_a_csv_of_a_gyro_alone(fresh):
    triad, path = still().angular_rate, fresh("log.csv")
    write(log_of(ImuStream("/imu", triad, None)), path)
    (imu,) = read(path).imus
    assert imu.specific_force is None
    assert imu.angular_rate.value.tolist() == triad.value.tolist()


def test_triads_on_two_clocks_are_refused_by_csv_and_leave_no_file(fresh):
    imu = ImuStream("/imu", still().angular_rate, still([0, 2]).specific_force)
    path = fresh("log.csv")
    with pytest.raises(MissingDataError, match="/imu: "):
        write(log_of(imu), path)
    assert list(path.parent.iterdir()) == []


@pytest.mark.parametrize(
    "imu",
    [
        ImuStream("/imu", still([1, 2]).angular_rate, still([1, 3, 4]).specific_force),
        ImuStream("/imu", still([1, 2]).angular_rate, None),
        ImuStream("/imu", None, still([1, 2]).specific_force),
    ],
    ids=["two clocks", "gyro alone", "accelerometer alone"],
)
def test_an_mcap_holds_triads_apart(fresh, imu):
    write(log_of(imu), path := fresh("log.mcap"))
    (found,) = read(path).imus
    assert found.name == "/imu"
    for one, other in ((found.angular_rate, imu.angular_rate), (found.specific_force, imu.specific_force)):
        assert (one is None) == (other is None)
        if other is not None:
            assert one.time.tolist() == other.time.tolist()
            np.testing.assert_array_equal(one.value, other.value)


def test_another_suffix_is_refused(simulated, fresh):
    with pytest.raises(UsageError, match=r"'\.txt'; .*\.mcap or \.csv"):
        write(simulated, fresh("log.txt"))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_place_that_cannot_be_written_is_named(simulated, fresh, suffix):
    path = fresh("log").parent / "nowhere" / f"log{suffix}"
    with pytest.raises(ImuwbError, match="cannot be written"):
        write(simulated, path)


def test_a_failure_on_the_way_leaves_the_old_file(simulated, fresh):
    path = fresh("log.mcap")
    path.write_bytes(b"old")

    def stop(done, total):
        del done, total
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(simulated, path, stop)
    assert path.read_bytes() == b"old"
    assert [p.name for p in path.parent.iterdir()] == ["log.mcap"]


def test_times_that_a_stamp_cannot_hold_are_refused(fresh):
    with pytest.raises(MissingDataError, match="after 2038"):
        write(log_of(still([2**31 * 10**9 - 1, 2**31 * 10**9])), path := fresh("log.mcap"))
    assert not path.exists()

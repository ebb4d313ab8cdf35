"""Every stream of a log, written and read back: MCAP in one file, CSV in one for each kind."""

from dataclasses import replace

import numpy as np
import pytest
from mcap.reader import make_reader

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Scalars, Triad
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.writers import places, write

ZERO = 1_700_000_000 * SECOND
UNIX = Origin(epoch="unix")
NAN = np.nan


def imu_of(name="/imu", seed=0, n=500, apart=False):
    rng = np.random.default_rng(seed)
    time = ZERO + np.arange(n) * 10_000_000 + seed
    other = time[::2] + 1_234_567 if apart else time
    gyro, accel = rng.standard_normal((n, 3)), rng.standard_normal((other.size, 3)) - [0, 0, 9.8]
    warmth = Scalars(f"{name}/temperature", time[::100], rng.standard_normal(time[::100].size) + 30)
    return ImuStream(name, Triad(time, gyro), Triad(other, accel), warmth, UNIX)


def gnss_of(name="/fix", n=40, **given):
    rng = np.random.default_rng(n)
    position = np.stack([rng.uniform(-1.5, 1.5, n), rng.uniform(-3.1, 3.1, n), rng.uniform(-400, 9000, n)], axis=1)
    velocity, sigma, speed_sigma = (
        rng.standard_normal((n, 3)),
        rng.uniform(0.01, 9, (n, 3)),
        rng.uniform(0.01, 1, (n, 3)),
    )
    velocity[5:8, 2] = NAN
    sigma[10:20] = NAN
    speed_sigma[3] = NAN
    kinds = np.arange(n) % 9
    kinds[kinds == 1] = 2  # rows without a fix are left out when they are read
    stream = GnssStream(
        name, ZERO + np.arange(n) * 125_000_000 + 7, position, velocity, sigma, speed_sigma, kinds, UNIX
    )
    return replace(stream, **given)


def reference_of(name="/truth", *, velocity=True, attitude=True, n=30):
    rng = np.random.default_rng(n)
    time = ZERO + np.arange(n) * 100_000_000 + 3
    position = np.stack([rng.uniform(-1.5, 1.5, n), rng.uniform(-3.1, 3.1, n), rng.uniform(-400, 9000, n)], axis=1)
    speeds = rng.standard_normal((n, 3)) if velocity else None
    angles = rng.uniform(-1.5, 1.5, (n, 3)) if attitude else None
    return Reference(name, time, position, speeds, angles, UNIX)


def speed_of(name="/wheel", n=60):
    return Scalars(name, ZERO + np.arange(n) * 50_000_000 + 11, np.random.default_rng(n).standard_normal(n))


def log_of(*imus, **given):
    return Log(Provenance("made", "test", "", 0), imus, **given)


def same(found, truth, *names, close=None):
    assert found.time.tolist() == truth.time.tolist()
    for name in names:
        one, other = getattr(found, name), getattr(truth, name)
        assert (one is None) == (other is None), name
        if other is None:
            continue
        if close is None or name not in close:
            np.testing.assert_array_equal(one, other, err_msg=name)
        else:
            np.testing.assert_allclose(one, other, **close[name], err_msg=name)


def same_imu(found, truth):
    same(found.angular_rate, truth.angular_rate, "value")
    same(found.specific_force, truth.specific_force, "value")
    same(found.temperature, truth.temperature, "value")


def same_gnss(found, truth):
    """Angles go through degrees and sigmas through variances in ROS messages."""
    of_sigma = {"rtol": 1e-15, "atol": 0}
    close = {"position": {"rtol": 0, "atol": 1e-15}, "position_sigma": of_sigma, "velocity_sigma": of_sigma}
    assert found.position[:, 2].tolist() == truth.position[:, 2].tolist()
    flat = replace(found, position=found.position * [1, 1, 0]), replace(truth, position=truth.position * [1, 1, 0])
    same(*flat, "position", "velocity", "position_sigma", "velocity_sigma", "fix_type", close=close)


@pytest.fixture
def back(fresh):
    def through(log, suffix=".mcap"):
        write(log, path := fresh(f"log{suffix}"))
        return read(path)

    return through


@pytest.mark.parametrize("apart", [False, True], ids=["one clock", "own clocks"])
def test_two_imus_with_their_temperatures(back, apart):
    imus = imu_of("/left", 1, apart=apart), imu_of("/right", 2, apart=apart)
    found = {imu.name: imu for imu in back(log_of(*imus)).imus}
    assert set(found) == {"/left", "/right"}
    for imu in imus:
        same_imu(found[imu.name], imu)
        assert found[imu.name].temperature.name == imu.temperature.name


def test_a_receiver_with_all_it_tells_also_what_it_does_not_know(back):
    (found,) = back(log_of(gnss=(gnss_of(),))).gnss
    assert found.name == "/fix"
    same_gnss(found, gnss_of())


@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_a_receiver_that_never_tells_the_velocity_down(back, suffix):
    gnss = gnss_of()
    velocity = np.where([True, True, False], gnss.velocity, NAN)
    (found,) = back(log_of(gnss=(replace(gnss, velocity=velocity),)), suffix).gnss
    np.testing.assert_array_equal(found.velocity, velocity)


@pytest.mark.parametrize("name", ["velocity", "velocity_sigma", "position_sigma"])
def test_what_a_receiver_never_tells_stays_untold(back, name):
    without = {"velocity": None, "velocity_sigma": None} if name == "velocity" else {name: None}
    (found,) = back(log_of(gnss=(gnss_of(**without),))).gnss
    same_gnss(found, gnss_of(**without))


def test_a_receiver_that_never_tells_the_kind_of_fix(back):
    assert back(log_of(gnss=(gnss_of(fix_type=None),))).gnss[0].fix_type is None


def test_two_receivers_keep_what_is_theirs(back):
    one, other = gnss_of("/gps/front"), gnss_of("/gps/rear", 41)
    found = {g.name: g for g in back(log_of(gnss=(one, other))).gnss}
    assert set(found) == {"/gps/front", "/gps/rear"}
    same_gnss(found["/gps/front"], one)
    same_gnss(found["/gps/rear"], other)


def test_a_receiver_whose_name_tells_nothing(back):
    (found,) = back(log_of(gnss=(gnss_of("UBX 0"),))).gnss
    same_gnss(found, gnss_of())


def test_a_speed(back):
    (found,) = back(log_of(speeds=(speed_of(),))).speeds
    assert found.name == "/wheel"
    same(found, speed_of(), "value")


def test_a_speed_that_a_receiver_made(back):
    assert [s.name for s in back(log_of(speeds=(speed_of("/gps_speed"),))).speeds] == ["/gps_speed"]


@pytest.mark.parametrize("velocity", [True, False])
@pytest.mark.parametrize("attitude", [True, False])
def test_a_reference(back, velocity, attitude):
    truth = reference_of(velocity=velocity, attitude=attitude)
    (found,) = back(log_of(references=(truth,))).references
    assert found.name == "/truth"
    same(found, truth, "position", "velocity", "attitude")


def everything():
    return log_of(imu_of(), gnss=(gnss_of(),), speeds=(speed_of(),), references=(reference_of(),))


def test_everything_in_one_mcap(back):
    found, truth = back(everything()), everything()
    same_imu(found.imus[0], truth.imus[0])
    same_gnss(found.gnss[0], truth.gnss[0])
    same(found.speeds[0], truth.speeds[0], "value")
    same(found.references[0], truth.references[0], "position", "velocity", "attitude")
    assert [len(x) for x in (found.imus, found.gnss, found.speeds, found.references)] == [1, 1, 1, 1]
    assert {s.origin.epoch for s in (*found.imus, *found.gnss, *found.references)} == {"unix"}


def test_slow_streams_are_whole_over_many_chunks(back):
    imu = imu_of(n=30_000)
    fast = log_of(imu, gnss=(gnss_of(n=2000),), speeds=(speed_of(n=7000),))  # 300 s, 250 s and 350 s
    found = back(fast)
    same_imu(found.imus[0], imu)
    same_gnss(found.gnss[0], fast.gnss[0])
    same(found.speeds[0], fast.speeds[0], "value")


def test_csv_is_a_file_for_each_kind(fresh):
    path, truth = fresh("run.csv"), everything()
    write(truth, path)
    tables = ["run.csv", "run.gnss.csv", "run.reference.csv", "run.speed.csv"]
    names = sorted([*tables, *(f"{name}.toml" for name in tables)])
    assert sorted(p.name for p in path.parent.iterdir()) == names
    assert sorted(p.name for p in places(truth, path)) == names
    same_imu(read(path).imus[0], truth.imus[0])
    all_of = ("position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    same(read(path.with_name("run.gnss.csv")).gnss[0], truth.gnss[0], *all_of)
    same(read(path.with_name("run.speed.csv")).speeds[0], truth.speeds[0], "value")
    found = read(path.with_name("run.reference.csv")).references[0]
    same(found, truth.references[0], "position", "velocity", "attitude")


@pytest.mark.parametrize("kind", ["gnss", "speeds", "references"])
def test_csv_of_one_kind_is_the_file_itself(fresh, kind):
    truth = replace(log_of(), **{kind: getattr(everything(), kind)})
    path = fresh("run.csv")
    write(truth, path)
    assert sorted(p.name for p in path.parent.iterdir()) == ["run.csv", "run.csv.toml"]
    (found,) = getattr(read(path), kind)
    assert found.time.tolist() == getattr(truth, kind)[0].time.tolist()


def test_csv_of_a_reference_without_an_attitude_is_still_one(back):
    truth = reference_of(attitude=False)
    (found,) = back(log_of(references=(truth,)), ".csv").references
    same(found, truth, "position", "velocity", "attitude")


@pytest.mark.parametrize("rows", [3, 40])
def test_csv_of_a_receiver_that_at_first_tells_little(back, rows):
    unknown = {
        name: np.where(np.arange(40)[:, None] < rows, NAN, np.ones((40, 3)))
        for name in ("velocity", "position_sigma", "velocity_sigma")
    }
    (found,) = back(log_of(gnss=(gnss_of(**unknown),)), ".csv").gnss
    assert found.time.tolist() == gnss_of().time.tolist()


def test_csv_has_room_for_one_stream_of_a_kind_and_says_which_there_are(fresh):
    path = fresh("run.csv")
    log = log_of(imu_of(), gnss=(gnss_of("/front"), gnss_of("/rear")))
    with pytest.raises(MissingDataError, match="gnss: /front, /rear"):
        write(log, path)
    assert list(path.parent.iterdir()) == []


def test_progress_counts_the_rows_of_all_tables(fresh):
    seen = []
    write(everything(), fresh("run.csv"), lambda done, total: seen.append((done, total)))
    assert seen == [(500, 630), (540, 630), (600, 630), (630, 630)]


@pytest.fixture(scope="module")
def messages(fresh):
    """Return {topic: messages} as the mcap package and the ROS 2 decoder read them."""
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    write(everything(), path := fresh("log.mcap"))
    found = {}
    with path.open("rb") as file:
        made = reader.make_reader(file, validate_crcs=True, decoder_factories=[decoder.DecoderFactory()])
        for schema, channel, record, message in made.iter_decoded_messages():
            stamp = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
            assert stamp == record.log_time == record.publish_time
            found.setdefault(channel.topic, []).append((schema.name, stamp, message))
    return found


def test_other_tools_find_all_topics(messages):
    assert {topic: (rows[0][0], len(rows)) for topic, rows in messages.items()} == {
        "/imu": ("sensor_msgs/msg/Imu", 500), "/imu/temperature": ("sensor_msgs/msg/Temperature", 5),
        "/fix": ("sensor_msgs/msg/NavSatFix", 40), "/fix/fix_type": ("imuwb_msgs/msg/FixType", 40),
        "/fix/gnss_velocity": ("geometry_msgs/msg/TwistWithCovarianceStamped", 40),
        "/wheel": ("geometry_msgs/msg/TwistStamped", 60), "/truth": ("imuwb_msgs/msg/Reference", 30),
    }  # fmt: skip


def test_other_tools_see_degrees_and_variances_east_north_up(messages):
    truth = gnss_of()
    for row, (_, stamp, fix) in enumerate(messages["/fix"]):
        assert stamp == truth.time[row]
        here = [fix.latitude, fix.longitude, fix.altitude]
        assert here == pytest.approx(np.append(np.degrees(truth.position[row, :2]), truth.position[row, 2]), rel=1e-15)
        north, east, down = np.nan_to_num(truth.position_sigma[row]) ** 2
        assert list(fix.position_covariance) == pytest.approx([east, 0, 0, 0, north, 0, 0, 0, down])
    status = [fix.status.status for _, _, fix in messages["/fix"][:9]]
    assert status == [-1, 0, 0, 0, 1, 2, 2, 2, 2]
    assert messages["/fix"][0][2].position_covariance_type == 2


def test_a_sigma_that_is_unknown_is_not_said_to_be_known(messages):
    truth = gnss_of()
    for row, (_, _, fix) in enumerate(messages["/fix"]):
        assert fix.position_covariance_type == (0 if np.isnan(truth.position_sigma[row]).any() else 2)


def test_other_tools_see_the_velocity_east_north_up(messages):
    truth = gnss_of()
    east_north_up = truth.velocity[:, [1, 0, 2]] * [1, 1, -1]
    for row, (_, _, message) in enumerate(messages["/fix/gnss_velocity"]):
        linear = message.twist.twist.linear
        np.testing.assert_array_equal([linear.x, linear.y, linear.z], east_north_up[row])
        expected = np.zeros(36)
        expected[[7, 0, 14]] = np.nan_to_num(truth.velocity_sigma[row]) ** 2
        assert list(message.twist.covariance) == pytest.approx(expected)


def test_other_tools_see_speed_kind_of_fix_and_reference(messages):
    assert [m.twist.linear.x for _, _, m in messages["/wheel"]] == speed_of().value.tolist()
    assert [m.fix_type for _, _, m in messages["/fix/fix_type"]] == gnss_of().fix_type.tolist()
    truth = reference_of()
    for row, (_, _, message) in enumerate(messages["/truth"]):
        assert list(message.latitude_longitude_height) == truth.position[row].tolist()
        assert list(message.velocity_north_east_down) == truth.velocity[row].tolist()
        assert list(message.roll_pitch_heading) == truth.attitude[row].tolist()


@pytest.mark.parametrize("kind", ["gnss", "references"])
@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_heights_above_mean_sea_level_stay_so(back, kind, suffix):
    origin = Origin("deg, m (above mean sea level)", epoch="unix")
    stream = replace({"gnss": gnss_of(), "references": reference_of()}[kind], origin=origin)
    (found,) = getattr(back(log_of(**{kind: (stream,)}), suffix), kind)
    assert "above mean sea level" in found.origin.units
    np.testing.assert_array_equal(found.position[:, 2], stream.position[:, 2])
    (found,) = getattr(back(log_of(**{kind: (replace(stream, origin=UNIX),)}), suffix), kind)
    assert not found.origin.above_sea


def test_the_index_of_a_written_file_tells_heights_above_mean_sea_level(fresh):
    from imuwb.readers import describe

    path = fresh("run.mcap")
    write(log_of(gnss=(replace(gnss_of(), origin=Origin("m (above mean sea level)", epoch="unix")),)), path)
    told = describe(path)
    assert "index" in told.notes[0]
    assert ["above mean sea level" in s.units for s in told.streams if s.kind == "gnss"] == [True]
    with path.open("rb") as file:
        (metadata,) = make_reader(file).iter_metadata()
    assert (metadata.name, metadata.metadata) == ("imuwb", {"/fix": "heights are above mean sea level"})


@pytest.mark.parametrize("epoch", ["unix", "boot", "log"])
def test_frame_and_epoch_come_back_from_csv(back, epoch):
    origin = Origin(epoch=epoch)
    truth = log_of(replace(imu_of(), origin=origin), gnss=(replace(gnss_of(), origin=origin),), speeds=(speed_of(),))
    found = back(truth, ".csv")
    assert (found.imus[0].origin.epoch, found.imus[0].origin.frame) == (epoch, "FRD (stated)")
    assert ids(found.notes) == ("sidecar",)
    assert "frame, epoch" in found.notes[0]

"""Messages of common packages give the streams that their definitions state."""

import numpy as np
import pytest

from imuwb.readers import read

from .ros_values import stamped
from .shape_truth import COUNT, HEIGHT, LATITUDE, LONGITUDE, RATE, T, assert_gnss, xyz


@pytest.mark.parametrize(("kind", "covariance", "sigma"), [
    (2, (1.0, 0, 0, 0, 4.0, 0, 0, 0, 9.0), (2.0, 1.0, 3.0)),
    (0, (1.0, 0, 0, 0, 4.0, 0, 0, 0, 9.0), (0.5, 0.5, 0.75)),  # its kind states that it is not known
    (1, (0.0,) * 9, (0.5, 0.5, 0.75)),
])  # fmt: skip
def test_a_gps_fix_has_sigmas_of_its_covariance_or_of_its_bounds(log_of, kind, covariance, sigma):
    def values(i, time):
        return stamped(
            time, latitude=LATITUDE, longitude=LONGITUDE, altitude=HEIGHT, track=90.0, speed=5.0, climb=-0.5,
            err_horz=0.5 * 2.4477, err_vert=0.75 * 1.96, err_speed=0.196, err_climb=0.392, status__status=19,
            position_covariance=covariance, position_covariance_type=kind,
        )  # fmt: skip

    for package in ("gps_msgs/msg", "gps_common"):
        (gnss,) = log_of({"/gps": (f"{package}/GPSFix", values)}).gnss
        np.testing.assert_allclose(gnss.velocity, [[0, 5, 0.5]] * COUNT, atol=1e-12)
        np.testing.assert_allclose(gnss.position_sigma, [sigma] * COUNT)
        np.testing.assert_allclose(gnss.velocity_sigma, [[0.1, 0.1, 0.2]] * COUNT)
        assert set(gnss.fix_type.tolist()) == {6}


@pytest.mark.parametrize(("kind", "known"), [(0, False), (1, True), (2, True), (3, True)])
def test_a_fix_has_sigmas_unless_its_covariance_is_not_known(log_of, kind, known):
    def values(i, time):
        return stamped(
            time, latitude=LATITUDE, longitude=LONGITUDE, altitude=HEIGHT, position_covariance=(1.0, 0, 0, 0, 4.0, 0, 0, 0, 9.0),
            position_covariance_type=kind,
        )  # fmt: skip

    (gnss,) = log_of({"/fix": ("sensor_msgs/msg/NavSatFix", values)}).gnss
    assert_gnss(gnss, velocity=None, sigma=(2.0, 1.0, 3.0) if known else None)


def test_microstrain_s_thermometer(log_of):
    log = log_of({
        "/imu/data": ("sensor_msgs/msg/Imu", lambda _, time: stamped(time) | xyz("angular_velocity", RATE) | xyz("linear_acceleration", (0.5, -0.25, 9.75))),
        "/mip/sensor/temperature_statistics": ("microstrain_inertial_msgs/msg/MipSensorTemperatureStatistics", lambda _, time: {
            f"header.{name}": value for name, value in stamped(time).items()} | {"min_temp": 20.0, "max_temp": 40.0, "mean_temp": 31.5}),
    })  # fmt: skip
    assert log.imu().temperature.value.tolist() == [31.5] * COUNT
    assert log.imu().temperature.time[0] == T


def ecef(latitude, longitude, height):
    flattening = 1 / 298.257223563
    squared = flattening * (2 - flattening)
    curve = 6378137.0 / np.sqrt(1 - squared * np.sin(latitude) ** 2)
    across = (curve + height) * np.cos(latitude)
    return across * np.cos(longitude), across * np.sin(longitude), (curve * (1 - squared) + height) * np.sin(latitude)


@pytest.mark.parametrize(("topic", "receiver"), [("/gnss_1/odometry_earth", True), ("/ekf/odometry_earth", False)])
def test_odometry_in_the_earth_frame_has_geodetic_positions(log_of, topic, receiver):
    def values(i, time):
        place = ecef(np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT)
        return stamped(time) | xyz("pose.pose.position", place) | {"pose.pose.orientation.w": 1.0}

    log = log_of({topic: ("nav_msgs/msg/Odometry", values)})
    (stream,) = log.gnss if receiver else log.references
    assert (len(log.gnss), len(log.references), log.poses) == (receiver, not receiver, ())
    np.testing.assert_allclose(stream.position[0], [np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT], rtol=1e-10)
    assert stream.origin.by_filter != receiver


def test_a_velocity_along_earth_centred_axes_is_refused(log_of):
    log = log_of({
        "/gnss_1/llh_position": ("sensor_msgs/msg/NavSatFix", lambda _, time: stamped(time, latitude=LATITUDE, longitude=LONGITUDE)),
        "/gnss_1/velocity_ecef": ("geometry_msgs/msg/TwistWithCovarianceStamped", lambda _, time: stamped(time, twist__twist__linear__x=5.0)),
    })  # fmt: skip
    assert log.gnss[0].velocity is None
    assert log.speeds == ()
    assert any("/gnss_1/velocity_ecef" in note for note in log.notes)


def test_geographic_poses_are_those_of_a_filter_and_points_are_none(log_of):
    def pose(i, time):
        return stamped(
            time,
            pose__position__latitude=LATITUDE,
            pose__position__longitude=LONGITUDE,
            pose__position__altitude=HEIGHT,
        )

    def point(i, time):
        return stamped(time, position__latitude=LATITUDE, position__longitude=LONGITUDE)

    log = log_of({
        "/geopose": ("geographic_msgs/msg/GeoPoseStamped", pose), "/origin": ("geographic_msgs/msg/GeoPointStamped", point),
    })  # fmt: skip
    assert_gnss(log.references[0], velocity=None)
    assert log.gnss == ()
    assert any("/origin" in note for note in log.notes)


def test_a_magnetic_field_is_named(log_of):
    log = log_of(
        {
            "/imu/mag": (
                "sensor_msgs/msg/MagneticField",
                lambda _, time: stamped(time) | xyz("magnetic_field", (1e-5, 0, 4e-5)),
            )
        }
    )
    assert "/imu/mag: 40 messages of sensor_msgs/msg/MagneticField" in log.notes[0]


def test_sentences_are_the_fixes_of_a_receiver(log_of):
    def sentence(text):
        return f"${text}*{np.bitwise_xor.reduce(np.frombuffer(text.encode(), np.uint8)):02X}"

    def values(i, time):
        clock = f"12{i // 60:02d}{i % 60:02d}.00"
        if i % 2:
            text = f"GPRMC,{clock},A,4730.00000,N,00830.00000,E,10.0,90.0,010524,,,A"
        else:
            text = f"GPGGA,{clock},4730.00000,N,00830.00000,E,4,12,0.6,402.0,M,48.0,M,,"
        return stamped(time, sentence=sentence(text))

    log = log_of({"/nmea_sentence": ("nmea_msgs/msg/Sentence", values)}, step=10**9)
    (gnss,) = log.gnss
    assert gnss.name == "/nmea_sentence"
    assert len(gnss) == COUNT // 2
    np.testing.assert_allclose(gnss.position[0], [np.radians(47.5), np.radians(8.5), 450.0], rtol=1e-9)
    assert gnss.time[0] == T
    assert set(gnss.fix_type.tolist()) == {6}


def test_a_message_of_ones_own_with_a_known_part_is_read(fresh, mcap, ros):
    text = "float64 latitude_deg\nfloat64 longitude_deg\nfloat64 altitude_ellipsoid_m\nuint64 timestamp\n"
    rows = [(T + i, ros.encode([("d", (LATITUDE, LONGITUDE, HEIGHT)), ("Q", T // 1000 + i)])) for i in range(COUNT)]
    (gnss,) = read(mcap.write(mcap.Topic(rows, "/mine", "my_msgs/msg/Fix", text))).gnss
    assert_gnss(gnss, velocity=None)
    assert gnss.time.tolist() == [T + 1000 * i for i in range(COUNT)]


@pytest.mark.parametrize("kind", ["AccelStamped", "AccelWithCovarianceStamped"])
@pytest.mark.parametrize(("force", "used"), [((0.5, -0.25, 9.75), True), ((0.01, 0.0, -0.02), False)])
def test_an_acceleration_is_a_specific_force_if_it_contains_gravity(log_of, kind, force, used):
    place = "accel.accel.linear" if "Covariance" in kind else "accel.linear"
    log = log_of({"/accel": (f"geometry_msgs/msg/{kind}", lambda _, time: stamped(time) | xyz(place, force))})
    assert [imu.specific_force.value[0].tolist() for imu in log.imus] == [[0.5, 0.25, -9.75]] * used
    assert used or ("gravity" in log.notes[0] and log.notes[0].id == "unused")


def test_bare_vectors_are_what_their_topics_say(log_of):
    def values(vector):
        return "geometry_msgs/msg/Vector3Stamped", lambda _, time: stamped(time) | xyz("vector", vector)

    log = log_of({
        "/imu/angular_velocity": values((0.1, 0.2, 0.3)), "/imu/acceleration": values((0.5, -0.25, 9.75)),
        "/imu/free_acceleration": values((0.01, 0, 0)), "/imu/dv": values((0, 0, 0.1)),
    })  # fmt: skip
    triads = [triad for imu in log.imus for triad in (imu.angular_rate, imu.specific_force) if triad is not None]
    assert sorted(triad.value[0].tolist() for triad in triads) == [[0.1, -0.2, -0.3], [0.5, 0.25, -9.75]]
    assert any("/imu/free_acceleration" in note and "gravity" in note for note in log.notes)
    assert any("/imu/dv" in note for note in log.notes)

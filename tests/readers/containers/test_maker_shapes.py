"""Messages of NovAtel, VectorNav, Septentrio and u-blox give the streams that their units, axes and clocks state."""

import numpy as np
import pytest

from imuwb.log import BY_FILTER
from tests.readers.repairs import repairs

from .ros_values import stamped
from .shape_truth import (
    COUNT,
    FORCE,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    NO_FIX,
    RATE,
    VELOCITY,
    T,
    assert_gnss,
    assert_imu,
    states_no_fix,
    xyz,
)  # fmt: skip

# NovAtel


def novatel_fix(**values):
    return lambda _, time: stamped(
        time, lat=LATITUDE, lon=LONGITUDE, hgt=HEIGHT - 48.0, undulation=48.0, lat_stdev=0.25, lon_stdev=0.5, hgt_stdev=1.0,
        **values,
    )  # fmt: skip


@pytest.mark.parametrize("form", [0, 2])  # two forms of the header of NovAtel
@pytest.mark.parametrize(("kind", "fix"), [(0, 1), (16, 3), (17, 4), (34, 5), (50, 6), (56, 6)])
def test_novatel_bestpos(log_of, form, kind, fix):
    log = log_of({"/bestpos": ("novatel_oem7_msgs/msg/BESTPOS", novatel_fix(pos_type__type=kind))}, form=form)
    if fix == NO_FIX:
        assert states_no_fix(log)
        return
    (gnss,) = log.gnss
    assert_gnss(gnss, velocity=None, sigma=(0.25, 0.5, 1.0), fix=fix)
    assert gnss.time.tolist() == [T + i * 10**7 for i in range(COUNT)]


def test_novatel_bestpos_that_is_not_computed_is_no_fix(log_of):
    values = novatel_fix(pos_type__type=50, sol_status__status=1)
    assert states_no_fix(log_of({"/bestpos": ("novatel_oem7_msgs/msg/BESTPOS", values)}))


def test_novatel_bestvel_is_the_velocity_of_bestpos(log_of):
    def velocity(i, time):
        return stamped(time, hor_speed=5.0, trk_gnd=90.0, ver_speed=0.5)

    (gnss,) = log_of({
        "/novatel/oem7/bestpos": ("novatel_oem7_msgs/msg/BESTPOS", novatel_fix(pos_type__type=50)),
        "/novatel/oem7/bestvel": ("novatel_oem7_msgs/msg/BESTVEL", velocity),
    }).gnss  # fmt: skip
    np.testing.assert_allclose(gnss.velocity, [[0, 5, -0.5]] * COUNT, atol=1e-12)


@pytest.mark.parametrize(("kind", "height"), [("INSPVA", HEIGHT), ("INSPVAX", HEIGHT - 48)])
def test_novatel_solution_is_that_of_its_filter(log_of, kind, height):
    more = (
        {"undulation": 48.0, "latitude_stdev": 0.5, "longitude_stdev": 0.25, "height_stdev": 1.0}
        if kind == "INSPVAX"
        else {}
    )

    def values(i, time):
        return stamped(
            time, latitude=LATITUDE, longitude=LONGITUDE, height=height, north_velocity=3.0, east_velocity=-4.0, up_velocity=-0.5,
            roll=2.0, pitch=-3.0, azimuth=120.0, **more,
        )  # fmt: skip

    log = log_of({"/ins": (f"novatel_oem7_msgs/msg/{kind}", values)})
    (reference,) = log.references
    assert log.gnss == ()
    np.testing.assert_allclose(reference.position[0], [np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT], rtol=1e-9)
    np.testing.assert_allclose(reference.velocity[0], VELOCITY)
    np.testing.assert_allclose(np.degrees(reference.attitude[0]), [2, -3, 120])
    assert reference.origin.by_filter


@pytest.mark.parametrize("kind", ["CORRIMU", "IMURATECORRIMU"])
def test_corrected_rates_of_novatel_are_refused(log_of, kind):
    log = log_of({"/corrimu": (f"novatel_oem7_msgs/msg/{kind}", lambda _, time: stamped(time, vertical_acc=0.01))})
    assert log.imus == ()
    (note,) = log.notes
    assert note.id == "unused"
    assert "gravity" in note


# VectorNav


def test_vectornav_raw_imu(log_of):
    def values(i, time):
        return stamped(time) | xyz("uncompgyro", RATE) | xyz("uncompaccel", FORCE) | {"temp": 33.5}

    log = log_of({"/vectornav/raw/imu": ("vectornav_msgs/msg/ImuGroup", values)})
    (imu,) = (imu for imu in log.imus if imu.angular_rate is not None)
    assert_imu(imu)
    assert imu.temperature.value.tolist() == [33.5] * COUNT
    assert imu.name == "/vectornav/raw/imu"
    assert imu.origin.frame == "FRD"
    assert [note.id for note in log.notes if ".compensated" in note] == ["no_sensor", "no_sensor"]


def test_vectornav_common_group(log_of):
    def values(i, time):
        return (
            stamped(time) | xyz("imu_rate", RATE) | xyz("imu_accel", FORCE) | xyz("angularrate", (0.01, 0.02, 0.03))
            | xyz("accel", (0.0, 0.0, -9.8)) | xyz("position", (LATITUDE, LONGITUDE, HEIGHT)) | xyz("velocity", VELOCITY)
            | xyz("yawpitchroll", (120.0, -3.0, 2.0)) | {"magpres_temp": 28.0}
        )  # fmt: skip

    log = log_of({"/vn": ("vectornav_msgs/msg/CommonGroup", values)})
    by_name = {imu.name: imu for imu in log.imus}
    assert_imu(by_name["/vn"])
    assert_imu(by_name["/vn.compensated"], (0.01, 0.02, 0.03), (0, 0, -9.8))
    (reference,) = log.references
    np.testing.assert_allclose(reference.velocity[0], VELOCITY)
    np.testing.assert_allclose(np.degrees(reference.attitude[0]), [2, -3, 120])
    assert {float(imu.temperature.value[0]) for imu in log.imus if imu.temperature is not None} == {28.0}


def test_vectornav_receiver(log_of):
    def values(i, time):
        return (
            stamped(time) | xyz("poslla", (LATITUDE, LONGITUDE, HEIGHT)) | xyz("velned", VELOCITY)
            | xyz("posu", (0.25, 0.5, 1.0)) | {"velu": 0.125, "fix": 3, "timeinfo_leapseconds": 18}
        )  # fmt: skip

    (gnss,) = log_of({"/vectornav/raw/gps": ("vectornav_msgs/msg/GpsGroup", values)}).gnss
    assert_gnss(gnss, sigma=(0.25, 0.5, 1.0), velocity_sigma=(0.125,) * 3, fix=3)


def test_vectornav_ins(log_of):
    def values(i, time):
        return (
            stamped(time) | xyz("poslla", (LATITUDE, LONGITUDE, HEIGHT)) | xyz("velned", VELOCITY)
            | {"posu": 0.5, "velu": 0.125}
        )  # fmt: skip

    log = log_of({"/vectornav/raw/ins": ("vectornav_msgs/msg/InsGroup", values)})
    assert_gnss(log.references[0], sigma=(0.5,) * 3, velocity_sigma=(0.125,) * 3)
    assert BY_FILTER in log.references[0].origin.frame


# Septentrio


@pytest.mark.parametrize(("mode", "fix"), [(0, 1), (1, 3), (2, 4), (4, 6), (5, 5), (6, 4)])
def test_septentrio_pvt(log_of, mode, fix):
    def values(i, time):
        return stamped(
            time, mode=mode, latitude=np.radians(LATITUDE), longitude=np.radians(LONGITUDE), height=HEIGHT, undulation=48.0,
            vn=3.0, ve=-4.0, vu=-0.5, h_accuracy=200, v_accuracy=300,
        )  # fmt: skip

    log = log_of({"/pvtgeodetic": ("septentrio_gnss_driver/msg/PVTGeodetic", values)})
    if fix == NO_FIX:
        assert states_no_fix(log)
        return
    (gnss,) = log.gnss
    # twice the root mean square of the distance in the plane; twice the sigma of the height
    assert_gnss(gnss, sigma=(np.sqrt(0.5),) * 2 + (1.5,), fix=fix)


def test_septentrio_marks_what_it_does_not_know(log_of):
    def values(i, time):
        none = -2e10
        at = (none,) * 2 if i < 5 else (np.radians(LATITUDE), np.radians(LONGITUDE))
        return stamped(
            time,
            mode=1,
            latitude=at[0],
            longitude=at[1],
            height=HEIGHT,
            vn=none,
            ve=none,
            vu=none,
            h_accuracy=65535,
            v_accuracy=65535,
        )

    (gnss,) = log_of({"/pvtgeodetic": ("septentrio_gnss_driver/msg/PVTGeodetic", values)}).gnss
    assert len(gnss) == COUNT - 5
    assert_gnss(gnss, velocity=None)


def test_septentrio_ins(log_of):
    def values(i, time):
        return stamped(
            time, latitude=np.radians(LATITUDE), longitude=np.radians(LONGITUDE), height=HEIGHT, vn=3.0, ve=-4.0, vu=-0.5,
            roll=2.0, pitch=-3.0, heading=120.0, latitude_std_dev=0.5, longitude_std_dev=0.25, height_std_dev=1.0,
        )  # fmt: skip

    (reference,) = log_of({"/insnavgeod": ("septentrio_gnss_driver/msg/INSNavGeod", values)}).references
    assert_gnss(reference, sigma=(0.5, 0.25, 1.0))
    np.testing.assert_allclose(np.degrees(reference.attitude[0]), [2, -3, 120], rtol=1e-6)


# u-blox


@pytest.mark.parametrize("kind", ["NavPVT", "NavPVT7"])
@pytest.mark.parametrize(
    ("fix", "flags", "wanted"), [(3, 1, 3), (3, 1 + 64, 5), (3, 1 + 128, 6), (3, 3, 4), (2, 1, 2), (0, 0, 1)]
)
def test_ublox_nav_pvt(log_of, kind, fix, flags, wanted):
    def values(i, time):
        return {
            "lat": 475_000_000, "lon": 85_000_000, "height": 450_000, "h_msl": 402_000, "h_acc": 500, "v_acc": 1500,
            "vel_n": 3000, "vel_e": -4000, "vel_d": 500, "s_acc": 250, "fix_type": fix, "flags": flags,
        }  # fmt: skip

    log = log_of({"/ublox/navpvt": (f"ublox_msgs/msg/{kind}", values)})
    if wanted == NO_FIX:
        assert states_no_fix(log)
        return
    (gnss,) = log.gnss
    assert_gnss(gnss, sigma=(0.5, 0.5, 1.5), velocity_sigma=(0.25,) * 3, fix=wanted)
    assert gnss.time.tolist() == [T + i * 10**7 for i in range(COUNT)]
    assert repairs(gnss) == {"no_stamp": COUNT}


def test_ublox_nav_velned_is_a_velocity(log_of):
    def place(i, time):
        return {"lat": 475_000_000, "lon": 85_000_000, "height": 450_000, "h_msl": 402_000, "h_acc": 500, "v_acc": 1500}

    def velocity(i, time):
        return {"vel_n": 300, "vel_e": -400, "vel_d": 50, "s_acc": 25}

    (gnss,) = log_of({
        "/ublox/navposllh": ("ublox_msgs/msg/NavPOSLLH", place), "/ublox/navvelned": ("ublox_msgs/msg/NavVELNED", velocity),
    }).gnss  # fmt: skip
    assert_gnss(gnss, sigma=(0.5, 0.5, 1.5), velocity_sigma=(0.25,) * 3)

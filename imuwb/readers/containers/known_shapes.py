"""The shapes of messages that imuwb reads, by the names of their fields: those of makers and drivers, then those of ROS itself.

Facts: the definitions that ``ros_messages.toml`` names; REP 103, 105, 145 (ros-infrastructure/rep); of PX4 also
PX4/PX4-Autopilot, msg; of NovAtel also docs.novatel.com, OEM7 (BESTPOS: position types; INSPVA: height above the
ellipsoid; INSPVAX, BESTPOS: above the geoid; CORRIMU: corrected for gravity and the Earth's rate); of Septentrio also its reference
guide (PVTGeodetic: modes, accuracies of two sigmas; -2e10: no value); of u-blox also its interface description (UBX-NAV-PVT).
"""

import math
import re
from collections.abc import Callable

from imuwb.log import BY_FILTER, MEAN_SEA_LEVEL
from imuwb.readers.containers.message_columns import (
    DEGREES,
    Quantity,
    course,
    covariance,
    diagonal,
    fix_sigmas,
    fix_type,
    orientation,
    position,
    rotation,
    sigmas,
    single,
    triad,
    ublox_fix,
    vector,
    whole,
    xyz,
)
from imuwb.readers.containers.shapes import MICROSECOND, Shape, Stamp

FORWARD_LEFT_UP, FORWARD_RIGHT_DOWN = "FLU (REP 145)", "FRD"
IMU_UNITS, ABOVE_SEA = "rad/s, m/s²", f"deg, m ({MEAN_SEA_LEVEL}), m/s"
ESTIMATE = f"NED, {BY_FILTER}"
_E7, _MM = 1e-7 * DEGREES, 1e-3
_RECEIVER = re.compile(r"(?:^|[/_.])(?:gps|gnss|fix|navsat|ublox)")
_RATES = re.compile(r"(?:^|[/_])(?:gyro|angular_velocity|angular_rate)(?:$|[/_])")
_FORCES = re.compile(r"(?:^|[/_])(?:accel|acceleration|accelerometer|linear_acceleration|specific_force)(?:$|[/_])")
_HALF = re.compile(r"imu|gyro|accel|fog", re.IGNORECASE)


def is_receiver(topic: str) -> bool:
    """Return whether a topic's name is that of a receiver of GNSS."""
    return _RECEIVER.search(topic.lower()) is not None and "speed" not in topic.lower()


def _is_twist(schema: str, topic: str) -> bool:
    return schema.endswith(("TwistStamped", "TwistWithCovarianceStamped")) and "ecef" not in topic.lower()


def _is_receivers_velocity(schema: str, topic: str) -> bool:
    return _is_twist(schema, topic) and is_receiver(topic)


def _is_speed(schema: str, topic: str) -> bool:
    return (schema.endswith("Odometry") or _is_twist(schema, topic)) and not is_receiver(topic)


def _is_half(schema: str, topic: str) -> bool:
    return _HALF.search(topic) is not None or _HALF.search(schema) is not None


def _is_vector_of(name: re.Pattern[str]) -> Callable[[str, str], bool]:
    """Return the test whether a topic of bare vectors has a name that tells what they are."""

    def allowed(schema: str, topic: str) -> bool:
        return schema.endswith("Vector3Stamped") and name.search(topic.lower()) is not None

    return allowed


def _of(*names: str) -> Callable[[str, str], bool]:
    """Return the test whether a type's name ends with one of some names."""

    def allowed(schema: str, topic: str) -> bool:
        return schema.endswith(names)

    return allowed


# PX4: the same names as in its own logs, in FRD axes, NED, microseconds.

_SAMPLED = Stamp(("timestamp_sample", "timestamp"), (MICROSECOND, MICROSECOND), instead=True)
_PUBLISHED = Stamp(("timestamp",), (MICROSECOND,))
_ACCELEROMETER = Stamp(("timestamp", "accelerometer_timestamp_relative"), (MICROSECOND, MICROSECOND))
_PX4_TIMES = (_SAMPLED, _PUBLISHED)
_PX4_FIX = (
    vector("velocity", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s"), sigmas("position_sigma", "eph", "eph", "epv"),
    sigmas("velocity_sigma", "s_variance_m_s", "s_variance_m_s", "s_variance_m_s"),
    fix_type("fix_type", {i: i for i in range(1, 7)} | {0: 1}),
)  # fmt: skip
PX4 = (
    Shape("imu", "gyro_rad[3]", (triad("angular_rate", "gyro_rad[3]"),), IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD", (_PUBLISHED,)),
    Shape("imu", "accelerometer_m_s2[3]", (triad("specific_force", "accelerometer_m_s2[3]"),),
          IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD", (_ACCELEROMETER, _PUBLISHED)),
    Shape("imu", "x", (triad("angular_rate", "x", "y", "z"),), IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD", _PX4_TIMES, _of("SensorGyro")),
    Shape("imu", "x", (triad("specific_force", "x", "y", "z"), single("temperature", "temperature", needed=False)),
          IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD", _PX4_TIMES, _of("SensorAccel")),
    Shape("gnss", "latitude_deg", (position("latitude_deg", "longitude_deg", "altitude_ellipsoid_m"), *_PX4_FIX),
          "deg, m, m/s", "NED", stamps=_PX4_TIMES),
    Shape("gnss", "vel_ned_valid", (position("lat", "lon", "alt_ellipsoid", angle=_E7, scale=_MM), *_PX4_FIX),
          "1e-7 deg, mm, m/s", "NED", stamps=_PX4_TIMES),
    Shape("reference", "lat_lon_reset_counter",
          (position("lat", "lon", "alt_ellipsoid"), sigmas("position_sigma", "eph", "eph", "epv")),
          "deg, m", ESTIMATE, stamps=_PX4_TIMES),
    Shape("pose", "pose_frame", (vector("position", "position[3]", needed=True), rotation("q[4]", "", "", "", whole=True),
          sigmas("position_sigma", "position_variance[3]", variances=True)), "m", "of its own", stamps=_PX4_TIMES),
)  # fmt: skip

# NovAtel OEM7

#: position types: without a position, differential, with float and with fixed ambiguities
_NOVATEL_FIXES: dict[int, int] = {
    0: 1, 1: 1, 2: 1, 17: 4, 18: 4, 54: 4, 32: 5, 33: 5, 34: 5, 55: 5, 68: 5, 69: 5, 73: 5, 74: 5, 48: 6, 49: 6, 50: 6, 56: 6,
}  # fmt: skip
_NO_FORCE = (
    "its rates and accelerations are corrected for gravity and the Earth's rate, so they are no measurements of an IMU"
)
_INS_ANGLES = vector("attitude", "roll", "pitch", "azimuth", scale=DEGREES)
_INS_VELOCITY = vector("velocity", "north_velocity", "east_velocity", "-up_velocity")
NOVATEL = (
    Shape("gnss", "lat_stdev", (
        position("lat", "lon", "hgt", above="undulation"), sigmas("position_sigma", "lat_stdev", "lon_stdev", "hgt_stdev"),
        fix_type("pos_type.type", _NOVATEL_FIXES, sound="sol_status.status")), "deg, m", "NED"),
    Shape("velocity", "trk_gnd", course("trk_gnd", "hor_speed", "ver_speed"), "deg, m/s", "NED"),
    Shape("reference", "latitude_stdev", (
        position("latitude", "longitude", "height", above="undulation"), _INS_VELOCITY, _INS_ANGLES,
        sigmas("position_sigma", "latitude_stdev", "longitude_stdev", "height_stdev"),
        sigmas("velocity_sigma", "north_velocity_stdev", "east_velocity_stdev", "up_velocity_stdev")),
        "deg, m, m/s", ESTIMATE, allowed=_of("INSPVAX")),
    Shape("reference", "azimuth", (position("latitude", "longitude", "height"), _INS_VELOCITY, _INS_ANGLES),
          "deg, m, m/s", ESTIMATE, allowed=_of("INSPVA")),
    Shape("imu", "lateral_acc", (), refused=_NO_FORCE),
)  # fmt: skip

# VectorNav: FRD axes, as the driver's raw topics have them

_VECTORNAV_FIXES = {0: 1, 1: 1, 2: 2, 3: 3, 4: 4, 5: 3, 7: 5, 8: 6}
_VECTORNAV_SIGMAS = sigmas("position_sigma", *xyz("posu"))
VECTORNAV = (
    Shape("imu", "imu_rate.x", (triad("angular_rate", *xyz("imu_rate")), triad("specific_force", *xyz("imu_accel"))),
          IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD"),
    Shape("imu", "uncompgyro.x", (
        triad("angular_rate", *xyz("uncompgyro")), triad("specific_force", *xyz("uncompaccel")),
        single("temperature", "temp", needed=False)), IMU_UNITS, FORWARD_RIGHT_DOWN, "FRD"),
    Shape("imu", "angularrate.x", (triad("angular_rate", *xyz("angularrate")), triad("specific_force", *xyz("accel"))),
          IMU_UNITS, "FRD, corrected by its own filter", "FRD", part="compensated"),
    Shape("gnss", "timeinfo_leapseconds", (
        position(*xyz("poslla")), vector("velocity", *xyz("velned")), _VECTORNAV_SIGMAS,
        sigmas("velocity_sigma", "velu", "velu", "velu"), fix_type("fix", _VECTORNAV_FIXES)), "deg, m, m/s", "NED"),
    Shape("reference", "linearaccelecef.x", (
        position(*xyz("poslla")), vector("velocity", *xyz("velned")), sigmas("position_sigma", "posu", "posu", "posu"),
        sigmas("velocity_sigma", "velu", "velu", "velu")), "deg, m, m/s", ESTIMATE),
    Shape("reference", "magpres_temp", (
        position(*xyz("position")), vector("velocity", *xyz("velocity")),
        vector("attitude", "yawpitchroll.z", "yawpitchroll.y", "yawpitchroll.x", scale=DEGREES)), "deg, m, m/s", ESTIMATE),
    Shape("temperature", "magpres_temp", (single("temperature", "magpres_temp"),), "°C"),
)  # fmt: skip

# Septentrio: radians; the accuracies are of two sigmas, the horizontal one of the distance

_SBF_ACCURACY = (5e-3 / math.sqrt(2), 5e-3 / math.sqrt(2), 5e-3)  #: sigmas of the axes, m, of one unit
_SBF_FIXES = {0: 1, 1: 3, 2: 4, 3: 3, 4: 6, 5: 5, 6: 4, 7: 6, 8: 5, 10: 5}
_INS_SOLUTION = (
    position("latitude", "longitude", "height", angle=1.0), vector("velocity", "vn", "ve", "-vu", or_none=True),
    vector("attitude", "roll", "pitch", "heading", scale=DEGREES, or_none=True),
    sigmas("position_sigma", "latitude_std_dev", "longitude_std_dev", "height_std_dev"),
    sigmas("velocity_sigma", "vn_std_dev", "ve_std_dev", "vu_std_dev"),
)  # fmt: skip
SEPTENTRIO = (
    Shape("gnss", "h_accuracy", (
        position("latitude", "longitude", "height", angle=1.0), vector("velocity", "vn", "ve", "-vu"),
        sigmas("position_sigma", "h_accuracy", "h_accuracy", "v_accuracy", scale=_SBF_ACCURACY, none=65535), fix_type("mode", _SBF_FIXES)),
        "rad, m, m/s", "NED", allowed=_of("PVTGeodetic")),
    Shape("reference", "latitude_std_dev", _INS_SOLUTION, "rad, m, m/s, deg", ESTIMATE, allowed=_of("INSNavGeod")),
)  # fmt: skip

# u-blox, with the names of ROS 1 and of ROS 2


def _nav_pvt(h_acc: str, v_acc: str, s_acc: str, fix: str, *velocity: str) -> tuple[Quantity, ...]:
    return (
        position("lat", "lon", "height", angle=_E7, scale=_MM), vector("velocity", *velocity, scale=_MM),
        sigmas("position_sigma", h_acc, h_acc, v_acc, scale=_MM), sigmas("velocity_sigma", s_acc, s_acc, s_acc, scale=_MM),
        ublox_fix(fix, "flags"),
    )  # fmt: skip


UBLOX = (
    Shape("gnss", "hMSL", _nav_pvt("hAcc", "vAcc", "sAcc", "fixType", "velN", "velE", "velD"), "1e-7 deg, mm, mm/s", "NED",
          allowed=_of("NavPVT", "NavPVT7", "NavPOSLLH")),
    Shape("gnss", "h_msl", _nav_pvt("h_acc", "v_acc", "s_acc", "fix_type", "vel_n", "vel_e", "vel_d"), "1e-7 deg, mm, mm/s", "NED",
          allowed=_of("NavPVT", "NavPVT7", "NavPOSLLH")),
    Shape("velocity", "velN", (vector("velocity", "velN", "velE", "velD", scale=1e-2, needed=True),
          sigmas("velocity_sigma", "sAcc", "sAcc", "sAcc", scale=1e-2)), "cm/s", "NED", allowed=_of("NavVELNED")),
    Shape("velocity", "vel_n", (vector("velocity", "vel_n", "vel_e", "vel_d", scale=1e-2, needed=True),
          sigmas("velocity_sigma", "s_acc", "s_acc", "s_acc", scale=1e-2)), "cm/s", "NED", allowed=_of("NavVELNED")),
)  # fmt: skip

# Others of a package of their own

_GPS_FIX = {-1: 1, 1: 4, 2: 4, 18: 4, 33: 4, 20: 5, 19: 6}
OTHERS = (
    Shape("gnss", "err_horz", (
        position("latitude", "longitude", "altitude"), *course("track", "speed", "climb", "err_speed", "err_climb"),
        fix_sigmas("position_covariance", "position_covariance_type", "err_horz", "err_vert"),
        fix_type("status.status", _GPS_FIX)), "deg, m (above the ellipsoid or the sea: not stated), m/s", "ENU"),
    Shape("temperature", "mean_temp", (single("temperature", "mean_temp"),), "°C", allowed=_of("TemperatureStatistics")),
    Shape("reference", "pose.position.latitude", (
        position("pose.position.latitude", "pose.position.longitude", "pose.position.altitude"),
        covariance("position_sigma", "covariance", 6)), "deg, m", f"ENU, {BY_FILTER}", allowed=_of("Stamped")),
    Shape("reference", "pose.pose.position.latitude", (
        position("pose.pose.position.latitude", "pose.pose.position.longitude", "pose.pose.position.altitude"),
        covariance("position_sigma", "pose.covariance", 6)), "deg, m", f"ENU, {BY_FILTER}"),
    Shape("gnss", "position.latitude", (), allowed=_of("GeoPointStamped"), refused="points of a map, no fixes of a receiver"),
    Shape("velocity", "twist.linear.x", (), allowed=lambda schema, topic: "Twist" in schema and "ecef" in topic.lower(),
          refused="a velocity along earth-centred axes is not read"),
)  # fmt: skip

# ROS itself: the names alone count, so that messages of one's own are read, too.

_NAVSAT_FIX = {-1: 1, 1: 4, 2: 4}
_LINEAR = tuple(f"twist.linear.{axis}" for axis in "xyz")
_RATE = triad("angular_rate", *xyz("angular_velocity"), absent="angular_velocity_covariance[0]")
_FORCE = triad("specific_force", *xyz("linear_acceleration"), absent="linear_acceleration_covariance[0]")
_POSE = tuple(f"pose.orientation.{part}" for part in "wxyz")
ROS = (
    Shape("imu", "angular_velocity.x", (_RATE, _FORCE), IMU_UNITS, FORWARD_LEFT_UP),
    Shape("orientation", "angular_velocity.x", orientation(), "", "FLU relative to ENU (REP 103)"),
    Shape("gnss", "latitude", (
        position("latitude", "longitude", "altitude"), covariance("position_sigma", "position_covariance", 3, "position_covariance_type"),
        *course("track", "speed", "climb"), fix_type("status.status", _NAVSAT_FIX)), "deg, m", "ENU"),
    Shape("temperature", "temperature", (single("temperature", "temperature"),), "°C", allowed=_of("Temperature")),
    Shape("velocity", "twist.linear.x", (
        vector("velocity", "twist.linear.y", "twist.linear.x", "-twist.linear.z", needed=True),
        covariance("velocity_sigma", "covariance", 6)), "m/s", "ENU", allowed=_is_receivers_velocity),
    Shape("speed", "twist.linear.x", (single("speed", "twist.linear.x"),), "m/s", "forward", allowed=_is_speed),
    Shape("fix", "fix_type", (single("fix_type", "fix_type"),), allowed=_of("FixType")),
    Shape("pose", "pose.position.x", (
        vector("position", *xyz("pose.position"), needed=True), rotation(*_POSE), diagonal("position_sigma", "covariance", 6)),
        "m", "of its own", allowed=_of("Odometry", "PoseStamped", "PoseWithCovarianceStamped")),
    Shape("reference", "latitude_longitude_height[3]", (
        whole("position", "latitude_longitude_height"), whole("velocity", "velocity_north_east_down"),
        whole("attitude", "roll_pitch_heading"), whole("position_sigma", "position_sigma", needed=False),
        whole("velocity_sigma", "velocity_sigma", needed=False), whole("attitude_sigma", "attitude_sigma", needed=False)),
        "rad, m, m/s", "NED"),
)  # fmt: skip
_ACCELERATION = triad("specific_force", *xyz("accel.linear"))
_VECTOR_RATE, _VECTOR_FORCE = triad("angular_rate", *xyz("vector")), triad("specific_force", *xyz("vector"))
#: A message of an IMU's own type may have only one of its sensors.
HALVES = (
    Shape("imu", "angular_velocity.x", (_RATE,), IMU_UNITS, FORWARD_LEFT_UP, allowed=_is_half),
    Shape("imu", "linear_acceleration.x", (_FORCE,), IMU_UNITS, FORWARD_LEFT_UP, allowed=_is_half),
    Shape("imu", "accel.linear.x", (_ACCELERATION,), IMU_UNITS, FORWARD_LEFT_UP, allowed=_of("Stamped"), gravity=True),
    Shape("imu", "vector.x", (_VECTOR_RATE,), IMU_UNITS, FORWARD_LEFT_UP, allowed=_is_vector_of(_RATES)),
    Shape(
        "imu", "vector.x", (_VECTOR_FORCE,), IMU_UNITS, FORWARD_LEFT_UP, allowed=_is_vector_of(_FORCES), gravity=True
    ),
)
SHAPES = ((*PX4, *NOVATEL, *VECTORNAV, *SEPTENTRIO, *UBLOX, *OTHERS), ROS, HALVES)

"""What a flight log holds and imuwb does not use: inertial, GNSS and trajectory data by name, everything else by number."""

import re
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence

from imuwb.readers.batch import Remark, unused

PARTNERS = "they lack the records that they belong to, or fields that they need"
REPLAY = "increments or copies for the vehicle's own filter; its IMUs and receivers are read themselves"
DERIVED = "filtered or integrated from an IMU that is read itself"
OTHER_SOLUTION = "another estimate of the vehicle's filter, or one without a geodetic position"
PLACES = (
    "places and attitudes of missions, cameras, other vehicles and commands, or of a filter that is not the main one"
)
RAW_GNSS = "messages or states of a receiver, without fixes"
BLENDED = "blended from receivers that are read themselves"
TRUTH = "the truth of a simulator, in a form that is not read"

#: fields of DataFlash records -> why the records that have them all are not used
_DATAFLASH = (
    ({"DAX", "DAY", "DAZ"}, REPLAY), ({"DelAX", "DelAY", "DelAZ"}, REPLAY), ({"DelaT"}, REPLAY), ({"GyrX"}, PARTNERS),
    ({"AccX"}, PARTNERS), ({"Lat", "Lng"}, PLACES), ({"Lat", "Lon"}, PLACES), ({"Roll", "Pitch", "Yaw"}, PLACES),
    ({"Q1", "Q2", "Q3", "Q4"}, PLACES), ({"VN", "VE", "VD"}, OTHER_SOLUTION),
)  # fmt: skip
#: DataFlash records with a meaning that their fields do not show
_DATAFLASH_NAMES = {
    "GPSB": BLENDED, "GPAB": BLENDED, "SIM": TRUTH, "SIM2": TRUTH, "SIMS": TRUTH, "GRAW": RAW_GNSS, "GRXH": RAW_GNSS, "GRXS": RAW_GNSS, "UBX1": RAW_GNSS,
    "UBX2": RAW_GNSS, "GPYW": RAW_GNSS, "SBRH": RAW_GNSS, "SBRM": RAW_GNSS, "SBRE": RAW_GNSS, "ISBH": PARTNERS,
    "ISBD": PARTNERS, **dict.fromkeys(("GPS", "GPS2", "GPA", "GPA2", "POS", "ATT"), PARTNERS), "IMT": REPLAY, "IMT2": REPLAY, "IMT3": REPLAY, "XKF1": OTHER_SOLUTION, "NKF1": OTHER_SOLUTION,
}  # fmt: skip
#: beginning or part of a PX4 topic's name -> why it is not used; the first that fits
_ULOG = (
    (r"setpoint|status|_mode|waypoint|mission|command|camera|gimbal|transponder|adsb|innovation|bias|_fft|_selection|debug", ""),
    (r"groundtruth", TRUTH), (r"^sensor_gps$|^vehicle_gps_position$", PARTNERS), (r"^vehicle_(acceleration|angular_velocity|angular_acceleration|imu\b)", DERIVED),
    (r"^sensor_(gyro|accel)|^sensor_combined|^vehicle_imu$", PARTNERS),
    (r"odometry|_attitude$|_position$|^control_state$|mocap|vision|home_position", OTHER_SOLUTION),
    (r"^gps|gnss|satellite|_gps", RAW_GNSS),
)  # fmt: skip
#: number of a MAVLink message -> name, and why it is not used. Source: https://mavlink.io/en/messages/all.html
_MAVLINK: dict[int, tuple[str, str]] = {
    25: ("GPS_STATUS", RAW_GNSS), 30: ("ATTITUDE", OTHER_SOLUTION), 31: ("ATTITUDE_QUATERNION", OTHER_SOLUTION),
    32: ("LOCAL_POSITION_NED", OTHER_SOLUTION), 33: ("GLOBAL_POSITION_INT", OTHER_SOLUTION),
    61: ("ATTITUDE_QUATERNION_COV", OTHER_SOLUTION), 63: ("GLOBAL_POSITION_INT_COV", OTHER_SOLUTION),
    64: ("LOCAL_POSITION_NED_COV", OTHER_SOLUTION), 90: ("HIL_STATE", TRUTH),
    101: ("GLOBAL_VISION_POSITION_ESTIMATE", OTHER_SOLUTION), 102: ("VISION_POSITION_ESTIMATE", OTHER_SOLUTION),
    104: ("VICON_POSITION_ESTIMATE", OTHER_SOLUTION), 108: ("SIM_STATE", TRUTH), 113: ("HIL_GPS", TRUTH),
    115: ("HIL_STATE_QUATERNION", TRUTH), 127: ("GPS_RTK", RAW_GNSS), 128: ("GPS2_RTK", RAW_GNSS),
    138: ("ATT_POS_MOCAP", OTHER_SOLUTION), 146: ("CONTROL_SYSTEM_STATE", OTHER_SOLUTION), 164: ("SIMSTATE", TRUTH),
    178: ("AHRS2", OTHER_SOLUTION), 182: ("AHRS3", OTHER_SOLUTION), 232: ("GPS_INPUT", RAW_GNSS),
    233: ("GPS_RTCM_DATA", RAW_GNSS), 296: ("GLOBAL_POSITION_SENSOR", OTHER_SOLUTION), 331: ("ODOMETRY", OTHER_SOLUTION),
    441: ("GNSS_INTEGRITY", RAW_GNSS), 60052: ("AVSS_DRONE_IMU", DERIVED),
}  # fmt: skip


def dataflash_left_out(
    counts: Mapping[str, int], labels: Mapping[str, Sequence[str]], used: Collection[str]
) -> Iterator[Remark]:
    """Yield what is not used of a DataFlash log.

    Args:
        counts: records by name.
        labels: fields by name.
        used: names of the records that are used.
    """

    def reason(name: str) -> str:
        own = set(labels.get(name, ()))
        fitting = (why for fields, why in _DATAFLASH if fields <= own)
        return _DATAFLASH_NAMES.get(name) or next(fitting, "")

    rest = {name: (count, reason(name)) for name, count in counts.items() if name not in used}
    yield from _left_out(rest, "kinds of records")


def ulog_left_out(counts: Mapping[str, int], used: Collection[str]) -> Iterator[Remark]:
    """Yield what is not used of a PX4 log: topics by name with their number of messages."""

    def reason(name: str) -> str:
        return next((why for pattern, why in _ULOG if re.search(pattern, name)), "")

    rest = {name: (count, reason(name)) for name, count in counts.items() if name not in used}
    yield from _left_out(rest, "topics")


def mavlink_left_out(counts: Mapping[int, int], used: Collection[int]) -> Iterator[Remark]:
    """Yield what is not used of a telemetry log: messages by number."""
    rest = {number: count for number, count in counts.items() if number not in used}
    named = {number: _MAVLINK.get(number, (f"message {number}", "")) for number in rest}
    yield from _left_out({named[n][0]: (count, named[n][1]) for n, count in rest.items()}, "kinds of messages")


def _left_out(rest: Mapping[str, tuple[int, str]], what: str) -> Iterator[Remark]:
    """Yield a remark for each reason, and one on everything without a reason.

    Args:
        rest: name -> number of records, and why they are not used; "" for records without inertial, GNSS or trajectory data.
        what: what the names name.
    """
    by_reason: dict[str, list[str]] = defaultdict(list)
    others = [count for count, why in rest.values() if not why]
    for name, (count, why) in sorted(rest.items()):
        if why:
            by_reason[why].append(f"{name} ({count})")
    for why, names in by_reason.items():
        yield unused(names, why)
    if others:
        yield unused([f"{len(others)} other {what} ({sum(others)} in all)"], "no inertial, GNSS or trajectory data")

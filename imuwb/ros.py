"""ROS 2 messages and MCAP marks that readers and writers have in common.

The fields are those of common_interfaces (sensor_msgs, geometry_msgs, nav_msgs, std_msgs).
"""

MCAP_MAGIC = b"\x89MCAP0\r\n"
OURS = "imuwb"  #: name of the MCAP metadata that imuwb writes
TRUTH = "imuwb simulation"  #: name of the MCAP metadata with the parameters of a simulated log
ABSENT = -1.0  #: first element of a covariance: the message has no such measurement
UNKNOWN = -2  #: status of a fix whose status is not known
_HEADER = "std_msgs/Header header"
_PARTS = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
    "sensor_msgs/NavSatStatus": "int8 status\nuint16 service\n",
}
_MESSAGES = {
    "sensor_msgs/Imu": (
        "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
        "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    ),
    "sensor_msgs/Temperature": "float64 temperature\nfloat64 variance\n",
    "sensor_msgs/NavSatFix": (
        "sensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
        "float64[9] position_covariance\nuint8 position_covariance_type\n"
    ),
    "geometry_msgs/TwistWithCovarianceStamped": "geometry_msgs/TwistWithCovariance twist\n",
    "geometry_msgs/TwistStamped": "geometry_msgs/Twist twist\n",
    "nav_msgs/Odometry": (
        "string child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
    ),
    # No common message has these fields. Units: SI, rad; north-east-down.
    "imuwb_msgs/FixType": "uint8 fix_type\n",
    **dict.fromkeys(
        ("imuwb_msgs/Reference", "imuwb_msgs/FilterEstimate"),
        "float64[3] latitude_longitude_height\nfloat64[3] velocity_north_east_down\nfloat64[3] roll_pitch_heading\n"
        "float64[3] position_sigma\nfloat64[3] velocity_sigma\nfloat64[3] attitude_sigma\n",
    ),
}


def definition(name: str) -> str:
    """Return the whole definition of a message such as ``sensor_msgs/msg/Imu``; an empty text for an unknown message."""
    body = _MESSAGES.get(name.replace("/msg/", "/"))
    if body is None:
        return ""
    text = f"{_HEADER}\n{body}"
    used = _used(text)
    parts = (f"MSG: {part}\n{fields}" for part, fields in _PARTS.items() if part in used)
    return ("=" * 80 + "\n").join([text, *parts])


def _used(text: str) -> set[str]:
    """Return the parts that a text names, directly or within another part."""
    inner = {part for part in _PARTS if f"{part} " in text}
    return inner.union(*(_used(_PARTS[part]) for part in inner))

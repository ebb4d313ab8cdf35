"""Definitions of the ROS 2 messages that imuwb reads, which older recordings in SQLite lack.

The fields are those of common_interfaces (sensor_msgs, geometry_msgs, nav_msgs, std_msgs).
"""

_HEADER = "std_msgs/Header header"
_PARTS = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance",
    "sensor_msgs/NavSatStatus": "int8 status\nuint16 service",
}
_MESSAGES = {
    "sensor_msgs/Imu": (
        "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
        "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance"
    ),
    "sensor_msgs/NavSatFix": (
        "sensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
        "float64[9] position_covariance\nuint8 position_covariance_type"
    ),
    "sensor_msgs/Temperature": "float64 temperature\nfloat64 variance",
    "geometry_msgs/TwistStamped": "geometry_msgs/Twist twist",
    "geometry_msgs/TwistWithCovarianceStamped": "geometry_msgs/TwistWithCovariance twist",
    "nav_msgs/Odometry": (
        "string child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist"
    ),
}


def definition(name: str) -> str | None:
    """Return the whole definition of a message such as ``sensor_msgs/msg/Imu``; None for an unknown message."""
    body = _MESSAGES.get(name.replace("/msg/", "/"))
    if body is None:
        return None
    parts = "".join(f"\n{'=' * 40}\nMSG: {part}\n{text}\n" for part, text in _PARTS.items())
    return f"{_HEADER}\n{body}\n{parts}"

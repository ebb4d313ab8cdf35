"""The first bytes of each container."""

BAG = b"#ROSBAG V2.0\n"
MCAP = b"\x89MCAP0\r\n"

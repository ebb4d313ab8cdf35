"""Containers of robots' messages: MCAP, ROS 1 bags, and ROS 2 recordings in SQLite."""

"""Logs of flight controllers: MAVLink telemetry, ArduPilot's DataFlash and PX4's ULog."""

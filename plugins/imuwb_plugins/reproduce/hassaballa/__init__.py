"""Hassaballa and others: noise of an MPU-6050 at several rates and bandwidths, and its calibration."""

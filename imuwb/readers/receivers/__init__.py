"""Logs of GNSS receivers as they send them: u-blox UBX, NMEA 0183, and NovAtel."""

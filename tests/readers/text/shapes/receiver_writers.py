"""Writers of the logs of receivers, of the record in ``truth``."""

import numpy as np

from tests.readers.text.shapes.truth import (
    FIX_TIME,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    START,
    UNDULATION,
    VELOCITY,
    File,
    decimals,
    gps,
    table,
)  # fmt: skip

BOOT = 5_000_000_000  # ns from power-up to the first sample


def navsat_fix():
    names = ["header.seq", "header.stamp", "header.frame_id", "status.status", "latitude", "longitude", "altitude"]
    head = "%time," + ",".join(f"field.{name}" for name in names)
    n = FIX_TIME.size
    return File(
        table(head, FIX_TIME + 9000, np.arange(n), FIX_TIME, ["gps"] * n, np.zeros(n, int), LATITUDE, LONGITUDE, HEIGHT)
    )


def kf_gins_gnss():
    _, tow = gps(FIX_TIME)
    text = table("", decimals(tow), LATITUDE, LONGITUDE, HEIGHT, np.tile([0.01, 0.02, 0.05], (30, 1)), mark=" ")
    return File(text, "GNSS_RTK.pos", tow, "log", sensors="sigma")


def px4_gps():
    boot = BOOT + FIX_TIME - START
    names = "timestamp,time_utc_usec,lat,lon,alt,alt_ellipsoid,s_variance_m_s,eph,epv,vel_m_s,vel_n_m_s,vel_e_m_s,vel_d_m_s,fix_type"
    degrees = [np.rint(x * 1e7).astype(int) for x in (LATITUDE, LONGITUDE)]
    heights = [np.rint(x * 1000).astype(int) for x in (HEIGHT - UNDULATION, HEIGHT)]
    columns = *degrees, *heights, np.full(30, 0.2), np.full(30, 0.9), np.full(30, 1.1), np.ones(30), VELOCITY
    text = table(names, boot // 1000, FIX_TIME // 1000, *columns, np.full(30, 3))
    return File(text, "log_vehicle_gps_position_0.csv", boot, "boot", sensors="velocity sigma")


def px4_sensor_gps():
    boot = BOOT + FIX_TIME - START
    names = "timestamp,latitude_deg,longitude_deg,altitude_msl_m,altitude_ellipsoid_m,eph,epv,vel_n_m_s,vel_e_m_s,vel_d_m_s,fix_type"
    columns = (
        LATITUDE,
        LONGITUDE,
        HEIGHT - UNDULATION,
        HEIGHT,
        np.full(30, 0.9),
        np.full(30, 1.1),
        VELOCITY,
        np.full(30, 3),
    )
    return File(table(names, boot // 1000, *columns), time=boot, epoch="boot", sensors="velocity sigma")


def mavlogdump_gps():
    speed, course = np.hypot(*VELOCITY[:, :2].T), np.degrees(np.arctan2(VELOCITY[:, 1], VELOCITY[:, 0])) % 360
    stamps = [f"{t / 1e9:.8f}" for t in FIX_TIME.tolist()]
    columns = (
        np.full(30, 3),
        np.zeros(30, int),
        np.full(30, 2288),
        LATITUDE,
        LONGITUDE,
        HEIGHT,
        speed,
        course,
        VELOCITY[:, 2],
    )
    text = table(
        "timestamp,TimeUS,I,Status,GMS,GWk,Lat,Lng,Alt,Spd,GCrs,VZ",
        stamps,
        FIX_TIME // 1000,
        np.zeros(30, int),
        *columns,
    )
    return File(text, sensors="velocity above_sea", streams=("gnss0",))


def sensor_logger_location():
    head = "time,seconds_elapsed,speedAccuracy,verticalAccuracy,horizontalAccuracy,speed,bearing,altitude,longitude,latitude"
    speed, course = np.hypot(*VELOCITY[:, :2].T), np.degrees(np.arctan2(VELOCITY[:, 1], VELOCITY[:, 0])) % 360
    columns = np.full(30, 0.3), np.full(30, 4.0), np.full(30, 3.0), speed, course, HEIGHT, LONGITUDE, LATITUDE
    return File(
        table(head, FIX_TIME, (FIX_TIME - START) / 1e9, *columns), "Location.csv", sensors="level_velocity sigma"
    )


def flysight_gnss():
    head = "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,gpsFix,numSV\n,(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),,"
    stamps = [str(np.datetime64(t, "ns"))[:22] + "Z" for t in FIX_TIME.tolist()]
    columns = (
        LATITUDE,
        LONGITUDE,
        HEIGHT,
        VELOCITY,
        np.full(30, 2.0),
        np.full(30, 3.0),
        np.full(30, 0.2),
        np.full(30, 3),
        np.full(30, 9),
    )
    return File(table(head, stamps, *columns), sensors="velocity sigma above_sea")


RECEIVERS = (navsat_fix, kf_gins_gnss, px4_gps, px4_sensor_gps, mavlogdump_gps, sensor_logger_location, flysight_gnss)

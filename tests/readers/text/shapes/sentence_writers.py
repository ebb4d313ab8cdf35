"""Writers of logs of sentences, of the record in ``truth``."""

import zlib
from functools import reduce
from operator import xor

import numpy as np

from tests.readers.text.shapes.truth import (
    ACCEL,
    DEG,
    FIX_TIME,
    GYRO,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    START,
    STEP,
    TIME,
    UNDULATION,
    VELOCITY,
    File,
    G,
    N,
    axes,
    decimals,
    gps,
)

BOOT = 5_000_000_000
DEVICE_ADIS, DEVICE_EPSON = 31, 41


def dollar(body):
    return f"{body}*{reduce(xor, body[1:].encode(), 0):02X}"


def novatel(sign, head, body):
    text = f"{head};{body}"
    return f"{sign}{text}*{zlib.crc32(text.encode(), 0xFFFFFFFF) ^ 0xFFFFFFFF:08x}"


def cells(row):
    return ",".join(map(repr, np.asarray(row).tolist()))


def vn_imu():
    """Without a time: the rate is stated."""
    lines = [dollar(f"$VNIMU,0.1,0.2,0.3,{cells(a)},{cells(w)},25.5,101.3") for w, a in zip(GYRO, ACCEL, strict=True)]
    return File("\r\n".join([*lines, ""]), "vn.txt", STEP * np.arange(N), "log", rate=100.0, frame="FRD")


def vn_ymr_stamped():
    """With the stamps of a host before each sentence."""
    lines = [
        f"{stamp} {dollar(f'$VNYMR,90.0,1.0,2.0,0.1,0.2,0.3,{cells(a)},{cells(w)}')}"
        for stamp, w, a in zip(decimals(TIME), GYRO, ACCEL, strict=True)
    ]
    return File("\n".join([*lines, ""]), "vn.log", frame="FRD")


def vn_qmr():
    lines = [
        dollar(f"$VNQMR,0.0,0.0,0.0,1.0,0.1,0.2,0.3,{cells(a)},{cells(w)}") for w, a in zip(GYRO, ACCEL, strict=True)
    ]
    time = STEP * np.arange(N)
    return File("\n".join([*lines, ""]), "vn.txt", time, "log", rate=100.0, frame="FRD")


def get_sensor_data():
    head = "% LogFile created by 'GetSensorData'\n% ACCE;AppTimestamp(s);SensorTimestamp(s);Acc_X(m/s^2);...;Accuracy(integer)\n"
    lines = []
    for i, (w, a) in enumerate(zip(axes(GYRO, "FLU"), axes(ACCEL, "FLU"), strict=True)):
        stamp = decimals([BOOT + STEP * i])[0]
        for tag, values in (("ACCE", a), ("GYRO", w), ("MAGN", a)):
            lines.append(f"{tag};{i / 100 + 0.003:.3f};{stamp};{';'.join(map(repr, values.tolist()))};3")
    return File(head + "\n".join([*lines, ""]), "logfile.txt", BOOT + STEP * np.arange(N), "boot", frame="FLU")


def gnss_logger():
    lines = ["# Header Description:", "#", "# Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters", "# "]
    for i, (w, a) in enumerate(zip(axes(GYRO, "FLU"), axes(ACCEL, "FLU"), strict=True)):
        utc, boot = TIME[i] // 10**6, BOOT + STEP * i
        lines.append(f"UncalGyro,{utc},{boot},{cells(w)},0.0,0.0,0.0")
        lines.append(f"UncalAccel,{utc},{boot},{cells(a)},0.0,0.0,0.0")
        lines.append(f"Raw,{utc},1,2,3")
    text = "\n".join([*lines, ""])
    return File(text, "gnss_log.txt", BOOT + STEP * np.arange(N), "boot", frame="FLU")


def flysight():
    lines = ["$FLYS,1", "$VAR,FIRMWARE_VER,v2023", "$COL,BARO,time,pressure", "$UNIT,BARO,s,Pa"]
    lines += ["$COL,IMU,time,wx,wy,wz,ax,ay,az,temperature", "$UNIT,IMU,s,deg/s,deg/s,deg/s,g,g,g,deg C"]
    lines += ["$COL,TIME,time,tow,week", "$UNIT,TIME,s,s,", "$DATA"]
    week, tow = gps(TIME[:1])
    lines.append(f"$TIME,{decimals([BOOT])[0]},{decimals(tow)[0]},{week[0]}")
    for i, (w, a) in enumerate(zip(GYRO / DEG, ACCEL / G, strict=True)):
        lines += [f"$IMU,{decimals([BOOT + STEP * i])[0]},{cells(w)},{cells(a)},31.5", f"$BARO,{i},101300"]
    return File("\n".join([*lines, ""]), "SENSOR.CSV")


def _raw_imu(device, gyro_scale, accel_scale, long=False):
    """Increments, or rates, in counts: z, -y, x of axes right, forward, up; accelerations first."""
    week, tow = gps(TIME)
    rate, force = axes(GYRO, "RFU") / gyro_scale, axes(ACCEL, "RFU") / accel_scale
    lines = []
    for i, (w, a) in enumerate(zip(rate, force, strict=True)):
        counts = [a[2], -a[1], a[0], w[2], -w[1], w[0]]
        stamp = decimals([tow[i]])[0]
        body = f"04,{device},{week[i]},{stamp},ea59fe00," + ",".join(f"{x:.0f}" for x in counts)
        short = f"RAWIMUSXA,{week[i]},{stamp[:-6]}"
        full = f"RAWIMUXA,COM1,0,68.5,FINESTEERING,{week[i]},{stamp[:-6]},024c0040,6125,30019"
        lines.append(novatel(*(("#", full) if long else ("%", short)), body))
    return File("\r\n".join([*lines, ""]), "log.gps", frame="RFU", resolution=max(gyro_scale, accel_scale))


def raw_imu_increments():
    """ADIS16488: 720/2^31 deg and 200/2^31 m/s."""
    return _raw_imu(DEVICE_ADIS, 720 / 2**31 * DEG * 100, 200 / 2**31 * 100)


def raw_imu_rates():
    """Epson G320: 0.008/2^16 deg/s and 0.2/2^16 mg."""
    return _raw_imu(DEVICE_EPSON, 0.008 / 2**16 * DEG, 0.2 / 2**16 * G / 1000, long=True)


SENTENCES = (vn_imu, vn_ymr_stamped, vn_qmr, get_sensor_data, gnss_logger, flysight, raw_imu_increments, raw_imu_rates)


def best_pos():
    week, tow = gps(FIX_TIME)
    lines = []
    for i, stamp in enumerate(decimals(tow)):
        head = f"BESTPOSA,COM1,0,78.0,FINESTEERING,{week[i]},{stamp[:-6]},02000040,6145,2724"
        place = f"{float(LATITUDE[i])!r},{float(LONGITUDE[i])!r},{HEIGHT[i] - UNDULATION:.4f},{UNDULATION},WGS84"
        rest = '0.01,0.02,0.05,"",0.000,0.000,19,19,19,19,00,06,00,33'
        lines.append(novatel("#", head, f"SOL_COMPUTED,NARROW_INT,{place},{rest}"))
    lines.append(novatel("#", head, f"INSUFFICIENT_OBS,NONE,0,0,0,0,WGS84,{rest}"))
    return File("\r\n".join([*lines, ""]), "log.gps", sensors="sigma")


def fix_of_gnss_logger():
    speed, course = np.hypot(*VELOCITY[:, :2].T), np.degrees(np.arctan2(VELOCITY[:, 1], VELOCITY[:, 0])) % 360
    lines = ["# Fix,Provider,LatitudeDegrees,..."]
    for i, boot in enumerate(BOOT + FIX_TIME - START):
        place = f"{float(LATITUDE[i])!r},{float(LONGITUDE[i])!r},{float(HEIGHT[i])!r},{float(speed[i])!r},3.0,{float(course[i])!r}"
        lines += [f"Fix,{provider},{place},{FIX_TIME[i] // 10**6},0.2,1.0,{boot},4.0" for provider in ("GPS", "NLP")]
    return File(
        "\n".join([*lines, ""]), "gnss_log.txt", BOOT + FIX_TIME - START, "boot", sensors="level_velocity sigma"
    )


RECEIVERS_OF_SENTENCES = (best_pos, fix_of_gnss_logger)


def ins_pva(extended=False):
    week, tow = gps(FIX_TIME)
    lines = []
    for i, stamp in enumerate(decimals(tow)):
        velocity = f"{float(VELOCITY[i, 0])!r},{float(VELOCITY[i, 1])!r},{float(-VELOCITY[i, 2])!r}"
        place = f"{float(LATITUDE[i])!r},{float(LONGITUDE[i])!r}"
        if extended:
            body = f"INS_SOLUTION_GOOD,INS_RTKFIXED,{place},{HEIGHT[i] - UNDULATION:.4f},{UNDULATION},{velocity},1.0,-2.0,30.0"
            body += "," + ",".join(["0.1"] * 9) + ",00000000,0"
            head = f"INSPVAXA,COM1,0,73.5,FINESTEERING,{week[i]},{stamp[:-6]},02000040,4e77,43562"
            lines.append(novatel("#", head, body))
        else:
            body = f"{week[i]},{stamp},{place},{float(HEIGHT[i])!r},{velocity},1.0,-2.0,30.0,INS_SOLUTION_GOOD"
            lines.append(novatel("%", f"INSPVASA,{week[i]},{stamp[:-6]}", body))
    return File("\r\n".join([*lines, ""]), "log.gps")


def ins_pvax():
    return ins_pva(extended=True)


REFERENCES = (ins_pva, ins_pvax)

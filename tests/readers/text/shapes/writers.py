"""A small writer for each shape of text logs; each makes its file of the record in ``truth``."""

import numpy as np

from tests.readers.text.shapes.truth import (
    ACCEL,
    DEG,
    GYRO,
    START,
    STEP,
    TIME,
    File,
    G,
    N,
    axes,
    decimals,
    gps,
    table,
)  # fmt: skip

BOOT = 5_000_000_000  # ns from power-up to the first sample
ZEROS = np.zeros((N, 9), dtype=int)


def euroc():
    names = [f"{s}_RS_S_{a} [{u}]" for s, u in (("w", "rad s^-1"), ("a", "m s^-2")) for a in "xyz"]
    return File(table("#timestamp [ns]," + ",".join(names), TIME, GYRO, ACCEL), "data.csv")


def kalibr():
    names = ",".join(f"{s}_{a}" for s in ("omega", "alpha") for a in "xyz")
    return File(table(f"timestamp,{names}", TIME, GYRO, ACCEL), "imu0.csv")


def rostopic():
    parts = [f"orientation.{a}" for a in "xyzw"] + [f"orientation_covariance{i}" for i in range(9)]
    for field in ("angular_velocity", "linear_acceleration"):
        parts += [f"{field}.{a}" for a in "xyz"] + [f"{field}_covariance{i}" for i in range(9)]
    head = ",".join(f"field.{part}" for part in ("header.seq", "header.stamp", "header.frame_id", *parts))
    rate, force = axes(GYRO, "FLU"), axes(ACCEL, "FLU")
    arrival = TIME + 7_000_000 + 1000 * np.arange(N) % 3_000_000
    text = table(
        f"%time,{head}",
        arrival,
        np.arange(N),
        TIME,
        ["imu_link"] * N,
        np.tile([0, 0, 0, 1], (N, 1)),
        ZEROS,
        rate,
        ZEROS,
        force,
        ZEROS,
    )
    return File(text, frame="FLU")


def ros_dotted():
    names = [f"{f}.{a}" for f in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    head = ",".join(["time", *(f"imu.{name}" for name in names)])
    return File(table(head, decimals(TIME), axes(GYRO, "FLU"), axes(ACCEL, "FLU")), frame="FLU")


def ros_flat():
    names = [f"orientation_{a}" for a in "xyzw"]
    names += [f"{f}_{a}" for f in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    columns = np.tile([0, 0, 0, 1], (N, 1)), axes(GYRO, "FLU"), axes(ACCEL, "FLU")
    return File(table("timestamp," + ",".join(names), TIME, *columns), frame="FLU")


def ros2_echo():
    """Without a header, and with the name of the frame."""
    rate, force = axes(GYRO, "FLU"), axes(ACCEL, "FLU")
    stamp = TIME // 10**9, TIME % 10**9
    text = table("", *stamp, ["imu_link"] * N, np.tile([0, 0, 0, 1], (N, 1)), ZEROS, rate, ZEROS, force, ZEROS)
    return File(text, frame="FLU")


def mcap_cat():
    names = ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"]
    names += [f"{f}.{a}" for f in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    logged = [f"{np.datetime64(t + 4_000_000, 'ns')}Z" for t in TIME.tolist()]
    columns = (
        logged,
        logged,
        np.arange(N),
        TIME // 10**9,
        TIME % 10**9,
        ["imu"] * N,
        axes(GYRO, "FLU"),
        axes(ACCEL, "FLU"),
    )
    return File(table("log_time,publish_time,sequence," + ",".join(names), *columns), frame="FLU")


def tex_cup():
    week, tow = gps(TIME)
    text = table("", week, tow // 10**9, tow % 10**9 / 1e9, ACCEL, GYRO / DEG)
    return File(text, "lord.log")


def matlab():
    """Variables of three columns, as writetable parts them."""
    names = [f"{name}_{i}" for name in ("accel_m_s2", "gyro_rad_s") for i in (1, 2, 3)]
    return File(
        table("t_s," + ",".join(names), decimals(STEP * np.arange(N)), ACCEL, GYRO),
        time=STEP * np.arange(N),
        epoch="log",
    )


def plotjuggler():
    """Rows of an IMU's topic, and rows of another one between them."""
    names = [f"/imu/data/{f}/{a}" for f in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    values = np.hstack([axes(GYRO, "FLU"), axes(ACCEL, "FLU")]).tolist()
    rows = []
    for stamp, row in zip(TIME.tolist(), values, strict=True):
        rows += [f"{decimals([stamp])[0]},{','.join(map(repr, row))},", f"{decimals([stamp + 3_000_000])[0]},,,,,,,1.5"]
    return File("\n".join(["__time," + ",".join(names) + ",/battery/voltage", *rows, ""]), frame="FLU")


def two_imus():
    names = [f"/imu_{i}/{f}/{a}" for i in "ab" for f in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    rate, force = axes(GYRO, "FLU"), axes(ACCEL, "FLU")
    text = table("time," + ",".join(names), decimals(TIME), rate, force, rate, force)
    return File(text, frame="FLU", streams=("/imu_a", "/imu_b"))


def ppc():
    week, tow = gps(TIME)
    head = "GPS TOW (s), GPS Week, Acc X (m/s^2), Acc Y (m/s^2), Acc Z (m/s^2), Ang Rate X (deg/s),  Ang Rate Y (deg/s),  Ang Rate Z (deg/s)"
    columns = decimals(tow), week, axes(ACCEL, "FLU"), axes(GYRO, "FLU") / DEG
    return File(table(head, *columns), "imu.csv", frame="FLU")


def ppc_as_documented():
    week, tow = gps(TIME)
    head = "GPS TOW (s), GPS Week, Acc X (m/s^2), Acc Y (m/s^2), Acc Z (m/s^2), Ang Rate X (deg/s),  Ang Rate Y (deg/s),  Ang Rate Z (deg/s)"
    return File(table(head, decimals(tow), week, ACCEL, GYRO / DEG), "imu.csv", frame="FRD")


def urban_nav():
    week, tow = gps(TIME)
    head = "GPS TOW (s), GPS Week, Acceleration X (m/s^2), Acceleration Y (m/s^2), Acceleration Z (m/s^2), "
    head += "Angular rate X (rad/s), Angular rate Y (rad/s), Angular rate Z (rad/s), Wheel velocity (m/s)"
    columns = decimals(tow), week, axes(ACCEL, "FLU"), axes(GYRO, "FLU"), np.full(N, 7.5)
    return File(table(head, *columns), "imu.csv", frame="FLU")


def kf_gins(odometer=False):
    """Increments over the step before each stamp, time of week without a week."""
    _, tow = gps(TIME)
    step = STEP / 1e9
    more = [np.full(N, 7.5)] if odometer else []
    text = table("", decimals(tow), GYRO * step, ACCEL * step, *more, mark=" ")
    return File(text, "ADIS16465.txt", time=tow, epoch="log", frame="FRD")


def kf_gins_odometer():
    return kf_gins(odometer=True)


def nclt():
    text = table("", TIME // 1000, np.tile([0.2, -0.1, 0.4], (N, 1)), ACCEL, GYRO)
    return File(text, "ms25.csv")


def picoquake():
    head = "# device_id: D00F0150\n# acc_range: 16 g\n# gyro_range: 2000 dps\n# data_rate: 100 Hz\n"
    text = head + table("count,a_x,a_y,a_z,g_x,g_y,g_z", np.arange(N), ACCEL / G, GYRO / DEG)
    return File(text, time=STEP * np.arange(N), epoch="log")


def sensor_combined():
    names = [*(f"gyro_rad[{i}]" for i in range(3)), "gyro_integral_dt", "accelerometer_timestamp_relative"]
    names += [*(f"accelerometer_m_s2[{i}]" for i in range(3)), "accelerometer_integral_dt"]
    boot = BOOT + STEP * np.arange(N)
    columns = boot // 1000, GYRO, np.full(N, 5000), np.zeros(N, int), ACCEL, np.full(N, 5000)
    return File(table("timestamp," + ",".join(names), *columns), "log_sensor_combined_0.csv", boot, "boot", frame="FRD")


def _px4(topic, values, sensors):
    boot = BOOT + STEP * np.arange(N)
    columns = boot // 1000 + 300, boot // 1000, np.full(N, 131074), values, np.full(N, 41.5), np.zeros(N, int)
    text = table("timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count", *columns)
    return File(text, f"log_{topic}_0.csv", boot, "boot", sensors=sensors, frame="FRD")


def sensor_gyro():
    return _px4("sensor_gyro", GYRO, "gyro")


def sensor_accel():
    return _px4("sensor_accel", ACCEL, "accel")


def mavlogdump():
    """Three IMUs with equal stamps."""
    rows = []
    for i in range(N):
        values = ",".join(map(repr, [*GYRO[i].tolist(), *ACCEL[i].tolist()]))
        stamp = f"{TIME[i] / 1e9:.8f}"
        rows += [f"{stamp},{(BOOT + STEP * i) // 1000},{k},{values},0,0,45.{k},1,1,100,100" for k in range(3)]
    head = "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"
    return File("\n".join([head, *rows, ""]), frame="FRD", streams=("imu0", "imu1", "imu2"))


def betaflight():
    """With the units that blackbox_decode writes on request."""
    boot = BOOT + STEP * np.arange(N)
    head = "loopIteration, time (us), gyroADC[0] (deg/s), gyroADC[1] (deg/s), gyroADC[2] (deg/s)"
    head += ", accSmooth[0] (g), accSmooth[1] (g), accSmooth[2] (g)"
    columns = np.arange(N), boot // 1000, GYRO / DEG, ACCEL / G
    return File(table(head, *columns, mark=", "), time=boot, epoch="boot")


def _sensor_logger(name, values, sensors):
    text = table("time,seconds_elapsed,z,y,x", TIME, (TIME - START) / 1e9, axes(values, "FLU")[:, ::-1])
    return File(text, name, sensors=sensors, frame="FLU")


def sensor_logger_gyro():
    return _sensor_logger("Gyroscope.csv", GYRO, "gyro")


def sensor_logger_accel():
    return _sensor_logger("TotalAcceleration.csv", ACCEL, "accel")


def phyphox_gyro():
    head = '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"'
    rate = axes(GYRO, "FLU")
    columns = (f"{x:.15E}" for x in STEP * np.arange(N) / 1e9), rate, np.linalg.norm(rate, axis=1)
    text = table(head, list(columns[0]), *columns[1:])
    return File(text, "Gyroscope.csv", STEP * np.arange(N), "log", sensors="gyro", frame="FLU")


def phyphox_accel():
    head = '"Time (s)","Acceleration x (m/s^2)","Acceleration y (m/s^2)","Acceleration z (m/s^2)","Absolute acceleration (m/s^2)"'
    force = axes(ACCEL, "FLU")
    text = table(head, decimals(STEP * np.arange(N)), force, np.linalg.norm(force, axis=1), mark="\t")
    return File(text, "Accelerometer.csv", STEP * np.arange(N), "log", sensors="accel", frame="FLU")


def physics_toolbox():
    force = axes(ACCEL, "FLU") / G
    text = table("time,gFx,gFy,gFz,TgF", decimals(STEP * np.arange(N)), force, np.linalg.norm(force, axis=1), mark=";")
    return File(text, time=STEP * np.arange(N), epoch="log", sensors="accel", frame="FLU")


def androsensor():
    names = [f"{s} {a} ({u})" for s, u in (("ACCELEROMETER", "m/s²"), ("GRAVITY", "m/s²"), ("LINEAR ACCELERATION", "m/s²"), ("GYROSCOPE", "rad/s")) for a in "XYZ"]  # fmt: skip
    head = "sep=;\n" + ";".join([*names, "Time since start in ms ", "YYYY-MO-DD HH-MI-SS_SSS"])
    stamps = [f"2023-11-14 22:13:{20 + i // 100:02d}:{i % 100 * 10:03d}" for i in range(N)]
    force = axes(ACCEL, "FLU")
    columns = force, np.tile([0, 0, 9.8], (N, 1)), force - [0, 0, 9.8], axes(GYRO, "FLU"), 10 * np.arange(N), stamps
    return File(table(head, *columns, mark=";"), time=STEP * np.arange(N), epoch="log", frame="FLU")


def sensor_log():
    """Accelerations with the signs of iOS."""
    names = ["loggingTime(txt)", "accelerometerTimestamp_sinceReboot(s)"]
    names += [f"{s}{a}({u})" for s, u in (("accelerometerAcceleration", "G"), ("motionUserAcceleration", "G"), ("motionRotationRate", "rad/s"), ("gyroRotation", "rad/s")) for a in "XYZ"]  # fmt: skip
    boot = BOOT + STEP * np.arange(N)
    texts = [f"{np.datetime64(t, 'ms')}".replace("T", " ") + " +0000" for t in (TIME // 10**6).tolist()]
    force, rate = -axes(ACCEL, "FLU") / G, axes(GYRO, "FLU")
    text = table(",".join(names), texts, decimals(boot), force, force, rate + 0.01, rate)
    return File(text, time=boot, epoch="boot", frame="FLU")


def wit_motion():
    names = ["time", "DeviceName"] + [
        f"{s}{a}({u})" for s, u in (("Acc", "g"), ("As", "°/s"), ("Angle", "°")) for a in "XYZ"
    ]
    stamps = [f"{np.datetime64(t, 'ms')}" for t in (TIME // 10**6).tolist()]
    text = table("\t".join(names), stamps, ["WT901(00:11:22:33)"] * N, ACCEL / G, GYRO / DEG, ZEROS[:, :3], mark="\t")
    return File(text, "data.txt")


def vectornav():
    week, tow = gps(TIME)
    names = ["GpsCycle", "GpsWeek", "GpsTow", "TimeStartup"]
    names += [f"Uncomp{s}.{a}" for s in ("Mag", "Accel", "Gyro") for a in "XYZ"]
    boot = BOOT + STEP * np.arange(N)
    text = table(
        ",".join([*names, "Temperature"]), week // 1024, week, tow, boot, ZEROS[:, :3], ACCEL, GYRO, np.full(N, 25.5)
    )
    return File(text, time=boot, epoch="boot")


def vectornav_gps_time():
    week, tow = gps(TIME)
    names = ["GpsWeek", "GpsTow", *(f"Uncomp{s}.{a}" for s in ("Accel", "Gyro") for a in "XYZ")]
    return File(table(",".join(names), week, tow, ACCEL, GYRO))


def vectornav_compensated():
    boot = BOOT + STEP * np.arange(N)
    names = ["TimeStartup", *(f"{s}.{a}" for s in ("Accel", "AngularRate") for a in "XYZ")]
    return File(table(",".join(names), boot, ACCEL, GYRO), time=boot, epoch="boot")


def vehicle_imu():
    """Increments over a step that the file states; the stamps jitter."""
    boot = BOOT + STEP * np.arange(N)
    names = ["timestamp", "timestamp_sample", "accel_device_id", "gyro_device_id"]
    names += [f"{s}[{i}]" for s in ("delta_angle", "delta_velocity") for i in range(3)]
    names += ["delta_angle_dt", "delta_velocity_dt", "delta_velocity_clipping"]
    step = np.where(np.arange(N) % 2, 5000, 4000)
    columns = (
        boot // 1000 + 200,
        boot // 1000,
        np.full(N, 1),
        np.full(N, 2),
        GYRO * step[:, None] / 1e6,
        ACCEL * step[:, None] / 1e6,
    )
    return File(table(",".join(names), *columns, step, step, np.zeros(N, int)), time=boot, epoch="boot", frame="FRD")


def xsens():
    """The time column is empty; the counter wraps once."""
    head = "// Start Time: Unknown\n// Update Rate: 100.0Hz\n// Filter Profile: human (46.1)\n// Option Flags: AHS Disabled\n"
    head += "\t".join(
        ["PacketCounter", "SampleTimeFine", *(f"{s}_{a}" for s in ("Acc", "FreeAcc", "Gyr") for a in "XYZ")]
    )
    force = axes(ACCEL, "FLU")
    counter = 1000 + np.arange(N)
    text = table(head, counter, [""] * N, force, force - [0, 0, 9.8], axes(GYRO, "FLU"), mark="\t")
    return File(text, "MT_0000-000.txt", counter * STEP, "log", frame="FLU")


def sbg():
    head = "timestamp\tstatus\taccelX\taccelY\taccelZ\tgyroX\tgyroY\tgyroZ\ttemperature\n"
    head += "(us)\t(na)\t(m.s^-2)\t(m.s^-2)\t(m.s^-2)\t(deg.s^-1)\t(deg.s^-1)\t(deg.s^-1)\t(degC)"
    boot = BOOT + STEP * np.arange(N)
    text = table(head, boot // 1000, np.full(N, 63), ACCEL, GYRO / DEG, np.full(N, 31.25), mark="\t")
    return File(text, "imuData.txt", boot, "boot", frame="FRD")


def microstrain():
    week, tow = gps(TIME)
    head = "FILE_INFO\nListSeparator=,\nDecimalSeparator=.\n\nSESSION_INFO\nTimestampUTC=1700000000\n\nDEVICE_INFO\nModel=3DM-GX5\n\nDATA_START\n"
    names = [f"{a} {s} [{d}]" for s, d in (("Accel", "x8004"), ("Gyro", "x8005")) for a in "XYZ"]
    text = table(
        head + ",".join(["GPS TFlags", "GPS Week", "GPS TOW", *names]),
        np.full(N, 7),
        week,
        decimals(tow),
        ACCEL / G,
        GYRO,
    )
    return File(text, frame="FRD")


def pimu():
    boot, step = BOOT + STEP * np.arange(N), STEP / 1e9
    head = ",".join(["_ID_", "time", *(f"{s}[{i}]" for s in ("theta", "vel") for i in range(3)), "dt", "status"])
    text = table(head, ["DID_PIMU"] * N, decimals(boot), GYRO * step, ACCEL * step, np.full(N, step), ZEROS[:, 0])
    return File(text, "LOG_SN1_PIMU.csv", boot, "boot", frame="FRD")


def openimu():
    head = "timeCntr (msec),time (s),xAccel (m/s^2),yAccel (m/s^2),zAccel (m/s^2),xRate (deg/s),yRate (deg/s),zRate (deg/s),temp (degC)"
    boot = BOOT + STEP * np.arange(N)
    text = table(head, boot // 10**6, decimals(boot), ACCEL, GYRO / DEG, np.full(N, 30.5))
    return File(text, "s1.csv", boot, "boot")


def x_imu3():
    head = "Time (s),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),Accelerometer X (g),Accelerometer Y (g),Accelerometer Z (g)"
    return File(
        table(head, decimals(STEP * np.arange(N)), GYRO / DEG, ACCEL / G), time=STEP * np.arange(N), epoch="log"
    )


WRITERS = (
    euroc, kalibr, rostopic, ros_dotted, ros_flat, ros2_echo, mcap_cat, tex_cup, matlab, plotjuggler, two_imus, ppc, ppc_as_documented, urban_nav, kf_gins, kf_gins_odometer,
    nclt, picoquake, sensor_combined, sensor_gyro, sensor_accel, mavlogdump, betaflight, sensor_logger_gyro, sensor_logger_accel,
    phyphox_gyro, phyphox_accel, physics_toolbox, androsensor, sensor_log, wit_motion, vectornav, vectornav_gps_time, vectornav_compensated, vehicle_imu, xsens, sbg, microstrain, pimu, openimu, x_imu3,
)  # fmt: skip

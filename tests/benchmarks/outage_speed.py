"""Measure an outage replay end to end against KF-GINS (C++), and the filter alone, on the same drive.

The drive: 56 minutes at 200 Hz, as long as the one that KF-GINS comes with, RTK fixes at 1 Hz with sigmas of 1 and 2 cm, a 3DM-GX3-25. KF-GINS gets the increments and the fixes
in its own text files, and imuwb gets them as CSV and RTKLIB-like CSV. Timed, as whole processes, in turns: ``KF-GINS conf.yaml`` (reading,
filter, writing of its trajectory), and ``imuwb outage`` with one filter, one outage of 60 s, judged against the filter's own run without
it, and a recording. "The filter alone" is
one run of the filter ``full`` with 15 and with 21 and more states over the prepared log. CPU seconds of all threads.

The program of KF-GINS is built from its own source with ``cmake -DCMAKE_BUILD_TYPE=Release``:

    python tests/benchmarks/outage_speed.py path/to/KF-GINS
"""

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from measure import cpu, versions

from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.log import SECOND
from imuwb.navigation import FilterModel, Installation
from imuwb.replay import model_named, prepare, run
from imuwb.simulation import Receiver, drive, mixed_route, preset
from imuwb.writers import write

SECONDS, RATE, RUNS = 3360.0, 200.0, 3  # as long as the drive that KF-GINS comes with
GNSS_TIME = 456_300.0  #: s of the GPS week at the log's start
CONFIGURATION = """imupath: "{folder}/imu.txt"
gnsspath: "{folder}/gnss.txt"
outputpath: "{folder}"
imudatalen: 7
imudatarate: 200
starttime: {start}
endtime: -1
initpos: [{position}]
initvel: [{velocity}]
initatt: [{attitude}]
initgyrbias: [0, 0, 0]
initaccbias: [0, 0, 0]
initgyrscale: [0, 0, 0]
initaccscale: [0, 0, 0]
initposstd: [0.01, 0.01, 0.02]
initvelstd: [0.1, 0.1, 0.1]
initattstd: [0.5, 0.5, 1.0]
imunoise:
  arw: [2.2, 2.2, 2.2]
  vrw: [0.045, 0.045, 0.045]
  gbstd: [32, 32, 32]
  abstd: [150, 150, 150]
  gsstd: [1000, 1000, 1000]
  asstd: [1000, 1000, 1000]
  corrtime: 1.0
antlever: [0, 0, 0]
"""


def made():
    """Return the drive."""
    receiver = Receiver(rate=1.0, position_sigma=(0.01, 0.01, 0.02), velocity_sigma=(0.02, 0.02, 0.03))
    return drive(preset("3dm-gx3-25"), mixed_route(SECONDS, 1), 1, rate=RATE, receiver=receiver)


def for_kf_gins(log, folder):
    """Write the drive in the files of KF-GINS; it starts where the vehicle moves."""
    imu, gnss, truth = log.imus[0], log.gnss[0], log.references[0]
    zero = log.zero
    time = (imu.angular_rate.time - zero) / SECOND + GNSS_TIME
    increments = np.hstack([imu.angular_rate.value, imu.specific_force.value]) / RATE
    np.savetxt(folder / "imu.txt", np.column_stack([time, increments]), fmt="%.9f" + " %.12f" * 6)
    fixes = (gnss.time - zero) / SECOND + GNSS_TIME
    degrees = np.degrees(gnss.position[:, :2])
    rows = np.column_stack([fixes, degrees, gnss.position[:, 2], gnss.position_sigma])
    np.savetxt(folder / "gnss.txt", rows, fmt="%.3f %.10f %.10f %.4f %.3f %.3f %.3f")
    first = int(np.argmax(np.hypot(truth.velocity[:, 0], truth.velocity[:, 1]) > 5))
    euler = truth.attitude[first] if truth.attitude.shape[1] == 3 else euler_of_quaternion(truth.attitude[first])

    def text(values):
        return ", ".join(f"{v:.9f}" for v in values)

    position = [*np.degrees(truth.position[first, :2]), truth.position[first, 2]]
    (folder / "conf.yaml").write_text(
        CONFIGURATION.format(
            folder=folder, start=(truth.time[first] - zero) / SECOND + GNSS_TIME, position=text(position),
            velocity=text(truth.velocity[first]), attitude=text(np.degrees(euler)),
        ),
        "utf-8",
    )  # fmt: skip


def spent(command):
    """Return the CPU time of a process, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{command[0]} ended with {done.returncode}: {done.stderr[-500:] or done.stdout[-500:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description="Time outage replays against KF-GINS.")
    parser.add_argument("program", type=Path, help="The program KF-GINS.")
    program = parser.parse_args().program
    log = made()
    model = preset("3dm-gx3-25")
    base = FilterModel("base", model, installation=Installation())
    prepared = prepare(log, base)
    filters = {name: model_named(name, base, interval=prepared.measurement.interval) for name in ("15AV", "full")}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for_kf_gins(log, folder)
        write(log, folder / "drive.csv")
        (folder / "m.toml").write_text(model.to_toml(), "utf-8")
        at = f"{SECONDS / 2:g}:60"
        ours = [
            Path(sys.executable).with_name("imuwb"), "outage", folder / "drive.csv", "--gnss", folder / "drive.gnss.csv", "--error-model", folder / "m.toml", "--models",
            "15AV", "--reference", "own", "--at", at, "--mounting", "0,0,0", "--gnss-delay", "0", "--clock-rate", "1", "-o", folder / "drive.rrd", "--force",
        ]  # fmt: skip
        theirs = [program, folder / "conf.yaml"]
        spent(ours), spent(theirs)
        pairs = [(spent(ours), spent(theirs)) for _ in range(RUNS)]
    end_to_end, peer = (min(pair[i] for pair in pairs) for i in (0, 1))
    print(versions("imuwb", "numpy", "numba"))
    print(f"{SECONDS:g} s at {RATE:g} Hz, RTK at 1 Hz; KF-GINS {peer:.2f} s CPU")
    print(f"| imuwb outage, end to end | {end_to_end:.2f} s | {peer / end_to_end:.1f} times |")
    for name, model in filters.items():
        states = len(model.states(prepared.measurement.interval))
        alone = cpu(lambda model=model: run(model, prepared), RUNS)
        print(f"| filter {name}, {states} states, alone | {alone:.3f} s | {peer / alone:.1f} times |")


if __name__ == "__main__":
    main()

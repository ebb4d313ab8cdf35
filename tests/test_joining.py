"""A receiver's file beside an IMU's, and one IMU of the parts of two."""

import re
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.joining import joined, shifted
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Repair, Scalars, Triad
from imuwb.notes import ids
from imuwb.selection import select

TIME = np.arange(10) * SECOND


def imu_of(name="/imu", epoch="unix", size=1.0, gyro=True, accel=True):
    gyros, accels = Triad(TIME, np.full((10, 3), size)), Triad(TIME[::2], np.full((5, 3), -size))
    return ImuStream(name, gyros if gyro else None, accels if accel else None, origin=Origin(epoch=epoch))


def log_of(*imus, name="imu.csv", **given):
    return Log(Provenance(name, "csv", f"sha256:{name}", 0), imus, **given)


def receiver(epoch="unix", start=0):
    position = np.tile([0.8, 0.2, 100.0], (10, 1))
    time = start + TIME
    return log_of(
        name="fixes.pos", notes=("GPS time converted to UTC",), gnss=(GnssStream("gnss", time, position, origin=Origin(epoch=epoch)),),
        references=(Reference("truth", time, position, origin=Origin(epoch=epoch)),),
        speeds=(Scalars("wheel", time, np.ones(10)),),
    )  # fmt: skip


def test_streams_of_both_are_there():
    own = GnssStream("own", TIME, np.tile([0.8, 0.2, 100.0], (10, 1)), origin=Origin(epoch="unix"))
    log = joined(log_of(imu_of(), gnss=(own,)), receiver())
    assert [g.name for g in log.gnss] == ["own", "gnss"]
    assert [r.name for r in log.references] == ["truth"]
    assert [s.name for s in log.speeds] == ["wheel"]
    assert [i.name for i in log.imus] == ["/imu"]
    assert log.provenance.path == "imu.csv"


def test_a_note_names_the_file_and_its_notes_are_kept():
    log = joined(log_of(imu_of(), notes=("own note",)), receiver())
    assert log.notes[0] == "own note"
    assert "fixes.pos (sha256:fixes.pos)" in log.notes[1]
    assert log.notes[2:] == ("GPS time converted to UTC",)


@pytest.mark.parametrize(("imu", "other"), [("log", "unix"), ("boot", "unix"), ("unix", "log")])
def test_different_clocks_are_noted(imu, other):
    log = joined(log_of(imu_of(epoch=imu)), receiver(other))
    (note,) = (n for n in log.notes if getattr(n, "id", "") == "clocks_differ")
    assert re.search(f"{other} time.* IMU .*{imu} time", note)


def test_the_same_clock_is_not():
    assert "clocks_differ" not in ids(joined(log_of(imu_of()), receiver()).notes)


def test_the_log_still_begins_where_the_imu_did():
    log = joined(log_of(imu_of()), receiver(start=-5 * SECOND))
    assert log.zero == 0
    assert log.seconds(log.gnss[0].time)[0] == -5


def test_an_imu_of_the_gyro_of_one_and_the_accelerometer_of_another():
    log = log_of(imu_of("/a", size=1.0), imu_of("/b", size=2.0))
    (imu,) = select(log, "/a+/b").imus
    assert imu.name == "/a+/b"
    assert (imu.angular_rate.value[0, 0], imu.specific_force.value[0, 0]) == (1, -2)
    (imu,) = select(log, "/b+/a").imus
    assert (imu.angular_rate.value[0, 0], imu.specific_force.value[0, 0]) == (2, -1)


@pytest.mark.parametrize("name", ["gyro.1+accel.1", "accel.1+gyro.1"])
def test_a_gyro_and_an_accelerometer_are_composed_in_either_order(name):
    log = log_of(imu_of("gyro.1", size=1.0, accel=False), imu_of("accel.1", size=2.0, gyro=False), imu_of("/c"))
    (imu,) = select(log, name).imus
    assert imu.name == name
    assert (imu.angular_rate.value[0, 0], imu.specific_force.value[0, 0]) == (1, -2)


def test_parts_of_a_composed_imu_can_be_composed_anew():
    log = log_of(imu_of("gyro.0+accel.0", size=1.0), imu_of("gyro.1+accel.1", size=2.0))
    (imu,) = select(log, "gyro.0+accel.1").imus
    assert (imu.angular_rate.value[0, 0], imu.specific_force.value[0, 0]) == (1, -2)


def test_a_composed_imu_takes_the_temperature_of_its_accelerometer_or_its_gyro():
    warm, cold = (Scalars("t", TIME, np.full(10, c)) for c in (40.0, 10.0))
    a, b = replace(imu_of("/a"), temperature=warm), replace(imu_of("/b"), temperature=cold)
    assert select(log_of(a, b), "/a+/b").imus[0].temperature is cold
    assert select(log_of(a, imu_of("/b")), "/a+/b").imus[0].temperature is warm


@pytest.mark.parametrize("name", ["/a+/c", "+", "/a+", "/a+/b+/c"])
def test_a_composition_of_what_is_not_there_lists_what_is(name):
    with pytest.raises(MissingDataError, match=r": /a, /b"):
        select(log_of(imu_of("/a"), imu_of("/b")), name)


def test_two_gyros_make_no_imu():
    with pytest.raises(MissingDataError, match="--imu "):
        select(log_of(imu_of("/a", accel=False), imu_of("/b", accel=False)), "/a+/b")


def test_what_was_mended_of_the_accelerometer_is_kept():
    mended = replace(imu_of("/b"), origin=Origin(epoch="unix", repairs=(Repair("rows left out", 3),)))
    (imu,) = select(log_of(imu_of("/a"), mended), "/a+/b").imus
    assert [r.count for r in imu.origin.repairs] == [3]


def test_a_file_without_a_receiver_is_refused():
    with pytest.raises(MissingDataError, match=r"imu\.csv: .*receiver.* /imu$"):
        joined(log_of(imu_of()), log_of(imu_of()))


@pytest.mark.parametrize(("start", "apart"), [(0, False), (9 * SECOND, False), (10 * SECOND, True), (-(10**12), True)])
def test_a_receiver_of_another_time_is_noted(start, apart):
    notes = joined(log_of(imu_of()), receiver(start=start)).notes
    assert ("no_overlap" in ids(notes)) == apart


def test_a_note_of_both_is_kept_once():
    log = joined(log_of(imu_of(), notes=("GPS time converted to UTC",)), receiver())
    assert log.notes.count("GPS time converted to UTC") == 1


@pytest.mark.parametrize("shift", [5 * SECOND, -7, "start"])
def test_the_clock_of_a_receivers_file_is_shifted(shift):
    log, other = log_of(imu_of(epoch="boot")), receiver(start=1_700_000_000 * SECOND)
    moved = shifted(other, shift, log)
    step = -1_700_000_000 * SECOND if shift == "start" else shift
    for before, after in ((other.gnss, moved.gnss), (other.references, moved.references), (other.speeds, moved.speeds)):
        assert (after[0].time - before[0].time).tolist() == [step] * 10
    assert ids(moved.notes[-1:]) == ("clock_shifted",)
    notes = ids(joined(log, moved).notes)
    assert "clocks_differ" not in notes
    assert ("no_overlap" in notes) == (shift != "start")


def test_the_receivers_of_the_log_itself_are_shifted_and_its_imu_is_not():
    own = GnssStream("own", 1000 * SECOND + TIME, np.tile([0.8, 0.2, 100.0], (10, 1)), origin=Origin(epoch="unix"))
    log = log_of(imu_of(), gnss=(own,))
    moved = shifted(log, "start", log)
    assert moved.gnss[0].time.tolist() == TIME.tolist()
    assert moved.imus[0].angular_rate.time.tolist() == TIME.tolist()


def test_without_a_receiver_or_an_imu_there_is_no_clock_to_shift():
    with pytest.raises(MissingDataError, match=r"imu\.csv: .* shifted"):
        shifted(log_of(imu_of()), SECOND, log_of(imu_of()))
    with pytest.raises(MissingDataError, match="shifted"):
        shifted(receiver(), SECOND, log_of())

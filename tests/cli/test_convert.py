"""``imuwb convert``: from any log to MCAP or CSV, whole or in part."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb import read
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Orientation, Origin, Provenance, Reference, Scalars, Triad
from imuwb.writers import write

ZERO = 1_714_564_800 * SECOND  # 2024-05-01T12:00:00Z


def log_of(names=("/imu",)):
    rng = np.random.default_rng(1)
    time = ZERO + np.arange(1000) * 10_000_000
    slow = time[::100] + 5
    position = np.stack([0.8 + 1e-6 * np.arange(10), np.full(10, -2.1), np.arange(10.0)], axis=1)
    origin = Origin(epoch="unix")
    imus = [
        ImuStream(name, Triad(time, rng.standard_normal((1000, 3))), Triad(time, rng.standard_normal((1000, 3)) - [0, 0, 9.8]),
                  Scalars(f"{name}/temperature", time[::100], np.arange(10.0)), origin)
        for name in names
    ]  # fmt: skip
    gnss = GnssStream("/fix", slow, position, np.ones((10, 3)), np.ones((10, 3)), None, np.full(10, 3), origin)
    truth = Reference("/truth", slow, position, None, np.full((10, 3), 0.1), origin)
    return Log(Provenance("", "", "", 0), tuple(imus), (gnss,), (Scalars("/wheel", slow, np.arange(10.0)),), (truth,))


@pytest.fixture
def single(tmp_path):
    write(log_of(), tmp_path / "run.mcap")
    return tmp_path / "run.mcap"


@pytest.fixture
def two(tmp_path):
    write(log_of(("/a", "/b")), tmp_path / "two.mcap")
    return tmp_path / "two.mcap"


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def test_mcap_becomes_csv_and_each_file_is_named(imuwb, single, tmp_path):
    done = imuwb("convert", single, "-o", "out.csv")
    assert done.code == 0, done.err
    tables = ["out.csv", "out.gnss.csv", "out.reference.csv", "out.speed.csv"]
    files = sorted([*tables, *(f"{name}.toml" for name in tables)])
    assert names(tmp_path) == [*files, "run.mcap"]
    wrote = " ".join(done.err.split()).partition(" Wrote ")[2]
    assert all(f"{name}, " in wrote for name in tables)
    assert wrote.endswith("each with its .toml")
    assert len(done.err.splitlines()) <= 15
    assert done.out == ""
    truth = read(single)
    (imu,) = read(tmp_path / "out.csv").imus
    for part in ("angular_rate", "specific_force", "temperature"):
        assert getattr(imu, part).time.tolist() == getattr(truth.imus[0], part).time.tolist()
        assert getattr(imu, part).value.tolist() == getattr(truth.imus[0], part).value.tolist()
    assert read(tmp_path / "out.gnss.csv").gnss[0].position.tolist() == truth.gnss[0].position.tolist()
    assert read(tmp_path / "out.speed.csv").speeds[0].value.tolist() == list(range(10))
    assert read(tmp_path / "out.reference.csv").references[0].attitude.tolist() == [[0.1] * 3] * 10


def test_csv_becomes_mcap_and_back_the_same_bytes(imuwb, single, tmp_path):
    assert imuwb("convert", single, "-o", "a.csv").code == 0
    assert imuwb("convert", "a.csv", "-o", "b.mcap").code == 0
    assert imuwb("convert", "b.mcap", "-o", "c.csv").code == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()


def test_csv_has_no_room_for_an_orientation_and_mcap_has(imuwb, tmp_path):
    log = log_of()
    time = log.imus[0].angular_rate.time
    turned = Orientation("/imu", time, np.tile([0.6, 0.0, 0.0, 0.8], (time.size, 1)))
    write(replace(log, orientations=(turned,)), tmp_path / "turned.mcap")
    done = imuwb("convert", "turned.mcap", "-o", "out.csv")
    assert done.code == 0
    assert "/imu: its orientation is not written" in " ".join(done.err.split())
    done = imuwb("convert", "turned.mcap", "-o", "again.mcap")
    assert "not written" not in done.err
    assert len(read(tmp_path / "again.mcap").orientations[0]) == time.size


def test_a_whole_log_goes_from_mcap_to_mcap(imuwb, two, tmp_path):
    assert imuwb("convert", two, "-o", "copy.mcap").code == 0
    found, truth = read(tmp_path / "copy.mcap"), read(two)
    assert [i.name for i in found.imus] == ["/a", "/b"]
    for kind in ("gnss", "speeds", "references"):
        assert [s.time.tolist() for s in getattr(found, kind)] == [s.time.tolist() for s in getattr(truth, kind)]


@pytest.mark.parametrize(("start", "end"), [("2", "5"), ("2024-05-01T12:00:02", "2024-05-01T12:00:05Z")])
def test_a_part_in_time_of_all_streams(imuwb, single, tmp_path, start, end):
    assert imuwb("convert", single, "-o", "part.mcap", "--start", start, "--end", end).code == 0
    part = read(tmp_path / "part.mcap")
    rate = part.imus[0].angular_rate.time - ZERO
    assert (rate[0], rate[-1], rate.size) == (2 * SECOND, 5 * SECOND - 10_000_000, 300)
    for stream in (part.gnss[0], part.speeds[0], part.references[0]):
        assert ((stream.time - ZERO) // SECOND).tolist() == [2, 3, 4]


def test_one_imu_of_several(imuwb, two, tmp_path):
    assert imuwb("convert", two, "-o", "b.csv", "--imu", "/b").code == 0
    found = read(tmp_path / "b.csv").imus[0].angular_rate.value
    assert found.tolist() == read(two).imus[1].angular_rate.value.tolist()


def test_a_gyro_and_an_accelerometer_of_two_imus(imuwb, two, tmp_path):
    assert imuwb("convert", two, "-o", "ab.csv", "--imu", "/a+/b").code == 0
    found, truth = read(tmp_path / "ab.csv").imus[0], read(two).imus
    assert found.angular_rate.value.tolist() == truth[0].angular_rate.value.tolist()
    assert found.specific_force.value.tolist() == truth[1].specific_force.value.tolist()


def test_an_unknown_imu_names_those_there_are(imuwb, two):
    done = imuwb("convert", two, "-o", "c.csv", "--imu", "/c")
    assert done.code == 3
    assert "/a, /b" in done.err


def test_several_imus_have_no_room_in_csv(imuwb, two, tmp_path):
    done = imuwb("convert", two, "-o", "out.csv")
    assert done.code == 3
    assert "/a, /b" in done.err
    assert "--imu" in done.err
    assert names(tmp_path) == ["two.mcap"]


@pytest.mark.parametrize("name", ["out.txt", "out", "out.rrd", "out.csv.gz"])
def test_another_suffix_is_refused(imuwb, single, tmp_path, name):
    done = imuwb("convert", single, "-o", name)
    assert done.code == 2
    assert ".mcap or .csv" in done.err
    assert names(tmp_path) == ["run.mcap"]


@pytest.mark.parametrize("there", ["out.csv", "out.csv.toml", "out.gnss.csv", "out.speed.csv", "out.reference.csv"])
def test_files_that_exist_are_kept_without_force(imuwb, single, tmp_path, there):
    (tmp_path / there).write_bytes(b"mine")
    done = imuwb("convert", single, "-o", "out.csv")
    assert done.code == 2
    assert there in done.err and "--force" in done.err  # noqa: PT018
    assert names(tmp_path) == [there, "run.mcap"]
    assert (tmp_path / there).read_bytes() == b"mine"
    assert imuwb("convert", single, "-o", "out.csv", "--force").code == 0
    assert (tmp_path / there).read_bytes() != b"mine"


@pytest.mark.parametrize("force", [[], ["--force"]])
def test_a_log_is_never_its_own_output(imuwb, single, force):
    before = single.read_bytes()
    done = imuwb("convert", single, "-o", single, *force)
    assert (done.code, "a different name" in done.err) == (2, True)
    assert single.read_bytes() == before


def test_a_sibling_may_not_be_the_log_either(imuwb, single, tmp_path):
    assert imuwb("convert", single, "-o", "out.csv").code == 0
    before = (tmp_path / "out.gnss.csv").read_bytes()
    write(Log(Provenance("", "", "", 0), log_of().imus, log_of().gnss), tmp_path / "both.mcap")
    (tmp_path / "x.gnss.csv").write_bytes((tmp_path / "both.mcap").read_bytes())  # bytes decide, not the suffix
    done = imuwb("convert", "x.gnss.csv", "-o", "x.csv", "--force")
    assert (done.code, "a different name" in done.err) == (2, True)
    assert (tmp_path / "out.gnss.csv").read_bytes() == before


@pytest.mark.parametrize("output", ["run.gnss.csv", "run.csv"])
def test_the_receiver_s_file_is_never_an_output(imuwb, single, tmp_path, output):
    assert imuwb("convert", single, "-o", "run.csv").code == 0
    (tmp_path / "imu.csv").write_bytes((tmp_path / "run.csv").read_bytes())
    before = (tmp_path / "run.gnss.csv").read_bytes()
    done = imuwb("convert", "imu.csv", "--gnss", "run.gnss.csv", "-o", output, "--force")
    assert (done.code, "a different name" in done.err) == (2, True)
    assert (tmp_path / "run.gnss.csv").read_bytes() == before


def test_a_log_that_is_not_there_leaves_nothing(imuwb, tmp_path):
    assert imuwb("convert", "gone.mcap", "-o", "out.csv").code == 4
    assert names(tmp_path) == []


def test_repairs_that_the_new_log_contains_are_noted(imuwb, csv_log, rows):
    lines = rows()
    lines[100], lines[101] = lines[101], lines[100]
    lines[200] = lines[200].replace(lines[200].split(",")[2], "oops")
    done = imuwb("convert", csv_log(lines), "-o", "out.mcap")
    assert done.code == 0, done.err
    assert "imu: rows out of order sorted by time (1)" in done.err
    assert "imu: cells that are not numbers are taken as missing (1)" in done.err


def test_heights_above_mean_sea_level_are_noted_and_kept(imuwb, tmp_path):
    rows = "".join(f"{i},47,8,{400 + i}\n" for i in range(20))
    (tmp_path / "fixes.csv").write_text(f"time_s,latitude_deg,longitude_deg,height_msl_m\n{rows}", "utf-8")
    for source, output in (("fixes.csv", "a.mcap"), ("a.mcap", "b.csv"), ("b.csv", "c.mcap")):
        done = imuwb("convert", source, "-o", output)
        assert "above mean sea level" in done.err
    assert "height_msl_m" in (tmp_path / "b.csv").read_text("utf-8")
    assert read(tmp_path / "c.mcap").gnss[0].origin.above_sea
    assert "above mean sea level" in imuwb("info", "c.mcap", "--json").out


def test_a_log_without_a_stream_is_refused_with_the_reason(imuwb, tmp_path):
    (tmp_path / "log.csv").write_text("time_s,voltage,current\n" + "0.1,1,2\n0.2,1,3\n", "utf-8")
    for command in (("convert", "log.csv", "-o", "out.mcap"), ("health", "log.csv", "-o", "out.rrd")):
        done = imuwb(*command)
        assert done.code == 3
        assert "no usable stream" in done.err
        assert "voltage" in done.err
    assert names(tmp_path) == ["log.csv"]


def test_the_same_imu_twice_is_wrong_usage(imuwb, two):
    assert imuwb("convert", two, "-o", "c.csv", "--imu", "/a+/a").code == 2


def test_a_start_before_the_log_is_wrong_usage(imuwb, single):
    assert imuwb("convert", single, "-o", "c.csv", "--start", "-1").code == 2


def test_frame_and_epoch_survive_csv(imuwb, csv_log, rows, tmp_path):
    path = csv_log(rows())
    path.with_name("log.csv.toml").write_text('frame = "FLU"\nepoch = "boot"\n', "utf-8")
    assert imuwb("convert", path, "-o", "out.csv").code == 0
    (found,), (truth,) = read(tmp_path / "out.csv").imus, read(path).imus
    assert (found.origin.frame, found.origin.epoch) == ("FRD (stated)", "boot")
    assert found.specific_force.value.tolist() == truth.specific_force.value.tolist()


def test_one_table_is_not_called_each(imuwb, static_mcap):
    wrote = " ".join(imuwb("convert", static_mcap, "-o", "one.csv").err.split()).partition(" Wrote ")[2]
    assert wrote == "one.csv, one.csv.toml beside it"

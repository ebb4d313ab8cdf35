"""Remote logs: how many bytes and requests they take, what is tried again, and what the errors are."""

import hashlib
import json
import socket
import tempfile

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import describe, read, stream
from imuwb.readers.bytes import remote, stores, transfer
from imuwb.readers.bytes.address import Address
from imuwb.readers.bytes.remote import RemoteLog
from imuwb.readers.reading import indexed
from imuwb.selection import Part

from .large_mcap import large_mcap

T = 1_714_564_800 * 10**9
HEADER = "time_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g\n"
SAMPLES = 3000


def rows(count=SAMPLES, header=HEADER):
    return (header + "".join(f"{i / 100},{i % 7},2,3,0,0,-1\n" for i in range(count))).encode()


@pytest.fixture(scope="module")
def imu_mcap(mcap, ros):
    messages = [(T + i * 10**7, ros.imu(T + i * 10**7, (1, 2, 3), (0, 0, 9.8))) for i in range(SAMPLES)]
    return mcap.write(mcap.Topic(messages), chunk_size=1 << 16).read_bytes()


@pytest.fixture
def no_copy(monkeypatch):
    """Fail where a copy of a log is made."""

    def refuse(*_, **__):
        raise AssertionError("a copy was made")

    monkeypatch.setattr(tempfile, "TemporaryDirectory", refuse)


@pytest.fixture
def copies(monkeypatch, tmp_path):
    """Return the folder of copies."""
    folder = tmp_path / "copies"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def digest(content):
    return f"sha256:{hashlib.sha256(content).hexdigest()}"


def check_rows(log, count=SAMPLES):
    assert [len(imu.angular_rate) for imu in log.imus] == [count]


def test_an_mcap_streams_once_and_is_hashed_on_the_way(web, imu_mcap, no_copy):
    web.objects["a/log.mcap"] = imu_mcap
    log = read(web.url("a/log.mcap"))
    check_rows(log)
    assert log.provenance.hash == digest(imu_mcap)
    assert (log.provenance.path, log.provenance.size) == (web.url("a/log.mcap"), len(imu_mcap))
    assert web.sent == len(imu_mcap)
    starts = [request.start for request in web.requests]
    assert starts == sorted(starts)


def test_pieces_of_a_remote_log_come_as_those_of_a_file(web, imu_mcap):
    web.objects["log.mcap"] = imu_mcap
    parts = list(stream(web.url("log.mcap")))
    assert sum(part.time.size for part in parts if hasattr(part, "time")) == SAMPLES


@pytest.mark.parametrize("ranges", [True, False])
def test_a_text_log_is_copied_once_and_the_copy_is_removed(web, copies, ranges):
    web.ranges = ranges
    web.objects["log.csv"] = content = rows()
    log = read(web.url("log.csv"))
    check_rows(log)
    assert log.provenance.hash == digest(content)
    starts = [request.start for request in web.requests if request.path == "/log.csv"]
    assert starts == ([0] if ranges else [0, None])
    assert list(copies.iterdir()) == []


def test_an_mcap_of_a_server_without_ranges_is_copied_once(web, imu_mcap, copies):
    web.ranges = False
    web.objects["log.mcap"] = imu_mcap
    log = read(web.url("log.mcap"))
    assert log.provenance.hash == digest(imu_mcap)
    assert [request.start for request in web.requests] == [0, None]
    assert list(copies.iterdir()) == []


def test_a_packed_text_log(web):
    import gzip

    web.objects["log.csv.gz"] = gzip.compress(rows())
    check_rows(read(web.url("log.csv.gz")))


@pytest.fixture(scope="module")
def gigabyte(ros):
    imu = ("/imu", "sensor_msgs/msg/Imu", "ros2msg", ros.imu_2, "cdr", ros.imu(T, (1, 2, 3), (0, 0, 9.8)))
    fix = {"latitude": 52.1, "longitude": 4.3, "altitude": 20.5}
    gnss = ("/fix", "Fix", "jsonschema", "{}", "json", json.dumps(fix).encode())
    image = ("/camera", "sensor_msgs/msg/Image", "ros2msg", "uint8[] data\n", "cdr", bytes(4))
    return large_mcap([imu, gnss, image], 1 << 20, 1024, T, 10**9)


def test_the_index_of_a_gigabyte_takes_few_bytes_and_requests(web, gigabyte, no_copy):
    web.objects["large.mcap"] = gigabyte
    summary = indexed(web.url("large.mcap"))
    assert len(gigabyte) > 2**30
    assert {s.name: (s.kind, s.count) for s in summary.streams} == {"/imu": ("imu", 1024), "/fix": ("gnss", 1024)}
    assert "from_index" in ids(summary.notes)
    assert (web.sent <= 500_000, len(web.requests) <= 8) == (True, True)


@pytest.mark.parametrize("size", [1, 65_536, 65_537, 200_001, 300_000])
def test_the_hash_is_that_of_all_bytes_after_jumps_too(web, size):
    content = np.random.default_rng(size).bytes(size)
    web.objects["log.bin"] = content
    with RemoteLog(Address(web.url("log.bin"))) as log, log.open() as file:
        for at in (size - 1, size // 2, 3):
            file.seek(at)
            assert file.read(1) == content[at : at + 1]
        file.seek(0)
        assert file.read() == content
        assert log.fingerprint() == digest(content)


def test_a_part_of_a_log_takes_a_part_of_its_bytes(web, mcap, ros):
    times = range(T, T + 150 * 10**9, 10**7)
    path = mcap.write(mcap.Topic([(t, ros.imu(t, (1, 2, 3), (0, 0, 9.8))) for t in times]), chunk_size=1 << 16)
    web.objects["log.mcap"] = content = path.read_bytes()
    wanted = Part(start="100", end="103")
    remote_part, part = read(web.url("log.mcap"), part=wanted), read(path, part=wanted)
    np.testing.assert_array_equal(remote_part.imus[0].angular_rate.time, part.imus[0].angular_rate.time)
    assert (len(part.imus[0].angular_rate), web.sent < 0.7 * len(content)) == (300, True)


def test_describe_reads_a_log_without_an_index(web):
    web.objects["log.csv"] = rows()
    assert [s.count for s in describe(web.url("log.csv")).streams] == [SAMPLES]


def test_a_connection_that_is_cut_once_goes_on_where_it_ended(web, imu_mcap):
    web.objects["log.mcap"], web.cut, web.cuts = imu_mcap, 100_000, 1
    assert read(web.url("log.mcap")).provenance.hash == digest(imu_mcap)
    assert web.sent == len(imu_mcap)


@pytest.mark.parametrize("ranges", [True, False])
def test_a_copy_goes_on_where_it_ended(web, ranges):
    web.ranges, web.cut, web.cuts = ranges, 20_000, 2
    web.objects["log.csv"] = content = rows()
    assert read(web.url("log.csv")).provenance.hash == digest(content)


def test_a_slow_server_that_is_cut_now_and_then(web, imu_mcap):
    web.objects["log.mcap"], web.slow, web.cut, web.cuts = imu_mcap, True, len(imu_mcap) // 4, 3
    assert read(web.url("log.mcap")).provenance.hash == digest(imu_mcap)


def test_a_connection_that_is_always_cut_ends_with_its_place(web, copies):
    web.objects["log.csv"], web.cut = (content := rows(6000)), 1000
    with pytest.raises(UnreadableLogError, match=rf"byte \d+000 of {len(content)} after {transfer.ATTEMPTS} attempts"):
        read(web.url("log.csv"))
    assert len(web.requests) <= transfer.ATTEMPTS
    assert list(copies.iterdir()) == []


def test_a_length_that_is_wrong_ends_with_its_place(web):
    web.ranges, web.claimed = False, 50
    web.objects["log.csv"] = content = rows()
    with pytest.raises(UnreadableLogError, match=f"byte {len(content)} of {len(content) + 50} "):
        read(web.url("log.csv"))


def test_a_server_that_fails_twice_is_asked_again(web):
    web.objects["log.csv"], web.statuses = rows(), [500, 503]
    check_rows(read(web.url("log.csv")))


@pytest.mark.parametrize(
    ("status", "match", "requests"),
    [
        (404, "no such object", 1),
        (403, "access is denied", 1),
        (401, "access is denied", 1),
        (410, "status 410", 1),
        (503, "status 503", 5),
    ],
)
def test_statuses(web, status, match, requests):
    web.statuses = [status] * 9
    with pytest.raises(UnreadableLogError, match=match):
        read(web.url("log.csv"))
    assert len(web.requests) == requests


def test_access_that_ends_during_the_transfer(web):
    web.objects["log.csv"] = content = rows(20_000)
    web.then = lambda: web.statuses.append(403)
    with pytest.raises(UnreadableLogError, match=f"byte {remote.HEAD} of {len(content)}: access is denied"):
        read(web.url("log.csv"))


@pytest.mark.parametrize("tags", [True, False])
def test_an_object_that_changes_is_noticed(web, imu_mcap, tags):
    web.objects["log.mcap"], web.tags = imu_mcap, tags

    def change():
        web.objects["log.mcap"] = imu_mcap[::-1] if tags else imu_mcap[:-1]

    web.then = change
    with pytest.raises(UnreadableLogError, match="changed while it was read"):
        read(web.url("log.mcap"))


def test_redirects(web):
    web.objects["there/log.csv"], web.redirects["log.csv"] = rows(), "/there/log.csv"
    check_rows(read(web.url("log.csv")))


def test_a_user_and_a_query_reach_the_server_and_nothing_else(web):
    web.objects["log.csv"] = rows()
    log = read(web.url("log.csv", "us%20er:SECRET@", "?X-Amz-Signature=SECRET"))
    assert "SECRET" not in repr(log) + str(log.provenance) + "".join(log.notes)
    assert {request.path for request in web.requests} == {"/log.csv?X-Amz-Signature=SECRET"}
    assert {request.authorization for request in web.requests} == {"Basic dXMgZXI6U0VDUkVU"}


def test_errors_have_no_secrets(web):
    for statuses in ([404], [403], [500] * 9, [400]):
        web.statuses = statuses
        with pytest.raises(UnreadableLogError) as raised:
            read(web.url("log.csv", "user:SECRET@", "?sig=SECRET"))
        assert "SECRET" not in str(raised.value)
        assert raised.value.__cause__ is None
        assert web.url("log.csv") in str(raised.value)


def test_a_name_that_is_not_resolved(web):
    with pytest.raises(UnreadableLogError, match="cannot be resolved"):
        read("http://host.invalid/log.csv")


def test_a_port_where_nothing_listens(web):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(UnreadableLogError, match="cannot be reached"):
            read(f"http://127.0.0.1:{taken.getsockname()[1]}/log.csv")


def test_a_host_that_sends_nothing(web, monkeypatch):
    from datetime import timedelta

    monkeypatch.setitem(stores.TIMES, "read_timeout", timedelta(milliseconds=20))
    web.silent = True
    with pytest.raises(UnreadableLogError, match="sent nothing"):
        read(web.url("log.csv"))


def test_an_empty_object(web):
    web.objects["log.csv"] = b""
    with pytest.raises(UnreadableLogError, match="empty"):
        read(web.url("log.csv"))


def test_a_web_page_is_no_log(web):
    web.page = b"<!DOCTYPE html><html><body>1, 2, 3</body></html>"
    with pytest.raises(UnreadableLogError, match="web page"):
        read(web.url("log.csv"))


def test_a_disk_without_room(web, monkeypatch, copies):
    from types import SimpleNamespace

    monkeypatch.setattr(remote.shutil, "disk_usage", lambda _: SimpleNamespace(free=1000))
    web.objects["log.csv"] = content = rows()
    with pytest.raises(UnreadableLogError, match=f"{len(content)} bytes.*TMPDIR"):
        read(web.url("log.csv"))
    assert list(copies.iterdir()) == []


def test_a_folder_of_copies_that_cannot_be_written(web, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    web.objects["log.csv"] = rows()
    with pytest.raises(UnreadableLogError, match="TMPDIR"):
        read(web.url("log.csv"))


def test_the_sidecar_of_a_remote_log_is_asked_for_once(web):
    web.objects["a/log.csv"] = rows(header=HEADER.replace("_dps", "").replace("_g", ""))
    web.objects["a/log.toml"] = b'units = { gyro = "deg/s", accel = "g" }\n'
    log = read(web.url("a/log.csv"))
    assert "sidecar" in ids(log.notes)
    np.testing.assert_allclose(log.imus[0].specific_force.value[0], (0, 0, -9.80665), atol=1e-9)
    paths = [request.path for request in web.requests]
    assert paths.count("/a/log.toml") == paths.count("/a/log.csv.toml") == 1


def test_the_file_of_the_other_sensor_is_asked_for(web):
    lines = [f"{i / 100:.2f},0.1,0.2,{i % 9}\n" for i in range(50)]
    web.objects["a/Gyroscope.csv"] = ("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n" + "".join(lines)).encode()
    web.objects["a/Accelerometer.csv"] = (
        ("time_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n" + "".join(lines)).replace("0.2", "9.8").encode()
    )
    (imu,) = read(web.url("a/Gyroscope.csv")).imus
    assert len(imu.angular_rate) == len(imu.specific_force) == 50


def test_faults_of_a_remote_sidecar_name_its_address(web, copies):
    web.objects |= {"a/log.csv": rows(), "a/log.toml": b"speed = 3\n"}
    with pytest.raises(UsageError, match="unknown key") as raised:
        read(web.url("a/log.csv"))
    assert web.url("a/log.toml") in str(raised.value)
    assert str(copies) not in str(raised.value)


def test_errors_of_the_content_name_the_address(web, copies):
    web.objects["a/log.csv"] = rows(header="time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n")
    with pytest.raises(UsageError, match="--units") as raised:
        read(web.url("a/log.csv"))
    assert web.url("a/log.csv") in str(raised.value)
    assert str(copies) not in str(raised.value)


def test_a_signed_log_has_no_sidecar_and_a_page_is_none(web):
    web.objects["log.csv"] = rows()
    web.page = b"<html>not here</html>"
    log = read(web.url("log.csv", query="?sig=1"))
    check_rows(log)
    assert "beside-not-sought" in ids(log.notes)
    assert "sig=1" not in "".join(log.notes)
    assert {request.path for request in web.requests} == {"/log.csv?sig=1"}
    check_rows(read(web.url("log.csv")))


def test_a_sidecar_without_access_is_noted(web):
    web.objects["log.csv"] = rows()
    asked = iter(range(99))

    def deny():
        if next(asked) == 1:  # after the log
            web.statuses.append(403)

    web.then = deny
    assert "beside-not-read" in ids(read(web.url("log.csv")).notes)

"""Remote logs on the command line: S3, Google and Azure from the environment, outputs, exit codes, and no secrets anywhere."""

import json
import subprocess
import sys

import pytest

from tests.readers.bytes.large_mcap import large_mcap

SECRETS = ("SECRET-KEY-ID", "SECRET-ACCESS-KEY", "SECRET-WORD", "SECRET-QUERY")
IMU = "time_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g\n" + "".join(f"{i / 100},{i % 7},2,3,0,0,-1\n" for i in range(3000))
POS = """% program   : RTKLIB
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)
""" + "".join(
    f"2024/05/01 00:00:{i:02d}.000   52.000000000    4.000000000    10.0000   1  10   0.0100   0.0100   0.0200\n"
    for i in range(30)
)


def without_secrets(folder, *runs):
    """Check what was printed, and every file that was written."""
    shown = "".join(run.out + run.err for run in runs)
    written = b"".join(path.read_bytes() for path in folder.rglob("*") if path.is_file())
    assert not [secret for secret in SECRETS if secret in shown or secret.encode() in written]


def test_a_log_in_s3(imuwb, bucket, tmp_path, static_mcap):
    bucket.put("runs/still 1.mcap", static_mcap.read_bytes())
    static_mcap.unlink()
    address = "s3://logs/runs/still 1.mcap"
    info, health = imuwb("info", address, "--json"), imuwb("health", address, "--json", "health.json")
    assert (info.code, health.code) == (0, 0)
    assert json.loads(info.out)["path"] == address
    document = json.loads((tmp_path / "health.json").read_text("utf-8"))
    assert [log["path"] for log in document["logs"]] == [address]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["health.json", "still 1.rrd"]
    again = imuwb("health", address)
    assert (again.code, "--force" in again.err) == (2, True)
    without_secrets(tmp_path, info, health, again)


def test_a_receiver_of_another_address_is_joined(imuwb, bucket, tmp_path):
    bucket.put("imu.csv", IMU.encode())
    bucket.put("gnss.pos", POS.encode())
    done = imuwb(
        "convert", "s3://logs/imu.csv", "--gnss", "s3://logs/gnss.pos", "--gnss-shift", "start", "-o", "both.mcap"
    )
    assert done.code == 0, done.err
    info = imuwb("info", "both.mcap", "--json")
    assert {stream["kind"] for stream in json.loads(info.out)["streams"]} == {"imu", "gnss"}
    without_secrets(tmp_path, done, info)


@pytest.mark.parametrize(
    ("address", "code", "match"),
    [
        ("s3://logs/none.mcap", 4, "NoSuchKey"),
        ("s3://no-such-bucket/log.mcap", 4, "NoSuchBucket"),
        ("s3://logs/", 2, "one object"),
        ("s3://logs/runs/", 2, "one object"),
    ],
)
def test_what_is_not_in_s3(imuwb, bucket, tmp_path, address, code, match):
    for command in (("info", address), ("health", address), ("convert", address, "-o", "out.mcap")):
        done = imuwb(*command)
        assert (done.code, match in done.err, address in done.err) == (code, True, True)
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_no_store_is_asked_for(imuwb, bucket):
    done = imuwb("info", "s3://logs/a//log.csv")
    assert (done.code, "attempts" in done.err) == (4, False)


def test_an_endpoint_without_a_scheme(imuwb, bucket):
    done = imuwb("info", "s3://logs/log.csv", AWS_ENDPOINT_URL="localhost:9000")
    assert (done.code, "AWS_ENDPOINT_URL" in done.err) == (2, True)


def test_an_empty_object_in_s3(imuwb, bucket):
    bucket.put("empty.csv", b"")
    assert imuwb("info", "s3://logs/empty.csv").code == 4


def test_a_profile_without_its_package_or_its_section(imuwb, bucket, monkeypatch, tmp_path):
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.setenv("AWS_PROFILE", "nobody")
    monkeypatch.setenv("AWS_CONFIG_FILE", str(tmp_path / "config"))
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "credentials"))
    done = imuwb("info", "s3://logs/log.mcap")
    assert (done.code, "nobody" in done.err) == (2, True)
    from imuwb.readers.bytes import stores

    monkeypatch.setattr(stores, "find_spec", lambda _: None)
    done = imuwb("info", "s3://logs/log.mcap")
    assert (done.code, "boto3" in done.err) == (2, True)


def test_a_profile(imuwb, bucket, monkeypatch, tmp_path):
    pytest.importorskip("boto3")
    bucket.put("imu.csv", IMU.encode())
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY")
    credentials = tmp_path / "credentials"
    credentials.write_text(
        "[lab]\naws_access_key_id = SECRET-KEY-ID\naws_secret_access_key = SECRET-ACCESS-KEY\n", "utf-8"
    )
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(credentials))
    monkeypatch.setenv("AWS_PROFILE", "lab")
    assert imuwb("info", "s3://logs/imu.csv").code == 0


@pytest.mark.parametrize(
    ("scheme", "environment"),
    [
        ("gs", {"GOOGLE_BASE_URL": "URL", "GOOGLE_SKIP_SIGNATURE": "true"}),
        (
            "az",
            {"AZURE_STORAGE_ENDPOINT": "URL", "AZURE_STORAGE_ACCOUNT_NAME": "account", "AZURE_SKIP_SIGNATURE": "true"},
        ),
        ("s3", {"AWS_ENDPOINT_URL_S3": "URL", "AWS_SKIP_SIGNATURE": "true"}),
    ],
)
def test_public_objects_of_each_store(imuwb, web, scheme, environment):
    for key in ("bucket/a/log.csv", "bucket/a%2Flog%2Ecsv"):  # Google's object names are one part of a path
        web.objects[key] = IMU.encode()
    variables = {name: value.replace("URL", f"http://127.0.0.1:{web.port}") for name, value in environment.items()}
    done = imuwb("info", f"{scheme}://bucket/a/log.csv", "--json", **variables)
    assert done.code == 0, done.err
    assert json.loads(done.out)["path"] == f"{scheme}://bucket/a/log.csv"
    assert {request.authorization for request in web.requests} == {None}


def test_requests_without_credentials_are_not_signed(imuwb, web, monkeypatch):
    from imuwb.readers.bytes import stores

    monkeypatch.setattr(stores, "find_spec", lambda _: None)  # boto3 would look for more
    for names in stores.CREDENTIALS.values():
        for name in names:
            monkeypatch.delenv(name, raising=False)
    web.objects["bucket/log.csv"] = IMU.encode()
    done = imuwb("info", "s3://bucket/log.csv", AWS_ENDPOINT_URL=f"http://127.0.0.1:{web.port}")
    assert (done.code, {request.authorization for request in web.requests}) == (0, {None})


def test_azure_without_an_account(imuwb, monkeypatch):
    monkeypatch.delenv("AZURE_STORAGE_ACCOUNT_NAME", raising=False)
    done = imuwb("info", "az://container/log.csv")
    assert (done.code, "AZURE_STORAGE_ACCOUNT_NAME" in done.err) == (2, True)


def test_secrets_of_a_url_are_shown_nowhere(imuwb, web, tmp_path):
    web.objects["a/log.csv"] = IMU.encode()
    address = web.url("a/log.csv", "user:SECRET-WORD@", "?X-Amz-Signature=SECRET-QUERY")
    runs = [
        imuwb("info", address), imuwb("info", address, "--json"), imuwb("health", address, "--json", "h.json"),
        imuwb("convert", address, "-o", "out.csv"), imuwb("convert", address, "-o", "out.mcap"),
        imuwb("convert", address, "--gnss", address, "-o", "two.mcap"), imuwb("health", address),
        imuwb("info", address.replace("log", "none")), imuwb(address), imuwb("convert", address, "-o", address),
        imuwb("outage", address, "--error-model", address), imuwb("info", address, "--columns", "a,b"),
        imuwb("model", "show", address), imuwb("view", address),
    ]  # fmt: skip
    assert [run.code for run in runs] == [0, 0, 0, 0, 0, 3, 2, 4, 2, 2, 2, 2, 2, 2]
    web.statuses = [403] * 4
    runs += [imuwb("info", address), imuwb("health", address, "-o", "x.rrd")]
    assert [run.code for run in runs[-2:]] == [4, 4]
    assert (tmp_path / "log.rrd").is_file()
    without_secrets(tmp_path, *runs)


def test_info_takes_the_index_of_a_large_remote_log(imuwb, web, ros):
    time = 1_714_564_800 * 10**9
    imu = ("/imu", "sensor_msgs/msg/Imu", "ros2msg", ros.imu_2, "cdr", ros.imu(time, (1, 2, 3), (0, 0, 9.8)))
    image = ("/camera", "sensor_msgs/msg/Image", "ros2msg", "uint8[] data\n", "cdr", bytes(4))
    web.objects["log.mcap"] = large_mcap([imu, image], 1 << 20, 20, time, 10**9)
    done = imuwb("info", web.url("log.mcap"), "--json")
    assert (done.code, [s["count"] for s in json.loads(done.out)["streams"]]) == (0, [20])
    assert web.sent < 1 << 18
    scanned = imuwb("info", web.url("log.mcap"), "--scan", "--json")
    assert [s["name"] for s in json.loads(scanned.out)["streams"]] == ["/imu"]
    assert web.sent > 20 << 20


def test_a_file_address_is_a_path(imuwb, csv_log, rows, tmp_path):
    path = csv_log(rows(), "my log.csv")
    done = imuwb("info", path.as_uri(), "--json")
    assert (done.code, json.loads(done.out)["path"]) == (0, str(path))


def test_local_logs_cause_no_traffic(mcap, ros):
    """Neither obstore nor a socket is there, also where a log has addresses in it."""
    name = "http://127.0.0.1:9/log.csv"
    messages = [(i * 10**7 + 10**18, ros.imu(i * 10**7 + 10**18, (1, 2, 3), (0, 0, 9.8), name)) for i in range(100)]
    path = mcap.write(mcap.Topic(messages, topic=name))
    code = "import sys, imuwb; imuwb.read(sys.argv[1]); sys.exit('obstore' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code, path], check=False).returncode == 0

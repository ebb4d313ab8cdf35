"""A sidecar is known by its content, not by its name alone."""

import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.text.sidecar import sidecar_of
from imuwb.simulation import preset

TEXT = "gx,gy,gz,ax,ay,az\n" + "\n".join(f"{i},0,0,0,0,1" for i in range(20))
SIDECAR = 'rate = 50\nunits = { gyro = "deg/s", accel = "g" }\n'
MODEL = preset("mpu-6050").to_toml()
FILTER = 'schema = 1\nfilter = "full"\n[error_model.gyro_x]\nprocesses = []\n'
LIMITS = '[gyro]\nN = "0.3 deg/√h"\n'


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "drive.csv"
    path.write_text(TEXT, "utf-8")
    return path


@pytest.mark.parametrize("model", [MODEL, FILTER, LIMITS], ids=["model", "filter", "limits"])
def test_a_model_under_the_name_of_a_sidecar_does_not_hide_the_sidecar(log, model):
    log.with_name("drive.csv.toml").write_text(model, "utf-8")
    log.with_name("drive.toml").write_text(SIDECAR, "utf-8")
    (imu,) = read(log).imus
    assert imu.angular_rate.time[1] == 20_000_000
    assert {"no-sidecar", "sidecar"} <= set(ids(read(log).notes))
    assert sidecar_of(log) == log.with_name("drive.toml")


def test_a_model_alone_leaves_the_log_to_its_options(log):
    log.with_name("drive.toml").write_text(MODEL, "utf-8")
    with pytest.raises(UsageError) as error:
        read(log)
    assert "drive.toml" not in str(error.value)
    assert sidecar_of(log) is None


def test_a_sidecar_with_the_keys_of_a_model_is_refused_with_the_key(log):
    log.with_name("drive.toml").write_text(SIDECAR + "[gyro_x]\nbias = 1\n", "utf-8")
    with pytest.raises(UsageError, match=r"drive\.toml: unknown key 'gyro_x'"):
        read(log)


def test_what_is_no_toml_is_refused_by_the_reader_and_is_no_sidecar(log):
    log.with_name("drive.toml").write_text("rate = [", "utf-8")
    with pytest.raises(UsageError, match=r"drive\.toml"):
        read(log)
    assert sidecar_of(log) is None

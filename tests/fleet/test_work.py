"""The work on one log: faults of a network are tried again, those of the log are not."""

import pytest

from imuwb.cli.fleet.work import Job, Settings, prepare, work
from imuwb.cli.options import Part
from imuwb.fleet.executor import Bounds, Call
from imuwb.fleet.identity import NOBODY
from imuwb.fleet.in_process import InProcess
from imuwb.fleet.listing import Listed
from imuwb.fleet.plan import Task
from imuwb.fleet.running import completed
from imuwb.readers.bytes import transfer
from imuwb.readers.read_options import ReadOptions

TABLE = b"time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n" + b"".join(
    b"%.2f,0.1,0.2,%.2f\n" % (i / 100, i % 7) for i in range(300)
)
PLUGIN = """
'''Rows of a log.'''
from dataclasses import dataclass
from imuwb.analysis import Answer
from imuwb.statistics import Estimate

@dataclass(frozen=True)
class Parameters:
    pass

def run(logs, parameters):
    return len(logs[0].imu().angular_rate)

def draw(result, review):
    pass

def answer(result):
    return Answer("", numbers={"rows": Estimate(result, result, result)})
"""


@pytest.mark.parametrize(("failures", "kind"), [(1, ""), (2, "transport")])
def test_a_log_whose_server_fails_is_read_once_more(web, tmp_path, failures, kind):
    web.objects["a.csv"] = TABLE
    web.statuses = [500] * (failures * transfer.ATTEMPTS)
    (tmp_path / "rows.py").write_text(PLUGIN)
    file, results = str(tmp_path / "rows.py"), str(tmp_path / "results")
    settings = Settings("rows", file, "", {}, Part(), ReadOptions(), (), results, "run")
    job = Job(settings, Task(Listed(web.url("a.csv"), len(TABLE), "t"), NOBODY, (), "", "t"), look=False)
    (done,) = completed([Call(work, job, Bounds(600, 4e9), prepare)], InProcess())
    assert (done.fault.kind if done.fault else "") == kind
    assert len(list((tmp_path / "results").rglob("*.parquet"))) == (0 if kind else 1)

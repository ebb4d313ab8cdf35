"""--smoothed: the smoothed trajectory in each format."""

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pyarrow.csv
import pytest

import imuwb
from imuwb.notes import ids
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters
from imuwb_plugins.outage.output import outputs, write_outputs

from .made import stated

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result(log, toml):
    return outage.run([log], stated(error_model=toml, models="full", at="150:10", smoothed="s.csv"))


@pytest.fixture
def written(result, toml, tmp_path):
    def write(name):
        parameters = Parameters(error_model=toml, models="full", at="150:10", smoothed=tmp_path / name)
        assert outputs(parameters)[0] == tmp_path / name
        write_outputs(result, parameters)
        return tmp_path / name

    return write


def test_a_table_at_the_rate_of_the_imu(result, written, log):
    path = written("s.csv")
    table = {name: column.to_numpy() for name, column in zip(*_columns(path), strict=True)}
    assert "separation" in ids(result.notes)
    assert np.median(np.diff(table["time_ns"])) == 20_000_000
    for way in ("north", "east", "down"):
        assert (table[f"sigma_{way}_m"] <= table[f"forward_own_sigma_{way}_m"] * (1 + 1e-9)).all()
        apart = table[f"backward_minus_smoothed_{way}_m"] - table[f"forward_minus_smoothed_{way}_m"]
        assert table[f"separation_{way}_m"] == pytest.approx(apart, nan_ok=True)
    (found,) = imuwb.read(path).references
    assert found.position_sigma.shape == found.position.shape
    assert found.attitude_sigma is not None
    assert len(found) == len(result.smoothed.smoothed)
    assert log.references[0].time[-1] >= found.time[0]


def _columns(path):
    table = pyarrow.csv.read_csv(path)
    return table.column_names, table.columns


def test_three_trajectories_of_mcap_and_kml(written):
    names = [r.name.partition(",")[0] for r in imuwb.read(written("s.mcap")).references]
    assert names == ["smoothed", "forward", "backward"]
    root = ET.parse(written("s.kml")).getroot()  # noqa: S314 - our own file
    assert len(root.findall(".//{http://www.opengis.net/kml/2.2}LineString")) == 3


def test_tum_has_the_smoothed_one(written, result):
    lines = written("s.tum").read_text("utf-8").splitlines()
    assert len(lines) == len(result.smoothed.smoothed)


def test_it_can_be_a_solution_and_a_truth(written, log, toml):
    path = written("s.csv")
    found = outage.run(
        [log], stated(error_model=toml, models="full", at="150:10", solution={"smoothed": Path(f"whole:{path}")})
    )
    assert found.whole_run["smoothed"].median_end < found.whole_run["full"].median_end
    assert found.whole_run["smoothed"].nees_per_dof is not None


def test_another_suffix_is_refused(command, mcap, toml):
    code, _, err = command("outage", mcap, "--error-model", toml, "--smoothed", "s.gpx", "-o", "o.rrd")
    assert (code, ".kml" in err) == (2, True)
    assert not Path("o.rrd").exists()

"""Trajectories for other tools."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

import imuwb
from imuwb.errors import UsageError
from imuwb.geodesy.attitude import quaternion_of_rotation, rotation_of_euler
from imuwb.log import BY_FILTER, Origin, Reference
from imuwb.readers import describe
from imuwb.writers.trajectory import write_trajectory

N = 50
TIME = 1_700_000_000_123_456_789 + np.arange(N) * 200_000_000
POSITION = np.stack([0.7 + np.linspace(0, 1e-4, N), 0.2 - np.linspace(0, 2e-4, N), np.linspace(200, 230, N)], axis=1)
EULER = np.stack([np.linspace(-0.1, 0.1, N), np.linspace(0.05, 0, N), np.linspace(-3, 3, N)], axis=1)
QUATERNION = np.array([quaternion_of_rotation(rotation_of_euler(e)) for e in EULER])
TRACK = Reference("a <b> & c", TIME, POSITION, np.ones((N, 3)), EULER)


def test_tum_has_local_metres_and_whole_stamps(tmp_path):
    file = tmp_path / "track.tum"
    write_trajectory(TRACK, QUATERNION, file)
    lines = [line.split() for line in file.read_text().splitlines()]
    assert len(lines) == N
    assert [line[0] for line in lines[:2]] == ["1700000000.123456789", "1700000000.323456789"]
    numbers = np.array([[float(x) for x in line] for line in lines])
    assert numbers[0, 1:4].tolist() == [0, 0, 0]
    assert numbers[-1, 1] == pytest.approx(6_378_137 * 1e-4, rel=5e-3)
    assert numbers[-1, 2] == pytest.approx(-6_378_137 * 2e-4 * np.cos(0.7), rel=5e-3)
    assert numbers[-1, 3] == pytest.approx(-30, abs=0.2)  # the plane leaves the ellipsoid
    assert numbers[:, [7, 4, 5, 6]] == pytest.approx(QUATERNION, abs=1e-8)


def test_kml_is_well_formed_and_in_degrees(tmp_path):
    file = tmp_path / "track.kml"
    write_trajectory(TRACK, QUATERNION, file)
    root = ET.parse(file).getroot()  # noqa: S314 - our own file
    space = {"k": "http://www.opengis.net/kml/2.2"}
    assert root.find(".//k:name", space).text == "a <b> & c"
    points = [p.split(",") for p in root.find(".//k:coordinates", space).text.split()]
    assert len(points) == N
    assert [float(x) for x in points[0]] == pytest.approx([np.degrees(0.2), np.degrees(0.7), 200], abs=1e-6)


@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_what_is_written_as_a_log_is_read_as_a_reference(tmp_path, suffix):
    file = tmp_path / f"track{suffix}"
    write_trajectory(TRACK, QUATERNION, file)
    (found,) = imuwb.read(file).references
    assert np.array_equal(found.time, TIME)
    assert found.position == pytest.approx(POSITION, abs=1e-9)
    assert found.attitude == pytest.approx(EULER, abs=1e-9)


SIGMAS = {
    "position_sigma": np.tile([1.0, 2.0, np.nan], (N, 1)), "velocity_sigma": np.full((N, 3), 0.1),
    "attitude_sigma": np.linspace(0.001, 0.002, 3 * N).reshape(N, 3),
}  # fmt: skip


@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_sigmas_are_read_as_they_are_written(tmp_path, suffix):
    file = tmp_path / f"track{suffix}"
    write_trajectory(replace(TRACK, **SIGMAS), QUATERNION, file)
    (found,) = imuwb.read(file).references
    for name, sigma in SIGMAS.items():
        assert getattr(found, name) == pytest.approx(sigma, abs=1e-12, nan_ok=True)
    write_trajectory(TRACK, QUATERNION, file)
    assert imuwb.read(file).references[0].position_sigma is None


def test_an_estimate_of_a_filter_stays_one(tmp_path):
    estimate = replace(TRACK, origin=Origin("SI", f"NED, {BY_FILTER}", "unix"))
    write_trajectory(estimate, QUATERNION, tmp_path / "track.mcap")
    assert imuwb.read(tmp_path / "track.mcap").references[0].origin.by_filter
    assert "own filter" in describe(tmp_path / "track.mcap").streams[0].frame
    write_trajectory(TRACK, QUATERNION, tmp_path / "track.mcap")
    assert not imuwb.read(tmp_path / "track.mcap").references[0].origin.by_filter


def test_another_suffix_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r"\.tum, \.kml"):
        write_trajectory(TRACK, QUATERNION, tmp_path / "track.gpx")

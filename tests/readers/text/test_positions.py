"""Latitudes, longitudes and heights in another unit than the one that a log's columns are taken in."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import ReadOptions, read

ROWS = 50
LATITUDE = 48.1 + np.arange(ROWS) * 1e-6
LONGITUDE = 11.5


def fixes(latitudes, longitude, height=550.0, names="lat,lon,alt", before=0):
    """Return a receiver's log, of which some rows have 0 before the first fix."""
    rows = [(0.0, 0.0, 0.0)] * before + [(x, longitude, height) for x in latitudes]
    return f"time_s,{names}\n" + "".join(
        f"{i / 10:.1f},{a:.12g},{o:.12g},{h:.12g}\n" for i, (a, o, h) in enumerate(rows)
    )


@pytest.mark.parametrize("before", [0, 5])
@pytest.mark.parametrize(
    ("text", "figures"),
    [
        ((LATITUDE * 1e7, LONGITUDE * 1e7), ("4.81", "deg", "position=degE7")),
        ((4800 + (LATITUDE - 48) * 60, 1130.0), ("4806", "1130", "ddmm")),
        ((np.radians(LATITUDE), np.radians(LONGITUDE)), ("0.8395", "position=rad")),
        ((LATITUDE, LONGITUDE, 550e3), ("550000 m", "height=mm")),
    ],
)
def test_positions_in_another_unit_are_refused_with_the_likely_one(text_log, text, figures, before):
    with pytest.raises(UnreadableLogError) as caught:
        read(text_log(fixes(*text, before=before)))
    assert all(figure in str(caught.value) for figure in figures)


@pytest.mark.parametrize(
    ("text", "units", "names"),
    [
        ((LATITUDE * 1e7, LONGITUDE * 1e7, 550e3), {"position": "degE7", "height": "mm"}, "lat,lon,alt"),
        ((np.radians(LATITUDE), np.radians(LONGITUDE)), {"position": "rad"}, "lat,lon,alt"),
        ((np.radians(LATITUDE), np.radians(LONGITUDE)), {}, "lat_rad,lon_rad,alt_m"),
        ((LATITUDE, LONGITUDE), {}, "lat,lon,alt"),
    ],
)
def test_the_stated_unit_of_a_position_is_used(text_log, text, units, names):
    (gnss,) = read(text_log(fixes(*text, names=names)), ReadOptions(units=units)).gnss
    np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), LATITUDE, atol=1e-8)
    np.testing.assert_allclose(gnss.position[:, 2], 550)


@pytest.mark.parametrize("units", [{"position": "deg"}, {}])
def test_places_near_the_equator_are_read_where_degrees_are_stated(text_log, units):
    names = "lat,lon,alt" if units else "lat_deg,lon_deg,alt_m"
    (gnss,) = read(text_log(fixes(LATITUDE - 48, 0.5, names=names)), ReadOptions(units=units)).gnss
    np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), LATITUDE - 48, atol=1e-9)


def test_high_flights_are_read_where_metres_are_stated(text_log):
    (gnss,) = read(text_log(fixes(LATITUDE, LONGITUDE, 400e3)), ReadOptions(units={"height": "m"})).gnss
    np.testing.assert_allclose(gnss.position[:, 2], 400e3)

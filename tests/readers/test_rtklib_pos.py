import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read

DEG = np.pi / 180
NOON = 1_714_564_800 * 10**9  # 2024-05-01T12:00:00Z
HEADER = "%  {} latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"
CELLS = "  47.5   -122.25   101.5   {}   9   0.1   0.2   0.3   0.0   0.0   0.0   1.0   5.0"


def pos(*stamps, scale="GPST", flags=None):
    flags = flags or [1] * len(stamps)
    rows = [stamp + CELLS.format(flag) for stamp, flag in zip(stamps, flags, strict=True)]
    return "\n".join(["% program   : RTKPOST", HEADER.format(scale), *rows]) + "\n"


@pytest.fixture
def fix_of(text_log):
    def fix(text):
        (found,) = read(text_log(text, "log.pos")).gnss
        return found

    return fix


def test_positions_are_radians_and_sigmas_north_east_down(fix_of):
    fix = fix_of(pos("2024/05/01 12:00:00.000", scale="UTC"))
    np.testing.assert_allclose(fix.position, [[47.5 * DEG, -122.25 * DEG, 101.5]], rtol=1e-15)
    assert fix.position_sigma.tolist() == [[0.1, 0.2, 0.3]]
    assert fix.velocity is None


@pytest.mark.parametrize(
    ("scale", "stamp"),
    [
        ("UTC", "2024/05/01 12:00:00.125"),
        ("GPST", "2024/05/01 12:00:18.125"),
        ("JST", "2024/05/01 21:00:00.125"),
        ("GPST", "2312 302418.125"),
    ],
)
def test_every_time_scale_becomes_utc(fix_of, scale, stamp):
    fix = fix_of(pos(stamp, scale=scale))
    assert fix.time.tolist() == [NOON + 125_000_000]
    assert fix.origin.epoch == "unix"


@pytest.mark.parametrize(
    ("date", "ahead"), [("2016/06/01", 17), ("2014/06/01", 16), ("2010/06/01", 15), ("2008/06/01", 14)]
)
def test_leap_seconds_are_those_of_the_date(fix_of, date, ahead):
    gps, utc = (fix_of(pos(f"{date} 12:00:30.000", scale=scale)).time[0] for scale in ("GPST", "UTC"))
    assert utc - gps == ahead * 10**9


def test_quality_flags_become_fix_types(fix_of):
    stamps = [f"2024/05/01 12:00:{i:02d}.000" for i in range(7)]
    assert fix_of(pos(*stamps, flags=[1, 2, 3, 4, 5, 6, 9])).fix_type.tolist() == [6, 5, 4, 4, 3, 8, 0]


def test_velocity_up_becomes_down(fix_of):
    text = (
        "%  UTC latitude(deg) longitude(deg) height(m) Q vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu\n"
        "2024/05/01 12:00:00.000 47 8 400 1 1.0 2.0 3.0 0.1 0.2 0.3\n"
    )
    fix = fix_of(text)
    assert fix.velocity.tolist() == [[1.0, 2.0, -3.0]]
    assert fix.velocity_sigma.tolist() == [[0.1, 0.2, 0.3]]


def test_lines_that_are_cut_or_no_numbers_are_left_out_and_counted(fix_of):
    stamps = [f"2024/05/01 12:00:{i:02d}.000" for i in range(3)]
    text = (
        pos(*stamps)
        + "garbage here\n\n2024/13/01 12:00:05.000"
        + CELLS.format(1)
        + "\n2024/05/01 12:00:09.000 47.5 -12"
    )
    fix = fix_of(text)
    assert len(fix) == 3
    assert [(r.what, r.count) for r in fix.origin.repairs] == [("lines that are cut or no numbers left out", 3)]


def test_a_header_without_a_solution_is_refused(text_log):
    with pytest.raises(UnreadableLogError, match="without a single solution"):
        read(text_log(pos(), "log.pos"))


def test_the_header_decides_not_the_suffix(text_log):
    assert read(text_log(pos("2024/05/01 12:00:00.000"), "log.csv")).provenance.format == "rtklib"


def test_that_gps_time_was_made_utc_is_noted(text_log):
    notes = [read(text_log(pos("2024/05/01 12:00:30.000", scale=scale), "log.pos")).notes for scale in ("GPST", "UTC")]
    assert notes == [("GPS time made UTC by the leap seconds of its date",), ()]


def test_a_real_drive(shared):
    (fix,) = read(shared / "drive" / "gnss_1934_sf.pos").gnss
    assert len(fix) == 2197
    assert np.count_nonzero(fix.fix_type == 6) == 2189
    assert np.median(np.diff(fix.time)) == 250_000_000
    moved = np.cumsum(np.linalg.norm(fix.velocity[:, :2], axis=1))[-1] * 0.25
    assert moved == pytest.approx(4050, rel=0.02)
